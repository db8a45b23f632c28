"""Goals of the action execute_trajectory of robomech_interfaces."""

from typing import Any

from trajectory_msgs.msg import JointTrajectory

from robomech_interfaces.action import ExecuteTrajectory
from robomech_ros.execution.motion_result import MotionResult
from robomech_ros.nodes.common.message_fields import duration_from_seconds
from robomech_ros.nodes.trajectory_publisher.action_transport import AskedTolerances


class ExecuteGoals:
    """Puts goals of ExecuteTrajectory; see `ActionGoals`."""

    kind = ExecuteTrajectory
    name = "execute_trajectory"

    def goal(self, trajectory: JointTrajectory, tolerances: AskedTolerances) -> Any:
        """Make a goal, which names a tolerance for every joint or for none."""
        count = len(trajectory.joint_names)
        return ExecuteTrajectory.Goal(
            trajectory=trajectory,
            path_position_tolerance=[tolerances.path] * count if tolerances.path else [],
            goal_position_tolerance=[tolerances.goal] * count if tolerances.goal else [],
            goal_time_tolerance=duration_from_seconds(tolerances.goal_time),
        )

    def verdict(self, status: int, result: Any, began: bool) -> MotionResult:
        """Return code and text, which the result has."""
        return MotionResult(int(result.error_code), str(result.error_msg))
