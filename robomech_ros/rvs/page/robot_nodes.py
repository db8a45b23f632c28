"""A robot in the scene: a node for each link, moved by its joints."""

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from viser._messages import SetOrientationMessage

from robomech_ros.robots.joint import rotation_from_z
from robomech_ros.rvs.model.bodies.solids import cylinder
from robomech_ros.rvs.model.bodies.visual_model import Colour, VisualModel
from robomech_ros.rvs.page.mesh_nodes import add_mesh
from robomech_ros.rvs.page.node_space import placed
from robomech_ros.typing import Array

ROOT = "/robot"
# Parts of the robot's reach: axes of frames, and axes of joints.
FRAME_LENGTH, FRAME_RADIUS = 0.09, 0.0035
AXIS_LENGTH, AXIS_RADIUS = 0.3, 0.0035
AXIS_COLOUR = (250, 200, 30)
# Opacity of bodies that hide what is inside them.
FADED = 0.3
# Colour of bodies that block a motion.
MARKED = (220, 40, 40)


class RobotNodes:
    """The nodes of a robot.

    - ``root``: name of the node above all links.
    - ``tint``: red, green, blue and alpha of all bodies, from 0 to 1; default their own colours.
    - ``node``: the node above all links, viser.FrameHandle.
    """

    def __init__(
        self, scene: Any, seen: VisualModel, root: str = ROOT, tint: Colour | None = None
    ) -> None:
        self._scene, self._seen, self._root, self._tint = scene, seen, root, tint
        self.node = scene.add_frame(root, show_axes=False)
        self._nodes: dict[str, Any] = {}
        self._axes: list[Any] = []
        self._paths: dict[str, str] = {}
        self._bodies: list[tuple[str, Any, tuple[int, ...]]] = []
        self._opacities: list[float | None] = []
        self._marked: frozenset[str] = frozenset()
        self._add_links(scene)
        self._add_bodies(scene)
        # Nodes of the moving joints, in order, and their last poses.
        self._moved = [self._nodes[joint.child] for joint in seen.moving]
        self._places = np.full((len(self._moved), 3), np.nan)
        self._turns = np.full((len(self._moved), 4), np.nan)

    def _add_links(self, scene: Any) -> None:
        tree, reach = self._seen.tree, self._seen.reach
        to_parent = {joint.child: joint for joint in tree.joints}
        moving = {joint.child: joint for joint in self._seen.moving}
        axis = cylinder(AXIS_RADIUS * reach, AXIS_LENGTH * reach)
        size = {"axes_length": FRAME_LENGTH * reach, "axes_radius": FRAME_RADIUS * reach}
        for number, (link, _) in enumerate(tree.link_poses().items()):
            joint = to_parent.get(link)
            above = self._root if joint is None else self._paths[joint.parent]
            # Names of links may contain what separates names of nodes.
            path = f"{above}/{number}_{link.replace('/', '_')}"
            pose = np.eye(4) if joint is None else joint.pose(joint.rest)
            node = scene.add_frame(path, show_axes=False, **size, **placed(pose))
            self._paths[link] = path
            self._nodes[link] = node
            if link in moving:
                look: dict[str, Any] = {"flat_shading": True, "visible": False}
                look |= placed(rotation_from_z(moving[link].axis))
                self._axes.append(add_mesh(scene, f"{path}/axis", axis, AXIS_COLOUR, **look))

    def _add_bodies(self, scene: Any) -> None:
        for number, body in enumerate(self._seen.bodies):
            *colour, alpha = self._tint or body.colour
            shade = tuple(round(255 * part) for part in colour)
            name = f"{self._paths[body.link]}/body_{number}"
            look: dict[str, Any] = {"flat_shading": True, "side": "double", **placed(body.pose)}
            node = add_mesh(scene, name, body.solid, shade, alpha, **look)
            self._bodies.append((body.link, node, shade))
            self._opacities.append(node.opacity)

    def mark(self, links: Iterable[str]) -> None:
        """Draw the bodies of these links red, and of no others."""
        marked = frozenset(links)
        for link, node, own in self._bodies:
            if (link in marked) != (link in self._marked):
                node.color = MARKED if link in marked else own
        self._marked = marked

    def fade(self, faded: bool) -> None:
        """Draw all bodies translucent, or as they are."""
        for (_, node, _), own in zip(self._bodies, self._opacities, strict=True):
            node.opacity = FADED if faded else own

    def move(self, positions: Mapping[str, float]) -> None:
        """Put the joints where they are (rad or m, by name); what stays is not sent again."""
        places, turns = self._seen.joint_poses(positions)
        turns = np.roll(turns, 1, axis=-1)
        moved = np.any(places != self._places, axis=1)
        turned = np.any(turns != self._turns, axis=1)
        self._places, self._turns = places, turns
        for k in np.flatnonzero(moved):
            self._moved[k].position = places[k]
        for k in np.flatnonzero(turned):
            self._turn(self._moved[k], turns[k])

    def _turn(self, node: Any, wxyz: Array) -> None:
        # As node.wxyz = wxyz, whose comparison with what was takes longer than all else here.
        node.wxyz[:] = wxyz
        self._scene._queue_scene_message(SetOrientationMessage(node.name, tuple(wxyz.tolist())))

    def path(self, link: str) -> str:
        """Return the name of the node of a link."""
        return self._paths[link]

    def show(self, shown: bool) -> None:
        """Show the robot, or not."""
        self.node.visible = shown

    def show_frames(self, shown: bool) -> None:
        """Show the frame of every link, or none."""
        for node in self._nodes.values():
            node.show_axes = shown

    def show_axes(self, shown: bool) -> None:
        """Show the axis of every joint that moves, or none."""
        for node in self._axes:
            node.visible = shown
