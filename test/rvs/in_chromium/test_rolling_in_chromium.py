"""A rolling robot in a real browser."""

import pytest
from browsing import IN_CHROMIUM, browser
from controls import button, field, press
from raw_client import wait_until

from robomech_ros.rvs import view

pytestmark = IN_CHROMIUM


@pytest.fixture(scope="module")
def shown():
    """A page of a mecanum base, and a browser that shows it."""
    with view("mecanum", port=0) as page, browser(page.url) as tab:
        tab.wait_for("document.querySelector('[data-rolling]')")
        tab.wait_for("__viserMutable.nodeRefFromName['/base/target']")
        yield page, tab


def command(page, name, axis, value):
    """Move a slider."""
    layer = page._layers[0]
    layer.ask(name, layer._command, name, axis, value)


def test_a_base_drives_on_the_page_and_leaves_a_trail(shown):
    page, tab = shown
    base = page._arm
    command(page, "forward", 1, 0.4)
    tab.wait_for("__viserMutable.nodeRefFromName['/base/way_ahead']")
    press(tab, field("drive"))
    wait_until(lambda: len(base.trail.points) > 10)
    tab.wait_for("__viserMutable.nodeRefFromName['/base/trail']")
    press(tab, field("drive"))
    wait_until(lambda: base.stands)
    press(tab, button("Clear trail"))
    tab.wait_for("!__viserMutable.nodeRefFromName['/base/trail']")


def test_what_limits_a_command_is_said(shown):
    page, tab = shown
    command(page, "forward", 1, 0.8)
    command(page, "sideways", 2, 0.8)
    tab.wait_for("document.querySelector('[data-sentence]').innerText.includes('rear_left')")
