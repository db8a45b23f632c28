"""The planning scene of move_group, as other nodes follow it."""

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.node import Node

from robomech_ros.errors import RobomechError
from robomech_ros.nodes.common.cooperative_wait import Worker
from robomech_ros.nodes.common.joint_state_monitor import JointStateMonitor
from robomech_ros.nodes.common.robot_description import LATCHED, RobotModel
from robomech_ros.nodes.middleware.throttled_log import ThrottledLog
from robomech_ros.robots import SerialChain

if TYPE_CHECKING:
    from robomech_ros.collision import PlanningScene
    from robomech_ros.nodes.move_group.scenes import Scenes


class MonitoredScene:
    """Follows the topic ``monitored_planning_scene``, where its messages and coal are installed.

    Parameters
    ----------
    node : Node
    model : RobotModel
    monitor : JointStateMonitor
        Knows the present state of the robot.
    worker : Worker
        Makes scenes, which takes a moment.
    changed : callable, optional
        Called after each change.
    """

    def __init__(
        self,
        node: Node,
        model: RobotModel,
        monitor: JointStateMonitor,
        worker: Worker,
        changed: Callable[[], None] = lambda: None,
    ) -> None:
        self._model, self._monitor, self._worker = model, monitor, worker
        self._changed = changed
        self._log = ThrottledLog(node.get_logger())
        self._scenes: Scenes | None = None
        try:
            from moveit_msgs.msg import PlanningScene
        except ImportError:
            return
        # Its states come from a publisher that keeps nothing, which is not for this subscription.
        silent = SubscriptionEventCallbacks(use_default_callbacks=False)
        topic = "monitored_planning_scene"
        node.create_subscription(PlanningScene, topic, self._take, LATCHED, event_callbacks=silent)

    async def of(self, way: Any, ignored: bool) -> "PlanningScene | None":
        """Return the scene of a chain; None where there is none, or it is not wanted.

        It is good until the next await; longer work takes a copy.
        """
        if ignored or self._scenes is None or not isinstance(way, SerialChain):
            return None
        known = self._monitor.known_positions(self._model.joint_names)
        return await self._scenes.of(way, known)

    def _take(self, message: Any) -> None:
        if message.is_diff:
            # It says where the robot is, which joint states do, too.
            return
        try:
            self._adopt(message)
        except RobomechError as error:
            self._log.error(f"the planning scene is not followed: {error}")

    def _adopt(self, message: Any) -> None:
        from robomech_ros.nodes.move_group.scenes import Scenes

        model = self._model
        if self._scenes is None:
            self._scenes = Scenes(model, self._worker, 0.0)
        scenes = self._scenes
        known = self._monitor.known_positions(model.joint_names)
        world = scenes.world.copy(empty=True)
        # Objects stand in the base, or in the link that carries them.
        places = {model.base_frame: np.eye(4)} | dict.fromkeys(model.description.links, np.eye(4))
        for one in message.robot_state.attached_collision_objects:
            world.apply_attached(one, places)
        world.allow(message.allowed_collision_matrix, scenes.ignored(known))
        for one in message.world.collision_objects:
            if one.header.frame_id not in (model.base_frame, model.chain.base):
                why = f"object '{one.id[:100]}' is in '{one.header.frame_id[:100]}'"
                raise RobomechError(f"{why}, expected '{model.base_frame}', the base")
            if not world.keep(one, scenes.world):
                world.apply_object(one, places | {model.chain.base: np.eye(4)})
        scenes.adopt(world, known)
        self._changed()
