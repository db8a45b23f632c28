"""Wake-up of the senders of a page, from any thread."""

from __future__ import annotations

import asyncio
from typing import Any


class WakeUp(asyncio.Event):
    """An event that is set on the thread of its loop alone.

    viser sets the event of its senders at once, on whatever thread has a message, and then has the
    loop set it.  A sender that begins to wait between the two finds it not set, and never hears of
    it: what is set already wakes nobody.  Here the first does nothing.

    Parameters
    ----------
    loop : asyncio.AbstractEventLoop
        Of the server.
    """

    def __init__(self, loop: asyncio.AbstractEventLoop) -> None:
        super().__init__()
        self._home = loop

    def set(self) -> None:
        """Wake who waits; elsewhere than on the loop nothing is done."""
        try:
            at_home = asyncio.get_running_loop() is self._home
        except RuntimeError:
            return
        if at_home:
            super().set()


def guard_wake_ups(server: Any) -> None:
    """Give the senders of a server (viser.ViserServer) such events, before a browser comes."""
    loop, websockets = server.get_event_loop(), server._websock_server

    def guard(sender: Any) -> None:
        sender.get_message_buffer().message_event = WakeUp(loop)

    guard(websockets)
    # Before the senders of a browser begin.
    websockets.on_client_connect(guard)
