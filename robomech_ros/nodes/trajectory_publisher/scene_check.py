"""Collision checks of motions, if there is a planning scene and the robot is known."""

from collections.abc import Callable
from typing import TYPE_CHECKING

from rclpy.node import Node

from robomech_ros.execution.client.execution_request import ExecutionRequest
from robomech_ros.nodes.common.cooperative_wait import Worker
from robomech_ros.nodes.common.joints.joint_state_monitor import JointStateMonitor
from robomech_ros.nodes.common.robot.robot_description import RobotModel
from robomech_ros.nodes.move_group.monitored_scene import MonitoredScene
from robomech_ros.nodes.trajectory_publisher.settings import PublisherSettings

if TYPE_CHECKING:
    from robomech_ros.nodes.move_group.motion_watch import MotionWatch


class SceneCheck:
    """Checks what execution requests would touch."""

    def __init__(
        self, node: Node, monitor: JointStateMonitor, settings: Callable[[], PublisherSettings]
    ) -> None:
        self._node, self._monitor, self._settings = node, monitor, settings
        self._worker: Worker | None = None
        self._model: RobotModel | None = None
        self._scene: MonitoredScene | None = None
        self._watched: tuple[ExecutionRequest, MotionWatch] | None = None

    def know_robot(self, model: RobotModel) -> None:
        """Follow the planning scene of an arm; other robots have none."""
        if model.mechanism is not None or model.legged is not None:
            return
        self._model, self._worker = model, Worker(self._node)
        self._scene = MonitoredScene(self._node, model, self._monitor, self._worker)

    def obstruction(self, execution: ExecutionRequest) -> str:
        """Name what the rest of a motion would touch; "" for nothing, or while nothing changes."""
        scene, model = self._scene, self._model
        if scene is None or model is None or scene.scenes is None:
            return ""
        if execution.ignore_collisions or not self._settings().check_collisions:
            return ""
        if self._watched is None or self._watched[0] is not execution:
            from robomech_ros.nodes.move_group.motion_watch import MotionWatch

            names, waypoints = execution.names, execution.waypoints
            self._watched = execution, MotionWatch(model, scene.known, names, waypoints)
        watch = self._watched[1]
        if not watch.is_due(scene.scenes.world):
            return ""
        return watch.obstruction(scene.scenes.at_once(watch.chain, scene.known()))

    def destroy(self) -> None:
        """End the thread that makes scenes."""
        if self._worker is not None:
            self._worker.close()
