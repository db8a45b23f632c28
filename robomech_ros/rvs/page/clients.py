"""Viewers of a page: one browser commands, the others watch until they take over."""

from collections.abc import Callable, Sequence
from contextlib import ExitStack
from typing import Any, Protocol

_WATCHING = '<div data-watching style="font-size:0.85em;padding:0.2em 0.85em 0.6em">{text}</div>'
_OTHER = "Another browser commands this robot; here it is only seen."
_NOBODY = "No browser commands this robot."


class Controls(Protocol):
    """Additional controls of the commanding browser."""

    def remove(self) -> None:
        """Take it from the browser."""


class AllControls:
    """The controls of several parts of a page as one."""

    def __init__(self, parts: Sequence[Controls]) -> None:
        self._parts = parts

    def remove(self) -> None:
        """Take them from the browser, the others, too, where that fails with one."""
        with ExitStack() as removing:
            for part in reversed(self._parts):
                removing.callback(part.remove)


class PageClients:
    """The browsers of a page.

    Not for several threads at a time.

    - ``make_controls``: gives a browser (viser.ClientHandle) the controls.
    - ``taken_over``: called with the identifier of a browser that wants to command.
    """

    def __init__(
        self, make_controls: Callable[[Any], Controls], taken_over: Callable[[int], None]
    ) -> None:
        self._make_controls, self._taken_over = make_controls, taken_over
        self._clients: dict[int, Any] = {}
        self._watching: dict[int, tuple[Any, Any]] = {}
        self._controls: Controls | None = None
        self.commander: int | None = None

    def came(self, client: Any) -> None:
        """Welcome a browser: it commands if nobody does."""
        self._clients[client.client_id] = client
        if self.commander is None:
            self.give_command(client.client_id)
        else:
            self._let_watch(client)

    def left(self, number: int) -> bool:
        """Forget a browser; says whether it was the one that commanded."""
        self._clients.pop(number, None)
        self._watching.pop(number, None)
        if number != self.commander:
            return False
        self.commander = None
        self._notify_watchers(_NOBODY)
        # Its computations end, too.
        self.withdraw()
        return True

    def give_command(self, number: int) -> None:
        """Pass command to a browser; the previous one watches."""
        client = self._clients.get(number)
        if client is None or number == self.commander:
            return
        self.withdraw()
        if self.commander is not None:
            self._let_watch(self._clients[self.commander])
        for handle in self._watching.pop(number, ()):
            handle.remove()
        self._equip(client)

    def withdraw(self) -> None:
        """Take the controls from the browser that commands, until it gets new ones."""
        controls, self._controls = self._controls, None
        if controls is not None:
            controls.remove()

    def renew(self) -> None:
        """Renew the controls of the commanding browser."""
        self.withdraw()
        if self.commander is not None:
            self._equip(self._clients[self.commander])

    def _equip(self, client: Any) -> None:
        """Pass command to a browser, or to none if its controls cannot be made."""
        try:
            self._controls = self._make_controls(client)
        except Exception:
            self.commander = None
            # Nobody may command by those that were made before it failed.
            client.gui.reset()
            client.scene.reset()
            self._let_watch(client)
            self._notify_watchers(_NOBODY)
            raise
        self.commander = client.client_id
        self._notify_watchers(_OTHER)

    def _notify_watchers(self, sentence: str) -> None:
        for text, _ in self._watching.values():
            text.content = _WATCHING.format(text=sentence)

    def _let_watch(self, client: Any) -> None:
        text = client.gui.add_html(_WATCHING.format(text=_OTHER), order=-1)
        button = client.gui.add_button("Take command", order=-0.5)
        number = client.client_id

        @button.on_click
        async def _(_: Any) -> None:
            self._taken_over(number)

        self._watching[number] = (text, button)
