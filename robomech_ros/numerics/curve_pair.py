"""Two curves that somebody points at: rough estimates refined to crossings, and judged."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.numerics.arrays import check_finite, real_array, shaped_array
from robomech_ros.numerics.bivariate_roots import ANGLES, bivariate, refine_root
from robomech_ros.numerics.grid_crossings import STEP, Equations, GridProblem, slopes_at
from robomech_ros.typing import Array, ArrayLike

# Cells of the grid on which curves are followed, and points of that on which the others are sized.
_CELLS, _COARSE = 240, 25
# Residual of a crossing in the drawn equations, relative to their size.
_CROSSED = 1e-9


@dataclass(frozen=True, eq=False)
class CurveCrossing:
    """Crossing of two curves.

    Parameters
    ----------
    point : ndarray, shape (2,)
        Point of the plane, within the bounds.
    path : ndarray, shape (k, 2)
        The steps from the estimate to it; they may leave the bounds by whole periods.
    left_over : float
        The greatest of the other equations there, as part of what it is in the mean; 0 where there
        is no other.
    angle : float
        Between the curves (rad), 0 to pi/2; near 0 the root is ill-conditioned.
    condition : float
        Condition number of the derivative of all equations, each in parts of its mean and by the
        unknowns in parts of the bounds' widths.
    """

    point: Array
    path: Array
    left_over: float
    angle: float
    condition: float


class CurvePair:
    """The curves on which two equations in two unknowns vanish, and what others say of crossings.

    Parameters
    ----------
    drawn : callable
        From arrays x and y of one shape (...) to the two equations, shape (2, ...); smooth.
    bounds : array_like, shape (2, 2), optional
        Least and greatest value of x, and of y; a turn of both by default.
    others : callable, optional
        The same of all other equations, shape (m, ...).
    period : float, optional
        With which all equations repeat in x and in y.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., sections 9.4 and B.4.
    """

    def __init__(
        self,
        drawn: Equations,
        bounds: ArrayLike = ANGLES,
        *,
        others: Equations | None = None,
        period: float | None = None,
    ) -> None:
        self._grid = GridProblem.of(drawn, bounds, (0, 1), period, _CELLS)
        self._others = others
        self._sizes = np.empty(0) if others is None else self._sized(others)

    @property
    def bounds(self) -> Array:
        """Least and greatest value of x, and of y, shape (2, 2)."""
        return np.stack([self._grid.low, self._grid.low + self._grid.width], axis=1)

    def curves(self) -> tuple[tuple[Array, ...], ...]:
        """Return the two curves, each in pieces of connected points (k, 2)."""
        return self._grid.curves()

    def refine(self, estimate: ArrayLike) -> CurveCrossing:
        """Refine an estimate of a crossing by Newton-Gauss.

        Parameters
        ----------
        estimate : array_like, shape (2,)
            Where to begin, for example where somebody has clicked.

        Raises
        ------
        BadValueError
            The steps lead to no crossing within the bounds, or it is no two numbers in them.
        """
        grid = self._grid
        start = self._start(estimate)
        try:
            end = refine_root(self._in_parts, (start - grid.low) / grid.width)
        except BadValueError:
            end = None
        if end is not None and np.abs(end.residual).max() <= _CROSSED:
            point = self._within(grid.low + end.x * grid.width)
            if point is not None:
                return self._crossing(point, grid.low + end.path * grid.width)
        raise BadValueError("estimate", start.tolist(), "a place near a crossing of the curves")

    def all(self) -> list[CurveCrossing]:
        """Find all crossings by increasing x; takes some tenths of a second."""
        grid = self._grid
        found = bivariate(grid.equations, self.bounds, period=grid.period, steps=_CELLS)
        return [self._crossing(point, point[None]) for point in found.crossings]

    def _sized(self, others: Equations) -> Array:
        low, high = self.bounds.T
        x, y = np.meshgrid(*np.linspace(low, high, _COARSE).T, indexing="ij")
        values = real_array("others", others(x, y))
        if values.ndim != 3 or values.shape[1:] != x.shape:
            raise WrongSizeError("others", values.shape, f"(m, {_COARSE}, {_COARSE})")
        check_finite("others", values)
        sizes: Array = np.sqrt(np.mean(values**2, axis=(1, 2)))
        sizes[sizes == 0.0] = 1.0
        return sizes

    def _start(self, estimate: ArrayLike) -> Array:
        start = shaped_array("estimate", estimate, (2,))
        (low, high), (least, most) = self.bounds
        if self._within(start) is None:
            expected = f"x from {low:.6g} to {high:.6g}, y from {least:.6g} to {most:.6g}"
            raise BadValueError("estimate", start.tolist(), expected)
        return start

    def _within(self, point: Array) -> Array | None:
        """Return a point in the bounds, by whole periods if there is one; None where it is not."""
        grid = self._grid
        if grid.period is not None:
            point = grid.low + (point - grid.low) % grid.period
        inside = (point >= grid.low) & (point <= grid.low + grid.width)
        return point if inside.all() else None

    def _in_parts(self, u: Array, v: Array) -> Array:
        """Return the scaled equations of the curves, for unknowns in parts of the bounds."""
        grid = self._grid
        x, y = (grid.low[k] + part * grid.width[k] for k, part in enumerate((u, v)))
        values = np.asarray(grid.equations(x, y), float)
        return values / grid.scale.reshape(2, *[1] * (values.ndim - 1))

    def _crossing(self, point: Array, path: Array) -> CurveCrossing:
        grid, (x, y) = self._grid, point[:, None]
        angle = float(grid.angles(point[None], (0, 1))[0])
        step = STEP * grid.width
        slopes = slopes_at(grid.equations, point[None], step)[0] / grid.scale[:, None]
        left = 0.0
        if self._others is not None:
            values = np.asarray(self._others(x, y), float)[:, 0]
            left = float(np.max(np.abs(values) / self._sizes, initial=0.0))
            more = slopes_at(self._others, point[None], step)[0] / self._sizes[:, None]
            slopes = np.vstack([slopes, more])
        condition = float(np.linalg.cond(slopes * grid.width))
        return CurveCrossing(point, path, left, angle, condition)
