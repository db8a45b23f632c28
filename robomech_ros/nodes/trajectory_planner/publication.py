"""Publications of the latest plan, after the planner's response has been sent."""

from collections.abc import Callable
from functools import partial
from typing import Any

from geometry_msgs.msg import PoseStamped
from nav_msgs.msg import Path
from rclpy.event_handler import PublisherEventCallbacks
from rclpy.node import Node
from trajectory_msgs.msg import JointTrajectory

from robomech_ros.nodes.common.cooperative_wait import steady_timer
from robomech_ros.nodes.common.messages.pose_messages import fill_pose
from robomech_ros.nodes.common.robot.robot_description import LATCHED, RobotModel
from robomech_ros.typing import Array

# Pose messages that are kept from one path to the next, 2 kB each.
_POSES_KEPT = 500
# When the client has its answer, s: on few cores, work right after it is sent would hold it up.
_ANSWERED = 0.002


class PlanPublication:
    """Publishes trajectories, and the paths that they let the tip take.

    To make and send a path takes longer than to plan: before anybody listens it is not done, and
    who listens first gets the latest.  From then on every path is published, so that who comes
    later finds no path of an earlier plan.  Pose messages are used again: to make one takes longer
    than to fill it, and a message that is published has been copied.

    - ``node``: gets the topics ``planned_trajectory`` and ``planned_path`` under its own name.
    """

    def __init__(self, node: Node, model: RobotModel) -> None:
        self._node, self._base = node, model.base_frame
        # Subscribers of another type or quality of service report that themselves.
        silent = PublisherEventCallbacks(use_default_callbacks=False)
        make = partial(node.create_publisher, qos_profile=LATCHED)
        self._trajectories = make(JointTrajectory, "~/planned_trajectory", event_callbacks=silent)
        on_match = PublisherEventCallbacks(matched=self._matched, use_default_callbacks=False)
        self._paths = make(Path, "~/planned_path", event_callbacks=on_match)
        self._timer = steady_timer(node, _ANSWERED, self._publish_late, autostart=False)
        self._waiting: tuple[JointTrajectory, Callable[[], Array]] | None = None
        self._poses: list[PoseStamped] = []
        self._unsent: Callable[[], Array] | None = None
        self._heard = False

    def publish_soon(self, trajectory: JointTrajectory, poses: Callable[[], Array]) -> None:
        """Publish a plan after the answer has left, before the next one is encoded.

        - ``poses``: gives the poses (m, 4, 4) of the tip at its points; called only if somebody
          listens.
        """
        self._waiting = (trajectory, poses)
        if self._node.executor is None:
            self.publish_waiting()
        else:
            self._timer.reset()

    def _publish_late(self) -> None:
        self._timer.cancel()
        self.publish_waiting()

    def publish_waiting(self) -> None:
        """Publish the plan that is not published yet, if there is one."""
        if self._waiting is None:
            return
        trajectory, poses = self._waiting
        self._waiting = None
        self._trajectories.publish(trajectory)
        self._unsent = poses
        self._send_if_heard(self._paths.get_subscription_count())

    def _matched(self, matched: Any) -> None:
        self._send_if_heard(matched.current_count)

    def _send_if_heard(self, listeners: int) -> None:
        """Publish the latest path, if not done yet, once somebody subscribes."""
        self._heard = self._heard or listeners > 0
        if self._heard and self._unsent is not None:
            self._paths.publish(self._along(self._unsent()))
            self._unsent = None

    def _along(self, transforms: Array) -> Path:
        """Make the path of m poses, of stamp 0; it holds until the next one is made."""
        new = [PoseStamped() for _ in range(len(transforms) - len(self._poses))]
        for message in new:
            message.header.frame_id = self._base
        poses = self._poses[: len(transforms)] + new
        for message, T in zip(poses, transforms, strict=True):
            fill_pose(message.pose, T)
        self._poses += new[: max(0, _POSES_KEPT - len(self._poses))]
        path = Path(poses=poses)
        path.header.frame_id = self._base
        return path
