"""A hand in a real browser."""

import pytest
from browsing import IN_CHROMIUM, browser
from controls import field, press
from raw_client import wait_until

from robomech_ros.rvs import view

pytestmark = IN_CHROMIUM

TEXT = "document.querySelector('[data-grasp]').innerText"


@pytest.fixture(scope="module")
def shown():
    """A page of a hand, and a browser that shows it."""
    with view("three_fingered", port=0) as page, browser(page.url) as tab:
        tab.wait_for("document.querySelector('[data-grasp]')")
        tab.wait_for("__viserMutable.nodeRefFromName['/base/target']")
        yield page, tab


def test_a_hand_is_seen_with_its_object_cones_and_forces(shown):
    _, tab = shown
    for node in ("object", "cones", "force_linear", "load_linear"):
        tab.wait_for(f"__viserMutable.nodeRefFromName['/base/{node}']")
    tab.wait_for(f"{TEXT}.includes('force closed: every load is held')")
    tab.wait_for(f"{TEXT}.includes('1.296 N at most')")
    tab.wait_for(f"{TEXT}.includes('in the weakest direction')")
    tab.wait_for("document.querySelectorAll('[data-posture]').length === 8")


def test_what_is_switched_off_is_not_seen(shown):
    page, tab = shown
    cones = "__viserMutable.nodeRefFromName['/base/cones'].visible"
    tab.wait_for(cones)
    press(tab, field("cones"))
    wait_until(lambda: not page._layers[0].on["cones"])
    tab.wait_for(f"!{cones}")
    press(tab, field("cones"))
    wait_until(lambda: page._layers[0].on["cones"])
    tab.wait_for(cones)


def test_another_posture_is_taken_by_its_row(shown):
    page, tab = shown
    hand = page._arm
    press(tab, "document.querySelector('[data-posture=\"8\"]')")
    wait_until(lambda: hand.study.postures and hand.study.postures[7].is_here)
    tab.wait_for("document.querySelector('[data-posture=\"8\"]').innerText.includes('here')")


def test_a_finger_that_does_not_reach_is_said(shown):
    page, tab = shown
    hand = page._arm
    T = hand.tip
    T[0, 3] += 0.03
    page.drag(lambda: T)
    wait_until(lambda: hand.reached == (0,))
    tab.wait_for("document.querySelector('[data-sentence]').innerText.includes('finger_2_spread')")
    tab.wait_for(f"{TEXT}.includes('not held')")
    tab.wait_for("__viserMutable.nodeRefFromName['/base/separating_linear']")
