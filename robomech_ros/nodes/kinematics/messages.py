"""Reading of requests to the node kinematics, and writing of its answers."""

from array import array
from typing import Any

import numpy as np
from sensor_msgs.msg import PointCloud2, PointField

from robomech_ros.errors import BadValueError
from robomech_ros.errors.formatting import counted
from robomech_ros.nodes.common.messages.error_codes import answer
from robomech_ros.nodes.common.messages.joint_messages import TrajectoryPoints
from robomech_ros.nodes.common.messages.message_fields import (
    duration_from_seconds,
    floats,
    not_negative,
    seconds_from_duration,
)
from robomech_ros.nodes.common.messages.pose_messages import matrix_from_pose, stamped_twist
from robomech_ros.nodes.frames.robot_frames import RobotFrames
from robomech_ros.nodes.kinematics.kinematic_results import PostureReport
from robomech_ros.outcomes import Code
from robomech_ros.typing import Array, IntArray

_METRICS = ("linf", "l2")
# Lists of a result, and where a response keeps them: its setters would copy the numbers once more.
_DISTANCES = ("seed_distance", "position_error", "orientation_error")
_SLOTS = {name: f"_{name}s" for name in (*_DISTANCES, "condition_number", "limit_margin")}
_SLOTS["blocking_excess"] = "_blocking_excess"
# Modes of SolveIK; SolveIKBatch has the first two.
_NEAREST, _FIRST = 1, 2


def inverse_options(request: Any) -> dict[str, Any]:
    """Read the options of a SolveIK request as keywords of `inverse_kinematics`.

    Raises BadValueError: a mode or metric that does not exist, a negative tolerance or timeout.
    """
    if request.metric >= len(_METRICS):
        raise BadValueError("metric", request.metric, "LINF (0) or L2 (1)")
    options: dict[str, Any] = {
        "respect_limits": not request.ignore_limits,
        "include_windings": request.include_windings,
        "metric": _METRICS[request.metric],
    }
    cap = 1 if wants_first(request.mode) or is_nearest(request.mode) else request.max_solutions
    if cap:
        options["max_solutions"] = cap
    if any(request.task_mask):
        options["task_mask"] = tuple(map(bool, request.task_mask))
    for name in ("position_tolerance", "orientation_tolerance"):
        value = getattr(request, name)
        if value:
            expected = "0 for the default, or a positive number"
            options[name] = not_negative(name, value, expected)
    if request.timeout.sec or request.timeout.nanosec:
        options["timeout"] = seconds_from_duration(request.timeout, "timeout")
    return options


def wants_first(mode: int) -> bool:
    """Return whether a mode of SolveIK asks for one attempt from the seed."""
    if mode > _FIRST:
        raise BadValueError("mode", mode, "ALL (0), NEAREST (1) or FIRST (2)")
    return mode == _FIRST


def is_nearest(mode: int) -> bool:
    """Return whether a mode asks for the nearest solution only."""
    if mode > _NEAREST:
        raise BadValueError("mode", mode, "ALL (0) or NEAREST (1)")
    return mode == _NEAREST


def encode_result(
    result: Any,
    joint_names: tuple[str, ...],
    points: TrajectoryPoints,
    solve_seconds: float,
    response: Any,
) -> Any:
    """Fill a SolveIK response with an InverseKinematicsResult or PlatformSolutions."""
    response.joint_names = list(joint_names)
    response.solutions = points.filled(None, result.q)
    for name, slot in _SLOTS.items():
        setattr(response, slot, floats(getattr(result, name)))
    response.branches = list(result.branches)
    response.complete = result.complete
    response.family = result.family
    response.blocking_joints = list(result.blocking_joints)
    clearances = getattr(result, "clearances", None)
    if clearances is not None:
        response.clearances = floats(clearances)
    duration_from_seconds(solve_seconds, response.solve_time)
    response.error_code = int(result.status)
    response.error_msg = result.reason
    return response


async def poses_in_base(frames: RobotFrames, poses: list[Any], patience: float) -> Array:
    """Convert the poses of a request to transforms in the base, shape (m, 4, 4) (m).

    - ``poses``: list of PoseStamped.
    - ``patience``: how long to wait for each new frame (s).

    Raises BadQuaternionError: the message names the pose by its index. FrameUnavailableError,
    NoStateError.
    """
    T = np.empty((len(poses), 4, 4))
    for k, stamped in enumerate(poses):
        T[k] = matrix_from_pose(stamped.pose, f"poses[{k}].pose")
    known: dict[tuple[str, int, int], Array] = {}
    for k, stamped in enumerate(poses):
        frame, stamp = stamped.header.frame_id, stamped.header.stamp
        key = frame, stamp.sec, stamp.nanosec
        if key not in known:
            known[key] = await frames.in_base(frame, patience, stamp)
        T[k] = known[key] @ T[k]
    return T


def encode_report(report: PostureReport, axes: Array, frame: str, response: Any) -> Any:
    """Fill an AnalyzeSingularity response.

    - ``axes``: rotation of the frame in the base in whose axes directions are given, shape (3, 3).
    - ``response``: AnalyzeSingularity.Response.
    """
    lost, free = (
        (twists.reshape(-1, 2, 3) @ axes).reshape(-1, 6)
        for twists in (report.lost_directions, report.free_directions)
    )
    response.singular_values = floats(report.singular_values)
    for name in (
        "rank",
        "manipulability",
        "condition_number",
        "characteristic_length",
        "normalised_condition_number",
    ):
        setattr(response, name, getattr(report, name))
    response.lost_directions = [stamped_twist(twist, frame) for twist in lost]
    response.singularity_types = list(report.singularity_types)
    response.summary = report.summary
    # Free directions have no field of their own.
    for rx, ry, rz, x, y, z in free.tolist():
        response.summary += (
            f"; free: [{x:.4g} {y:.4g} {z:.4g}] m/s with [{rx:.4g} {ry:.4g} {rz:.4g}] rad/s"
        )
    return answer(response)


def workspace_cloud(frame: str, T: Array, count: IntArray, distance: Array) -> PointCloud2:
    """Make a cloud of judged poses: x, y, z, how many solutions, distance from the boundary.

    - ``frame``: base of the chain.
    - ``T``: poses in the base (m), shape (m, 4, 4).
    - ``count``: numbers of solutions, shape (m,).
    - ``distance``: distances from the boundary (m), NaN if unknown, shape (m,).
    """
    rows = np.column_stack((T[:, :3, 3], count, distance)).astype("<f4")
    names = ("x", "y", "z", "solutions", "boundary_distance")
    fields = [
        PointField(name=name, offset=4 * k, datatype=PointField.FLOAT32, count=1)
        for k, name in enumerate(names)
    ]
    message = PointCloud2(height=1, width=len(rows), fields=fields, is_dense=False)
    message.header.frame_id = frame
    message.point_step = rows.itemsize * len(names)
    message.row_step = message.point_step * len(rows)
    message.data = array("B", rows.tobytes())
    return message


def answer_in_time(response: Any, done: int, poses: int, allowed: float) -> Any:
    """Finish the answer about many poses, of which some were done in the allowed time (s)."""
    if done == poses:
        return answer(response)
    text = f"{done} of {counted(poses, 'pose')} solved in {allowed:g} s"
    return answer(response, Code.TIMED_OUT, f"{text}, the parameter batch_timeout")
