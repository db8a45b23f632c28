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
        assert tab.errors == [], tab.errors
    finally:
        tab.close()
