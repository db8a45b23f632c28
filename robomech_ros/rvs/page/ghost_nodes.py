"""Ghosts in the scene: one batch of cylinders for all postures, and their numbers."""

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

from robomech_ros.rvs.model.bodies.solids import cylinder
from robomech_ros.rvs.model.ghosts import GhostMaker, Rgb
from robomech_ros.rvs.model.postures import MOST_POSTURES
from robomech_ros.rvs.page.mesh_nodes import add_batch
from robomech_ros.rvs.page.node_space import NodeSpace
from robomech_ros.typing import Array

OPACITY = 0.45
# Numbers nearer to each other than this part of the reach are written as one.
TOGETHER = 0.05
# Mark after the number of a struck-out posture.
CROSS = "\N{MULTIPLICATION SIGN}"


class Ghost(NamedTuple):
    """One ghost."""

    #: Index of the posture, from 0; the page counts from 1.
    number: int
    #: Posture (rad or m), shape (n,).
    q: Array
    #: Red, green, blue, 0 to 255.
    colour: Rgb
    #: Whether its number is crossed out.
    struck: bool = False

    @property
    def text(self) -> str:
        """Its number, with a cross if it is struck out."""
        return f"{self.number + 1}{CROSS if self.struck else ''}"


class GhostBatch:
    """Ghosts with a common opacity.

    - ``name``: name of their node, at the base of the arm.
    - ``opacity``: opacity from 0 to 1.
    """

    def __init__(self, scene: Any, name: str, ghosts: GhostMaker, opacity: float) -> None:
        self._ghosts = ghosts
        look: dict[str, Any] = {"opacity": opacity, "flat_shading": True, "visible": False}
        scales = np.full((1, 3), 1e-6)
        self.node = add_batch(scene, name, cylinder(1.0, 1.0), batched_scales=scales, **look)

    def place(self, postures: Sequence[Array], colours: Sequence[Rgb]) -> None:
        """Put them into postures (n,) in rad or m, at least one, of these colours."""
        pieces = self._ghosts.placed(postures, colours)
        self.node.batched_positions = pieces.positions.astype(np.float32)
        self.node.batched_wxyzs = pieces.wxyz.astype(np.float32)
        self.node.batched_scales = pieces.scales.astype(np.float32)
        self.node.batched_colors = pieces.colours


class GhostNodes:
    """The ghosts of a robot."""

    def __init__(self, space: NodeSpace, ghosts: GhostMaker) -> None:
        scene, base, reach = space
        self._ghosts, self._together = ghosts, TOGETHER * reach
        self._shown: Sequence[Ghost] = ()
        self._wanted = True
        self._batch = GhostBatch(scene, f"{base}/ghosts", ghosts, OPACITY)
        self._labels = [
            scene.add_label(f"{base}/numbers/{k}", "", visible=False, anchor="center-center")
            for k in range(MOST_POSTURES)
        ]

    def on_click(self, taken: Callable[[Any, int], None]) -> None:
        """Call a function for a clicked ghost, with the client and the number."""

        @self._batch.node.on_click
        async def _(event: Any) -> None:
            ghosts = self._shown
            if event.instance_index is not None and self._ghosts.pieces:
                index = event.instance_index // self._ghosts.pieces
                if index < len(ghosts):
                    taken(event.client, ghosts[index].number)

    def show(self, ghosts: Sequence[Ghost]) -> None:
        """Show these ghosts, and no others."""
        self._shown = ghosts
        self._batch.node.visible = bool(ghosts) and self._wanted
        self._write_numbers()
        if ghosts:
            self._batch.place([one.q for one in ghosts], [one.colour for one in ghosts])

    def want(self, wanted: bool) -> None:
        """Show ghosts at all, or not."""
        self._wanted = wanted
        self.show(self._shown)

    def _write_numbers(self) -> None:
        texts: list[str] = []
        places: list[Array] = []
        if self._shown and self._wanted:
            at = self._ghosts.middles([one.q for one in self._shown])
            for one, place in zip(self._shown, at, strict=True):
                near = [
                    k for k, p in enumerate(places) if np.linalg.norm(p - place) < self._together
                ]
                if near:
                    texts[near[0]] += f", {one.text}"
                else:
                    texts.append(one.text)
                    places.append(place)
        for k, label in enumerate(self._labels):
            label.visible = k < len(texts)
            if k < len(texts):
                label.text, label.position = texts[k], places[k]
