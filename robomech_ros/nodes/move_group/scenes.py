"""The planning scene in the form for distance computations."""

from functools import partial
from itertools import combinations

import numpy as np
from rclpy.task import Future

from robomech_ros.collision import Clearance, PlanningScene
from robomech_ros.collision.planning import in_words
from robomech_ros.errors import RobomechError
from robomech_ros.nodes.common.cooperative_wait import Worker
from robomech_ros.nodes.common.robot.robot_description import RobotModel
from robomech_ros.nodes.move_group.world import SceneObject, World
from robomech_ros.nodes.moveit.whole_robot import Positions
from robomech_ros.robots import DisabledCollision, SerialChain


class Scenes:
    """One collision scene for each requested chain; all follow the world.

    - ``padding``: thickness that is added to every link (m).
    """

    def __init__(self, model: RobotModel, worker: Worker, padding: float) -> None:
        self._model, self._worker, self._padding = model, worker, padding
        #: The planning scene as clients have made it; each change replaces it by a new one.
        self.world = World(model.base_frame, model.description.links, model.link_of)
        self._followers: dict[tuple[str, str], _Follower] = {}
        self._remaking: Future | None = None
        self._configured()

    def adopt(self, world: World, positions: Positions) -> None:
        """Replace the world, unless the new one has an object that no scene can have.

        Raises RobomechError: a shape has no volume, or a link is to carry a plane.
        """
        self._configured().at(world, positions)
        self.world = world

    async def of(self, chain: SerialChain, positions: Positions) -> PlanningScene:
        """Return the scene of a chain, the other joints of the robot at positions (rad or m).

        It is good until the next await; longer work takes a copy.
        """
        follower = self._followers.get((chain.base, chain.tip))
        if follower is None or self._is_outdated(follower):
            follower = await self._worker.do(partial(self._made, chain))
        return follower.at(self.world, positions)

    def at_once(self, chain: SerialChain, positions: Positions) -> PlanningScene:
        """Return the same scene, but block until it is made.

        After a change of the SRDF the earlier scene serves until the worker has made a new one.
        """
        return self._present(chain).at(self.world, positions)

    def whole(self, positions: Positions) -> PlanningScene:
        """Return the scene of the configured chain, as `at_once` does."""
        return self._configured().at(self.world, positions)

    def ignored(self, positions: Positions) -> set[frozenset[str]]:
        """Return the pairs of bodies that are not checked."""
        return {frozenset(pair) for pair in self.whole(positions).ignored}

    def nearest(self, positions: Positions) -> Clearance | None:
        """Return the nearest pair of bodies at positions of all joints; None if nothing can touch.

        Positions are in rad or m; its points are in the base (m).
        """
        scene = self.whole(positions)
        found = scene.clearance([positions[name] for name in scene.chain.joint_names])
        return found if np.isfinite(found.distance) else None

    def contact(self, positions: Positions) -> str:
        """Say which bodies touch at positions (rad or m) of all joints; "" for none."""
        found = self.nearest(positions)
        if found is None or found.distance > 0.0:
            return ""
        return f"contact of {in_words(found.bodies, found.distance)}"

    @property
    def unchecked(self) -> str:
        """Name the unchecked links, with the reasons; "" if all links are checked."""
        return self.whole({}).unchecked_text

    def _configured(self) -> "_Follower":
        return self._present(self._model.chain)

    def _present(self, chain: SerialChain) -> "_Follower":
        follower = self._followers.get((chain.base, chain.tip))
        if follower is None:
            return self._made(chain)
        if self._is_outdated(follower) and (self._remaking is None or self._remaking.done()):
            self._remaking = self._worker.begin(partial(self._made, chain))
        return follower

    def _is_outdated(self, follower: "_Follower") -> bool:
        return follower.disabled != self._model.semantic.disabled_collisions

    def _made(self, chain: SerialChain) -> "_Follower":
        """Make the follower of a chain, unless earlier work has made it; this takes seconds."""
        follower = self._followers.get((chain.base, chain.tip))
        if follower is None or self._is_outdated(follower):
            semantic = self._model.semantic
            scene = PlanningScene(chain, srdf=semantic, padding=self._padding)
            empty = self.world.copy(empty=True)
            follower = _Follower(scene, empty, self._model, semantic.disabled_collisions)
            self._followers[chain.base, chain.tip] = follower
        return follower


class _Follower:
    """The scene of one chain, brought up to date when it is asked for."""

    def __init__(
        self,
        scene: PlanningScene,
        empty: World,
        model: RobotModel,
        disabled: tuple[DisabledCollision, ...],
    ) -> None:
        self.disabled, self._model = disabled, model
        self._bare, self._scene = scene, scene.copy()
        self._empty = self._world = empty
        self._others: dict[str, float] = {}

    def at(self, world: World, positions: Positions) -> PlanningScene:
        """Return the scene with the objects of the world, other joints at positions."""
        own = self._scene.chain.joint_names
        others = {name: value for name, value in positions.items() if name not in own}
        if any(self._others.get(name) != value for name, value in others.items()):
            self._scene.set_other_joints(others)
            self._others |= others
            if self._scene.chain.base not in self._model.fixed_frames:
                # The base of the chain has moved among the objects.
                self._start_anew()
        if world is not self._world:
            self._scene, self._world = self._followed(world), world
        return self._scene

    def _start_anew(self) -> None:
        self._scene, self._world = self._bare.copy(), self._empty
        self._scene.set_other_joints(self._others)

    def _followed(self, world: World) -> PlanningScene:
        """Return the scene with the changes since the last world."""
        if (world.allowed, world.defaults) != (self._world.allowed, self._world.defaults):
            # Earlier decisions are not withdrawn pair by pair.
            self._start_anew()
        scene, before = self._scene.copy(), self._world
        for name, one in before.objects.items():
            if world.objects.get(name) is not one:
                scene.remove(name)
        for name, one in world.objects.items():
            if before.objects.get(name) is not one:
                try:
                    self._add(scene, name, one)
                except RobomechError as error:
                    raise RobomechError(f"{name[:100]!r}: {error}") from error
        _decide(scene, world)
        return scene

    def _add(self, scene: PlanningScene, name: str, one: SceneObject) -> None:
        if not one.link:
            scene.add(name, one.shapes, one.pose, frame=self._model.chain.base)
            return
        scene.add(name, one.shapes)
        scene.attach(name, one.link, one.touch_links, pose=one.pose)


def _decide(scene: PlanningScene, world: World) -> None:
    """Apply what clients have decided about pairs of bodies."""
    if not world.allowed and not world.defaults:
        return
    ignored = {frozenset(pair) for pair in scene.ignored}
    for first, second in combinations(scene.bodies, 2):
        otherwise = frozenset((first, second)) in ignored
        may = world.may_touch(first, second, otherwise)
        if may and not otherwise:
            scene.allow(first, second, "allowed by a client")
        elif otherwise and not may:
            scene.forbid(first, second)
