"""The Delta robot: its platform where three spheres meet, from one quadratic equation."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robomech_ros.errors import BadValueError
from robomech_ros.parallel.argument_checks import actuated
from robomech_ros.parallel.delta import Delta
from robomech_ros.spatial.arrays import check_kind
from robomech_ros.spatial.poses import assembled
from robomech_ros.typing import Array, ArrayLike, ComplexArray

# Relative area of the triangle of the centres that counts as rounding; part of the squared forearm
# that is the least scale.
_IN_LINE, _PART = 1e-9, 1e-2


@dataclass(frozen=True, eq=False)
class DeltaQuadratic:
    """The platform of a Delta robot on the line common to the planes of three spheres.

    Parameters
    ----------
    centres : ndarray, shape (3, 3)
        Centres of the spheres (m): the elbows, moved inwards by the platform's radius.
    point, direction : ndarray, shape (3,)
        The line of points at the same distance from all centres: the one in their plane (m), and
        the unit vector normal to it.
    quadratic : ndarray, shape (3,)
        Coefficients of t^2, t and 1 for positions ``point + t direction`` (1, m, m^2).
    positions : ndarray of complex, shape (2, 3)
        Positions at both roots (m).
    """

    centres: Array
    point: Array
    direction: Array
    quadratic: Array
    positions: ComplexArray

    @property
    def real(self) -> Array:
        """Real poses (r, 4, 4) in m: two, one if both roots are equal, or none."""
        kept = self.positions.real[np.all(self.positions.imag == 0.0, axis=1)]
        if len(kept) == 2 and np.array_equal(*kept):
            kept = kept[:1]
        return assembled(np.eye(3), kept)


def delta_quadratic(robot: Delta, q: ArrayLike) -> DeltaQuadratic:
    """Return the quadratic equation of a Delta robot, and its roots.

    Parameters
    ----------
    robot : Delta
    q : array_like, shape (3,)
        Angles of the arms, downwards from the horizontal (rad).

    Raises
    ------
    BadValueError
        The centres of the spheres are in a line.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 10.2.

    Examples
    --------
    >>> from robomech_ros.parallel import load_parallel
    >>> from robomech_ros.parallel.equations import delta_quadratic
    >>> found = delta_quadratic(load_parallel("delta"), [0.0, 0.0, 0.0])
    >>> found.real[:, 2, 3].round(6)
    array([-1.064452,  1.064452])
    """
    check_kind("robot", robot, Delta, "a Delta")
    given = actuated("q", q, 3)
    out = robot.base_radius - robot.platform_radius + robot.arm * np.cos(given)
    x, y = out * np.cos(robot.azimuths), out * np.sin(robot.azimuths)
    centres = np.stack((x, y, -robot.arm * np.sin(given)), axis=1)
    sides = centres[1:] - centres[0]
    normal = np.cross(*sides)
    area = float(np.linalg.norm(normal))
    scale = max(float(np.prod(np.linalg.norm(sides, axis=1))), _PART * robot.forearm**2)
    if not area > _IN_LINE * scale:
        raise BadValueError("q", given.tolist(), "angles at which the three elbows are not in line")
    direction = normal / area if normal[2] >= 0.0 else -normal / area
    # p . (c_i - c_1) = (|c_i|^2 - |c_1|^2) / 2, in the plane of the centres.
    half = 0.5 * np.sum(sides**2, axis=1)
    point = centres[0] + np.linalg.solve(np.vstack((sides, direction)), np.append(half, 0.0))
    gap = point - centres[0]
    quadratic = np.array([1.0, 2.0 * gap @ direction, gap @ gap - robot.forearm**2])
    roots = np.sort_complex(np.roots(quadratic).astype(complex))
    positions = point + roots[:, None] * direction
    return DeltaQuadratic(centres, point, direction, quadratic, positions)
