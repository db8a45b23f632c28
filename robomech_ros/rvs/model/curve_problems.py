"""Problems drawn as two crossing curves: postures of an arm at a pose, or any two equations."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import ArrayLike

from robomech_ros.kinematics.oracles.posture_contours import MINORS, Crossing, PostureContours
from robomech_ros.numerics import CurveCrossing, CurvePair
from robomech_ros.numerics.grid_crossings import Equations
from robomech_ros.robots import SerialChain
from robomech_ros.typing import Array

# What a root leaves of the other equations, as part of their size; where curves touch, a crossing
# is known to the root of the rounding.
LEFT = 1e-6
# Joints over which contours are drawn, from 0.
JOINTS = (3, 4)


class Axis(NamedTuple):
    """One unknown of a plot, with its unit (empty for a mere number) and between what it is."""

    name: str
    unit: str
    low: float
    high: float


@dataclass(frozen=True, eq=False)
class Finding:
    """A crossing that was found.

    Parameters
    ----------
    point : ndarray, shape (2,)
    path : ndarray, shape (k, 2)
        The steps from the estimate to it.
    is_root : bool
        Whether all other equations vanish there, too; else it is spurious.
    left_over : float
        The greatest of the other equations, as part of its size.
    angle : float
        Between the curves (rad).
    condition : float or None
        Condition number of the root.
    q : ndarray, shape (n,), or None
        The posture that it is (rad), where it is one.
    """

    point: Array
    path: Array
    is_root: bool
    left_over: float
    angle: float
    condition: float | None = None
    q: Array | None = None


class CurveProblem(Protocol):
    """Two curves, and what is known of where they cross."""

    @property
    def axes(self) -> tuple[Axis, Axis]:
        """The two unknowns."""

    @property
    def others(self) -> int:
        """How many equations are left over."""

    def curves(self) -> tuple[tuple[Array, ...], ...]:
        """Return the two curves, each in pieces of connected points (k, 2)."""

    def refine(self, estimate: ArrayLike) -> Finding:
        """Refine an estimate (2,); raises what ``CurvePair.refine`` does."""

    def all(self) -> list[Finding]:
        """Find all crossings."""


class PostureProblem:
    """The postures of an arm of six revolute joints at a pose, over joints 4 and 5.

    Parameters
    ----------
    chain : SerialChain
    T : ndarray, shape (4, 4)
        ``T_base_tip`` (m).
    pair : tuple of int
        Numbers of two of ``minor_names()``.

    Raises
    ------
    BadValueError, WrongSizeError
        As :class:`~robomech_ros.kinematics.oracles.PostureContours` does.
    """

    def __init__(self, chain: SerialChain, T: Array, pair: tuple[int, int]) -> None:
        self._contours = PostureContours(chain, T, pair=[MINORS[k] for k in pair])
        names = [chain.joint_names[joint] for joint in JOINTS]
        first, second = (Axis(name, "rad", -np.pi, np.pi) for name in names)
        self.axes = (first, second)
        self.others = len(MINORS) - 2

    def curves(self) -> tuple[tuple[Array, ...], ...]:
        """Return the contours."""
        return self._contours.curves()

    def refine(self, estimate: ArrayLike) -> Finding:
        """Refine an estimate of joints 4 and 5 (rad)."""
        return _posture(self._contours.refine(estimate))

    def all(self) -> list[Finding]:
        """Find all crossings."""
        return [_posture(each) for each in self._contours.all()]


class EquationsProblem:
    """Any two equations in two unknowns, and those that are left over.

    Parameters
    ----------
    equations : callable
        As in :func:`~robomech_ros.numerics.bivariate`.
    axes : tuple of two Axis
    pair : tuple of int
        Numbers of the two equations, from 0.
    count : int
        How many equations there are.
    period : float, optional
        With which all of them repeat.

    Raises
    ------
    BadValueError, WrongSizeError
        As :class:`~robomech_ros.numerics.CurvePair` does.
    """

    def __init__(
        self,
        equations: Equations,
        axes: tuple[Axis, Axis],
        pair: tuple[int, int],
        count: int,
        period: float | None = None,
    ) -> None:
        rest = [k for k in range(count) if k not in pair]
        self.axes, self.others = axes, len(rest)

        def part(chosen: Sequence[int]) -> Equations:
            return lambda x, y: np.asarray(equations(x, y), float)[list(chosen)]

        bounds = [(axis.low, axis.high) for axis in axes]
        self._pair = CurvePair(
            part(pair), bounds, others=part(rest) if rest else None, period=period
        )

    def curves(self) -> tuple[tuple[Array, ...], ...]:
        """Return the curves."""
        return self._pair.curves()

    def refine(self, estimate: ArrayLike) -> Finding:
        """Refine an estimate."""
        return _root(self._pair.refine(estimate))

    def all(self) -> list[Finding]:
        """Find all crossings."""
        return [_root(each) for each in self._pair.all()]


def minor_names() -> tuple[str, ...]:
    """Name the equations whose contours can be drawn, by the rows of their determinants."""
    return tuple("rows " + " ".join(str(row + 1) for row in rows) for rows in MINORS)


def what_is_missing(chain: SerialChain) -> str:
    """Say in a sentence why no contours can be drawn of an arm; empty where they can."""
    if chain.n == 6 and not chain.types.any() and chain.coupling is None:
        return ""
    if chain.coupling is not None:
        why = "joints of this one follow others"
    elif chain.n != 6:
        joint = "joint" if chain.n == 1 else "joints"
        why = f"this one has {chain.n} {joint}"
    else:
        slides = [name for name, kind in zip(chain.joint_names, chain.types, strict=True) if kind]
        why = f"joint '{slides[0]}' of this one slides"
    return f"Contours are drawn for arms of six revolute joints; {why}."


def _posture(found: Crossing) -> Finding:
    known = (found.angles, found.path, found.posture is not None, found.left_over, found.across)
    if found.posture is None:
        return Finding(*known)
    return Finding(*known, found.posture.condition, found.posture.q)


def _root(found: CurveCrossing) -> Finding:
    is_root = found.left_over <= LEFT
    known = (found.point, found.path, is_root, found.left_over, found.angle)
    return Finding(*known, found.condition)
