"""Samples and results of calibrations in messages."""

from typing import Any

import numpy as np
from geometry_msgs.msg import PoseArray, Vector3

from robomech_ros.calibration import HandEyeResult, NextPose
from robomech_ros.calibration.estimation import LARGEST_COORDINATE
from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.nodes.calibration.files import POSITION_FIRST
from robomech_ros.nodes.calibration.samples import Samples, Solution
from robomech_ros.nodes.common.messages.error_codes import FrameUnavailableError, shortened
from robomech_ros.nodes.common.messages.message_fields import floats
from robomech_ros.nodes.common.messages.pose_messages import (
    matrix_from_pose,
    pose_from_matrix,
    stamped_pose,
    stamped_transform,
)
from robomech_ros.spatial import rotation_vector_from_matrix
from robomech_ros.typing import Array

_MOST_NAMED = 20
# So few samples do not tell a sensor in the hand from one beside the robot.
_EITHER_MOUNT = 3


def poses_from_array(message: PoseArray, frame: str, what: str, most: int) -> Array:
    """Read poses, shape (n, 4, 4).

    - ``frame``: required frame of the poses; empty for any.
    - ``what``: name of the field.
    - ``most``: largest number of poses.

    Raises FrameUnavailableError, BadQuaternionError: a pose at fault is named by its number.
    """
    given = message.header.frame_id.removeprefix("/")
    if given and frame and given != frame:
        raise FrameUnavailableError(given, [frame], f"{what} is taken in {frame!r} alone, or ''")
    if len(message.poses) > most:
        raise WrongSizeError(f"{what}.poses", len(message.poses), f"at most {most}")
    rows = [matrix_from_pose(pose, f"{what}.poses[{k}]") for k, pose in enumerate(message.poses)]
    poses = np.array(rows).reshape(-1, 4, 4)
    reach = np.abs(poses[:, :3, 3]).max(axis=1)
    for k in np.flatnonzero(reach > LARGEST_COORDINATE)[:1].tolist():
        raise BadValueError(
            f"largest coordinate of {what}.poses[{k}].position",
            float(reach[k]),
            f"at most {LARGEST_COORDINATE:g} m",
        )
    return poses


def fill_list(samples: Samples, base: str, sensor: str, response: Any) -> None:
    """Write the samples, in these frames, to a ListSamples response."""
    for field, frame, poses in (
        (response.robot, base, samples.robot),
        (response.tracking, sensor, samples.tracking),
    ):
        field.header.frame_id = frame
        field.poses = [pose_from_matrix(T) for T in poses]
    if samples.solved is not None:
        _fill_residuals(samples.solved.result, response)
    response.summary = "\n".join(_lines(samples)) or "no samples"


def _fill_residuals(found: HandEyeResult, response: Any) -> None:
    response.rotation_residuals, response.position_residuals = map(floats, found.residuals.T)
    response.inlier = found.inlier.tolist()


def _lines(samples: Samples) -> list[str]:
    solution = samples.solved
    lines = []
    for k, (robot, tracking) in enumerate(zip(samples.robot, samples.tracking, strict=True)):
        text = f"{k}: hand at {_listed(robot[:3, 3])} m, target at {_listed(tracking[:3, 3])} m"
        if solution is not None:
            angle, distance = solution.result.residuals[k]
            text += f", off by {distance:.3g} m and {angle:.3g} rad"
            text += "" if solution.result.inlier[k] else ", left out"
        lines.append(text)
    return lines


def encode_solution(solution: Solution, response: Any) -> None:
    """Write a result to a SolveCalibration response, all but the next pose."""
    found, frames = solution.result, solution.frames
    response.sensor = stamped_transform(found.sensor, solution.sensor_parent, frames.sensor)
    response.target = stamped_transform(found.target, solution.target_parent, frames.target)
    response.covariance = found.covariance[np.ix_(POSITION_FIRST, POSITION_FIRST)].ravel()
    response.position_deviation = found.position_deviation
    response.rotation_deviation = found.rotation_deviation
    _fill_residuals(found, response)
    response.outliers = list(found.outliers)
    for field in ("weak_directions", "free_directions"):
        rows = getattr(found, field).tolist()
        setattr(response, field, [Vector3(**dict(zip("xyz", row, strict=True))) for row in rows])
    response.position_noise, response.rotation_noise = found.noise.position, found.noise.rotation
    response.robot_share = found.noise.robot_share
    response.summary = _in_words(solution)


def encode_next(proposed: NextPose, candidates: Array | None, base: str, response: Any) -> None:
    """Write the pose for the next sample to a SolveCalibration response."""
    response.next_pose = stamped_pose(proposed.pose, base)
    response.next_gain = proposed.gain
    if candidates is not None:
        away = np.abs(candidates - proposed.pose).sum(axis=(1, 2))
        response.next_index = int(np.argmin(away))


def _in_words(solution: Solution) -> str:
    """Say where the sensor is and how well that is known."""
    found, frames = solution.result, solution.frames
    turn = rotation_vector_from_matrix(found.sensor[:3, :3])
    lines = [
        f"{frames.sensor or 'the sensor'} in {solution.sensor_parent}: at "
        f"{_listed(found.sensor[:3, 3])} m, rotation vector {_listed(turn)} rad; {found.mount}, "
        f"{int(found.inlier.sum())} of {len(found.inlier)} samples",
        f"known to {found.determined_deviation:.3g} m and {found.rotation_deviation:.3g} rad (one "
        f"deviation, worst direction); noise of the samples {found.noise.position:.3g} m and "
        f"{found.noise.rotation:.3g} rad",
    ]
    if len(found.inlier) == _EITHER_MOUNT:
        lines.append("three samples fit either mount: the mount is not verified")
    if found.outliers:
        named = shortened([str(k) for k in found.outliers], _MOST_NAMED)
        lines.append(f"left out, since they contradict the others: samples {named}")
    free = len(found.free_directions)
    for axis in found.weak_directions[:free]:
        lines.append(
            f"not determined along {_listed(axis)} of {solution.sensor_parent}, where it is taken "
            "to be 0: all turns are about parallel axes. Measure it, or add a pose that is tilted"
        )
    for axis in found.weak_directions[free:]:
        lines.append(f"badly known along {_listed(axis)} of {solution.sensor_parent}")
    return "\n".join(lines)


def _listed(vector: Array) -> str:
    return " ".join(f"{x:.4f}" for x in np.round(vector, 4) + 0.0)
