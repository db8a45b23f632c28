"""The latched topic with the path of the tip under the latest plan."""

from collections.abc import Callable
from typing import Any

from geometry_msgs.msg import PoseStamped
from nav_msgs.msg import Path
from rclpy.event_handler import PublisherEventCallbacks
from rclpy.node import Node

from robomech_ros.nodes.common.pose_messages import fill_pose
from robomech_ros.nodes.common.robot_description import LATCHED
from robomech_ros.typing import Array

# Pose messages that are kept from one path to the next, 2 kB each.
_POSES_KEPT = 500


class PlannedPath:
    """Publishes the path of the tip in the base link, for one plan after the other.

    To make and send a path takes longer than to plan: before anybody listens it is not done, and
    who listens first gets the latest.  From then on every path is published, so that who comes
    later finds no path of an earlier plan.  Pose messages are used again: to make one takes longer
    than to fill it, and a message that is published has been copied.

    Parameters
    ----------
    node : Node
        Gets the topic ``planned_path`` under its own name.
    base : str
        Frame of the robot's base.
    """

    def __init__(self, node: Node, base: str) -> None:
        self._base = base
        self._poses: list[PoseStamped] = []
        self._unsent: Callable[[], Array] | None = None
        self._heard = False
        self._publisher = node.create_publisher(
            Path,
            "~/planned_path",
            LATCHED,
            event_callbacks=PublisherEventCallbacks(matched=self._matched),
        )

    def show(self, poses: Callable[[], Array]) -> None:
        """Publish the path of the latest plan, whose poses (m, 4, 4) a callable gives."""
        self._unsent = poses
        self._send_if_heard(self._publisher.get_subscription_count())

    def _matched(self, matched: Any) -> None:
        self._send_if_heard(matched.current_count)

    def _send_if_heard(self, listeners: int) -> None:
        """Publish the latest path, if not done yet, once somebody subscribes."""
        self._heard = self._heard or listeners > 0
        if self._heard and self._unsent is not None:
            self._publisher.publish(self._along(self._unsent()))
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
