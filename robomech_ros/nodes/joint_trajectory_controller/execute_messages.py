"""Messages of the action execute_trajectory of robomech_interfaces."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from builtin_interfaces.msg import Time

from robomech_interfaces.action import ExecuteTrajectory
from robomech_ros.execution.controller.trajectory_goal import GoalResult, TrajectoryGoal
from robomech_ros.execution.joints import State
from robomech_ros.execution.motion_tolerances import Tolerances, override_tolerances
from robomech_ros.execution.received_trajectory import joint_order
from robomech_ros.nodes.common.error_codes import code_of
from robomech_ros.nodes.common.message_fields import floats, seconds_from_duration
from robomech_ros.nodes.joint_trajectory_controller.messages import fill_feedback

_FIELDS = ("path_position_tolerance", "goal_position_tolerance", "goal_velocity_tolerance")


class ExecuteMessages:
    """Reads goals and writes results of ExecuteTrajectory.

    Parameters
    ----------
    joint_names : sequence of str
        The joints that trajectories move.
    others : sequence of str, optional
        Joints that follow them and may be named, too: the passive ones of a parallel robot.
    """

    kind = ExecuteTrajectory
    name = "execute_trajectory"

    def __init__(self, joint_names: Sequence[str], others: Sequence[str] = ()) -> None:
        self._joint_names, self._others = list(joint_names), tuple(others)
        self._feedback = ExecuteTrajectory.Feedback(joint_names=self._joint_names)

    def tolerances(
        self, message: Any, default: Tolerances, joint_names: Sequence[str]
    ) -> tuple[Tolerances, str]:
        """Read the tolerances of a goal, and say what of them does not hold: nothing.

        Those that do not make sense are refused.
        """
        names = message.trajectory.joint_names
        order = joint_order(names, [*joint_names, *self._others], partial=True)[: len(joint_names)]
        path, at_goal, velocity = (
            override_tolerances(values, getattr(message, field), order, names, field)
            for field, values in zip(
                _FIELDS, (default.path, default.goal, default.velocity), strict=True
            )
        )
        time = seconds_from_duration(message.goal_time_tolerance, "goal_time_tolerance")
        found = replace(
            default, path=path, goal=at_goal, velocity=velocity, goal_time=time or default.goal_time
        )
        return found, ""

    def refused(self, error: Exception) -> Any:
        """Make the result of a goal that is not executed."""
        return ExecuteTrajectory.Result(
            joint_names=self._joint_names, error_code=code_of(error), error_msg=str(error)
        )

    def ended(self, result: GoalResult, note: str) -> Any:
        """Make the result of a motion."""
        return ExecuteTrajectory.Result(
            joint_names=self._joint_names,
            final_position_error=floats(result.error),
            error_code=result.code,
            error_msg=result.text,
        )

    def feedback(self, goal: TrajectoryGoal, desired: State, actual: State, stamp: Time) -> Any:
        """Tell how far a motion has come."""
        self._feedback.header.stamp = stamp
        fill_feedback(self._feedback, desired, actual, goal.time)
        self._feedback.progress = goal.progress
        return self._feedback
