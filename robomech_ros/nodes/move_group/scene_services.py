"""The planning scene by MoveIt's services and topics."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import numpy as np
from moveit_msgs.msg import AttachedCollisionObject, CollisionObject, PlanningScene, RobotState
from moveit_msgs.srv import ApplyPlanningScene, GetPlanningScene
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.event_handler import PublisherEventCallbacks
from rclpy.node import Node

from robomech_ros.errors import RobomechError
from robomech_ros.nodes.common.cooperative_wait import steady_timer
from robomech_ros.nodes.common.robot.robot_description import LATCHED
from robomech_ros.nodes.common.services import serve
from robomech_ros.nodes.middleware.drained_subscription import create_drained_subscription
from robomech_ros.nodes.middleware.queue_depth import DEPTH
from robomech_ros.nodes.middleware.throttled_log import ThrottledLog
from robomech_ros.nodes.move_group.scene_messages import (
    frames_of_scene,
    refuse_unserved,
    write_scene,
)
from robomech_ros.nodes.move_group.scenes import Scenes
from robomech_ros.nodes.move_group.settings import MoveGroupSettings
from robomech_ros.nodes.move_group.world import Poses, World
from robomech_ros.nodes.moveit.whole_robot import WholeRobot

_MONITORED = "monitored_planning_scene"
# Changes within this time (s) are published together.
_TOGETHER = 0.02
# Period of publication of a moving robot (s), and the least published move (rad or m).
_STATE_PERIOD, _MOVED = 0.1, 1e-4


class SceneServices:
    """Takes changes of the scene from clients, and publishes it.

    - ``scenes``: the scenes that follow the changes.
    """

    def __init__(
        self, node: Node, robot: WholeRobot, scenes: Scenes, settings: MoveGroupSettings
    ) -> None:
        self._robot, self._scenes, self._patience = robot, scenes, settings.state_timeout
        self._log = ThrottledLog(node.get_logger())
        # Changes are made in the order of arrival, even if one waits for a frame.
        order = MutuallyExclusiveCallbackGroup()
        serve(node, ApplyPlanningScene, "apply_planning_scene", self._apply, callback_group=order)
        others = ReentrantCallbackGroup()
        serve(node, GetPlanningScene, "get_planning_scene", self._get, callback_group=others)
        for kind, topic, take in (
            (PlanningScene, "planning_scene", self._take_scene),
            (CollisionObject, "collision_object", self._take_object),
            (AttachedCollisionObject, "attached_collision_object", self._take_attached),
        ):
            create_drained_subscription(node, kind, topic, take, DEPTH, callback_group=order)
        self._publisher = node.create_publisher(PlanningScene, _MONITORED, LATCHED)
        # States would replace the latched scene, so subscribers of it do not get them.
        silent = PublisherEventCallbacks(use_default_callbacks=False)
        self._states = node.create_publisher(PlanningScene, _MONITORED, 10, event_callbacks=silent)
        self._published: list[float] = []
        self._due = steady_timer(node, _TOGETHER, self._publish)
        steady_timer(node, _STATE_PERIOD, self._publish_state)

    async def _apply(self, request: Any, response: Any) -> Any:
        response.success = await self._take_scene(request.scene)
        return response

    async def _get(self, request: Any, response: Any) -> Any:
        response.scene = self._message(request.components.components)
        return response

    async def _take_object(self, message: Any) -> None:
        await self._change([message], [], f"collision object {message.id[:100]!r}")

    async def _take_attached(self, message: Any) -> None:
        what = f"attached collision object {message.object.id[:100]!r}"
        await self._change([], [message], what)

    async def _take_scene(self, scene: Any) -> bool:
        attached = scene.robot_state.attached_collision_objects
        return await self._change(scene.world.collision_objects, attached, "planning scene", scene)

    async def _change(
        self, objects: Sequence[Any], attached: Sequence[Any], what: str, scene: Any = None
    ) -> bool:
        """Make all changes or none; the log says why."""
        try:
            if scene is not None:
                refuse_unserved(scene)
            poses = await self._poses(frames_of_scene(objects, attached, self._scenes.world))
            changed = self._changed(objects, attached, scene, poses)
            self._scenes.adopt(changed, self._robot.known())
        except RobomechError as error:
            self._log.error(f"{what} refused, the scene stays as it is: {error}")
            return False
        if self._due.is_canceled():
            self._due.reset()
        return True

    def _changed(
        self, objects: Sequence[Any], attached: Sequence[Any], scene: Any, poses: Poses
    ) -> World:
        """Return the scene as it will be; in MoveIt's order."""
        world = self._scenes.world.copy(empty=scene is not None and not scene.is_diff)
        for one in attached:
            with _named(one.object):
                world.apply_attached(one, poses)
        if scene is not None:
            world.allow(scene.allowed_collision_matrix, self._scenes.ignored(self._robot.known()))
            world.colors |= {color.id: color for color in scene.object_colors}
        carried = [one.object.id for one in attached]
        for one in objects:
            with _named(one):
                world.apply_object(one, poses, carried)
            if one.subframe_names:
                self._log.warning(f"the subframes of {one.id[:100]!r} are ignored")
        return world

    async def _poses(self, frames: set[str]) -> dict[str, np.ndarray]:
        """Return the present poses (4, 4) of frames and links in the base (m)."""
        places = await self._robot.places(frames, self._patience)
        joints = dict.fromkeys(name for place in places.values() for name in place.joint_names)
        positions = await self._robot.with_needed({}, joints, self._patience)
        return {frame: place.pose(positions) for frame, place in places.items()}

    def _message(self, wanted: int = 0) -> PlanningScene:
        known = self._robot.known()
        scene = self._scenes.whole(known)
        ignored = {frozenset(pair) for pair in scene.ignored}
        state = self._robot.state(known)
        message = write_scene(self._scenes.world, state, scene.bodies, ignored, wanted)
        message.name, message.robot_model_name = "(robomech)", self._robot.model.description.name
        return message

    def _publish(self) -> None:
        self._due.cancel()
        self._publisher.publish(self._message())

    def _publish_state(self) -> None:
        """Publish the robot's state if it has moved and there is a subscriber."""
        if not self._states.get_subscription_count():
            return
        known = self._robot.known()
        now = list(known.values())
        before, self._published = self._published, now
        if len(now) == len(before) and np.allclose(now, before, rtol=0.0, atol=_MOVED):
            return
        state = RobotState(joint_state=self._robot.state(known), is_diff=True)
        self._states.publish(PlanningScene(is_diff=True, robot_state=state))


@contextmanager
def _named(message: Any) -> Iterator[None]:
    """Put the name of an object in front of an error about it."""
    try:
        yield
    except RobomechError as error:
        raise RobomechError(f"{message.id[:100]!r}: {error}") from error
