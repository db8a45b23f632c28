"""Choice of the next sample of a hand-eye calibration."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robomech_ros._kernels.calibration import refinement
from robomech_ros._kernels.compiling.jit import direct
from robomech_ros.calibration.estimation import MOUNTS
from robomech_ros.calibration.initial_guess import pack_poses
from robomech_ros.calibration.result import HandEyeResult, sensor_covariance
from robomech_ros.errors import WrongSizeError
from robomech_ros.spatial.arrays import check_kind
from robomech_ros.spatial.poses import as_pose, inverse_pose
from robomech_ros.spatial.rotations.axis_angle import matrix_from_rotation_vector
from robomech_ros.typing import Array, ArrayLike

_information = direct(refinement.information_of)

# Turns (rad) about the target by which views are proposed: a target stays visible.
_TURNS = (0.35, 0.7)
_AXES = 8


@dataclass(frozen=True, eq=False)
class NextPose:
    """A pose for the next sample, and what it brings.

    Attributes
    ----------
    pose : ndarray, shape (4, 4)
        ``T_base_hand``.
    covariance : ndarray, shape (6, 6)
        Covariance of the sensor's pose with that sample, as in the result.
    gain : float
        Factor, at least 1, by which its error ellipsoid gets smaller: the root of the ratio of
        the determinants.
    """

    pose: Array
    covariance: Array
    gain: float


def next_best_pose(calibration: HandEyeResult, candidates: ArrayLike | None = None) -> NextPose:
    """Choose the pose of the robot whose sample makes the result's error ellipsoid smallest.

    Parameters
    ----------
    calibration : HandEyeResult
        Calibration of the samples so far.
    candidates : array_like, shape (m, 4, 4), optional
        ``T_base_hand`` to choose from, such as those that the robot can reach.  Without them,
        views of the target from where it was seen, turned about the target by 20 and 40
        degrees: the robot may be unable to reach one.
    """
    check_kind("calibration", calibration, HandEyeResult, "a HandEyeResult")
    if candidates is None:
        poses = _views(calibration)
    else:
        poses = as_pose(candidates, what="candidates")
        if poses.ndim != 3 or not len(poses):
            raise WrongSizeError("candidates", poses.shape, "(m, 4, 4) with m at least 1")
    side = MOUNTS.index(calibration.mount)
    rows = pack_poses(inverse_pose(poses) if side else poses)
    noise = calibration.noise
    three = np.array([noise.rotation**2, noise.position**2, noise.robot_share])
    at = pack_poses(np.stack((calibration.sensor, calibration.target))).reshape(24)
    added = np.empty((len(rows), 12, 12))
    _information(rows, at, three, side, added)
    before = sensor_covariance(calibration.information, calibration.sensor)
    after = [sensor_covariance(calibration.information + one, calibration.sensor) for one in added]
    sizes = [float(np.linalg.slogdet(one)[1]) for one in after]
    best = int(np.argmin(sizes))
    gain = float(np.exp(0.5 * (np.linalg.slogdet(before)[1] - sizes[best])))
    widening = calibration.covariance[0, 0] / before[0, 0]
    return NextPose(poses[best].copy(), widening * after[best], gain)


def _views(calibration: HandEyeResult) -> Array:
    """Poses of the hand with the sensor, or the target, turned about the target's origin."""
    Z = calibration.target
    base = calibration.robot_poses[calibration.inlier]
    angles = 2.0 * np.pi * np.arange(_AXES) / _AXES
    axes = np.stack((np.cos(angles), np.sin(angles), np.zeros(_AXES)), axis=1)
    axes = np.concatenate((axes, [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]))
    turns = np.tile(np.eye(4), (len(_TURNS) * len(axes), 1, 1))
    vectors = np.concatenate([turn * axes for turn in _TURNS])
    turns[:, :3, :3] = matrix_from_rotation_vector(vectors)
    if calibration.mount == "eye-in-hand":
        # T_target_hand of each sample, turned in the target's frame.
        seen = inverse_pose(Z) @ base
        views = Z @ turns[:, None] @ seen
    else:
        views = base[None] @ Z @ turns[:, None] @ inverse_pose(Z)
    return np.ascontiguousarray(views.reshape(-1, 4, 4))
