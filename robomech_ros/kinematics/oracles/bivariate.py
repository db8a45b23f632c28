"""The bivariate approach: contours over joints 4 and 5, and Newton-Gauss at their crossings.

The six equations are ``G(q_4, q_5) (cos q_3, sin q_3, 1)^T = 0`` with G (6, 3), so all minors of G
vanish at a posture.  The contours of two of them cross there and at other points, which the
remaining equations tell apart.

References
----------
Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 9.4.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robomech_ros.errors import BadValueError
from robomech_ros.kinematics.forward_uncompiled import tip_poses
from robomech_ros.kinematics.inverse.target import as_targets
from robomech_ros.kinematics.oracles.closure import ClosureEquations, circle, posture_of
from robomech_ros.numerics import newton_gauss
from robomech_ros.numerics.two_unknowns import shared_cells
from robomech_ros.robots.chain import SerialChain
from robomech_ros.spatial.arrays import real_number

__all__ = ["Intersection", "contours", "solve_bivariate"]

Array = NDArray[np.float64]

_ACCEPTED = 1e-9
_APART = 1e-6
# Two ends of the refinement this near (rad) are one singular posture, where it converges slowly, if
# the posture between them, too, gives the pose to this part.
_ONE_POSTURE = 1e-3
_BETWEEN = 1e-9
_FEWEST_STEPS = 8


@dataclass(frozen=True, eq=False)
class Intersection:
    """A crossing of the contours that is a posture.

    Parameters
    ----------
    q : ndarray, shape (6,)
        The posture (rad).
    condition : float
        Condition number of the two columns of G that cosine and sine of joint 3 are computed from.
    crossing : float
        Angle (rad) at which the two contours cross; near 0 the posture is nearly singular.
    """

    q: Array
    condition: float
    crossing: float


def contours(equations: ClosureEquations, steps: int) -> tuple[Array, Array]:
    """Give angles (steps,) and two minors over them, shape (2, steps, steps), for plotting."""
    angles = -np.pi + 2.0 * np.pi * np.arange(steps) / steps
    basis = np.array([np.cos(angles), np.sin(angles), np.ones(steps)])
    G = np.einsum("eijk,jm,kn->mnei", equations.free, basis, basis)
    return angles, np.array([np.linalg.det(G[:, :, :3]), np.linalg.det(G[:, :, 3:])])


def solve_bivariate(chain: SerialChain, T: ArrayLike, *, steps: int = 240) -> list[Intersection]:
    """Find the postures of an arm of six revolute joints where contours cross.

    Parameters
    ----------
    chain : SerialChain
    T : array_like, shape (4, 4)
        Target pose of the tip in the base (m).
    steps : int, optional
        Of the grid on which contours are followed, 8 at least; crossings nearer to each other may
        be lost.

    Returns
    -------
    list of Intersection
        By increasing joint 3.  A singular posture, where the contours touch, stands once.

    Raises
    ------
    BadValueError
        No arm of six revolute joints, no pose, or too few steps.
    WrongSizeError, NonFiniteError
        No pose.
    """
    count = real_number("steps", steps, f"a whole number from {_FEWEST_STEPS} on")
    if not (count >= _FEWEST_STEPS and float(count).is_integer()):
        raise BadValueError("steps", steps, f"a whole number from {_FEWEST_STEPS} on")
    equations = ClosureEquations.of(chain, as_targets(T)[0])
    steps = int(count)
    angles, minors = contours(equations, steps)
    half = np.pi / steps
    found: list[Intersection] = []
    for i, j in zip(*np.nonzero(shared_cells(*minors, wrap=True)), strict=True):
        start = _start(equations, float(angles[i]) + half, float(angles[j]) + half)
        end = _refined(equations, start)
        if end is None:
            continue
        q = posture_of(equations, *(float(x) for x in end))
        if q is None or any(_is_same(equations, q, other.q) for other in found):
            continue
        found.append(_measured(equations, q))
    return sorted(found, key=lambda crossing: float(crossing.q[2]))


def _start(equations: ClosureEquations, q4: float, q5: float) -> Array:
    G = np.einsum("eijk,j,k->ei", equations.free, circle(q4), circle(q5))
    c, s = np.linalg.lstsq(G[:, :2], -G[:, 2], rcond=None)[0]
    return np.array([np.arctan2(s, c), q4, q5])


def _refined(equations: ClosureEquations, start: Array) -> Array | None:
    def value(x: Array) -> Array:
        result: Array = np.einsum("eijk,i,j,k->e", equations.free, *(circle(a) for a in x))
        return result

    def slope(x: Array) -> Array:
        b = [circle(a) for a in x]
        d = [np.array([-np.sin(a), np.cos(a), 0.0]) for a in x]
        columns = [
            np.einsum(
                "eijk,i,j,k->e", equations.free, *(d[m] if m == k else b[m] for m in range(3))
            )
            for k in range(3)
        ]
        return np.array(columns).T

    try:
        end = newton_gauss(value, slope, start, tolerance=1e-13, iterations=30)
    except BadValueError:
        return None
    return end.x if np.abs(end.residual).max() < _ACCEPTED else None


def _measured(equations: ClosureEquations, q: Array) -> Intersection:
    q4, q5 = float(q[3]), float(q[4])
    G = np.einsum("eijk,j,k->ei", equations.free, circle(q4), circle(q5))
    step = 1e-6
    slopes = []
    for rows in (slice(0, 3), slice(3, 6)):
        around = [
            np.linalg.det(
                np.einsum("eijk,j,k->ei", equations.free[rows], circle(q4 + u), circle(q5 + v))
            )
            for u, v in ((step, 0.0), (-step, 0.0), (0.0, step), (0.0, -step))
        ]
        slopes.append(((around[0] - around[1]), (around[2] - around[3])))
    (a, b), (c, d) = slopes
    crossing = float(np.arctan2(abs(a * d - b * c), abs(a * c + b * d)))
    return Intersection(q, float(np.linalg.cond(G[:, :2])), crossing)


def _is_same(equations: ClosureEquations, q: Array, p: Array) -> bool:
    away = _distance(q, p)
    if away < _APART or away > _ONE_POSTURE:
        return away < _APART
    middle = p + 0.5 * ((q - p + np.pi) % (2.0 * np.pi) - np.pi)
    error = tip_poses(equations.chain, middle[None])[0] - equations.target
    return bool(np.abs(error).max() < _BETWEEN)


def _distance(q: Array, p: Array) -> float:
    return float(np.abs((q - p + np.pi) % (2.0 * np.pi) - np.pi).max())
