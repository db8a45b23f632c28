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
from robomech_ros.numerics.grid_crossings import shared_cells
from robomech_ros.robots.chain import SerialChain
from robomech_ros.spatial.arrays import real_number

__all__ = ["PAIR", "Intersection", "measured", "minors", "solve_bivariate"]

Array = NDArray[np.float64]

_ACCEPTED = 1e-9
_APART = 1e-6
# Two ends of the refinement this near (rad) are one singular posture, where it converges slowly, if
# the posture between them, too, gives the pose to this part.
_ONE_POSTURE = 1e-3
_BETWEEN = 1e-9
_FEWEST_STEPS = 8
# Rows of the two minors whose contours are followed.
PAIR = ((0, 1, 2), (3, 4, 5))


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


def minors(equations: ClosureEquations, q4: ArrayLike, q5: ArrayLike, rows: ArrayLike) -> Array:
    """Give determinants of three rows of G each.

    Parameters
    ----------
    equations : ClosureEquations
    q4, q5 : array_like, shape (...)
        Joints 4 and 5 (rad).
    rows : array_like of int, shape (m, 3)
        Of G.

    Returns
    -------
    ndarray, shape (m, ...)
    """
    G = np.einsum("eijk,j...,k...->...ei", equations.free, circle(q4), circle(q5))
    return np.moveaxis(np.linalg.det(G[..., np.asarray(rows), :]), -1, 0)


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
    angles = -np.pi + 2.0 * np.pi * np.arange(steps) / steps
    values = minors(equations, angles[:, None], angles[None, :], PAIR)
    half = np.pi / steps
    found: list[Intersection] = []
    for i, j in zip(*np.nonzero(shared_cells(*values, wrap=True)), strict=True):
        start = _start(equations, float(angles[i]) + half, float(angles[j]) + half)
        end = _refined(equations, start)
        if end is None:
            continue
        q = posture_of(equations, *(float(x) for x in end))
        if q is None or any(_is_same(equations, q, other.q) for other in found):
            continue
        found.append(measured(equations, q))
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


def measured(equations: ClosureEquations, q: Array, pair: ArrayLike = PAIR) -> Intersection:
    """Measure how well a posture (6,) is conditioned, and how the contours of two minors cross."""
    q4, q5 = float(q[3]), float(q[4])
    G = np.einsum("eijk,j,k->ei", equations.free, circle(q4), circle(q5))
    step = 1e-6
    around = [(step, 0.0), (-step, 0.0), (0.0, step), (0.0, -step)]
    four, five = (np.array([q4, q5])[:, None] + np.array(around).T).tolist()
    values = minors(equations, four, five, pair)
    (a, b), (c, d) = values[:, [0, 2]] - values[:, [1, 3]]
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
