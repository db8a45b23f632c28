"""Parametric curves in space: what a curve is, and curves from functions and from others."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.spatial.arrays import check_finite, listed, of_shape, real_array
from robomech_ros.spatial.poses import as_pose
from robomech_ros.trajectory.curves.compiled_sampling import sample_many
from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial
from robomech_ros.trajectory.paths.curve_arguments import as_breaks, as_parameters
from robomech_ros.trajectory.tolerances import COINCIDENT
from robomech_ros.typing import Array, ArrayLike

# Position and four derivatives: the fourth gives the rate of the torsion.
ORDERS = 5


class Curve(Protocol):
    """A curve in space over a parameter u, of any unit, from ``breaks[0]`` to ``breaks[-1]``."""

    @property
    def breaks(self) -> Array:
        """Parameters of the ends and of all places where a derivative steps, shape (k + 1,)."""

    def derivatives(self, u: ArrayLike) -> Array:
        """Position (m) and its first four derivatives with respect to u.

        Parameters
        ----------
        u : array_like, shape () or (m,)
            At an inner break the part after it counts.

        Returns
        -------
        ndarray, shape (5, 3) or (5, m, 3)
        """


@dataclass(frozen=True, eq=False)
class FunctionCurve:
    """A curve whose derivatives are given by a function.

    Attributes
    ----------
    function : callable
        From parameters, shape (m,), to position (m) and its first four derivatives, each (m, 3),
        in a frame of the curve's own.
    breaks : ndarray, shape (k + 1,)
        Ends, and places between them where a derivative steps; strictly increasing.
    pose : array_like, shape (4, 4), optional
        ``T_base_curve``, where that frame is (m).
    """

    function: Callable[[Array], Sequence[ArrayLike] | Array]
    breaks: Array
    pose: Array = None  # type: ignore[assignment]

    def __post_init__(self) -> None:
        if not callable(self.function):
            raise BadValueError("function", self.function, "a callable")
        object.__setattr__(self, "breaks", as_breaks("breaks", self.breaks))
        pose = of_shape("pose", np.eye(4) if self.pose is None else as_pose(self.pose), (4, 4))
        object.__setattr__(self, "pose", pose)

    def derivatives(self, u: ArrayLike) -> Array:
        """Position (m) and four derivatives, shape (5, 3) or (5, m, 3), as for any `Curve`."""
        return evaluated(self.breaks, u, self._rows)

    def _rows(self, u: Array) -> Array:
        what = "derivatives of the curve"
        expected = "position and four derivatives, arrays of shape (m, 3)"
        given = listed(what, self.function(u), expected)
        if len(given) != ORDERS:
            raise WrongSizeError(what, len(given), ORDERS)
        rows = np.empty((ORDERS, len(u), 3))
        for k, row in enumerate(given):
            array = real_array(f"{what}, order {k}", row)
            of_shape(f"{what}, order {k}", array, (len(u), 3))
            rows[k] = array
        check_finite(what, rows)
        placed: Array = rows @ self.pose[:3, :3].T
        placed[0] += self.pose[:3, 3]
        return placed


@dataclass(frozen=True, eq=False)
class PolynomialCurve:
    """A curve whose three coordinates (m) are piecewise polynomials of its parameter."""

    pieces: PiecewisePolynomial

    @property
    def breaks(self) -> Array:
        """Parameters of the ends and of the knots, shape (k + 1,)."""
        return self.pieces.breaks

    def derivatives(self, u: ArrayLike) -> Array:
        """Position (m) and four derivatives, shape (5, 3) or (5, m, 3), as for any `Curve`."""
        return evaluated(self.breaks, u, self._rows)

    def _rows(self, u: Array) -> Array:
        rate = PiecewisePolynomial(self.pieces.breaks, self.pieces.derivative(1))
        return np.stack([*sample_many(self.pieces, u), sample_many(rate, u).jerk])


@dataclass(frozen=True, eq=False)
class JoinedCurve:
    """Curves one after another; the parameter runs on from each to the next.

    The starts (k + 1,) are the parameters where each begins, and where the last one ends.
    """

    curves: tuple[Curve, ...]
    starts: Array

    @property
    def breaks(self) -> Array:
        """Parameters of all breaks of the curves and of the joints between them."""
        inner = [
            start + curve.breaks[:-1] - curve.breaks[0]
            for curve, start in zip(self.curves, self.starts, strict=False)
        ]
        return np.concatenate([*inner, self.starts[-1:]])

    def derivatives(self, u: ArrayLike) -> Array:
        """Position (m) and four derivatives, shape (5, 3) or (5, m, 3), as for any `Curve`."""
        return evaluated(self.starts, u, self._rows)

    def _rows(self, u: Array) -> Array:
        last = len(self.curves) - 1
        owner = np.minimum(np.searchsorted(self.starts, u, side="right") - 1, last)
        rows = np.empty((ORDERS, len(u), 3))
        order = np.argsort(owner, kind="stable")
        asked, begins = np.unique(owner[order], return_index=True)
        for k, mine in zip(asked, np.split(order, begins[1:]), strict=True):
            curve = self.curves[k]
            local = np.minimum(u[mine] - self.starts[k] + curve.breaks[0], curve.breaks[-1])
            rows[:, mine] = curve.derivatives(local)
        return rows


def join_curves(curves: Sequence[Curve]) -> JoinedCurve:
    """Join curves end to end.

    Parameters
    ----------
    curves : sequence of Curve
        Each begins where the one before it ends; directions may differ there.

    Raises
    ------
    BadValueError
        No curves, or a gap between two; the message names it.
    """
    expected = "a list of at least one curve"
    parts = tuple(
        as_curve(f"curves[{k}]", c) for k, c in enumerate(listed("curves", curves, expected))
    )
    if not parts:
        raise BadValueError("curves", curves, expected)
    ends = [part.derivatives(part.breaks[[0, -1]])[0] for part in parts]
    size = max(float(np.abs(end).max()) for end in ends)
    for k in range(1, len(parts)):
        gap = float(np.linalg.norm(ends[k][0] - ends[k - 1][1]))
        if gap > COINCIDENT * max(size, 1.0):
            expected = "each curve to start where the one before ends"
            raise BadValueError(f"gap between the curves {k - 1} and {k}", gap, expected)
    spans = [float(part.breaks[-1] - part.breaks[0]) for part in parts]
    return JoinedCurve(parts, np.concatenate([[0.0], np.cumsum(spans)]))


def as_curve(what: str, value: object) -> Curve:
    """Check that a value is a curve, or raise BadValueError."""
    if not (hasattr(value, "breaks") and callable(getattr(value, "derivatives", None))):
        raise BadValueError(what, value, "a curve, with breaks and derivatives(u)")
    return value  # type: ignore[return-value]


def evaluated(breaks: Array, u: ArrayLike, rows: Callable[[Array], Array]) -> Array:
    """Check parameters and evaluate rows (k, m, 3) for them; (k, 3) for a single parameter."""
    inside = as_parameters("parameter", u, float(breaks[0]), float(breaks[-1]))
    values = rows(np.atleast_1d(inside))
    return values if inside.ndim else values[:, 0]
