"""The world around an arm: objects that can be dragged, and the nearest pair of bodies."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from robomech_ros.rvs.model.running.live_robot import LiveRobot
from robomech_ros.rvs.page.clients import AllControls, Controls
from robomech_ros.rvs.page.folder import Folder
from robomech_ros.rvs.page.layer import Layer, LayerContext
from robomech_ros.rvs.page.node_space import place_node
from robomech_ros.rvs.page.panel import GIZMO
from robomech_ros.rvs.page.switches import Switches
from robomech_ros.rvs.page.tables import fact_table
from robomech_ros.spatial import pose_from_position_quaternion
from robomech_ros.spatial.arrays import as_choice
from robomech_ros.typing import Array

if TYPE_CHECKING:
    from robomech_ros.collision import PlanningScene
    from robomech_ros.rvs.model.world import WorldView
    from robomech_ros.rvs.page.object_nodes import DistanceNodes, ObjectNodes

# Label of the choice of what is dragged, and the choice of nothing.
DRAG, NOTHING = "drag", "nothing"
LABELS = {"objects": "objects", "nearest": "nearest pair"}
# Size of the gizmo of an object in reaches of the robot.
SIZE = 0.7 * GIZMO


class WorldLayer(Layer):
    """The objects of a planning scene, and the distance of the arm from them.

    - ``scene``: initial scene.
    - ``robot``: the running robot, which sends its scene and moves dragged objects.
    """

    label, order, expanded = "World", 3.8, True

    def __init__(
        self,
        context: LayerContext,
        scene: PlanningScene | None = None,
        robot: LiveRobot | None = None,
    ) -> None:
        super().__init__(context)
        self._robot = robot
        # Made with the first scene: before, the collision library is not loaded.
        self._nodes: tuple[ObjectNodes, DistanceNodes] | None = None
        self._on = dict.fromkeys(LABELS, True)
        self._switches = Switches(context, LABELS, self._on)
        # Posture of a running robot; what was drawn last; the version of the world for which
        # postures were listed; the object with the gizmo, and whether it is held.
        self._q: Array | None = None
        self._shown: object = None
        self._listed = -1
        self._dragged, self._held = NOTHING, False
        self._client: Any = None
        self._gizmo: Any = None
        self._choice: Any = None
        context.extents["world"] = self._extent
        context.followers.append(self._follow)
        if scene is not None:
            from robomech_ros.rvs.model.world import scene_for

            # Another robot of the same page keeps the objects where they were dragged.
            objects = context.saved_values.get("world", scene)
            self._take(scene_for(context.chain, scene, objects))
            self.show()
        if robot is not None:
            robot.follow_world(self)

    # Called by the page, on its thread.

    def show(self) -> None:
        """Follow the arm, or the running robot, and the objects."""
        world = self._context.arm.world
        if world is None:
            self._write("no planning scene has come yet")
        else:
            self._listed = world.version
            self._draw(world)

    def _draw(self, world: WorldView) -> None:
        assert self._nodes is not None
        objects, line = self._nodes
        q = self._context.arm.q if self._q is None else self._q
        now = (world, world.version, q.tobytes(), *self._on.values())
        if now != self._shown:
            self._shown = now
            objects.show(world.objects if self._on["objects"] else {}, world.touching(q))
            line.show(world.nearest(q) if self._on["nearest"] else None)
            self._write(world.nearest_text(q), world.scene.unchecked_text)
        self._show_gizmo(world, objects)

    def controls(self, client: Any) -> Controls:
        """Return the folder, and the gizmo of the chosen object, for the commanding browser."""
        self._dragged, self._held, self._shown = NOTHING, False, None
        self._client, size = client, SIZE * self._context.seen.reach
        self._gizmo = gizmo = client.scene.add_transform_controls(
            f"{self._context.base}/object", size, depth_test=False, visible=False
        )

        @gizmo.on_update
        async def _(event: Any) -> None:
            if event.phase == "start":
                self._held = True
            elif event.phase == "end":
                self._held = False
                # Unlike a request, this keeps the notice of a refused drag.
                self._context.run((self, "release"), self.show)
            elif self._held:
                wxyz, position = np.roll(gizmo.wxyz, -1), gizmo.position.copy()
                self.ask("drag", self._drag, position, wxyz)

        return AllControls([gizmo, super().controls(client)])

    def _fill(self, folder: Folder, gui: Any) -> None:
        self._table = folder.text()
        hint = "The object with the arrows; a click on an object chooses it, too"
        self._choice = folder.dropdown(DRAG, self._choices(), NOTHING, self._choose, hint)
        for name in LABELS:
            self._switches.add_to(folder, name)

    # Called by the controls, on the thread of the page.

    def _choose(self, name: Any) -> None:
        self._dragged = as_choice("object", name, self._choices())

    def _drag(self, position: Array, quaternion: Array) -> None:
        world = self._context.arm.world
        if world is None or self._nodes is None or self._dragged not in world.movable:
            return
        pose = pose_from_position_quaternion(position, quaternion)
        pose[:3, 3] -= pose[:3, :3] @ self._nodes[0].middle(world.objects[self._dragged])
        world.move(self._dragged, pose)
        if self._robot is not None:
            self._robot.move_object(self._dragged, pose)

    # Called by browsers and the running robot, on any thread.

    def _clicked(self, client: Any, name: str) -> None:
        def choose() -> None:
            # Only the commanding browser has a gizmo.
            if self.is_open and client.client_id == self._client.client_id:
                self._choose(name)
                self._choice.value = name

        self.ask("choose", choose)

    def show_scene(self, scene: PlanningScene) -> None:
        """Show another scene of the same arm; the page owns it from now on."""
        self.ask("scene", self._take, scene)

    def _follow(self, positions: Mapping[str, float]) -> None:
        self._context.run((self, "follow"), partial(self._follow_robot, dict(positions)))

    def _take(self, scene: PlanningScene) -> None:
        arm, context = self._context.arm, self._context
        if arm.world is None:
            from robomech_ros.rvs.model.world import WorldView
            from robomech_ros.rvs.page.object_nodes import DistanceNodes, ObjectNodes

            objects = ObjectNodes(context.space, context.path, self._clicked)
            self._nodes = objects, DistanceNodes(context.space)
            arm.world = WorldView(scene)
        else:
            held = self._dragged
            mine = self.is_open and self._held and held in arm.world.movable
            if mine and held in scene.objects:
                # The scene is older than the drag: keep the dragged pose.
                scene.move(held, arm.world.objects[held].pose)
            arm.world.replace(scene)
        if self._robot is None:
            context.saved_values["world"] = scene

    def _follow_robot(self, positions: Mapping[str, float]) -> None:
        arm, world = self._context.arm, self._context.arm.world
        self._q = np.array([positions[name] for name in arm.state_joints])
        if world is None:
            return
        before = world.version
        world.place_others(positions)
        if world.version == before != self._listed:
            # Joints outside the arm have moved: the contacts of the postures are outdated.
            self.ask("others", lambda: None)
        with self._context.server.atomic():
            self._draw(world)

    def _choices(self) -> tuple[str, ...]:
        world = self._context.arm.world
        return (NOTHING, *(world.movable if world is not None else ()))

    def _show_gizmo(self, world: WorldView, objects: ObjectNodes) -> None:
        if not self.is_open:
            return
        choices = self._choices()
        if self._choice.options != choices:
            self._choice.options = choices
        if self._dragged not in choices:
            self._dragged, self._held = NOTHING, False
        seen = self._dragged != NOTHING and self._on["objects"]
        self._gizmo.visible = seen
        if seen and not self._held:
            one = world.objects[self._dragged]
            pose = one.pose.copy()
            pose[:3, 3] += pose[:3, :3] @ objects.middle(one)
            place_node(self._gizmo, pose)

    def _write(self, nearest: str, unchecked: str = "") -> None:
        if self.is_open:
            facts = [("nearest", nearest), *([("note", unchecked)] if unchecked else [])]
            self._table.content = fact_table("world", facts)

    def _extent(self) -> Array:
        """Return points (k, 3) in the root around the objects (m)."""
        arm = self._context.arm
        if self._nodes is None:
            return np.empty((0, 3))
        return self._nodes[0].corners(self._context.seen.tree.link_poses(arm.positions), arm.base)
