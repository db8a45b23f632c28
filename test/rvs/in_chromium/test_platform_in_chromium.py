"""A parallel robot in a real browser."""

import numpy as np
import pytest
from browsing import IN_CHROMIUM, browser
from controls import checkbox, field
from raw_client import wait_until

from robomech_ros.rvs import view

pytestmark = IN_CHROMIUM
TABLE = "document.querySelector('[data-platform]')"
OPEN = "[...document.querySelectorAll('label')].some(l => l.textContent === '{label}')"
WORKSPACE = (
    "[...document.querySelectorAll('div')].find(d => d.children.length <= 2 && "
    "d.textContent === 'Workspace')"
)
POSITIONS = "document.querySelector('[data-positions]')"


@pytest.fixture(scope="module")
def shown():
    """A page of a hexapod, and a browser that shows it."""
    with view("hexapod", port=0) as page, browser(page.url) as tab:
        tab.wait_for("document.querySelector('[data-postures]')")
        tab.wait_for("__viserMutable.nodeRefFromName['/base/target']")
        tab.wait_for(f"{TABLE}.innerText.includes('dexterity')")
        yield page, tab


def test_all_assembly_modes_are_listed_and_one_beyond_limits_is_refused(shown):
    page, tab = shown
    tab.wait_for("document.querySelectorAll('tr[data-posture]').length === 8")
    tab.wait_for("document.body.innerText.includes('these are all')")
    tab.wait_for("document.body.innerText.includes('7 of them beyond limits of joints')")
    home = page._arm.q
    tab.value("document.querySelectorAll('tr[data-posture]')[1].click()")
    tab.wait_for("document.querySelector('[data-notice]').innerText.includes('in its cone')")
    np.testing.assert_array_equal(page._arm.q, home)


def test_an_assembly_mode_is_taken_by_a_click():
    with view("planar_3rpr", port=0) as page, browser(page.url) as tab:
        tab.wait_for("document.querySelectorAll('tr[data-posture]').length === 4")
        # A row writes into this field, which comes after the table.
        tab.wait_for(field("Take posture"))
        drives, other = page._arm.values, page._arm.study.postures[1].q
        tab.value("document.querySelectorAll('tr[data-posture]')[1].click()")
        wait_until(lambda: np.allclose(page._arm.q, other))
        np.testing.assert_allclose(page._arm.values, drives)


def test_a_leg_that_ends_a_drag_is_red_until_the_gizmo_is_let_go(shown):
    page, tab = shown
    far = page._arm.tip
    far[:3, 3] += [0.25, 0.0, 0.2]
    page.drag(lambda: far)
    tab.wait_for("document.querySelector('[data-sentence]').innerText.includes('leg')")
    wait_until(lambda: page._stage._robot._marked)
    page.release()
    tab.wait_for("document.querySelector('[data-sentence]').innerText.includes('modes')")
    wait_until(lambda: not page._stage._robot._marked)


def test_positions_are_drawn_with_what_ends_them(shown):
    page, tab = shown
    tab.wait_for(WORKSPACE)
    tab.value(f"{WORKSPACE}.click()")
    tab.wait_for(checkbox("positions"))
    tab.value(f"{checkbox('positions')}.click()")
    tab.wait_for(f"{POSITIONS}.innerText.includes('too long')")
    tab.wait_for("__viserMutable.nodeRefFromName['/base/positions_0']")
    tab.value(f"{checkbox('positions')}.click()")
    tab.wait_for("!__viserMutable.nodeRefFromName['/base/positions_0']")
    assert page._arm.faulty_links == ()


def test_orientations_are_drawn_beside_positions(shown):
    page, tab = shown
    part, box = page._layers[1]._parts["orientations"], checkbox("orientations")
    tab.wait_for(WORKSPACE)
    tab.value(f"if (!{OPEN.format(label='orientations')}) {WORKSPACE}.click()")
    tab.wait_for(box)
    tab.value(f"{box}.click()")
    wait_until(lambda: part.reach is not None)
    tab.wait_for(f"{POSITIONS}.innerText.includes('It turns here by')")
    tab.wait_for("__viserMutable.nodeRefFromName['/base/orientations_0']")
    tab.value(f"{box}.click()")
    wait_until(lambda: not part.on)
    tab.wait_for("!__viserMutable.nodeRefFromName['/base/orientations_0']")
