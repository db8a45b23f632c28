"""Factors of the Jacobian's determinant that have names: shoulder, elbow, wrist.

They are read off the axes of the joints as they stand, for arms with a spherical wrist, with
parallel axes or with spherical shoulder and wrist.
"""

import functools
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robomech_ros._kernels.tolerances import ARM_RANK, NAMED_MISFIT
from robomech_ros.kinematics.decoupled import common_point
from robomech_ros.kinematics.mobility import arm_size
from robomech_ros.robots.chain import PRISMATIC, SerialChain, unpack_chain

__all__ = ["singularity_factors"]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class _Structure:
    """What of the geometry is the same in every posture.

    Attributes
    ----------
    size : float
        Of the arm (m).
    parallel : tuple of int
        The longest run of revolute joints with parallel axes, if it is two or more.
    first, last : tuple of int
        The first, or last, three revolute joints, if their axes meet in one point.
    turning : tuple of int
        All revolute joints.
    """

    size: float
    parallel: tuple[int, ...]
    first: tuple[int, ...]
    last: tuple[int, ...]
    turning: tuple[int, ...]


@functools.lru_cache(maxsize=64)
def _structure(chain: SerialChain) -> _Structure:
    links = unpack_chain(chain.packed)
    size = arm_size(chain)
    turning = tuple(i for i in range(chain.n) if chain.types[i] != PRISMATIC)
    runs: list[list[int]] = [[]]
    direct = np.eye(3)
    for i in range(chain.n):
        if i:
            direct = direct @ links[i, :3, :3]
        if chain.types[i] == PRISMATIC:
            continue
        if runs[-1] and np.hypot(*direct[:2, 2]) > ARM_RANK:
            runs.append([])
        runs[-1].append(i)
        direct = np.eye(3)
    longest = max(runs, key=len)
    return _Structure(
        size,
        tuple(longest) if len(longest) > 1 else (),
        _concurrent(chain, links, turning[:3], size),
        _concurrent(chain, links, turning[-3:], size),
        turning,
    )


def _concurrent(
    chain: SerialChain, links: Array, joints: tuple[int, ...], size: float
) -> tuple[int, ...]:
    """Give three neighbouring joints if their axes meet in one point, else none."""
    if len(joints) < 3 or joints[2] - joints[0] != 2:
        return ()
    found = common_point(links[joints[1]], links[joints[2]])
    return joints if found is not None and found[2] <= NAMED_MISFIT * size else ()


def singularity_factors(chain: SerialChain, J: Array) -> dict[str, float]:
    """Give those factors of the determinant that have a name.

    Parameters
    ----------
    chain : SerialChain
        Of n joints.
    J : ndarray, shape (6, n)
        The Jacobian in a posture (1 and m).

    Returns
    -------
    dict
        From "shoulder", "elbow", "wrist" or "arm" to a dimensionless number that is zero where
        this part of the arm is singular.  Empty for arms without such parts.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 5.4.
    """
    structure = _structure(chain)
    axes = J[:3].T
    # The point of every axis that is nearest to the tip, as seen from there.
    posture = _Posture(structure, axes, np.cross(axes, J[3:].T), J[3:].T)
    if structure.last and structure.first and structure.last[0] > structure.first[-1]:
        return posture.spherical_ends()
    if structure.last == (3, 4, 5) and chain.n == 6:
        return posture.decoupled()
    if len(structure.parallel) >= 3:
        return posture.planar()
    return {"wrist": posture.volume(structure.last)} if structure.last else {}


@dataclass(frozen=True)
class _Posture:
    """The axes of an arm in one posture, zero for slides, points on them and the tip's velocities.

    All are seen from the tip, in m.
    """

    structure: _Structure
    axes: Array
    points: Array
    velocities: Array

    def volume(self, joints: tuple[int, ...]) -> float:
        """Give the volume that the directions of three axes span."""
        return float(np.linalg.det(self.axes[list(joints)]))

    def meeting(self, joints: tuple[int, ...]) -> Array:
        """Give the point nearest to the axes."""
        lines = self.axes[list(joints)]
        across = np.eye(3) - lines[:, :, None] * lines[:, None, :]
        moved = np.einsum("kij,kj->i", across, self.points[list(joints)])
        point: Array = np.linalg.solve(across.sum(axis=0), moved)
        return point

    def velocity(self, joint: int, point: Array) -> Array:
        """Give the velocity that a joint gives to a point of its link; a turn's over the size."""
        if joint not in self.structure.turning:
            slid: Array = self.velocities[joint]
            return slid
        turned: Array = np.cross(self.axes[joint], point - self.points[joint])
        return turned / self.structure.size

    def spherical_ends(self) -> dict[str, float]:
        """Of an arm with spherical shoulder and wrist, and an elbow between them."""
        first, last = self.structure.first, self.structure.last
        shoulder, wrist = self.meeting(first), self.meeting(last)
        found = {"shoulder": self.volume(first), "wrist": self.volume(last)}
        between = range(first[-1] + 1, last[0])
        if len(between) == 1:
            reach = self.velocity(between[0], wrist) @ (wrist - shoulder)
            found["elbow"] = float(reach / max(float(np.linalg.norm(wrist - shoulder)), 1e-300))
        return found

    def decoupled(self) -> dict[str, float]:
        """Of an arm of three joints with a spherical wrist."""
        wrist = self.volume(self.structure.last)
        centre = self.meeting(self.structure.last)
        first, second, third = (self.velocity(i, centre) for i in range(3))
        if self.structure.parallel[:2] != (1, 2):
            arm = float(np.cross(first, second) @ third)
            return {"arm": arm, "wrist": wrist}
        return {
            "shoulder": float(first @ self.axes[1]),
            "elbow": float(np.cross(second, third) @ self.axes[1]),
            "wrist": wrist,
        }

    def planar(self) -> dict[str, float]:
        """Of an arm with three parallel axes, and perhaps joints before and after them."""
        parallel = self.structure.parallel
        direction = self.axes[parallel[0]]
        legs = self.points[list(parallel)] - self.points[parallel[0]]
        elbow = np.cross(legs[1], legs[2]) @ direction / self.structure.size**2
        found = {"elbow": float(elbow)}
        if self.structure.turning == (0, 1, 2, 3, 4, 5) and parallel == (1, 2, 3):
            outer = np.cross(self.axes[4], self.axes[5])
            across = float(np.linalg.norm(outer))
            gap = abs(outer @ (self.points[5] - self.points[4])) / max(across, 1e-300)
            found["wrist"] = float(outer @ direction)
            if across > ARM_RANK and gap <= NAMED_MISFIT * self.structure.size:
                centre = self.meeting((4, 5))
                found["shoulder"] = float(self.velocity(0, centre) @ direction)
        return found
