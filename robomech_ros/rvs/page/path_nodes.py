"""A way in the scene: a line that grows, or is drawn anew."""

from typing import Any

import numpy as np

from robomech_ros.rvs.model.ghosts import Rgb
from robomech_ros.rvs.page.node_space import NodeSpace
from robomech_ros.typing import Array

# Width of the line, in the reach of the robot.
WIDTH = 0.02


class PathNode:
    """A line through points, drawn as soon as there are two."""

    def __init__(self, space: NodeSpace, name: str, colour: Rgb) -> None:
        self._space, self._name, self._colour = space, name, colour
        self._node: Any = None
        self._shown: Array | None = None

    def show(self, points: Array) -> None:
        """Draw the line through points (m, 3) (m); none through fewer than two."""
        ends = np.stack([points[:-1], points[1:]], axis=1)
        if self._shown is not None and np.array_equal(ends, self._shown):
            return
        self._shown = ends
        if self._node is not None:
            self._node.remove()
            self._node = None
        if len(ends):
            self._node = self._space.add_lines(self._name, ends, self._colour, WIDTH)
