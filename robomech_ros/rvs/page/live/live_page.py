"""The page of a robot that runs: its messages, its button Stop, and the browsers that show it."""

import html
import threading
from collections.abc import Callable, Hashable, Sequence
from typing import Any

from robomech_ros.errors import BadValueError
from robomech_ros.rvs.page.clients import AllControls, Controls
from robomech_ros.rvs.page.layer import Layer, LayerContext
from robomech_ros.rvs.page.live.hold_field import HoldField
from robomech_ros.rvs.page.tables import STYLE, WARN


class LivePage(Layer):
    """Common part of the pages of all running robots.

    - ``robot``: the running robot; subclasses call its ``begin`` when they are constructed.
    - ``lines``: names of messages beside "state", "jog" and "result".
    """

    def __init__(
        self, context: LayerContext, robot: Any, lines: Sequence[str], stop_hint: str
    ) -> None:
        super().__init__(context)
        self._running = robot
        # The browser that commands, or did last.
        self._commander: int | None = None
        # Buttons that jog, of the browser that commands; none of a robot that cannot be jogged.
        self._pads: list[HoldField] = []
        self._viewer_present, self._clients = threading.Event(), set[int]()
        gui = context.server.gui
        # Messages on top of the panel, which every browser sees.
        self._messages = context.units.html(gui, order=-0.2)
        self._speaking = threading.Lock()
        self._lines = dict.fromkeys(("state", *lines, "jog", "result"), "")
        stop = gui.add_button("Stop", color="red", hint=stop_hint, order=-0.15)

        @stop.on_click
        async def _(_: Any) -> None:
            self._stop()

        context.server.on_client_connect(self._connected)
        context.server.on_client_disconnect(self._disconnected)

    def controls(self, client: Any) -> Controls:
        """Add the controls to the commanding browser."""
        self._commander = client.client_id
        return AllControls([super().controls(client), *self._pads])

    def close(self) -> None:
        """End what is jogged."""
        self._running.let_go()

    def refuse(self, error: BadValueError) -> None:
        """Say that something was refused."""
        self.show_result(f"Refused: {error}", failed=True)

    def ask(self, kind: Hashable, request: Callable[..., None], *arguments: Any) -> None:
        """Run a request on the thread of the page; every browser sees why it is refused."""

        def tried() -> None:
            try:
                request(*arguments)
            except BadValueError as error:
                self.refuse(error)

        super().ask(kind, tried)

    def _stop(self) -> None:
        self._running.stop()

    async def _connected(self, client: Any) -> None:
        self._clients.add(client.client_id)
        self._viewer_present.set()

    async def _disconnected(self, client: Any) -> None:
        self._clients.discard(client.client_id)
        if not self._clients:
            self._viewer_present.clear()
        if self._commander == client.client_id:
            self._running.let_go()

    # Calls of the robot, on any thread.

    def say(self, line: str, text: str, failed: bool = True) -> None:
        """Write a message, whose line is also an attribute; an empty text takes it away."""
        with self._speaking:
            row = f'<div style="{WARN if failed else ""}" data-{line}>{html.escape(text)}</div>'
            row = row if text else ""
            if self._lines[line] == row:
                return
            self._lines[line] = row
            rows = "".join(self._lines.values())
            self._messages.content = f'<div style="{STYLE}" data-live>{rows}</div>' if rows else ""

    def wait_for_viewer(self, seconds: float) -> bool:
        """Wait until somebody looks, but no longer; return whether somebody does."""
        return self._viewer_present.wait(seconds)

    def show_state(self, text: str) -> None:
        """Say what is wrong with the state of the robot; empty for nothing."""
        self.say("state", text)

    def show_result(self, text: str, *, failed: bool = False) -> None:
        """Say what came of a request."""
        self.say("result", text, failed)

    def show_jog(self, text: str) -> None:
        """Say why a jog has ended, or does not begin; empty for nothing."""
        self.say("jog", text)
