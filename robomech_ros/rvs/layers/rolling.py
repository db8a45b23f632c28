"""A rolling robot that is driven on the page: command, wheels, limits, trail and way ahead."""

from __future__ import annotations

import threading
import time
from functools import partial
from typing import Any

from robomech_ros.errors import BadValueError
from robomech_ros.numerics.arrays import finite_number
from robomech_ros.rvs.model.kinds.rolling import AXES, PERIOD, SeenBase
from robomech_ros.rvs.page.audience import Controls
from robomech_ros.rvs.page.fact_table import fact_table
from robomech_ros.rvs.page.folder import Folder
from robomech_ros.rvs.page.layer import Place, Switch
from robomech_ros.rvs.page.path_nodes import PathNode
from robomech_ros.spatial.arrays import as_flag

__all__ = ["RollingLayer"]

ORDER = 3.5
# How often the base is drawn while it drives (s), and steps that are made up for at most.
TICK, MOST_STEPS = 0.05, 20
TRAIL, AHEAD = (31, 119, 180), (230, 120, 20)


class RollingLayer:
    """The layer.

    Parameters
    ----------
    place : Place
    """

    def __init__(self, place: Place) -> None:
        if not isinstance(place.moved, SeenBase):
            raise TypeError("the page shows no rolling robot")
        self._place, self._base = place, place.moved
        scene = place.server.scene
        self._trail = PathNode(scene, f"{place.base}/trail", TRAIL, place.seen.reach)
        self._ahead = PathNode(scene, f"{place.base}/way_ahead", AHEAD, place.seen.reach)
        self._shown = True
        # Whether it is to drive, and whether it moves, which it does until it has braked.
        self._drives, self._moves, self._closing = False, threading.Event(), threading.Event()
        self._stepped = 0.0
        self._folder: Folder | None = None
        self._table: Any = None
        place.offered["trail"] = Switch(lambda: self._shown, self._turn)
        self._thread = threading.Thread(target=self._run, name="drive", daemon=True)
        self._thread.start()

    def show(self) -> None:
        """Follow the robot."""
        base = self._base
        self._trail.show(base.trail if self._shown else base.trail[:0])
        self._ahead.show(base.way_ahead())
        if self._folder is not None and not self._folder.removed:
            self._table.content = fact_table("rolling", base.facts())

    def controls(self, client: Any) -> Controls:
        """Give a browser the folder "Drive"."""
        folder = self._folder = Folder(client.gui, "Drive", ORDER, expanded=True)
        with folder:
            for name, unit, k in AXES:
                most = float(self._base.most[k])
                if most > 0.0:
                    slider = client.gui.add_slider(
                        name, -most, most, 0.01, float(self._base.command[k]), hint=unit
                    )
                    folder.listen(slider, partial(self._command, name, k))
            hint = "Drives as commanded, within the limits; switched off, it brakes within them"
            folder.checkbox("drive", self._drives, self._switch, hint)
            folder.checkbox("trail", self._shown, self._show_trail)
            folder.button("Clear trail", self._clear)
            self._table = folder.text()
        self.show()
        return folder

    def close(self) -> None:
        """Stop driving."""
        self._closing.set()
        self._moves.set()
        self._thread.join()

    def _command(self, name: str, axis: int, value: Any) -> None:
        def commanded() -> None:
            given, most = finite_number(name, value, AXES[axis][1]), float(self._base.most[axis])
            if abs(given) > most:
                raise BadValueError(name, value, f"{-most:g} to {most:g} {AXES[axis][1]}")
            self._base.command[axis] = given
            self._base.preview()

        self._place.ask((self, name), commanded, name)

    def _switch(self, value: Any) -> None:
        def switched() -> None:
            self._drives = as_flag("drive", value)
            if self._drives and not self._moves.is_set():
                self._stepped = time.monotonic()
                self._moves.set()

        self._place.ask((self, "drive"), switched)

    def _show_trail(self, value: Any) -> None:
        self._place.ask((self, "trail"), lambda: self._turn(as_flag("trail", value)))

    def _turn(self, shown: bool) -> None:
        self._shown = shown
        if self._folder is not None:
            self._folder.mark("trail", shown)

    def _clear(self) -> None:
        self._place.ask((self, "clear"), self._base.forget)

    def _run(self) -> None:
        """Ask for steps, on the thread of the layer, while the base moves."""
        while True:
            self._moves.wait()
            if self._closing.wait(TICK):
                return
            self._place.ask((self, "step"), self._step)

    def _step(self) -> None:
        """Move on to now; where nobody looks any more, brake."""
        if not self._place.server.get_clients():
            self._drives = False
        now = time.monotonic()
        steps = int((now - self._stepped) / PERIOD)
        # What was missed for long is not made up for.
        self._stepped = now if steps > MOST_STEPS else self._stepped + steps * PERIOD
        self._base.drive(min(steps, MOST_STEPS), brake=not self._drives)
        if not self._drives and self._base.stands:
            self._moves.clear()
