"""Messages of the action follow_joint_trajectory of control_msgs, as ros2_control has them."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from builtin_interfaces.msg import Time
from control_msgs.action import FollowJointTrajectory

from robomech_ros.errors import BadValueError, RobomechError, UnknownJointError
from robomech_ros.errors.formatting import counted
from robomech_ros.execution.controller.trajectory_goal import End, GoalResult, TrajectoryGoal
from robomech_ros.execution.joints import State
from robomech_ros.execution.motion_tolerances import NONE, Tolerances
from robomech_ros.execution.rejections import (
    JointMismatchError,
    StartMismatchError,
    TrajectoryOverError,
    TrajectoryRefusedError,
)
from robomech_ros.nodes.joint_trajectory_controller.messages import fill_feedback
from robomech_ros.outcomes import Code
from robomech_ros.typing import Array

_RESULT = FollowJointTrajectory.Result
_CODES: dict[int, int] = {
    Code.NONE: _RESULT.SUCCESSFUL,
    Code.PATH_TOLERANCE: _RESULT.PATH_TOLERANCE_VIOLATED,
    Code.GOAL_TOLERANCE: _RESULT.GOAL_TOLERANCE_VIOLATED,
}
_NANO = 1e-9


class FollowMessages:
    """Reads goals and writes results of FollowJointTrajectory.

    - ``joint_names``: the joints of the robot.
    """

    kind = FollowJointTrajectory
    name = "follow_joint_trajectory"

    def __init__(self, joint_names: Sequence[str]) -> None:
        self._feedback = FollowJointTrajectory.Feedback(joint_names=list(joint_names))
        # Not in Jazzy's definition.
        self._has_index = hasattr(self._feedback, "index")

    def tolerances(
        self, message: Any, default: Tolerances, joint_names: Sequence[str]
    ) -> tuple[Tolerances, str]:
        """Read the tolerances of a goal, and say what of them does not hold.

        As in ros2_control the defaults hold, all of them, where one tolerance is at fault.

        Raises TrajectoryRefusedError: the goal moves joints of several degrees of freedom.
        """
        compound = message.multi_dof_trajectory
        if compound.joint_names or compound.points:
            named = ", ".join(compound.joint_names[:5]) or counted(len(compound.points), "point")
            raise _CompoundJointError(
                f"multi_dof_trajectory has {named}, expected nothing: the robot has no joint of "
                "several degrees of freedom"
            )
        try:
            return _with_tolerances(message, default, joint_names), ""
        except RobomechError as error:
            return default, f"the default tolerances hold, as one of the goal cannot: {error}"

    def refused(self, error: Exception) -> Any:
        """Make the result of a goal that is not executed."""
        code = _RESULT.INVALID_GOAL
        if isinstance(error, UnknownJointError | JointMismatchError | _CompoundJointError):
            code = _RESULT.INVALID_JOINTS
        elif isinstance(error, TrajectoryOverError):
            code = _RESULT.OLD_HEADER_TIMESTAMP
        elif isinstance(error, StartMismatchError):
            code = _RESULT.PATH_TOLERANCE_VIOLATED
        return _RESULT(error_code=code, error_string=str(error))

    def ended(self, result: GoalResult, note: str) -> Any:
        """Make the result of a motion; a cancelled one has code 0, as in ros2_control."""
        code = _CODES.get(result.code, _RESULT.INVALID_GOAL)
        if result.end is End.CANCELLED:
            code = _RESULT.SUCCESSFUL
        text = "; ".join(part for part in (result.text, note) if part)
        return _RESULT(error_code=code, error_string=text)

    def feedback(self, goal: TrajectoryGoal, desired: State, actual: State, stamp: Time) -> Any:
        """Tell how far a motion has come."""
        self._feedback.header.stamp = stamp
        fill_feedback(self._feedback, desired, actual, goal.time)
        self._feedback.error.accelerations = (desired.acceleration - actual.acceleration).tolist()
        if self._has_index:
            times = goal.waypoints.times
            place = int(np.searchsorted(times, goal.time + goal.late, side="right"))
            self._feedback.index = min(place, len(times) - 1)
        return self._feedback


class _CompoundJointError(TrajectoryRefusedError):
    """The goal moves joints of several degrees of freedom."""


def _with_tolerances(goal: Any, default: Tolerances, joint_names: Sequence[str]) -> Tolerances:
    for field in ("component_path_tolerance", "component_goal_tolerance"):
        if getattr(goal, field):
            joint = getattr(goal, field)[0].joint_name
            raise BadValueError(field, joint, "nothing: no joint has several degrees of freedom")
    path, at_goal = goal.path_tolerance, goal.goal_tolerance
    any_rate = np.full(len(joint_names), math.inf)
    names = tuple(joint_names)
    return replace(
        default,
        path=_override(default.path, path, "position", "path_tolerance", names),
        path_velocity=_override(any_rate, path, "velocity", "path_tolerance", names),
        path_acceleration=_override(any_rate, path, "acceleration", "path_tolerance", names),
        goal=_override(default.goal, at_goal, "position", "goal_tolerance", names),
        velocity=_override(default.velocity, at_goal, "velocity", "goal_tolerance", names),
        goal_acceleration=_override(any_rate, at_goal, "acceleration", "goal_tolerance", names),
        goal_time=_goal_time(goal.goal_time_tolerance, default.goal_time),
    )


def _override(
    default: Array, given: Iterable[Any], field: str, what: str, names: tuple[str, ...]
) -> Array:
    """Replace the defaults of joints that are named: 0 = default, -1 = any."""
    values = default.copy()
    for tolerance in given:
        if tolerance.name not in names:
            raise UnknownJointError(tolerance.name, names)
        value = getattr(tolerance, field)
        if not math.isfinite(value) or (value < 0.0 and value != NONE):
            joint = f"{what}.{field} of joint '{tolerance.name}'"
            raise BadValueError(joint, value, "positive, 0 (default) or -1 (any)")
        if value:
            values[names.index(tolerance.name)] = math.inf if value == NONE else value
    return values


def _goal_time(given: Any, default: float) -> float:
    seconds = given.sec + given.nanosec * _NANO
    if seconds < 0.0 and seconds != NONE:
        raise BadValueError("goal_time_tolerance", seconds, "positive, 0 (default) or -1 (any)")
    return math.inf if seconds == NONE else seconds or default
