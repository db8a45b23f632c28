"""The planning scene of move_group, as other nodes follow it."""

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.node import Node

from robomech_ros.errors import RobomechError
from robomech_ros.nodes.common.cooperative_wait import Worker
from robomech_ros.nodes.common.joints.joint_state_monitor import JointStateMonitor
from robomech_ros.nodes.common.robot.robot_description import LATCHED, RobotModel
from robomech_ros.nodes.middleware.throttled_log import ThrottledLog
from robomech_ros.robots import SerialChain

if TYPE_CHECKING:
    from robomech_ros.collision import PlanningScene
    from robomech_ros.nodes.move_group.scenes import Scenes

# Joints outside the chain, such as fingers, are followed if they move by more (rad or m).
_MOVED = 1e-3


class MonitoredScene:
    """Follows the topic ``monitored_planning_scene``, where its messages and coal are installed.

    - ``padding``: thickness that is added to every link (m).
    - ``changed``: called after each change.
    """

    def __init__(
        self,
        node: Node,
        model: RobotModel,
        monitor: JointStateMonitor,
        worker: Worker,
        padding: float = 0.0,
        changed: Callable[[], None] = lambda: None,
    ) -> None:
        self._model, self._monitor, self._worker = model, monitor, worker
        self._padding, self._changed = padding, changed
        self._log = ThrottledLog(node.get_logger())
        self._waiting: Any = None
        self._positions: dict[str, float] = {}
        self.scenes: Scenes | None = None  #: Received scenes; None before the first message.
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
        if ignored or self.scenes is None or not isinstance(way, SerialChain):
            return None
        return await self.scenes.of(way, self.known())

    def current(self) -> "PlanningScene | None":
        """Return the scene of the configured chain; None before the first message.

        It is the same object as long as nothing changes. Joints outside the chain are updated only
        when they move noticeably.
        """
        if self.scenes is None:
            return None
        known = self.known()
        own = self._model.chain.joint_names
        others = {name: value for name, value in known.items() if name not in own}
        before = self._positions
        if any(abs(before.get(name, np.inf) - value) > _MOVED for name, value in others.items()):
            self._positions = others
        return self.scenes.whole(self._positions)

    def known(self) -> dict[str, float]:
        """Return the present positions of the joints that are known (rad or m)."""
        return self._monitor.known_positions(self._model.joint_names)

    def add_note(self, scene: "PlanningScene | None", response: Any) -> Any:
        """Append the unchecked links to the text of an answer, and return the answer."""
        if scene is not None and self.scenes is not None:
            texts = response.error_msg, self.scenes.unchecked
            response.error_msg = "; ".join(filter(None, texts))
        return response

    def _take(self, message: Any) -> None:
        if message.is_diff:
            # It says where the robot is, which joint states do, too.
            return
        if self.scenes is not None:
            self._try_to_adopt(message)
            return
        making, self._waiting = self._waiting is not None, message
        if not making:
            self._worker.begin(self._new_scenes).add_done_callback(self._begin)

    def _new_scenes(self) -> "Scenes":
        from robomech_ros.nodes.move_group.scenes import Scenes

        return Scenes(self._model, self._worker, self._padding)

    def _begin(self, made: Any) -> None:
        """Store the first scenes, and apply the latest message to them."""
        message, self._waiting = self._waiting, None
        if made.exception() is not None:
            self._log.error(f"the planning scene is not followed: {made.exception()}")
            return
        self.scenes = made.result()
        self._try_to_adopt(message)

    def _try_to_adopt(self, message: Any) -> None:
        try:
            self._adopt(message)
        except RobomechError as error:
            self._log.error(f"the planning scene is not followed: {error}")

    def _adopt(self, message: Any) -> None:
        assert self.scenes is not None
        model, scenes, known = self._model, self.scenes, self.known()
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
