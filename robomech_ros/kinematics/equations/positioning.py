"""The positioning problem of decoupled arms: where the first three joints put the wrist centre."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.kinematics.equations.closure import as_angles
from robomech_ros.kinematics.equations.decoupled_table import decoupled_table
from robomech_ros.kinematics.equations.half_angles import (
    angle_of,
    angles_of_line,
    angles_of_roots,
    half_angle_polynomial,
)
from robomech_ros.kinematics.inverse.request.target import as_targets
from robomech_ros.robots.chain import SerialChain
from robomech_ros.robots.dh_table import DHTable
from robomech_ros.spatial.arrays import as_finite
from robomech_ros.typing import Array, ArrayLike, ComplexArray

# Part of the arm's size, and of 1, below which a coefficient is rounding.
_NOTHING = 1e-10


@dataclass(frozen=True, eq=False)
class PositioningEquations:
    r"""The two equations free of joint 2, and what is left of them without joint 1.

    .. math::

       A c_1 + B s_1 + C c_3 + D s_3 + E &= 0 \\
       F c_1 + G s_1 + H c_3 + I s_3 + J &= 0 \\
       K c_3^2 + L s_3^2 + M c_3 s_3 + N c_3 + P s_3 + Q &= 0 \\
       R \tau^4 + S \tau^3 + T \tau^2 + U \tau + V &= 0, \qquad \tau = \tan(\theta_3 / 2)

    Parameters
    ----------
    centre : ndarray, shape (3,)
        Wrist centre in the first frame (m).
    first : ndarray, shape (5,)
        A .. E (m^2): the distance from the origin of frame 2.
    second : ndarray, shape (5,)
        F .. J (m): the height along axis 2.
    determinant : float
        A G - F B (m^3): zero where axes 1 and 2 meet or are parallel, or the centre is on axis 1.
    conic : ndarray, shape (6,)
        K, L, M, N, P, Q (m^4).
    quartic : ndarray, shape (5,)
        R .. V (m^4): R vanishes where a half turn is a root.
    theta3 : ndarray of complex, shape (k,)
        All roots (rad), angles of the table: four of the quartic, or, where axes 1 and 2 meet or
        are parallel, the two of that one of the first two equations that joint 1 leaves; none where
        it leaves joint 3, too.
    """

    centre: Array
    first: Array
    second: Array
    determinant: float
    conic: Array
    quartic: Array
    theta3: ComplexArray


def wrist_centre(chain: SerialChain, T: ArrayLike) -> Array:
    r"""Find where axes 4, 5 and 6 meet when the tip is at a pose.

    .. math:: c = p - Q\, [a_6, b_6 \mu_6, b_6 \lambda_6]^T

    Parameters
    ----------
    chain : SerialChain
        Six revolute joints, the last three with axes through one point.
    T : array_like, shape (4, 4)
        Pose of the tip in the base (m).

    Returns
    -------
    ndarray, shape (3,)
        In the first frame of the Denavit-Hartenberg table (m).

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 4.4.1.

    Examples
    --------
    >>> from robomech_ros.kinematics import forward_kinematics
    >>> from robomech_ros.kinematics.equations import wrist_centre
    >>> from robomech_ros.robots import load_robot
    >>> puma = load_robot("puma560")
    >>> q = [0.3, 0.5, -1.2, 0.4, 0.8, 0.2]
    >>> tip, turned = forward_kinematics(puma, [q, [*q[:3], 1.0, -0.5, 2.0]])
    >>> bool(abs(wrist_centre(puma, tip) - wrist_centre(puma, turned)).max() < 1e-12)
    True
    """
    table = decoupled_table(chain)
    pose = np.linalg.inv(table.base) @ as_targets(T)[0] @ np.linalg.inv(table.tool)
    a, b, alpha = table.a[5], table.b[5], table.alpha[5]
    return pose[:3, 3] - pose[:3, :3] @ [a, b * np.sin(alpha), b * np.cos(alpha)]


def positioning_equations(chain: SerialChain, centre: ArrayLike) -> PositioningEquations:
    """Write down the equations of the positioning problem, and all their roots.

    Parameters
    ----------
    chain : SerialChain
        Six revolute joints, the last three with axes through one point.
    centre : array_like, shape (3,)
        Wrist centre in the first frame (m), as from `wrist_centre`.

    Raises
    ------
    BadValueError
        Another arm or one whose first two axes are one line.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 4.4.1.

    Examples
    --------
    >>> from math import pi
    >>> from robomech_ros.kinematics.equations import positioning_equations
    >>> from robomech_ros.robots import chain_from_dh
    >>> twists = [pi / 2, -pi / 2, pi / 2, pi / 2, pi / 2, 0]
    >>> arm = chain_from_dh([1, 1, 1, 0, 0, 0], [0, 1, 1, 1, 0, 0], twists)
    >>> equations = positioning_equations(arm, [0, 2, -1])
    >>> (equations.quartic / equations.quartic[0] * 9).round(9)
    array([  9.,   0., -46., -32.,   9.])
    """
    table = decoupled_table(chain)
    c = _point(centre)
    first, second = _two_equations(table, c)
    (A, B, C, D, E), (F, G, H, I, J) = first, second  # noqa: E741
    u, v = 4.0 * table.a[0] ** 2, np.sin(table.alpha[0]) ** 2
    conic = np.array(
        [
            u * H**2 + v * C**2,
            u * I**2 + v * D**2,
            2.0 * (u * H * I + v * C * D),
            2.0 * (u * H * J + v * C * E),
            2.0 * (u * I * J + v * D * E),
            u * J**2 + v * E**2 - u * v * (c[0] ** 2 + c[1] ** 2),
        ]
    )
    K, L, M, N, P, Q = conic
    # cos^2, sin^2 and cos sin by the double angle, then each angle by exp(i angle).
    twice, once = 0.25 * (K - L - 1j * M), 0.5 * (N - 1j * P)
    waves = np.array([twice.conj(), once.conj(), Q + 0.5 * (K + L), once, twice])
    if _meeting(table):
        theta3 = _roots_of_one(C, D, E)
    elif _parallel(table):
        theta3 = _roots_of_one(H, I, J)
    else:
        theta3 = angles_of_roots(waves)
    quartic = half_angle_polynomial(waves)
    return PositioningEquations(c, first, second, A * G - F * B, conic, quartic, theta3)


def arm_angles(chain: SerialChain, centre: ArrayLike, theta3: complex) -> ComplexArray:
    """Find joints 1 and 2 for a root of the positioning problem.

    Parameters
    ----------
    chain, centre
        As for `positioning_equations`.
    theta3 : complex
        One of its ``theta3`` (rad).  It is not checked to be a root: at other angles the centre is
        missed.

    Returns
    -------
    ndarray of complex, shape (k, 3)
        theta_1, theta_2 and theta_3 of the table (rad): one row, or two where axes 1 and 2 meet or
        are parallel.  An angle that may be anything is 0: the first where the centre is on axis 1,
        the second where it is on axis 2.

    Raises
    ------
    BadValueError, WrongSizeError
        As there, or ``theta3`` is no finite number.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 4.4.1.
    """
    table = decoupled_table(chain)
    point = _point(centre)
    (A, B, C, D, E), (F, G, H, I, J) = _two_equations(table, point)  # noqa: E741
    angle = as_angles("theta3", theta3)
    if angle.ndim:
        raise WrongSizeError("theta3", angle.shape, "()")
    theta3 = complex(angle)
    c3, s3 = np.cos(theta3), np.sin(theta3)
    size = float(np.abs(np.concatenate((table.a, table.b, point))).max())
    if np.hypot(*point[:2]) < _NOTHING * size:
        turns = [0j]
    elif _meeting(table):
        turns = _roots_of_one(F, G, H * c3 + I * s3 + J).tolist()
    elif _parallel(table):
        turns = _roots_of_one(A, B, C * c3 + D * s3 + E).tolist()
    else:
        one, other = C * c3 + D * s3 + E, H * c3 + I * s3 + J
        determinant = A * G - F * B
        turns = [angle_of((B * other - G * one) / determinant, (F * one - A * other) / determinant)]
    rows = [[theta1, _second_angle(table, point, theta1, theta3), theta3] for theta1 in turns]
    return np.array(rows, complex).reshape(-1, 3)


def _two_equations(table: DHTable, centre: Array) -> tuple[Array, Array]:
    """Return A .. E and F .. J."""
    (a1, a2, a3), (b1, b2, b3, b4) = table.a[:3], table.b[:4]
    (l1, l2, l3), (m1, m2, m3) = np.cos(table.alpha[:3]), np.sin(table.alpha[:3])
    x, y, z = centre
    E = a2**2 + a3**2 + b2**2 + b3**2 + b4**2 - a1**2 - x**2 - y**2 - (z - b1) ** 2
    E += 2.0 * (b2 * b3 * l2 + b2 * b4 * l2 * l3 + b3 * b4 * l3)
    first = [
        2.0 * a1 * x,
        2.0 * a1 * y,
        2.0 * (a2 * a3 - b2 * b4 * m2 * m3),
        2.0 * (a3 * b2 * m2 + a2 * b4 * m3),
        E,
    ]
    J = b2 + b3 * l2 + b4 * l2 * l3 - (z - b1) * l1
    second = [y * m1, -x * m1, -b4 * m2 * m3, a3 * m2, J]
    return np.array(first), np.array(second)


def _second_angle(table: DHTable, centre: Array, theta1: complex, theta3: complex) -> complex:
    (a1, a2, a3), (b1, _, b3, b4) = table.a[:3], table.b[:4]
    (l1, l2, l3), (m1, m2, m3) = np.cos(table.alpha[:3]), np.sin(table.alpha[:3])
    x, y, z = centre
    c1, s1, c3, s3 = np.cos(theta1), np.sin(theta1), np.cos(theta3), np.sin(theta3)
    A11 = a2 + a3 * c3 + b4 * m3 * s3
    A12 = -a3 * l2 * s3 + b3 * m2 + b4 * l2 * m3 * c3 + b4 * m2 * l3
    along = x * c1 + y * s1 - a1
    across = -x * l1 * s1 + y * l1 * c1 + (z - b1) * m1
    return angle_of(A11 * along - A12 * across, A12 * along + A11 * across)


def _roots_of_one(C: complex, D: complex, E: complex) -> ComplexArray:
    """Find both angles with C cos + D sin + E = 0; none where C and D vanish."""
    if max(abs(C), abs(D)) <= _NOTHING * abs(E) or not (C or D):
        return np.empty(0, complex)
    return angles_of_line(C, D, E)


def _meeting(table: DHTable) -> bool:
    size = float(np.abs(np.concatenate((table.a, table.b))).max())
    meeting = abs(float(table.a[0])) <= _NOTHING * size
    if meeting and _parallel(table):
        raise BadValueError("a_1 and sin alpha_1", 0.0, "axes 1 and 2 that are not one line")
    return meeting


def _parallel(table: DHTable) -> bool:
    return abs(float(np.sin(table.alpha[0]))) <= _NOTHING


def _point(centre: ArrayLike) -> Array:
    point = as_finite("centre", centre, (3,))
    if point.shape != (3,):
        raise WrongSizeError("centre", point.shape, "(3,)")
    return point
