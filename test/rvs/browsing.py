"""Shared parts of tests in a real browser: skip conditions, and a browser that is closed."""

from contextlib import contextmanager

import pytest

pytest.importorskip("viser")

from chromium import Tab, chromium

__all__ = ["IN_CHROMIUM", "browser"]

IN_CHROMIUM = [
    pytest.mark.skipif(chromium() is None, reason="no Chromium: sudo apt-get install chromium"),
    pytest.mark.timeout(900),
]


@contextmanager
def browser(address, width=1280, height=760):
    """A browser that shows a page, point for point, and has nothing to complain of at the end."""
    tab = Tab(f"{address}{'&' if '?' in address else '?'}fixedDpr=1", width, height)
    try:
        yield tab
        # Viser sends to one browser and to all by two queues: its reset of all may overtake the
        # last value of a control, of which the page then says that the control is gone.
        errors = [one for one in tab.errors if "Tried to update non-existent" not in one]
        assert errors == [], errors
    finally:
        tab.close()
