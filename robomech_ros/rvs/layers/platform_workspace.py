"""Range of a platform with its present orientation, and the limbs that end it."""

from __future__ import annotations

import html
from functools import partial
from typing import Any

import numpy as np

from robomech_ros.errors import RobomechError
from robomech_ros.rvs.model.bodies.solids import Solid
from robomech_ros.rvs.model.platforms.reach import PlatformReach, platform_reach
from robomech_ros.rvs.page.folder import Folder
from robomech_ros.rvs.page.layer import Layer, LayerContext
from robomech_ros.rvs.page.mesh_nodes import add_mesh
from robomech_ros.rvs.page.switches import Switches
from robomech_ros.rvs.page.tables import SMALL

# Switches, and their hints.
LABELS = {
    "positions": (
        "Positions of the platform with its present orientation, in the colour of what ends them"
    ),
    "orientations": "Turns of the platform at its present place, each drawn along its axis",
}
OPACITY, WIDTH = 0.35, 0.006
_SWATCH = (
    '<span style="display:inline-block;width:0.8em;height:0.8em;margin-right:0.5em;'
    'border-radius:2px;background:rgb{colour}"></span>'
)


class PlatformWorkspaceLayer(Layer):
    """The layer."""

    label, order = "Workspace", 20

    def __init__(self, context: LayerContext) -> None:
        super().__init__(context)
        self._parts = {label: _Part(label) for label in LABELS}
        self._on = dict.fromkeys(LABELS, False)
        self._switches = Switches(context, {label: label for label in LABELS}, self._on, self._set)

    def show(self) -> None:
        """Follow the robot, where it is wanted."""
        q = self._context.platform.q
        for part in self._parts.values():
            if part.on and not np.array_equal(q, part.asked):
                part.asked = q
                self.find(part.label, partial(self._found, part, q), partial(self._know, part))
        if self.is_open:
            self._table.content = self._written()

    def _fill(self, folder: Folder, gui: Any) -> None:
        for label, hint in LABELS.items():
            self._switches.add_to(folder, label, hint)
        self._table = folder.text()

    def _set(self, label: str, _: bool) -> None:
        part = self._parts[label]
        part.on = self._on[label]
        if not part.on:
            part.reach, part.asked = None, np.empty(0)
            self._draw(part)

    def _found(self, part: _Part, q: Any) -> PlatformReach | str:
        """Find the boundary, or say why there is none; on the thread of the layer."""
        try:
            return platform_reach(self._context.platform.robot, q, turns=part.turns)
        except RobomechError as error:
            return f"No {part.label}: {error}."

    def _know(self, part: _Part, found: PlatformReach | str) -> None:
        if part.on:
            part.reach = found
            self._draw(part)

    def _draw(self, part: _Part) -> None:
        for node in part.nodes:
            node.remove()
        part.nodes = []
        if not isinstance(part.reach, PlatformReach):
            return
        space = self._context.space
        for number, (cause, piece) in enumerate(part.reach.parts.items()):
            name, colour = f"{part.label}_{number}", part.reach.colours[cause]
            if part.reach.flat:
                node = space.add_lines(name, piece, colour, WIDTH)
            else:
                faces = np.arange(3 * len(piece)).reshape(-1, 3)
                look = {"flat_shading": True, "side": "double"}
                solid = Solid(piece.reshape(-1, 3), faces)
                path = f"{space.base}/{name}"
                node = add_mesh(space.scene, path, solid, colour, OPACITY, **look)
            part.nodes.append(node)

    def _written(self) -> str:
        lines = [line for part in self._parts.values() for line in part.lines()]
        if not lines:
            lines = ["How far the platform gets, or turns, from where it is, and what ends it."]
        rows = "".join(f"<div>{line}</div>" for line in lines)
        return f'<div style="{SMALL}" data-positions>{rows}</div>'


class _Part:
    """Shown workspace of positions, or of orientations.

    - ``on``: whether it is shown.
    - ``asked``: the posture for which it was asked last (rad or m); empty for none.
    - ``reach``: its boundary, or a sentence on why there is none; None until it is found.
    - ``nodes``: in the scene.
    """

    def __init__(self, label: str) -> None:
        self.label, self.turns = label, label == "orientations"
        self.on, self.asked = False, np.empty(0)
        self.reach: PlatformReach | str | None = None
        self.nodes: list[Any] = []

    def lines(self) -> list[str]:
        """Write what the colours are, as HTML, a line each."""
        if not self.on:
            return []
        reach = self.reach
        if isinstance(reach, str):
            return [html.escape(reach)]
        if reach is None:
            return [f"Looking for {self.label} ..."]
        says = (
            f"It gets {reach.least:.3f} to {reach.greatest:.3f} m from here, as far as the way "
            "there is straight. That ends at:"
        )
        if self.turns:
            says = (
                f"It turns here by {reach.least:.3f} to {reach.greatest:.3f} rad, as far as the "
                "axis stays. That ends at:"
            )
        ends = [
            _SWATCH.format(colour=reach.colours[cause])
            + html.escape(f"{cause} ({100 * share:.0f} %)")
            for cause, share in reach.shares.items()
        ]
        return [says, *ends]
