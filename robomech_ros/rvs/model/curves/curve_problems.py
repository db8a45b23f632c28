"""Problems drawn as two crossing curves: postures of an arm at a pose, or any two equations."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from robomech_ros.errors import BadValueError
from robomech_ros.errors.formatting import counted
from robomech_ros.kinematics.oracles.posture_contours import MINORS, Crossing, PostureContours
from robomech_ros.numerics import CurveCrossing, CurvePair
from robomech_ros.numerics.grid_crossings import Equations
from robomech_ros.robots import SerialChain
from robomech_ros.robots.documents.numbers_in_text import number
from robomech_ros.typing import Array

# Relative residual of a root in the other equations; where curves touch, a crossing
# is known to the root of the rounding.
LEFT = 1e-6
# Joints over which contours are drawn, from 0.
JOINTS = (3, 4)


class Axis(NamedTuple):
    """One unknown of a plot, with its unit (empty for a plain number) and its range."""

    name: str
    unit: str
    low: float
    high: float


@dataclass(frozen=True, eq=False)
class Finding:
    """A crossing that was found."""

    #: Values of the two unknowns, shape (2,).
    point: Array
    #: Steps of the iteration from the estimate to the crossing, shape (k, 2).
    path: Array
    #: Whether all other equations vanish there, too; else it is spurious.
    is_root: bool
    #: Greatest residual of the other equations, relative to the size of the equation.
    left_over: float
    #: Angle between the curves (rad).
    angle: float
    #: Condition number of the root.
    condition: float | None = None
    #: The posture of the root (rad), shape (n,); None if it has none.
    q: Array | None = None


class CurveProblem(NamedTuple):
    """Two curves, and their known crossings."""

    #: The two unknowns.
    axes: tuple[Axis, Axis]
    #: Number of other equations.
    others: int
    #: Makes the curves, and refines their crossings.
    source: PostureContours | CurvePair

    def refine(self, estimate: ArrayLike) -> Finding:
        """Refine an estimate (2,); raises what ``CurvePair.refine`` does."""
        return _finding(self.source.refine(estimate))

    def all(self) -> list[Finding]:
        """Find all crossings."""
        return [_finding(each) for each in self.source.all()]


def posture_problem(chain: SerialChain, T: Array, pair: tuple[int, int]) -> CurveProblem:
    """Draw the postures of an arm of six revolute joints at a pose, over joints 4 and 5.

    - ``chain``: an arm accepted by :func:`what_is_missing`, which returns an empty text.
    - ``T``: pose of the tip in the base (m), shape (4, 4).
    - ``pair``: which two equations, counted in :func:`minor_names`.
    """
    first, second = (Axis(chain.joint_names[joint], "rad", -np.pi, np.pi) for joint in JOINTS)
    contours = PostureContours(chain, T, pair=[MINORS[k] for k in pair])
    return CurveProblem((first, second), len(MINORS) - 2, contours)


def equations_problem(
    equations: Equations,
    axes: tuple[Axis, Axis],
    pair: tuple[int, int],
    count: int,
    period: float | None = None,
) -> CurveProblem:
    """Draw two of several equations in two unknowns.

    - ``equations``: as for :class:`~robomech_ros.numerics.CurvePair`, all of them.
    - ``pair``: the two that are drawn.
    - ``count``: number of equations.
    - ``period``: period of both unknowns.
    """
    rest = [k for k in range(count) if k not in pair]

    def part(chosen: Sequence[int]) -> Equations:
        return lambda x, y: np.asarray(equations(x, y), float)[list(chosen)]

    bounds = [(axis.low, axis.high) for axis in axes]
    others = part(rest) if rest else None
    return CurveProblem(
        axes, len(rest), CurvePair(part(pair), bounds, others=others, period=period)
    )


def minor_names() -> tuple[str, ...]:
    """Name the equations whose contours can be drawn, by the rows of their determinants."""
    return tuple("rows " + " ".join(str(row + 1) for row in rows) for rows in MINORS)


def what_is_missing(chain: SerialChain) -> str:
    """Say why no contours can be drawn for an arm; empty if they can."""
    if chain.n == 6 and not chain.types.any() and chain.coupling is None:
        return ""
    if chain.coupling is not None:
        why = "joints of this one follow others"
    elif chain.n != 6:
        why = f"this one has {counted(chain.n, 'joint')}"
    else:
        slides = [name for name, kind in zip(chain.joint_names, chain.types, strict=True) if kind]
        why = f"joint '{slides[0]}' of this one slides"
    return f"Contours are drawn for arms of six revolute joints; {why}."


def _finding(found: Crossing | CurveCrossing) -> Finding:
    if isinstance(found, CurveCrossing):
        known = (found.point, found.path, found.left_over <= LEFT, found.left_over, found.angle)
        return Finding(*known, found.condition)
    known = (found.angles, found.path, found.posture is not None, found.left_over, found.across)
    if found.posture is None:
        return Finding(*known)
    return Finding(*known, found.posture.condition, found.posture.q)


def pair_of_numbers(what: str, text: object, expected: str) -> list[float]:
    """Read two numbers, apart by a comma or a space, or raise a BadValueError."""
    try:
        first, second = (number(part) for part in str(text).replace(",", " ").split())
    except ValueError:
        raise BadValueError(what, text, expected) from None
    return [first, second]
