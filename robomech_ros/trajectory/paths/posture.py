"""Postures at the poses of a path: correction by Newton steps, and rates along the path."""

from dataclasses import dataclass

import numpy as np

from robomech_ros.spatial.arrays import shaped_array
from robomech_ros.spatial.cross_product import axial_vector
from robomech_ros.trajectory.paths.arms import JoinedArms, Tracked
from robomech_ros.trajectory.paths.partial_poses import (
    is_partial,
    least_solution,
    partial_deviation,
    partial_rank,
    partial_rates,
    partial_step,
)
from robomech_ros.trajectory.paths.pose_path import PoseSample
from robomech_ros.typing import Array

# Change of joint values (rad, m, relative beyond 1) by a Newton step that ends the correction of a
# posture: convergence is quadratic, the next one would be rounding.
CORRECTED = 1e-11
# Error (rad, and m, relative beyond 1) a corrected pose may have: rounding of the kinematics of an
# arm, with room.
ON_PATH = 1e-9
# Newton steps for a posture from a predicted one; those that go well need two or three.
CORRECTIONS = 10
_ROWS = ("q", "first", "second")


@dataclass(frozen=True, eq=False)
class Posture:
    """Joint values (n,), rad or m, at a place of a path, and their derivatives by its coordinate.

    The condition number is that of the Jacobian, infinite where it is singular; of joined arms the
    largest one.
    """

    q: Array
    first: Array
    second: Array
    condition: float


def posture(arm: Tracked, q: Array, place: PoseSample) -> Posture:
    """Find the derivatives of joint values (n,) that are on a path.

    q' = J^-1 t' and q'' = J^-1 (t'' - J' q').  For an arm of fewer than six joints, on a path that
    it can follow, they are meant in the sense of least squares.  A redundant arm moves with the
    least joint rates, q' = J^T x with J J^T x = t'; the derivative of that adds the part of J'^T x
    that moves no tool to q''.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 11.5.
    """
    if isinstance(arm, JoinedArms):
        parts = [posture(one, own, place) for one, own in arm.shares(q)]
        q, first, second = (np.concatenate([getattr(one, name) for one in parts]) for name in _ROWS)
        return Posture(q, first, second, max(one.condition for one in parts))
    if is_partial(arm):
        return Posture(q, *partial_rates(arm, q, place))
    J = shaped_array("jacobian", arm.jacobian(q), (6, len(q)))
    singular = np.linalg.svd(J, compute_uv=False)
    first = least_solution(J, place.twist)
    rate = shaped_array("jacobian_rate", arm.jacobian_rate(q, first), (6, len(q)))
    second = least_solution(J, place.twist_rate - rate @ first)
    if is_redundant(arm, q):
        spare = rate.T @ least_solution(J.T, first)
        second += spare - least_solution(J, J @ spare)
    condition = float(singular[0] / singular[-1]) if singular[-1] > 0.0 else np.inf
    return Posture(q, first, second, condition)


def is_redundant(arm: Tracked, q: Array) -> bool:
    """Return whether an arm with joint values (n,) has more joints than a path holds freedoms."""
    if is_partial(arm):
        return len(q) > partial_rank(arm, len(q))
    return max(arm.joints) > 6 if isinstance(arm, JoinedArms) else len(q) > 6


def corrected(arm: Tracked, q: Array, pose: Array) -> Array | None:
    """Correct joint values (n,) near a posture to a pose (4, 4) by Newton steps.

    The error of the orientation is the axial vector of the rotation that is left, e sin(phi).
    Returns None where the steps do not converge, or do not end at the pose.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 11.5.
    """
    if isinstance(arm, JoinedArms):
        parts = [corrected(one, own, pose) for one, own in arm.shares(q)]
        found = [part for part in parts if part is not None]
        return np.concatenate(found) if len(found) == len(parts) else None
    last = 0.0
    for _ in range(CORRECTIONS):
        if is_partial(arm):
            step = partial_step(arm, q, pose)
        else:
            J = shaped_array("jacobian", arm.jacobian(q), (6, len(q)))
            step = least_solution(J, pose_deviation(arm, q, pose))
        size = float(np.abs(step).max())
        if not np.isfinite(size) or size > max(2.0 * last, 1.0):
            return None  # the next step would be longer still, or leads to another branch
        q, last = q + step, size
        if size <= CORRECTED * max(1.0, float(np.abs(q).max())):
            left = np.abs(pose_deviation(arm, q, pose)).max()
            return q if left <= ON_PATH * max(1.0, float(np.abs(pose[:3, 3]).max())) else None
    return None


def pose_deviation(arm: Tracked, q: Array, pose: Array) -> Array:
    """Rotation left to a pose as e sin(phi), beyond a right angle as e, and distance, (6,).

    In rad and m, in the base frame; of k joined arms one after the other, (6 k,).  Of an arm with a
    task mask the components that are held, in the axes of the pose.
    """
    if is_partial(arm):
        return partial_deviation(arm, q, pose)
    if isinstance(arm, JoinedArms):
        return np.concatenate([pose_deviation(one, own, pose) for one, own in arm.shares(q)])
    actual = shaped_array("pose of the arm", arm.forward(q), (4, 4))
    left = pose[:3, :3] @ actual[:3, :3].T
    vector = axial_vector(left)
    if np.trace(left) < 1.0:
        # Beyond a right angle the sine falls again: keep the direction, and the length 1.
        length = np.linalg.norm(vector)
        vector = vector / length if length > 0.0 else np.ones(3)
    return np.concatenate([vector, pose[:3, 3] - actual[:3, 3]])
