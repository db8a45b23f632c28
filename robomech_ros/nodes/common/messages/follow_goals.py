"""Goals of the action follow_joint_trajectory of control_msgs, which ros2_control serves."""

from typing import Any

from action_msgs.msg import GoalStatus
from control_msgs.action import FollowJointTrajectory
from control_msgs.msg import JointTolerance
from trajectory_msgs.msg import JointTrajectory

from robomech_ros.execution.motion_result import MotionResult
from robomech_ros.nodes.common.messages.execute_goals import AskedTolerances
from robomech_ros.nodes.common.messages.message_fields import duration_from_seconds
from robomech_ros.outcomes import Code

_RESULT = FollowJointTrajectory.Result
_CODES: dict[int, Code] = {
    _RESULT.SUCCESSFUL: Code.REJECTED,
    _RESULT.INVALID_GOAL: Code.REJECTED,
    _RESULT.INVALID_JOINTS: Code.UNKNOWN_JOINT,
    _RESULT.OLD_HEADER_TIMESTAMP: Code.REJECTED,
    _RESULT.PATH_TOLERANCE_VIOLATED: Code.PATH_TOLERANCE,
    _RESULT.GOAL_TOLERANCE_VIOLATED: Code.GOAL_TOLERANCE,
}
# Codes that mean, after the start of a motion, that something else has ended it.
_STOPPED = (_RESULT.SUCCESSFUL, _RESULT.INVALID_GOAL)
_NAMES = {
    getattr(_RESULT, name): name
    for name in dir(_RESULT)
    if name.isupper() and isinstance(getattr(_RESULT, name), int)
}
# Text of joint_trajectory_controller without an error.
_DEFAULT_TEXT = "Goal successfully reached!"


class FollowGoals:
    """Goals of FollowJointTrajectory: encoding, and meaning of results."""

    kind = FollowJointTrajectory
    name = "follow_joint_trajectory"

    def goal(self, trajectory: JointTrajectory, tolerances: AskedTolerances) -> Any:
        """Make a goal with the joints that have tolerances of their own."""
        names = trajectory.joint_names
        return FollowJointTrajectory.Goal(
            trajectory=trajectory,
            path_tolerance=_for_each(tolerances.path, names),
            goal_tolerance=_for_each(tolerances.goal, names),
            goal_time_tolerance=duration_from_seconds(tolerances.goal_time),
        )

    def verdict(self, status: int, result: Any, began: bool) -> MotionResult:
        """Translate a result.

        The same code, INVALID_GOAL, says that a goal is refused and that its motion was ended by
        another goal or by the controller's end: whether the robot has moved tells which.
        """
        given, text = int(result.error_code), str(result.error_string)
        if status == GoalStatus.STATUS_SUCCEEDED and given == _RESULT.SUCCESSFUL:
            return MotionResult(Code.NONE, "" if text == _DEFAULT_TEXT else text)
        name = _NAMES.get(given, f"error code {given}")
        if status == GoalStatus.STATUS_CANCELED:
            return MotionResult(Code.PREEMPTED, text or "the goal was cancelled")
        code = _CODES.get(given, Code.REJECTED)
        if began and given in _STOPPED:
            code = Code.PREEMPTED
        return MotionResult(code, f"{name}: {text}" if text else f"{name}, without a reason")


def _for_each(value: float, names: list[str]) -> list[JointTolerance]:
    return [JointTolerance(name=name, position=value) for name in names] if value else []
