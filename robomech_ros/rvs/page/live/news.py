"""Lines on top of the panel about a robot that runs, and who looks at them."""

from __future__ import annotations

import html
import threading
from collections.abc import Sequence
from typing import Any

from robomech_ros.rvs.page.tables import STYLE, WARN
from robomech_ros.rvs.page.units import Units

__all__ = ["News", "Onlookers"]


class News:
    """The lines, which every browser sees; methods may be called from any thread.

    Parameters
    ----------
    gui : viser.GuiApi
        Of all browsers.
    units : Units
    lines : sequence of str
        Their names, from above; also attributes, as ``data-state``.
    """

    def __init__(self, gui: Any, units: Units, lines: Sequence[str]) -> None:
        self._html = units.html(gui, order=-0.2)
        self._speaking = threading.Lock()
        self._lines = dict.fromkeys(lines, "")

    def say(self, line: str, text: str, failed: bool = True) -> None:
        """Write a line; an empty text takes it away."""
        with self._speaking:
            row = f'<div style="{WARN if failed else ""}" data-{line}>{html.escape(text)}</div>'
            row = row if text else ""
            if self._lines[line] == row:
                return
            self._lines[line] = row
            rows = "".join(self._lines.values())
            self._html.content = f'<div style="{STYLE}" data-live>{rows}</div>' if rows else ""


class Onlookers:
    """The browsers that show the page, by their numbers."""

    def __init__(self) -> None:
        self._seen, self._clients = threading.Event(), set[int]()

    def came(self, number: int) -> None:
        """Count one more."""
        self._clients.add(number)
        self._seen.set()

    def left(self, number: int) -> None:
        """Count one less."""
        self._clients.discard(number)
        if not self._clients:
            self._seen.clear()

    def wait(self, seconds: float) -> bool:
        """Wait until somebody looks, at most so long; says whether somebody does."""
        return self._seen.wait(seconds)
