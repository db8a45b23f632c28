"""Dimensions of arms and wrists that have an isotropic posture.

References
----------
Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 5.8.
Salisbury and Craig, Articulated hands: force control and kinematic issues, Int. J. of Robotics
Research 1(1), 1982, pp. 4-17.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robomech_ros.numerics.arrays import real_within, whole_number
from robomech_ros.robots.chain import SerialChain
from robomech_ros.robots.dh import chain_from_dh
from robomech_ros.typing import Array

_MOST_JOINTS = 64
# Reaches (m) of which a chain can be made.
_LEAST_REACH, _MOST_REACH = 1e-6, 1e6


@dataclass(frozen=True, eq=False)
class IsotropicDesign:
    """Denavit-Hartenberg parameters of an arm, and a posture in which it is isotropic.

    Parameters
    ----------
    a, b : ndarray, shape (n,)
        Length and offset of each link (m).
    alpha : ndarray, shape (n,)
        Twist of each link (rad).
    q : ndarray, shape (n,)
        Joint angles of the isotropic posture (rad).  The first is free.
    part : {"position", "orientation", "pose"}
        The rows of the Jacobian that are isotropic.
    length : float or None
        Characteristic length (m) of the part "pose".
    """

    a: Array
    b: Array
    alpha: Array
    q: Array
    part: str
    length: float | None = None

    @property
    def chain(self) -> SerialChain:
        """The arm, without limits."""
        return chain_from_dh(self.a, self.b, self.alpha, name="isotropic")


def isotropic_planar_2r(reach: float) -> IsotropicDesign:
    r"""Return the planar arm of two revolute joints that positions isotropically.

    The columns :math:`E s_1` and :math:`E s_2` are of equal length and orthogonal only if
    :math:`a_1 = \sqrt 2\, a_2` and :math:`\theta_2 = \pm 135^\circ`.

    Parameters
    ----------
    reach : float
        Length of the outstretched arm (m).

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 5.8.1.

    Examples
    --------
    >>> from robomech_ros.kinetostatics import condition_number, isotropic_planar_2r
    >>> design = isotropic_planar_2r(1.0)
    >>> round(float(design.a[0] / design.a[1]), 6)
    1.414214
    >>> round(condition_number(design.chain, design.q, part=design.part), 9)
    1.0
    """
    size = _checked_reach(reach)
    a = size * np.array([np.sqrt(2.0), 1.0]) / (1.0 + np.sqrt(2.0))
    return IsotropicDesign(a, np.zeros(2), np.zeros(2), np.array([0.0, 0.75 * np.pi]), "position")


def isotropic_planar_3r(reach: float) -> IsotropicDesign:
    r"""Return the planar arm of three revolute joints that positions and orients isotropically.

    The vectors :math:`s_i` from the joints to the tip have the sum zero, equal lengths and equal
    angles between them, so the joints are at the vertices of an equilateral triangle and the tip
    is at its centroid: :math:`a_1 = a_2 = \sqrt 3\, a_3`, with the characteristic length
    :math:`L = a_1 / \sqrt 6`.

    Parameters
    ----------
    reach : float
        Length of the outstretched arm (m).

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., sections 5.8.1 and 5.8.3.
    """
    size = _checked_reach(reach)
    side = size / (2.0 + 1.0 / np.sqrt(3.0))
    a = side * np.array([1.0, 1.0, 1.0 / np.sqrt(3.0)])
    q = np.radians([0.0, 120.0, 150.0])
    return IsotropicDesign(a, np.zeros(3), np.zeros(3), q, "pose", float(side / np.sqrt(6.0)))


def isotropic_spatial_3r(reach: float, *, shoulder: float = 0.0) -> IsotropicDesign:
    r"""Return an arm of three revolute joints that positions isotropically in space.

    Axis 1 is perpendicular to the parallel axes 2 and 3.  In their plane the arm is the planar
    design of two joints, :math:`a_2 = \sqrt 2\, a_3`, :math:`\theta_3 = \pm 135^\circ`.  Joint 2
    places the tip at the distance :math:`a_3` from axis 1:
    :math:`a_1 + a_3 \cos\psi = a_3`, where :math:`\psi` is the elevation of the tip seen from
    axis 2.

    Parameters
    ----------
    reach : float
        Greatest distance of the tip from axis 1, ``a_1 + a_2 + a_3`` (m).
    shoulder : float, optional
        Distance a_1 of axis 2 from axis 1 (m), from 0 to ``2 a_3 = 2 reach / (3 + sqrt(2))``: with
        a greater one no posture is isotropic.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 5.8.1.
    """
    size = _checked_reach(reach)
    most = 2.0 * size / (3.0 + np.sqrt(2.0))
    expected = f"0 to {most:.6g} m: with a larger one, no design of this reach is isotropic"
    offset = real_within("shoulder", shoulder, expected, 0.0, most)
    a3 = (size - offset) / (1.0 + np.sqrt(2.0))
    psi = np.arccos(np.clip(1.0 - offset / a3, -1.0, 1.0))
    # Seen from axis 2, the tip is 45 degrees behind link 2.
    q = np.array([0.0, psi - 0.25 * np.pi, 0.75 * np.pi])
    alpha = np.array([0.5 * np.pi, 0.0, 0.0])
    return IsotropicDesign(
        np.array([offset, np.sqrt(2.0) * a3, a3]), np.zeros(3), alpha, q, "position"
    )


def isotropic_wrist(joints: int = 3) -> IsotropicDesign:
    r"""Return a spherical wrist that orients isotropically.

    With n axes at equal distances around a cone of half angle :math:`\arccos(1/\sqrt 3)`,
    :math:`\sum e_i e_i^T = (n/3)\, 1`.  Three axes are orthogonal, as in every isotropic wrist
    of three joints; four are the diagonals of a cube.

    Parameters
    ----------
    joints : int, optional
        3 to 64; more than three are redundant.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 5.8.2.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.kinetostatics import isotropic_wrist
    >>> np.degrees(isotropic_wrist().alpha).round(6).tolist()
    [90.0, 90.0, 0.0]
    """
    expected = f"a whole number from 3 to {_MOST_JOINTS}: fewer axes do not span all rotations"
    n = whole_number("joints", joints, expected, 3, _MOST_JOINTS)
    step = 2.0 * np.pi / n
    around = step * np.arange(3)
    sine, cosine = np.sqrt(2.0 / 3.0), np.sqrt(1.0 / 3.0)
    e = np.stack((sine * np.cos(around), sine * np.sin(around), np.full(3, cosine)), axis=1)
    before, after = np.cross(e[0], e[1]), np.cross(e[1], e[2])
    turn = np.arctan2(np.cross(before, after) @ e[1], before @ after)
    alpha = np.full(n, np.arctan2(np.linalg.norm(before), e[0] @ e[1]))
    alpha[-1] = 0.0
    q = np.full(n, turn)
    q[[0, -1]] = 0.0
    return IsotropicDesign(np.zeros(n), np.zeros(n), alpha, q, "orientation")


def _checked_reach(reach: float) -> float:
    expected = f"{_LEAST_REACH:g} to {_MOST_REACH:g} m"
    return real_within("reach", reach, expected, _LEAST_REACH, _MOST_REACH)
