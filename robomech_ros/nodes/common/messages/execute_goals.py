"""Goals of the action execute_trajectory of robomech_interfaces."""

from dataclasses import dataclass
from typing import Any

from trajectory_msgs.msg import JointTrajectory

from robomech_interfaces.action import ExecuteTrajectory
from robomech_ros.execution.motion_result import MotionResult
from robomech_ros.nodes.common.messages.message_fields import duration_from_seconds


@dataclass(frozen=True)
class AskedTolerances:
    """Tolerances that every goal requests from the controller; 0 = the controller's own setting.

    - ``path``, ``goal``: how far a joint may be from its path and from its last point, rad or m; -1
      = any distance.
    """

    path: float = 0.0
    goal: float = 0.0
    goal_time: float = 0.0  #: Time after its end by which a trajectory must reach its goal (s).


class ExecuteGoals:
    """Goals of ExecuteTrajectory: how they are put, and what results mean."""

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
