"""Twists in the scene: arrows of motions along, and of rotations about, a direction."""

from typing import Any

import numpy as np

from robomech_ros.rvs.model.arms.analysis import TwistArrows
from robomech_ros.rvs.model.ghosts import Rgb
from robomech_ros.rvs.page.node_space import NodeSpace

# Widths of arrows, in reaches of the robot.
SHAFT, HEAD, HEAD_LENGTH = 0.007, 0.02, 0.05


class TwistNodes:
    """The arrows of some twists, drawn as soon as there are any.

    - ``name``: name of the nodes, before the endings ``_linear`` and ``_angular``.
    """

    def __init__(self, space: NodeSpace, name: str) -> None:
        self._space, self._name = space, f"{space.base}/{name}"
        self._nodes: dict[str, Any] = {}

    def show(self, arrows: TwistArrows | None, colours: tuple[Rgb, Rgb]) -> None:
        """Show arrows, of the colours of motions and of rotations; or none."""
        for k, part in enumerate(TwistArrows._fields):
            ends = arrows[k] if arrows is not None else np.empty((0, 2, 3))
            node = self._nodes.get(part)
            if not len(ends):
                if node is not None:
                    node.visible = False
                continue
            if node is None:
                node = self._nodes[part] = self._add(part, colours[k])
            node.visible = True
            node.points = ends.astype(np.float32)
            node.colors = np.full((len(ends), 3), colours[k], dtype=np.uint8)

    def _add(self, part: str, colour: Rgb) -> Any:
        reach = self._space.reach
        return self._space.scene.add_arrows(
            f"{self._name}_{part}",
            np.zeros((1, 2, 3)),
            colour,
            shaft_radius=SHAFT * reach,
            head_radius=HEAD * reach,
            head_length=HEAD_LENGTH * reach,
        )
