"""Goals of the action execute_trajectory of robomech_interfaces."""

from dataclasses import dataclass
from typing import Any

from trajectory_msgs.msg import JointTrajectory

from robomech_interfaces.action import ExecuteTrajectory
from robomech_ros.execution.motion_result import MotionResult
from robomech_ros.nodes.common.messages.message_fields import duration_from_seconds


@dataclass(frozen=True)
class AskedTolerances:
    """Tolerances in every goal to the controller; 0 = the controller's own setting.

    - ``path``, ``goal``: how far a joint may be from its path and from its last point, rad or m; -1
      = any distance.
    """

    path: float = 0.0
    goal: float = 0.0
    goal_time: float = 0.0  #: Allowed delay of the goal after the end of a trajectory (s).


class ExecuteGoals:
    """Goals of ExecuteTrajectory: encoding, and meaning of results."""

    kind = ExecuteTrajectory
    name = "execute_trajectory"

    def goal(self, trajectory: JointTrajectory, tolerances: AskedTolerances) -> Any:
        """Make a goal with a tolerance for every joint or for none."""
        count = len(trajectory.joint_names)
        return ExecuteTrajectory.Goal(
            trajectory=trajectory,
            path_position_tolerance=[tolerances.path] * count if tolerances.path else [],
            goal_position_tolerance=[tolerances.goal] * count if tolerances.goal else [],
            goal_time_tolerance=duration_from_seconds(tolerances.goal_time),
        )

    def verdict(self, status: int, result: Any, began: bool) -> MotionResult:
        """Return code and text of a result."""
        return MotionResult(int(result.error_code), str(result.error_msg))
