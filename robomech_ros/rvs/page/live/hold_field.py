"""The field that says, again and again, that a button is held."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any

from robomech_ros.errors import BadValueError


class HoldField:
    """A text field of one browser, which is not seen: a pad of buttons writes into it.

    Parameters
    ----------
    gui : viser.GuiApi
        Of the browser.
    hold : callable
        Goes on with what the text says; raises a BadValueError where it says nothing.
    let_go : callable
        Ends what is held.
    refuse : callable
        Says why something is refused.

    Attributes
    ----------
    handle : viser.GuiInputHandle
        Of the field.
    gone : bool
        Whether the browser commands no more; changed while nothing is held.
    """

    def __init__(
        self,
        gui: Any,
        hold: Callable[[str], None],
        let_go: Callable[[], None],
        refuse: Callable[[BadValueError], None],
    ) -> None:
        self._hold, self._let_go, self._refuse = hold, let_go, refuse
        self.gone, self._holding = False, threading.Lock()
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
            # What a browser said before it lost command may come after.
            if self.gone:
                return
            if not text.strip():
                self._let_go()
                return
            try:
                self._hold(text)
            except BadValueError as error:
                self._let_go()
                self._refuse(error)

    def end(self) -> None:
        """End what is held; the browser commands no more."""
        with self._holding:
            self.gone = True
            self._let_go()
