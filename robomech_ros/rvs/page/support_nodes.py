"""Feet on the ground, their support polygon, and how far it is to tipping."""

from __future__ import annotations

from typing import Any

import numpy as np

from robomech_ros.rvs.model.walking.support import Support
from robomech_ros.rvs.page.path_nodes import PathNode

# Feet that stand, and feet in the air; the border; the way to the nearest edge, safe or not.
STANDS, LIFTED = (40, 160, 70), (150, 150, 150)
BORDER = (40, 160, 70)
SAFE, UNSAFE = (120, 60, 190), (220, 40, 40)
# Size of a foot, in the reach of the robot.
FOOT = 0.045


class SupportNodes:
    """The nodes.

    Parameters
    ----------
    scene : viser.SceneApi
    base : str
        The node of the ground.
    reach : float
        Of the robot (m).
    """

    def __init__(self, scene: Any, base: str, reach: float) -> None:
        self._scene, self._name, self._size = scene, f"{base}/feet", FOOT * reach
        self._border = PathNode(scene, f"{base}/support_polygon", BORDER, reach)
        self._ways = {
            safe: PathNode(scene, f"{base}/{name}", colour, reach)
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
        way = support.shortest_path()
        for one, node in self._ways.items():
            node.show(way if one == safe else way[:0])

    def hide(self) -> None:
        """Draw nothing."""
        if self._feet is not None:
            self._feet.remove()
            self._feet = None
        nothing = np.empty((0, 3))
        for node in (self._border, *self._ways.values()):
            node.show(nothing)
