"""The planning scene in the form that distances are computed from."""

from functools import partial
from itertools import combinations

import numpy as np

from robomech_ros.collision import Clearance, PlanningScene
from robomech_ros.collision.planning import in_words
from robomech_ros.nodes.common.cooperative_wait import Worker
from robomech_ros.nodes.common.robot_description import RobotModel
from robomech_ros.nodes.move_group.world import SceneObject, World
from robomech_ros.nodes.moveit.whole_robot import Positions
from robomech_ros.robots import SemanticDescription, SerialChain


class Scenes:
    """One scene for each chain that requests are about; all follow the world.

    Parameters
    ----------
    model : RobotModel
    worker : Worker
        Makes the scenes of further chains, which takes a moment.
    padding : float
        Thickness that is added to every link (m).

    Attributes
    ----------
    world : World
        What clients have made of the scene; a changed one replaces it.
    """

    def __init__(self, model: RobotModel, worker: Worker, padding: float) -> None:
        self._model, self._worker, self._padding = model, worker, padding
        self.world = World(model.base_frame, model.description.links, model.link_of)
        self._followers: dict[tuple[str, str], _Follower] = {}
        self._keep(model.chain, self._made(model.chain, model.semantic))

    async def of(self, chain: SerialChain, positions: Positions) -> PlanningScene:
        """Return the scene of a chain, the other joints of the robot at positions (rad or m).

        It is good until the next await; longer work takes a copy.
        """
        semantic = self._model.semantic
        follower = self._followers.get((chain.base, chain.tip))
        if follower is None or follower.semantic is not semantic:
            made = await self._worker.do(partial(self._made, chain, semantic))
            follower = self._keep(chain, made)
        return follower.at(self.world, positions)

    def whole(self, positions: Positions) -> PlanningScene:
        """Return the scene of the configured chain, as `of` does."""
        chain = self._model.chain
        return self._followers[chain.base, chain.tip].at(self.world, positions)

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
        """Say what of the robot is not checked; "" if all of it is."""
        scene, name = self.whole({}), self._model.description.name
        if not scene.has_geometry:
            return f"no collisions were checked: '{name}' has no collision geometry"
        faults = "; ".join(f"link '{link}': {why}" for link, why in scene.unchecked.items())
        return f"collisions of some links were not checked: {faults}" if faults else ""

    def _made(
        self, chain: SerialChain, semantic: SemanticDescription
    ) -> tuple[PlanningScene, SemanticDescription]:
        return PlanningScene(chain, srdf=semantic, padding=self._padding), semantic

    def _keep(
        self, chain: SerialChain, made: tuple[PlanningScene, SemanticDescription]
    ) -> "_Follower":
        empty = self.world.copy(empty=True)
        follower = self._followers[chain.base, chain.tip] = _Follower(*made, empty, self._model)
        return follower


class _Follower:
    """The scene of one chain, brought up to date when it is asked for."""

    def __init__(
        self, scene: PlanningScene, semantic: SemanticDescription, empty: World, model: RobotModel
    ) -> None:
        self.semantic, self._model = semantic, model
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
        if world is not self._world:
            self._follow(world)
        return self._scene

    def _follow(self, world: World) -> None:
        before = self._world
        if (world.allowed, world.defaults) != (before.allowed, before.defaults):
            # What was decided before is not to be taken back pair by pair.
            before, self._scene = self._empty, self._bare.copy()
            self._scene.set_other_joints(self._others)
        for name, one in before.objects.items():
            if world.objects.get(name) is not one:
                self._scene.remove(name)
        for name, one in world.objects.items():
            if before.objects.get(name) is not one:
                self._add(name, one)
        self._decide(world)
        self._world = world

    def _add(self, name: str, one: SceneObject) -> None:
        if not one.link:
            self._scene.add(name, one.shapes, one.pose, frame=self._model.chain.base)
            return
        self._scene.add(name, one.shapes)
        self._scene.attach(name, one.link, one.touch_links, pose=one.pose)

    def _decide(self, world: World) -> None:
        """Apply what clients have decided about pairs of bodies."""
        if not world.allowed and not world.defaults:
            return
        ignored = {frozenset(pair) for pair in self._scene.ignored}
        for first, second in combinations(self._scene.bodies, 2):
            otherwise = frozenset((first, second)) in ignored
            may = world.may_touch(first, second, otherwise)
            if may and not otherwise:
                self._scene.allow(first, second, "allowed by a client")
            elif otherwise and not may:
                self._scene.forbid(first, second)
