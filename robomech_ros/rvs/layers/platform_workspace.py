"""How far the platform of a parallel robot gets with its orientation, and what ends it."""

from __future__ import annotations

import html
from typing import Any

import numpy as np

from robomech_ros.errors import BadValueError, RobomechError
from robomech_ros.parallel import Mechanism
from robomech_ros.rvs.model.platforms.reach import PlatformReach, platform_reach
from robomech_ros.rvs.page.audience import Controls
from robomech_ros.rvs.page.fact_table import SMALL
from robomech_ros.rvs.page.folder import Folder
from robomech_ros.rvs.page.layer import Place, Switch
from robomech_ros.rvs.serving.worker import Worker
from robomech_ros.spatial.arrays import as_flag

__all__ = ["PlatformWorkspaceLayer"]

ORDER = 20
LABEL = "positions"
OPACITY, WIDTH = 0.35, 0.006
_HINT = "Positions of the platform with its present orientation, in the colour of what ends them"
_SWATCH = (
    '<span style="display:inline-block;width:0.8em;height:0.8em;margin-right:0.5em;'
    'border-radius:2px;background:rgb{colour}"></span>'
)


class PlatformWorkspaceLayer:
    """The layer.

    Parameters
    ----------
    place : Place
    """

    def __init__(self, place: Place) -> None:
        self._place, self._worker = place, Worker()
        self._on, self._asked = False, np.empty(0)
        self._reach: PlatformReach | None = None
        self._reason = ""
        self._nodes: list[Any] = []
        self._folder: Folder | None = None
        self._text: Any = None
        place.offered[LABEL] = Switch(lambda: self._on, self._turn)

    def show(self) -> None:
        """Follow the robot, where it is wanted."""
        q = self._place.platform.q
        if self._on and not np.array_equal(q, self._asked):
            self._asked = q
            self._worker.submit("reach", lambda: self._find(q))
        if self._folder is not None and not self._folder.removed:
            self._text.content = self._written()

    def controls(self, client: Any) -> Controls:
        """Give a browser the folder "Workspace"."""
        folder = self._folder = Folder(client.gui, "Workspace", ORDER)
        with folder:
            folder.checkbox(LABEL, self._on, self._switch, _HINT)
            self._text = folder.text()
        self.show()
        return folder

    def close(self) -> None:
        """Stop what runs."""
        self._worker.close(wait=False)

    def _switch(self, value: Any) -> None:
        def switched() -> None:
            self._set(as_flag(LABEL, value))

        self._place.ask((self, "shown"), switched)

    def _turn(self, on: bool) -> None:
        self._set(on)
        if self._folder is not None:
            self._folder.mark(LABEL, on)

    def _set(self, on: bool) -> None:
        self._on = on
        if not on:
            self._reach, self._reason, self._asked = None, "", np.empty(0)
            self._draw()

    def _find(self, q: Any) -> None:
        """Find the boundary; on the thread of the layer."""
        reach: PlatformReach | None = None
        reason = ""
        robot = self._place.platform.robot
        try:
            if isinstance(robot, Mechanism):
                raise BadValueError("robot", robot.name, "one that is not of limbs of any kind")
            reach = platform_reach(robot, q)
        except RobomechError as error:
            reason = f"There is none: {error}."

        def known() -> None:
            if self._on:
                self._reach, self._reason = reach, reason
                self._draw()

        self._place.ask((self, "reach"), known)

    def _draw(self) -> None:
        for node in self._nodes:
            node.remove()
        self._nodes = []
        if self._reach is None:
            return
        scene, root = self._place.server.scene, f"{self._place.base}/positions"
        for number, (cause, part) in enumerate(self._reach.parts.items()):
            name, colour = f"{root}_{number}", self._reach.colours[cause]
            if self._reach.flat:
                width = WIDTH * self._place.seen.reach
                node = scene.add_line_segments(name, part, colour, thickness=width)
            else:
                node = scene.add_mesh_simple(
                    name,
                    part.reshape(-1, 3),
                    np.arange(3 * len(part)).reshape(-1, 3),
                    color=colour,
                    opacity=OPACITY,
                    flat_shading=True,
                    side="double",
                    cast_shadow=False,
                    receive_shadow=False,
                )
            self._nodes.append(node)

    def _written(self) -> str:
        """Write what the colours are, as HTML."""
        if not self._on:
            lines = ["Where the platform gets with its present orientation, and what ends it."]
        elif self._reason:
            lines = [html.escape(self._reason)]
        elif self._reach is None:
            lines = ["Looking how far the platform gets ..."]
        else:
            reach = self._reach
            lines = [
                f"From here {reach.least:.3f} to {reach.greatest:.3f} m, as far as the way there "
                "is straight. It ends at:"
            ]
            lines += [
                _SWATCH.format(colour=reach.colours[cause])
                + html.escape(f"{cause} ({100 * share:.0f} %)")
                for cause, share in reach.shares.items()
            ]
        rows = "".join(f"<div>{line}</div>" for line in lines)
        return f'<div style="{SMALL}" data-positions>{rows}</div>'
