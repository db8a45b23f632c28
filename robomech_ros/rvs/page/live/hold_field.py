"""The field that says, again and again, that a button is held."""

import threading
from collections.abc import Callable
from typing import Any

from robomech_ros.errors import BadValueError
from robomech_ros.rvs.model.running.jog import HoldHeartbeat, read_beat

# Parts of the greatest jogging speed.
SLOWEST, AT_FIRST = 0.05, 0.5


class HoldField:
    """A slider of the speed, and a hidden text field that a pad of buttons writes into.

    - ``joints``: number of joints with buttons.
    - ``hold``: called with a HoldHeartbeat and a fraction of the greatest jogging speed; raises a
      BadValueError if that motion is impossible.
    - ``let_go``: ends the press.
    - ``refuse``: shows why a press is refused.
    - ``handle``: handle of the field, viser.GuiInputHandle.
    - ``gone``: whether the browser no longer commands; changed only while nothing is held.
    """

    def __init__(
        self,
        gui: Any,
        joints: int,
        hold: Callable[[HoldHeartbeat, float], None],
        let_go: Callable[[], None],
        refuse: Callable[[BadValueError], None],
    ) -> None:
        self._joints, self._hold, self._let_go, self._refuse = joints, hold, let_go, refuse
        self.gone, self._holding = False, threading.Lock()
        hint = "Part of the greatest jogging speed, a parameter of the node"
        self._speed = gui.add_slider("speed", SLOWEST, 1.0, 0.05, AT_FIRST, hint=hint)
        self.handle = gui.add_text("jog", "")

        # On the server's own thread: no other request of the page may delay the end of a jog.
        @self.handle.on_update
        async def _(event: Any) -> None:
            if event.client is not None:
                self._take(self.handle.value)

    @property
    def identifier(self) -> str:
        """By which the page knows the field."""
        return str(self.handle._impl.uuid)

    def _take(self, text: str) -> None:
        """Go on with what is held, or end it, as the text says."""
        with self._holding:
            # Messages of a browser that lost command may arrive later.
            if self.gone:
                return
            if not text.strip():
                self._let_go()
                return
            try:
                beat, speed = read_beat(text, self._joints), self._speed.value
                if not SLOWEST <= speed <= 1.0:
                    raise BadValueError("speed", speed, f"{SLOWEST:g} to 1")
                self._hold(beat, speed)
            except BadValueError as error:
                self._let_go()
                self._refuse(error)

    def remove(self) -> None:
        """End what is held; the browser commands no more."""
        with self._holding:
            self.gone = True
            self._let_go()
