"""A walking machine: on which feet it stands, how safely, and in which gait it walks."""

from typing import Any

import numpy as np

from robomech_ros.rvs.model.walking.support import Support
from robomech_ros.rvs.model.walking.walker_view import WalkerView
from robomech_ros.rvs.page.folder import Folder
from robomech_ros.rvs.page.layer import Layer, LayerContext
from robomech_ros.rvs.page.node_space import NodeSpace
from robomech_ros.rvs.page.path_nodes import PathNode
from robomech_ros.rvs.page.switches import Switches

# Feet that stand, and feet in the air; the border; the way to the nearest edge, safe or not.
STANDS, LIFTED = (40, 160, 70), (150, 150, 150)
BORDER = (40, 160, 70)
SAFE, UNSAFE = (120, 60, 190), (220, 40, 40)
# Size of a foot, in the reach of the robot.
FOOT = 0.045
SHOWN = "support polygon"


class SupportNodes:
    """The nodes, over the ground."""

    def __init__(self, space: NodeSpace) -> None:
        self._scene, base, reach = space
        self._name, self._size = f"{base}/feet", FOOT * reach
        self._border = PathNode(space, "support_polygon", BORDER)
        self._edge_lines = {
            safe: PathNode(space, name, colour)
            for safe, name, colour in ((True, "margin", SAFE), (False, "no_margin", UNSAFE))
        }
        self._feet: Any = None

    def show(self, support: Support, safe: bool) -> None:
        """Draw on which feet it stands, and whether that is safe."""
        colours = np.where(support.contacts[:, None], STANDS, LIFTED).astype(np.uint8)
        points = support.feet.astype(np.float32)
        if self._feet is None:
            self._feet = self._scene.add_point_cloud(
                self._name,
                points,
                colours,
                point_size=self._size,
                point_shape="circle",
                precision="float32",
            )
        else:
            self._feet.points, self._feet.colors = points, colours
        self._border.show(support.border())
        path = support.shortest_path()
        for one, node in self._edge_lines.items():
            node.show(path if one == safe else path[:0])

    def hide(self) -> None:
        """Draw nothing."""
        if self._feet is not None:
            self._feet.remove()
            self._feet = None
        nothing = np.empty((0, 3))
        for node in (self._border, *self._edge_lines.values()):
            node.show(nothing)


class WalkingLayer(Layer):
    """The layer."""

    label, order, expanded = "Feet", 3.6, True

    def __init__(self, context: LayerContext) -> None:
        super().__init__(context)
        self._robot = context.robot_of(WalkerView)
        self._nodes = SupportNodes(context.space)
        self._switches = Switches(context, {SHOWN: SHOWN}, {SHOWN: True})
        self._gait: Any = None

    def show(self) -> None:
        """Follow the machine."""
        robot = self._robot
        if self._switches[SHOWN]:
            support = robot.support
            self._nodes.show(support, support.margin >= robot.bound)
        else:
            self._nodes.hide()
        if self.is_open:
            self._gait.value = robot.chosen_gait
        self.write("feet", robot.support_facts())

    def _fill(self, folder: Folder, gui: Any) -> None:
        hint = "In which it walks on as soon as it stands"
        gaits, chosen = self._robot.gaits, self._robot.chosen_gait
        self._gait = folder.dropdown("gait", gaits, chosen, self._robot.choose_gait, hint)
        hint = "Of the feet that stand, and the way from the mass centre to its nearest edge"
        self._switches.add_to(folder, SHOWN, hint)
        self._table = folder.text()
