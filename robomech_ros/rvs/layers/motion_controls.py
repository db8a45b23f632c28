"""The folder Motion of the browser that commands."""

from __future__ import annotations

import html
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

from robomech_ros.rvs.model.planning import JOG_DIRECTIONS
from robomech_ros.rvs.model.player import FASTEST, SLOWEST
from robomech_ros.rvs.page.folder import Folder
from robomech_ros.rvs.page.units import Units
from robomech_ros.trajectory import PROFILES

# Steps of the slider of the time (s), and of the speed; decimals that their fields have room for.
STEP, SPEED_STEP, DECIMALS = 0.01, 0.1, 2
START, GOAL = "Start here", "Goal here"
_STATUS = (
    '<div style="font-size:0.85em;padding:0 0.85em 0.4em" data-plan><div{style}>{text}</div></div>'
)
_WARNS = ' style="border-left:3px solid #d9480f;padding-left:0.6em"'


class MotionControls:
    """The controls of one browser.

    Parameters
    ----------
    client : viser.ClientHandle
        The browser.
    units : Units
    layer : MotionLayer
    curves : sequence of str
        Names of what can be drawn.
    """

    def __init__(self, client: Any, units: Units, layer: Any, curves: Sequence[str]) -> None:
        self._layer, self._gui = layer, client.gui
        self._folder = Folder(client.gui, units, "Motion", 40)
        with self._folder:
            self._add_planning()
            self._add_playing()
            self._add_looks(curves)
            with client.gui.add_folder("Trace", expand_by_default=False):
                for link in layer.traced:
                    box = client.gui.add_checkbox(link, layer.traced[link])
                    self._on(box, ("trace", link), partial(self._trace, link))
        self.load()

    def _on(self, handle: Any, kind: object, request: Callable[[Any], None]) -> None:
        """Have a request done with the value to which the page changes a control."""
        self._folder.listen(handle, lambda value: self._layer.ask(kind, partial(request, value)))

    def _button(self, label: str, request: Callable[[], None], hint: str | None = None) -> Any:
        return self._folder.button(label, lambda: self._layer.ask(label, request), hint)

    def _add_planning(self) -> None:
        gui, layer = self._gui, self._layer
        self._status = self._folder.text()
        for label, which in ((START, "start"), (GOAL, "goal")):
            hint = f"The present posture is the {which} of a plan"
            self._button(label, partial(layer.remember, which), hint)
        way = gui.add_dropdown("Way", JOG_DIRECTIONS, initial_value=layer.way)
        profile = gui.add_dropdown("Profile", tuple(PROFILES), initial_value=layer.profile)
        self._on(way, "way", lambda value: layer.choose_plan(value, layer.profile))
        self._on(profile, "profile", lambda value: layer.choose_plan(layer.way, value))

    def _add_playing(self) -> None:
        gui, layer = self._gui, self._layer
        self._time = gui.add_slider("Time", 0.0, 1.0, STEP, 0.0, hint="s")
        self._time.precision = DECIMALS
        self._on(self._time, "seek", layer.seek)
        self._play = self._button("Play", layer.play_or_pause)
        hint = "Times as fast as planned"
        speed = gui.add_slider("Speed", SLOWEST, FASTEST, SPEED_STEP, layer.player.speed, hint=hint)
        self._on(speed, "speed", layer.player.set_speed)
        loop = gui.add_checkbox("loop", layer.player.loop)
        self._on(loop, "loop", lambda value: setattr(layer.player, "loop", bool(value)))
        hint = "The robot itself goes where the ghost at the time is"
        along = gui.add_checkbox("arm goes along", layer.along, hint=hint)
        self._on(along, "along", lambda value: setattr(layer, "along", bool(value)))

    def _add_looks(self, curves: Sequence[str]) -> None:
        gui, layer = self._gui, self._layer
        drawn = gui.add_dropdown("Curves", tuple(curves), initial_value=layer.curves)
        self._on(drawn, "curves", layer.choose_curves)
        sweep = gui.add_checkbox("sweep of ghosts", layer.sweep)
        self._on(sweep, "sweep", self._sweep)
        self._button("Forget the plan", layer.forget)

    def _sweep(self, shown: object) -> None:
        self._layer.sweep = bool(shown)
        self._layer.choose_traces()

    def _trace(self, link: str, shown: object) -> None:
        self._layer.traced[link] = bool(shown)
        self._layer.choose_traces()

    def load(self) -> None:
        """Show another plan."""
        if self._folder.removed:
            return
        duration = self._layer.player.duration
        there = duration > 0.0
        self._time.disabled = self._play.disabled = not there
        self._time.max = max(duration, STEP)
        self.update()

    def update(self, *, keep_time: bool = False) -> None:
        """Show where the player is; the slider of the time is left where it is if it asked."""
        layer = self._layer
        if self._folder.removed:
            return
        if not keep_time and self._time.value != layer.player.time:
            self._time.value = layer.player.time
        label = "Pause" if layer.player.playing else "Play"
        if self._play.label != label:
            self._play.label = label
        style = _WARNS if layer.warns else ""
        self._status.content = _STATUS.format(style=style, text=html.escape(layer.status))

    def remove(self) -> None:
        """Take the controls from the browser."""
        self._folder.remove()
