"""The remaining joints of an arm whose middle three are known, and postures refined on the pose.

All angles may be complex: a polynomial of degree sixteen has sixteen roots, real or not.

References
----------
Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., sections 9.6 and B.4.
"""

from __future__ import annotations

from typing import overload

import numpy as np

from robomech_ros.errors import BadValueError
from robomech_ros.kinematics.equations.closure import (
    ClosureEquations,
    Numbers,
    circle,
    turn_about_z,
)
from robomech_ros.kinematics.equations.half_angles import angle_of
from robomech_ros.numerics import newton_gauss
from robomech_ros.typing import Array

# Residual of a posture in the pose, relative to the change by one radian, or to 1.
_ACCEPTED = 1e-10
# Two ends of the refinement this near (rad) are one; up to the second they are one singular
# posture, where it converges slowly, if the posture between them, too, gives the pose to the third.
_APART = 1e-6
ONE_POSTURE = 1e-3
BETWEEN = 1e-9
_NUDGE = 1e-5
# Derivative of a turn about z at no turn.
_D = np.zeros((4, 4))
_D[0, 1], _D[1, 0] = -1.0, 1.0


def remaining_angles(
    equations: ClosureEquations, q3: complex, q4: complex, q5: complex
) -> tuple[complex, complex, complex]:
    """Find joints 1 and 2 by least squares of the fourteen equations, and joint 6 as the rest.

    Parameters
    ----------
    equations : ClosureEquations
    q3, q4, q5 : complex
        rad.

    Returns
    -------
    q1, q2, q6 : complex
        rad; real for real angles.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 9.6.
    """
    values = np.einsum("rijk,i,j,k", equations.left, circle(q3), circle(q4), circle(q5))
    right = equations.right
    products = np.linalg.lstsq(right[:, :8], values - right[:, 8], rcond=None)[0]
    # Products of (cos, sin, 1) of joints 1 and 2 but the last: 2 and 5 are those of joint 1 with
    # 1, 6 and 7 those of joint 2.
    q1 = angle_of(products[2], products[5])
    q2 = angle_of(products[6], products[7])
    before = np.eye(4)
    for angle, link in zip((q1, q2, q3, q4, q5), equations.links[:5], strict=True):
        before = before @ turn_about_z(angle) @ link
    # The loop is closed where before J_6 L_6 = 1.
    rest = np.linalg.inv(equations.links[5] @ before)
    return q1, q2, angle_of(rest[0, 0], rest[1, 0])


@overload
def posture_of(equations: ClosureEquations, q3: float, q4: float, q5: float) -> Array | None: ...


@overload
def posture_of(
    equations: ClosureEquations, q3: complex, q4: complex, q5: complex
) -> Numbers | None: ...


def posture_of(
    equations: ClosureEquations, q3: complex, q4: complex, q5: complex
) -> Numbers | None:
    """Find joints 1, 2 and 6 for three angles, and improve all six on the pose.

    Parameters
    ----------
    equations : ClosureEquations
    q3, q4, q5 : float or complex
        rad; of real angles a real posture is sought.

    Returns
    -------
    ndarray, shape (6,), or None
        The chain's joint angles (rad), real parts from -pi to pi.  None where no posture with these
        angles gives the pose.
    """
    q1, q2, q6 = remaining_angles(equations, q3, q4, q5)
    start = np.array([q1, q2, q3, q4, q5, q6])
    is_real = not any(np.iscomplexobj(x) and np.imag(x) for x in (q3, q4, q5))
    if not np.isfinite(start).all():
        return None
    end = _refined(equations, start.real if is_real else start)
    if end is None:
        return None
    q = np.empty_like(end)
    q[equations.joints] = end
    turned = (q.real + np.pi) % (2.0 * np.pi) - np.pi
    return turned if is_real else turned + 1j * q.imag


def same_posture(equations: ClosureEquations, q: Numbers, p: Numbers) -> bool:
    """Return whether two ends of a refinement are one posture, if need be a singular one."""
    difference = q - p
    difference = (difference.real + np.pi) % (2.0 * np.pi) - np.pi + 1j * np.imag(difference)
    away = float(np.abs(difference).max())
    if away < _APART or away > ONE_POSTURE:
        return away < _APART
    middle = (p + 0.5 * difference)[equations.joints]
    return bool(np.abs(_loop_error(equations, middle)[0]).max() < BETWEEN)


def _refined(equations: ClosureEquations, start: Numbers) -> Numbers | None:
    """Improve joints 1 to 6 by Newton-Gauss on the loop; complex ones as twice as many real."""
    if np.iscomplexobj(start):

        def value(x: Array) -> Array:
            error = _loop_error(equations, x[:6] + 1j * x[6:])[0]
            return np.concatenate((error.real, error.imag))

        def slope(x: Array) -> Array:
            J = _loop_error(equations, x[:6] + 1j * x[6:])[1]
            return np.block([[J.real, -J.imag], [J.imag, J.real]])

        begin: Array = np.concatenate((start.real, start.imag))
    else:

        def value(x: Array) -> Array:
            return np.asarray(_loop_error(equations, x)[0], float)

        def slope(x: Array) -> Array:
            return np.asarray(_loop_error(equations, x)[1], float)

        begin = start.real
    for nudge in (0.0, _NUDGE):
        try:
            # Complex angles of a step too long are too great for a cosine.
            with np.errstate(over="ignore", invalid="ignore"):
                x = newton_gauss(value, slope, begin + nudge, tolerance=1e-14, iterations=30).x
        except BadValueError:
            # In a singular posture itself no step can be computed, but beside it.
            continue
        size = max(1.0, float(np.abs(slope(x)).max()))
        if np.abs(value(x)).max() <= _ACCEPTED * size:
            return x[:6] + 1j * x[6:] if np.iscomplexobj(start) else x
        break
    return None


def _loop_error(equations: ClosureEquations, q: Numbers) -> tuple[Numbers, Numbers]:
    """Return three rows of J_1 L_1 .. J_6 minus L_6^-1, (12,), and their derivative (12, 6)."""
    steps = turn_about_z(q)
    before = [np.eye(4) + 0.0 * steps[0]]
    for step, link in zip(steps[:-1], equations.links[:5], strict=True):
        before.append(before[-1] @ step @ link)
    whole = before[-1] @ steps[5]
    error = whole - np.linalg.inv(equations.links[5])
    columns = []
    for front in before:
        # A turn of a joint moves all behind it about its axis.
        rotation, point = front[:3, :3], front[:3, 3]
        twist = np.zeros((4, 4), dtype=front.dtype)
        twist[:3, :3] = rotation @ _D[:3, :3] @ rotation.T
        twist[:3, 3] = -twist[:3, :3] @ point
        columns.append((twist @ whole)[:3].ravel())
    return error[:3].ravel(), np.array(columns).T
