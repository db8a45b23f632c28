"""The planning scene of move_group on a page, where objects can be dragged."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rclpy.node import Node

from robomech_ros.nodes.common.cooperative_wait import Worker
from robomech_ros.nodes.common.joints.joint_state_monitor import JointStateMonitor
from robomech_ros.nodes.common.messages.pose_messages import pose_from_matrix
from robomech_ros.nodes.common.robot.robot_description import RobotModel
from robomech_ros.nodes.move_group.monitored_scene import MonitoredScene
from robomech_ros.nodes.rvs.gripper import soon
from robomech_ros.typing import Array

if TYPE_CHECKING:
    from robomech_ros.rvs.layers.world import WorldLayer

_TOPIC = "collision_object"


class WorldFeed:
    """Shows the planning scene on a page, and publishes the objects moved there.

    - ``view``: shows the scene.
    """

    def __init__(self, node: Node, model: RobotModel, view: WorldLayer) -> None:
        self._node, self._model, self._view = node, model, view
        self._worker = Worker(node)
        self._scene = MonitoredScene(
            node,
            model,
            JointStateMonitor(node),
            self._worker,
            changed=lambda: soon(node, self._show),
        )
        self._publisher: Any = None
        try:
            from moveit_msgs.msg import CollisionObject
        except ImportError:
            return
        self._publisher = node.create_publisher(CollisionObject, _TOPIC, 10)

    def move(self, name: str, pose: Array) -> str:
        """Publish a new pose (4, 4) of an object in the base (m); warn without subscribers."""
        from moveit_msgs.msg import CollisionObject

        topic = self._publisher.topic_name
        if not self._publisher.get_subscription_count():
            return f"No move_group listens on '{topic}': '{name}' has moved on this page alone."
        moved = CollisionObject(id=name, operation=CollisionObject.MOVE)
        moved.header.frame_id = self._model.base_frame
        moved.header.stamp = self._node.get_clock().now().to_msg()
        moved.pose = pose_from_matrix(pose)
        self._publisher.publish(moved)
        return ""

    def close(self) -> None:
        """End the thread that makes scenes."""
        self._worker.close()

    async def _show(self) -> None:
        scene = await self._scene.of(self._model.chain, False)
        if scene is not None:
            self._view.show_scene(scene.copy())
