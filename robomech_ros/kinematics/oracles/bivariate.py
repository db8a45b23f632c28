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

from robomech_ros.errors import BadValueError
from robomech_ros.kinematics.equations.closure import ClosureEquations, circle, closure_equations
from robomech_ros.kinematics.equations.postures import (
    BETWEEN,
    ONE_POSTURE,
    posture_of,
    same_posture,
)
from robomech_ros.numerics import newton_gauss
from robomech_ros.numerics.grid_crossings import shared_cells
from robomech_ros.robots.chain import SerialChain
from robomech_ros.spatial.arrays import real_number
from robomech_ros.typing import Array, ArrayLike

_ACCEPTED = 1e-9
_FEWEST_STEPS = 8
# First steps from all cells at once, and then of those that come near a posture, where it may be
# singular; how long they may be (rad), what is left of the equations near a posture, and the digits
# in which equal ends agree.
_FIRST_STEPS = (10, 20)
_LONGEST_STEP = 0.3
_NEAR = 1e-4
_DIGITS = 7
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
    """Return determinants of three rows of G each.

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
    G = equations.three_columns(q4, q5)
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

    Examples
    --------
    >>> from robomech_ros.kinematics import forward_kinematics
    >>> from robomech_ros.kinematics.oracles import solve_bivariate
    >>> from robomech_ros.robots import load_robot
    >>> diestro = load_robot("diestro")
    >>> T = forward_kinematics(diestro, [0.3, 1.2, -1.4, 1.1, -2.0, 0.7])
    >>> len(solve_bivariate(diestro, T))
    4
    """
    count = real_number("steps", steps, f"a whole number from {_FEWEST_STEPS} on")
    if not (count >= _FEWEST_STEPS and float(count).is_integer()):
        raise BadValueError("steps", steps, f"a whole number from {_FEWEST_STEPS} on")
    equations = closure_equations(chain, T)
    steps = int(count)
    angles = -np.pi + 2.0 * np.pi * np.arange(steps) / steps
    values = minors(equations, angles[:, None], angles[None, :], PAIR)
    cell = 2.0 * np.pi / steps
    starts = angles[np.argwhere(shared_cells(*values, wrap=True))] + 0.5 * cell
    found: list[Intersection] = []
    for start in _first_steps(equations, starts):
        if any(_is_one(equations, start, other.q[2:5]) for other in found):
            continue
        end = _refined(equations, start)
        if end is None:
            continue
        q = posture_of(equations, *(float(x) for x in end))
        if q is None or any(same_posture(equations, q, other.q) for other in found):
            continue
        found.append(measured(equations, q))
    return sorted(found, key=lambda crossing: float(crossing.q[2]))


def _first_steps(equations: ClosureEquations, starts: Array) -> Array:
    """Take the first steps of Newton-Gauss from all starts (n, 2) at once.

    Returns joints 3, 4 and 5 (m, 3), rad, of those that have come near a posture, equal ones once.
    """
    G = equations.three_columns(*starts.T)
    third = np.squeeze(np.linalg.pinv(G[:, :, :2]) @ -G[:, :, 2:], axis=2)
    x = np.column_stack((np.arctan2(third[:, 1], third[:, 0]), starts))
    for steps in _FIRST_STEPS:
        for _ in range(steps):
            step = np.linalg.pinv(_slope(equations, x)) @ -_value(equations, x)[:, :, None]
            x = x + np.clip(step[:, :, 0], -_LONGEST_STEP, _LONGEST_STEP)
        x = x[np.abs(_value(equations, x)).max(axis=1, initial=0.0) < _NEAR]
    turned = (x + np.pi) % (2.0 * np.pi) - np.pi
    return turned[np.unique(turned.round(_DIGITS), axis=0, return_index=True)[1]]


def _is_one(equations: ClosureEquations, x: Array, known: Array) -> bool:
    """Return whether three angles are those of a singular posture that is known."""
    away = (x - known + np.pi) % (2.0 * np.pi) - np.pi
    if np.abs(away).max() > ONE_POSTURE:
        return False
    return bool(np.abs(_value(equations, known + 0.5 * away)).max() < BETWEEN)


def _value(equations: ClosureEquations, x: Array) -> Array:
    """Return the six equations (..., 6) at joints 3, 4 and 5 (..., 3)."""
    rows = [circle(x[..., k]) for k in range(3)]
    return np.einsum("eijk,i...,j...,k...->...e", equations.free, *rows)


def _slope(equations: ClosureEquations, x: Array) -> Array:
    """Return their derivative (..., 6, 3)."""
    columns = []
    for k in range(3):
        rows = [circle(x[..., m]) for m in range(3)]
        rows[k] = np.stack([-rows[k][1], rows[k][0], 0.0 * rows[k][2]])
        columns.append(np.einsum("eijk,i...,j...,k...->...e", equations.free, *rows))
    return np.stack(columns, axis=-1)


def _refined(equations: ClosureEquations, start: Array) -> Array | None:
    try:
        end = newton_gauss(
            lambda x: _value(equations, x),
            lambda x: _slope(equations, x),
            start,
            tolerance=1e-13,
            iterations=30,
        )
    except BadValueError:
        # At a singular posture itself no step can be computed.
        end = None
    x, left = (start, _value(equations, start)) if end is None else (end.x, end.residual)
    return x if np.abs(left).max() < _ACCEPTED else None


def measured(equations: ClosureEquations, q: Array, pair: ArrayLike = PAIR) -> Intersection:
    """Measure how well a posture (6,) is conditioned, and how the contours of two minors cross."""
    q4, q5 = float(q[3]), float(q[4])
    G = equations.three_columns(q4, q5)
    step = 1e-6
    around = [(step, 0.0), (-step, 0.0), (0.0, step), (0.0, -step)]
    four, five = (np.array([q4, q5])[:, None] + np.array(around).T).tolist()
    values = minors(equations, four, five, pair)
    (a, b), (c, d) = values[:, [0, 2]] - values[:, [1, 3]]
    crossing = float(np.arctan2(abs(a * d - b * c), abs(a * c + b * d)))
    return Intersection(q, float(np.linalg.cond(G[:, :2])), crossing)
