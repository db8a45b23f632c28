"""The collision guard of the servo, made from the planning scene."""

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from rclpy.node import Node

from robomech_ros.nodes.common.cooperative_wait import Worker
from robomech_ros.nodes.common.joints.joint_state_monitor import JointStateMonitor
from robomech_ros.nodes.common.robot.robot_description import RobotModel
from robomech_ros.nodes.move_group.monitored_scene import MonitoredScene
from robomech_ros.nodes.servo.settings import ServoNodeSettings

if TYPE_CHECKING:
    from robomech_ros.collision.servo_guard import ServoGuard


class SceneGuard:
    """Follows the planning scene, and makes the guard of a servo from it.

    - ``monitor``: knows the positions of joints outside the chain, such as fingers.
    """

    def __init__(
        self,
        node: Node,
        model: RobotModel,
        monitor: JointStateMonitor,
        settings: Callable[[], ServoNodeSettings],
    ) -> None:
        self._settings, self._worker = settings, Worker(node)
        self._scene = MonitoredScene(node, model, monitor, self._worker, settings().padding)
        self._guard: ServoGuard | None = None
        self._distances: Any = None

    def current(self) -> "ServoGuard | None":
        """Return the guard of the present scene; None if there is no scene, or it is ignored."""
        settings = self._settings()
        scene = self._scene.current() if settings.check_collisions else None
        if scene is None:
            return None
        if self._guard is None or scene.distances is not self._distances:
            from robomech_ros.collision.servo_guard import ServoGuard

            self._distances = scene.distances
            thresholds = (
                settings.self_collision_proximity_threshold,
                settings.scene_collision_proximity_threshold,
            )
            self._guard = ServoGuard(scene, *thresholds)
        return self._guard

    def close(self) -> None:
        """End the thread that makes scenes."""
        self._worker.close()
