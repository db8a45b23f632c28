"""The objects around a robot in the scene, and the line between the two nearest bodies."""

from collections.abc import Callable, Collection, Mapping
from typing import Any, NamedTuple

import numpy as np

from robomech_ros.collision import Clearance, SceneObject
from robomech_ros.rvs.model.bodies.object_solids import ObjectPart, middle_of, parts_of
from robomech_ros.rvs.model.bodies.solids import sphere
from robomech_ros.rvs.page.mesh_nodes import add_batch, add_mesh
from robomech_ros.rvs.page.node_space import NodeSpace, place_node, placed
from robomech_ros.rvs.page.robot_nodes import MARKED
from robomech_ros.typing import Array

# Colours of standing objects and of those that links carry; opacity of planes.
STANDING, CARRIED = (166, 148, 116), (128, 116, 176)
PLANE_ALPHA = 0.35
# Side of the square that stands for a plane, in reaches of the robot.
SIDE = 3.0
# The line between the nearest bodies; its width and its ends in reaches of the robot.
APART = (20, 140, 80)
WIDTH, END = 0.008, 0.012


class _DrawnObject(NamedTuple):
    """A drawn object: its shapes, its nodes, and whether it is marked."""

    one: SceneObject
    parts: tuple[ObjectPart, ...]
    frame: Any
    bodies: list[Any]
    marked: bool


class ObjectNodes:
    """The objects of a planning scene.

    - ``space``: at the base of the arm.
    - ``path_of``: returns the name of the node of a link.
    - ``clicked``: called with the browser (viser.ClientHandle) and the name of an object that it
      clicks on.
    """

    def __init__(
        self,
        space: NodeSpace,
        path_of: Callable[[str], str],
        clicked: Callable[[Any, str], None] | None = None,
    ) -> None:
        self._scene, self._base, reach = space
        self._path_of, self._clicked, self._side = path_of, clicked, SIDE * reach
        self._drawn: dict[str, _DrawnObject] = {}
        # Nodes get names of their own: those of objects may contain anything.
        self._count = 0

    def show(self, objects: Mapping[str, SceneObject], marked: Collection[str]) -> None:
        """Draw exactly these objects, the marked ones in red."""
        for name in [name for name in self._drawn if name not in objects]:
            self._drawn.pop(name).frame.remove()
        for name, one in objects.items():
            self._drawn[name] = self._updated(one, name in marked)

    def middle(self, one: SceneObject) -> Array:
        """Return the middle of an object in its own frame, shape (3,) (m)."""
        drawn = self._drawn.get(one.name)
        return middle_of(parts_of(one, self._side) if drawn is None else drawn.parts)

    def corners(self, poses: Mapping[str, Array], base: str) -> Array:
        """Return the vertices (k, 3) of all finite shapes in the root (m).

        - ``poses``: poses (4, 4) of the links in the root (m).
        - ``base``: the base of the arm.
        """
        points = [np.empty((0, 3))]
        for drawn in self._drawn.values():
            T = poses[drawn.one.link or base] @ drawn.one.pose
            points += [part.corners(T) for part in drawn.parts if not part.endless]
        return np.vstack(points)

    def _updated(self, one: SceneObject, marked: bool) -> _DrawnObject:
        before = self._drawn.get(one.name)
        if before is not None and before.one is one and before.marked == marked:
            return before
        known = before is not None and before.one.parts is one.parts
        parts = before.parts if before is not None and known else parts_of(one, self._side)
        if before is None or not _look_alike(before, one, parts):
            if before is not None:
                before.frame.remove()
            return self._added(one, parts, marked)
        if not np.array_equal(before.one.pose, one.pose):
            place_node(before.frame, one.pose)
        if before.marked != marked:
            for node in before.bodies:
                node.color = _colour(one, marked)
        return before._replace(one=one, parts=parts, marked=marked)

    def _added(self, one: SceneObject, parts: tuple[ObjectPart, ...], marked: bool) -> _DrawnObject:
        self._count += 1
        above = self._path_of(one.link) if one.link else self._base
        path = f"{above}/object_{self._count}"
        frame = self._scene.add_frame(path, show_axes=False, **placed(one.pose))
        bodies = []
        for number, part in enumerate(parts):
            look: dict[str, Any] = {"flat_shading": True, "side": "double", **placed(part.pose)}
            alpha = PLANE_ALPHA if part.endless else 1.0
            colour, name = _colour(one, marked), f"{path}/part_{number}"
            bodies.append(add_mesh(self._scene, name, part.solid, colour, alpha, **look))
            # Planes do not listen: they are under the mouse nearly everywhere.
            if not one.link and not part.endless:
                self._listen(bodies[-1], one.name)
        return _DrawnObject(one, parts, frame, bodies, marked)

    def _listen(self, node: Any, name: str) -> None:
        clicked = self._clicked
        if clicked is None:
            return

        @node.on_click
        async def _(event: Any) -> None:
            clicked(event.client, name)


def _colour(one: SceneObject, marked: bool) -> tuple[int, int, int]:
    if marked:
        return MARKED
    return CARRIED if one.link else STANDING


def _look_alike(before: _DrawnObject, one: SceneObject, parts: tuple[ObjectPart, ...]) -> bool:
    if before.one.link != one.link or len(before.parts) != len(parts):
        return False
    return all(mine.is_same(its) for mine, its in zip(before.parts, parts, strict=True))


class DistanceNodes:
    """A line between the two nearest bodies, with their distance."""

    def __init__(self, space: NodeSpace) -> None:
        scene, base, reach = space
        name, hidden = f"{base}/nearest", {"visible": False}
        self._line = space.add_lines("nearest/line", np.zeros((1, 2, 3)), APART, WIDTH)
        self._line.visible = False
        self._ends = add_batch(scene, f"{name}/ends", sphere(END * reach), 2, **hidden)
        self._label = scene.add_label(
            f"{name}/label", "", anchor="bottom-left", depth_test=False, **hidden
        )

    def show(self, found: Clearance | None) -> None:
        """Draw the line of a clearance, in red if in contact; hide it for None."""
        for node in (self._line, self._ends, self._label):
            node.visible = found is not None
        if found is None:
            return
        touches = found.distance <= 0.0
        colour = np.array(MARKED if touches else APART, dtype=np.uint8)
        self._line.points = found.points[None].astype(np.float32)
        self._line.colors = np.tile(colour, (1, 2, 1))
        self._ends.batched_positions = found.points.astype(np.float32)
        self._ends.batched_colors = np.tile(colour, (2, 1))
        depth = f"contact, {-found.distance:.3f} m deep" if touches else f"{found.distance:.3f} m"
        self._label.text, self._label.position = depth, found.points.mean(axis=0)
