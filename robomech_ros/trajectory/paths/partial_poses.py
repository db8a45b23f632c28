"""Paths of which an arm holds only some components: the others follow from its joints.

With the pose T of the path and the pose of the tool in it, (Q, p), the components of the rotation
vector of Q and of p that are held must vanish.  Their rates are linear in those of the joints,
A q' = b, where b is what the path moves.  Of all solutions the one with the least rates is taken,
each divided by a factor that falls from 1 to a tenth near the limits of its joint.
"""

import math
from collections.abc import Callable
from functools import lru_cache
from typing import TypeGuard

import numpy as np

from robomech_ros.spatial.arrays import shaped_array
from robomech_ros.spatial.rotations.axis_angle import (
    matrix_from_rotation_vector,
    rotation_vector_from_matrix,
)
from robomech_ros.spatial.rotations.rates import rotation_rates
from robomech_ros.trajectory.paths.arms import SerialArm, Tracked
from robomech_ros.trajectory.paths.joint_path import JointPath
from robomech_ros.trajectory.paths.pose_path import PoseSample
from robomech_ros.typing import Array, IntArray

# Moves (rad, m) between which the rates along a path are compared for their derivative.
_MOVE = 1e-5
# Part of the range of a joint, and most (rad or m), within which a limit is near; and the factor of
# its rate at the limit.
_NEAR, _NEAR_AT_MOST, _LEAST = 0.15, 0.3, 0.1
# Postures that show how many components an arm can move, and what is no rounding there.
_POSTURES, _RANK = 3, 1e-9


def is_partial(arm: Tracked | None) -> TypeGuard[SerialArm]:
    """Return whether an arm holds only some components of the poses of a path."""
    return isinstance(arm, SerialArm) and arm.held is not None


@lru_cache(maxsize=16)
def partial_rank(arm: SerialArm, joints: int) -> int:
    """Return how many of the held components an arm with n joints can move at the same time."""
    rank = 1
    for q in np.random.default_rng(0).uniform(-1.0, 1.0, (_POSTURES, joints)):
        place = PoseSample(np.asarray(arm.forward(q), dtype=np.float64), np.zeros(6), np.zeros(6))
        singular = np.linalg.svd(_equations(arm, q, place)[:, :-1], compute_uv=False)
        rank = max(rank, int((singular > _RANK * singular[0]).sum()))
    return rank


def partial_deviation(arm: SerialArm, q: Array, pose: Array) -> Array:
    """Return what is left of the k held components (rad, m), in the axes of the pose."""
    actual = shaped_array("pose of the arm", arm.forward(q), (4, 4))
    R = pose[:3, :3]
    turn = rotation_vector_from_matrix(R.T @ actual[:3, :3])
    return -np.concatenate([turn, R.T @ (actual[:3, 3] - pose[:3, 3])])[arm.held]


def least_turn(target: Array, actual: Array, rows: IntArray) -> Array:
    """Return the least rotation vector (rad, base axes) that brings what is held of a rotation.

    `rows` are the components that are held: rows 0, 1 and 2 of twists, about axes of the target.
    """
    held = np.isin(np.arange(3), rows)
    if not held.any():
        return np.zeros(3)
    if held.sum() != 2:
        return rotation_vector_from_matrix(target @ actual.T)
    axis, wanted = actual[:, ~held][:, 0], target[:, ~held][:, 0]
    normal = np.cross(axis, wanted)
    sine = float(np.linalg.norm(normal))
    return normal * (math.atan2(sine, float(axis @ wanted)) / max(sine, 1e-300))


def partial_step(arm: SerialArm, q: Array, pose: Array) -> Array:
    """Return the Newton step (n,) towards a posture whose held components are those of a pose."""
    A = _equations(arm, q, PoseSample(pose, np.zeros(6), np.zeros(6)))[:, :-1]
    freedom = _freedom(arm, q)
    return freedom * least_solution(A * freedom, partial_deviation(arm, q, pose))


def partial_rates(arm: SerialArm, q: Array, place: PoseSample) -> tuple[Array, Array, float]:
    """Return the first two derivatives (n,) of joint values along a path, and the condition."""
    first = _least_rates(arm, q, place)
    h = _MOVE / max(1.0, float(np.abs(first).max()), float(np.abs(place.twist).max()))
    ahead, behind = (_least_rates(arm, q + x * first, _moved(place, x)) for x in (h, -h))
    singular = np.linalg.svd(_equations(arm, q, place)[:, :-1], compute_uv=False)
    weakest = singular[partial_rank(arm, len(q)) - 1]
    condition = float(singular[0] / weakest) if weakest > 0.0 else np.inf
    return first, (ahead - behind) / (2.0 * h), condition


def tip_rates(arm: SerialArm, joints: JointPath) -> Callable[[Array], Array]:
    """Return a function that gives the twists (m, 6) of the tool at coordinates (m,) of a path."""

    def twists(s: Array) -> Array:
        q, first = joints.derivatives(np.clip(s, 0.0, joints.length))[:2]
        return np.array([arm.jacobian(row) @ rate for row, rate in zip(q, first, strict=True)])

    return twists


def least_solution(A: Array, b: Array) -> Array:
    """Return the least vector with the least error of A x = b."""
    return np.linalg.lstsq(A, b, rcond=None)[0].astype(np.float64, copy=False)


def _least_rates(arm: SerialArm, q: Array, place: PoseSample) -> Array:
    system, freedom = _equations(arm, q, place), _freedom(arm, q)
    return freedom * least_solution(system[:, :-1] * freedom, system[:, -1])


def _equations(arm: SerialArm, q: Array, place: PoseSample) -> Array:
    """Return [A b], shape (k, n + 1), of the equations A q' = b."""
    J = shaped_array("jacobian", arm.jacobian(q), (6, len(q)))
    actual = shaped_array("pose of the arm", arm.forward(q), (4, 4))
    R, apart = place.pose[:3, :3], actual[:3, 3] - place.pose[:3, 3]
    omega, velocity = place.twist[:3], place.twist[3:]
    carried = np.concatenate([omega, velocity + np.cross(omega, apart)])
    twists = np.column_stack([J, carried])
    turning, moving = R.T @ twists[:3], R.T @ twists[3:]
    if arm.held is None or arm.held[0] < 3:
        turn = rotation_vector_from_matrix(R.T @ actual[:3, :3])
        turns = np.tile(turn, (turning.shape[1], 1))
        turning = rotation_rates(turns, "rotation-vector", turning.T)[0].T
    return np.concatenate([turning, moving])[arm.held]


def _moved(place: PoseSample, h: float) -> PoseSample:
    """Return a place that is farther along a path by a small part of the coordinate."""
    pose = place.pose.copy()
    pose[:3, :3] = matrix_from_rotation_vector(h * place.twist[:3]) @ pose[:3, :3]
    pose[:3, 3] += h * place.twist[3:]
    return PoseSample(pose, place.twist + h * place.twist_rate, place.twist_rate)


def _freedom(arm: SerialArm, q: Array) -> Array:
    """Return the factors (n,) of the rates, which fall smoothly near the limits of joints."""
    if arm.bounds is None:
        return np.ones(len(q))
    lower, upper = arm.bounds
    near = np.clip(_NEAR * (upper - lower), np.finfo(np.float64).tiny, _NEAR_AT_MOST)
    x = np.clip(np.minimum(q - lower, upper - q) / near, 0.0, 1.0)
    return _LEAST + (1.0 - _LEAST) * x**3 * (10.0 - 15.0 * x + 6.0 * x**2)
