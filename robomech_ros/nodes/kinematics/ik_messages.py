"""Reading of SolveIK requests and encoding of what was found."""

from array import array
from typing import Any

import numpy as np
from numpy.typing import NDArray
from trajectory_msgs.msg import JointTrajectoryPoint

from robomech_ros.errors import BadValueError, NonFiniteError
from robomech_ros.kinematics import InverseKinematicsResult
from robomech_ros.nodes.common.message_fields import (
    duration_from_seconds,
    floats,
    seconds_from_duration,
)

__all__ = ["SolutionPoints", "encode_result", "inverse_options", "is_nearest"]

Array = NDArray[np.float64]

_METRICS = ("linf", "l2")
_NEAREST = 1


def inverse_options(request: Any) -> dict[str, Any]:
    """Read the options of a SolveIK request as keywords of `inverse_kinematics`.

    Raises
    ------
    BadValueError, NonFiniteError
        A mode or metric that does not exist, a negative tolerance or timeout.
    """
    if request.metric >= len(_METRICS):
        raise BadValueError("metric", request.metric, "LINF (0) or L2 (1)")
    options: dict[str, Any] = {
        "respect_limits": not request.ignore_limits,
        "include_windings": request.include_windings,
        "metric": _METRICS[request.metric],
    }
    cap = 1 if is_nearest(request.mode) else request.max_solutions
    if cap:
        options["max_solutions"] = cap
    mask = tuple(bool(entry) for entry in request.task_mask)
    if any(mask):
        options["task_mask"] = mask
    for name in ("position_tolerance", "orientation_tolerance"):
        value = getattr(request, name)
        if value:
            options[name] = _tolerance(name, value)
    if request.timeout.sec or request.timeout.nanosec:
        options["timeout"] = seconds_from_duration(request.timeout, "timeout")
    return options


def is_nearest(mode: int) -> bool:
    """Whether a mode asks for the nearest solution only."""
    if mode > _NEAREST:
        raise BadValueError("mode", mode, "ALL (0) or NEAREST (1)")
    return mode == _NEAREST


def _tolerance(name: str, value: float) -> float:
    if not np.isfinite(value):
        raise NonFiniteError(name, value)
    if value < 0.0:
        raise BadValueError(name, value, "0 for the default, or a positive number")
    return value


class SolutionPoints:
    """Trajectory points that are used again for every answer.

    To make a point message takes longer than to fill it, and rclpy copies an answer before the
    next request is taken.
    """

    def __init__(self) -> None:
        self._points: list[JointTrajectoryPoint] = []

    def filled(self, q: Array) -> list[JointTrajectoryPoint]:
        """Give k points with the rows of q, shape (k, n), as positions."""
        while len(self._points) < len(q):
            self._points.append(JointTrajectoryPoint())
        points = self._points[: len(q)]
        for point, row in zip(points, q, strict=True):
            point.positions = floats(row)
        return points


def encode_result(
    result: InverseKinematicsResult,
    joint_names: tuple[str, ...],
    points: SolutionPoints,
    solve_seconds: float,
    response: Any,
) -> Any:
    """Fill a SolveIK response."""
    response.joint_names = list(joint_names)
    response.solutions = points.filled(result.q)
    response.seed_distances = floats(result.seed_distance)
    response.position_errors = floats(result.position_error)
    response.orientation_errors = floats(result.orientation_error)
    response.condition_numbers = floats(result.condition_number)
    response.limit_margins = floats(result.limit_margin)
    response.branches = list(result.branches)
    response.complete = result.complete
    response.family = result.family
    response.blocking_joints = list(result.blocking_joints)
    response.blocking_excess = array("d", result.blocking_excess)
    response.solve_time = duration_from_seconds(solve_seconds)
    response.error_code = int(result.status)
    response.error_msg = result.reason
    return response
