"""Publications of the latest plan, after the planner's response has been sent."""

from collections.abc import Callable

from rclpy.node import Node
from trajectory_msgs.msg import JointTrajectory

from robomech_ros.nodes.common.robot_description import LATCHED, RobotModel
from robomech_ros.nodes.trajectory_planner.planned_path import PlannedPath
from robomech_ros.typing import Array


class PlanPublication:
    """Publishes trajectories, and the paths that they let the tip take.

    Parameters
    ----------
    node : Node
        Gets the topics ``planned_trajectory`` and ``planned_path`` under its own name.
    model : RobotModel
        Whose motions they are.
    """

    def __init__(self, node: Node, model: RobotModel) -> None:
        self._node = node
        self._trajectories = node.create_publisher(JointTrajectory, "~/planned_trajectory", LATCHED)
        self._path = PlannedPath(node, model.base_frame)
        self._waiting: tuple[JointTrajectory, Callable[[], Array]] | None = None

    def publish_soon(self, trajectory: JointTrajectory, poses: Callable[[], Array]) -> None:
        """Publish a plan after the answer has left, before the next one is encoded.

        Parameters
        ----------
        trajectory : JointTrajectory
        poses : callable
            Gives the poses (m, 4, 4) of the tip at its points; called only if somebody listens.
        """
        self._waiting = (trajectory, poses)
        if self._node.executor is None:
            self.publish_waiting()
        else:
            self._node.executor.create_task(self.publish_waiting)

    def publish_waiting(self) -> None:
        """Publish the plan that is not published yet, if there is one."""
        if self._waiting is None:
            return
        trajectory, poses = self._waiting
        self._waiting = None
        self._trajectories.publish(trajectory)
        self._path.show(poses)
