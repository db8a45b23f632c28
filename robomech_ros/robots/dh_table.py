"""Denavit-Hartenberg tables, and the constant transforms they stand for.

The convention is the book's, identical to the usual "standard" one with d = b:
``T_i = Rz(theta_i) Tz(b_i) Tx(a_i) Rx(alpha_i)``, joint i about or along z_i, frame i + 1 fixed to
link i.  A negative ``a`` is accepted although the book defines a distance.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from robomech_ros.printing import MOST_LINES, Printed
from robomech_ros.typing import Array, IntArray

_WIDTHS = (12, 12, 14, 14)
# A turn (rad), with room for rounding.
_TURN = 2.0 * math.pi + 1e-3


@dataclass(frozen=True, eq=False)
class DHTable(Printed):
    r"""Denavit-Hartenberg parameters of a chain of n joints.

    .. math::

       T_i = R_z(\theta_i)\, T_z(b_i)\, T_x(a_i)\, R_x(\alpha_i) = \begin{bmatrix}
       \cos\theta_i & -\lambda_i \sin\theta_i & \mu_i \sin\theta_i & a_i \cos\theta_i \\
       \sin\theta_i & \lambda_i \cos\theta_i & -\mu_i \cos\theta_i & a_i \sin\theta_i \\
       0 & \mu_i & \lambda_i & b_i \\
       0 & 0 & 0 & 1 \end{bmatrix}

    with :math:`\lambda_i = \cos\alpha_i` and :math:`\mu_i = \sin\alpha_i`.  The tip's pose is
    ``base @ T_1 @ ... @ T_n @ tool``, the joint variable added to ``theta_i`` of a revolute and to
    ``b_i`` of a prismatic joint.

    Parameters
    ----------
    a, b : ndarray, shape (n,)
        Length and offset of each link (m).
    alpha, theta : ndarray, shape (n,)
        Twist of each link and angle about each joint axis (rad).
    base, tool : ndarray, shape (4, 4)
        First frame in the base link; tip link in the last frame.
    types : ndarray of int, shape (n,)
        0 revolute, 1 prismatic.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 4.2.
    """

    a: Array
    b: Array
    alpha: Array
    theta: Array
    base: Array
    tool: Array
    types: IntArray

    def __post_init__(self) -> None:
        for name in ("a", "b", "alpha", "theta", "base", "tool", "types"):
            array = np.array(getattr(self, name), order="C")
            array.setflags(write=False)
            object.__setattr__(self, name, array)

    def __str__(self) -> str:
        lines = [f"{'a (m)':>12}{'b (m)':>12}{'alpha (rad)':>14}{'theta (rad)':>14}"]
        for row in zip(self.a, self.b, self.alpha, self.theta, strict=True):
            lines.append("".join(f"{x + 0.0:>{w}.6g}" for x, w in zip(row, _WIDTHS, strict=True)))
        if len(lines) > MOST_LINES:
            lines[MOST_LINES - 1 :] = [f"and {len(lines) - MOST_LINES + 1} more"]
        return "\n".join(lines)


def implausible_angles(what: str, angles: Iterable[float], names: Iterable[str]) -> Iterator[str]:
    """Yield a note for each angle (rad) beyond one turn."""
    for name, angle in zip(names, angles, strict=True):
        if abs(angle) > _TURN:
            yield (
                f"joint '{name}': {what} of {angle:g} rad is more than a turn; angles are in "
                "radians, in YAML in degrees after units: degrees"
            )


def link_transforms(table: DHTable) -> Array:
    """Return the transforms C_i = Rz(theta_i) Tz(b_i) Tx(a_i) Rx(alpha_i), shape (n, 4, 4)."""
    n = len(table.a)
    ct, st = np.cos(table.theta), np.sin(table.theta)
    ca, sa = np.cos(table.alpha), np.sin(table.alpha)
    T = np.zeros((n, 4, 4))
    T[:, 0] = np.stack((ct, -ca * st, sa * st, table.a * ct), axis=1)
    T[:, 1] = np.stack((st, ca * ct, -sa * ct, table.a * st), axis=1)
    T[:, 2] = np.stack((np.zeros(n), sa, ca, table.b), axis=1)
    T[:, 3, 3] = 1.0
    return T
