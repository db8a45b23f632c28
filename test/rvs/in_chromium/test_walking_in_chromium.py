"""A walking machine in a real browser."""

import pytest
from browsing import IN_CHROMIUM, browser
from controls import button, field, press
from raw_client import wait_until

from robomech_ros.rvs import view

pytestmark = IN_CHROMIUM


@pytest.fixture(scope="module")
def shown():
    """A page of a hexapod, and a browser that shows it."""
    with view("phantomx", port=0) as page, browser(page.url) as tab:
        tab.wait_for("document.querySelector('[data-feet]')")
        tab.wait_for("__viserMutable.nodeRefFromName['/base/target']")
        yield page, tab


def test_a_hexapod_walks_on_the_page_with_its_feet_and_margin(shown):
    page, tab = shown
    walker = page._arm
    for node in ("feet", "support_polygon", "margin"):
        tab.wait_for(f"__viserMutable.nodeRefFromName['/base/{node}']")
    page._layers[0]._command("forward", 1, 0.08)
    press(tab, field("walk"))
    tab.wait_for("document.querySelector('[data-sentence]').innerText.startsWith('Walks on ')")
    tab.wait_for("__viserMutable.nodeRefFromName['/base/trail']")
    press(tab, field("walk"))
    wait_until(lambda: walker.stands and not page._layers[0].moves)
    tab.wait_for("document.querySelector('[data-sentence]').innerText.startsWith('Stands on 6')")
    press(tab, button("Clear trail"))
    tab.wait_for("!__viserMutable.nodeRefFromName['/base/trail']")


def test_a_pose_that_is_refused_names_leg_and_joint(shown):
    page, tab = shown
    page.set_joint(3, 0.3)
    tab.wait_for("document.querySelector('[data-sentence]').innerText.includes(\"of leg 'RM'\")")
    page.set_joint(3, 0.05)
    tab.wait_for("document.querySelector('[data-sentence]').innerText.startsWith('Stands on 6')")
