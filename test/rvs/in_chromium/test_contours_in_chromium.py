"""Contours in a real browser: clicked, typed, told apart, for an arm and for any equations."""

import numpy as np
import pytest
from browsing import IN_CHROMIUM, browser
from controls import button, field, heading, press, settled, write
from raw_client import wait_until

from robomech_ros.kinematics import forward_kinematics
from robomech_ros.rvs import view, view_equations
from robomech_ros.rvs.model.curves.curve_drawing import BOTTOM, LEFT, SIDE, TOP

pytestmark = IN_CHROMIUM
PLOT = "document.querySelector('[data-plot]')"
# A general posture, so that no two curves touch.
Q = [0.3, -1.2, 1.5, -0.8, 0.9, 0.2]


@pytest.fixture(scope="module")
def shown():
    """A page of a UR5e in that posture, and a browser with the contours of its pose."""
    with view("ur5e", port=0) as page, browser(page.url) as tab:
        tab.wait_for("document.querySelector('[data-postures]')")
        page._ask("posture", lambda: page._arm.move_to(Q))
        wait_until(lambda: np.array_equal(page._arm.q, Q))
        press(tab, heading("Contours"))
        tab.wait_for(field("contours"))
        # Nothing is computed before it is asked for.
        assert layer(page)._target is None
        press(tab, field("contours"))
        tab.wait_for(f"{PLOT}.querySelector('[data-curve]')")
        yield page, tab


def layer(page):
    """The contours of a page."""
    return next(one for one in page._layers if type(one).__name__ == "ContoursLayer")


@pytest.fixture
def contours(shown):
    """The same, with the arm in that posture."""
    page, tab = shown
    page._ask("posture", lambda: page._arm.move_to(Q))
    wait_until(lambda: np.array_equal(page._arm.q, Q))
    target = forward_kinematics(page._arm.chain, Q)
    wait_until(lambda: np.allclose(layer(page)._target, target, atol=1e-6))
    # The ring is drawn last: what is seen are the curves of this pose.
    at = [LEFT + SIDE * (Q[3] + np.pi) / (2.0 * np.pi), BOTTOM - TOP * (Q[4] + np.pi) / (2 * np.pi)]
    ring = f"{PLOT}.querySelector('[data-mark=here]')"
    tab.wait_for(f"{ring}.getAttribute('cx') === '{at[0]:.2f}'")
    tab.wait_for(f"{ring}.getAttribute('cy') === '{at[1]:.2f}'")
    return page, tab


def steady_plane(tab):
    """Return the plane's position on the screen, once folders and the page have stopped moving."""
    script = f"""(() => {{
        {PLOT}.scrollIntoView({{block: 'center'}});
        const r = {PLOT}.querySelector('[data-plane]').getBoundingClientRect();
        return [r.left, r.bottom, r.width, r.height]; }})()"""
    return settled(tab, script)


def click_beside(tab, point, pixels=2.0):
    """Click so many pixels off a point of the plane, from -pi to pi in both directions."""
    left, bottom, width, height = steady_plane(tab)
    x, y = (np.array(point) + np.pi) / (2.0 * np.pi)
    off = pixels / np.sqrt(2.0)
    tab.click(left + x * width + off, bottom - y * height + off)


def sentence(tab, text):
    """Wait for what the page says."""
    tab.wait_for(f"document.body.innerText.includes({text!r})")


def off_pose(page):
    """How far the tip is from the pose of that posture."""
    return np.abs(page._arm.tip - forward_kinematics(page._arm.chain, Q)).max()


def test_a_click_two_pixels_off_a_crossing_is_refined(contours):
    page, tab = contours
    for number in (5, 2, 8):
        posture = page._arm.study.postures[number - 1]
        click_beside(tab, (posture.q[3:5] + np.pi) % (2.0 * np.pi) - np.pi)
        wait_until(lambda n=number: page._arm.study.postures[n - 1].is_here)
        assert np.abs((page._arm.q - posture.q + np.pi) % (2 * np.pi) - np.pi).max() < 1e-12
        assert off_pose(page) < 1e-12
        sentence(tab, "A posture: the other 18 equations leave")
        sentence(tab, "The curves cross at")
        tab.wait_for(f"Number({PLOT}.querySelector('[data-steps]').dataset.steps) >= 3")
        here = f"[...{PLOT}.querySelectorAll('[data-mark=root]')].length"
        tab.wait_for(f"{here} >= 1 && {PLOT}.querySelector('[data-mark=here]')")


def test_a_pair_is_typed(contours):
    page, tab = contours
    posture = page._arm.study.postures[3]
    first, second = (posture.q[3:5] + 0.01 + np.pi) % (2.0 * np.pi) - np.pi
    write(tab, "Estimate", f"{first:.4f}, {second:.4f}")
    wait_until(lambda: page._arm.study.postures[3].is_here)
    assert off_pose(page) < 1e-12
    write(tab, "Estimate", "here and there")
    sentence(tab, "two numbers, as 0.5, -1.2")
    assert off_pose(page) < 1e-12


def test_spurious_crossings_are_told_and_move_nothing(contours):
    page, tab = contours
    press(tab, button("Mark all crossings"))
    sentence(tab, "crossings: 8 postures (discs)")
    tab.wait_for(f"{PLOT}.querySelectorAll('[data-mark=root]').length === 8")
    tab.wait_for(f"{PLOT}.querySelectorAll('[data-mark=spurious]').length > 0")
    view = layer(page)._view
    wrong = [found for found in view._found if not found.is_root]
    before = page._arm.q
    # One that is far from all others: a click beside it leads there.
    points = np.array([found.point for found in view._found])
    apart = [np.sort(np.linalg.norm(points - one.point, axis=1))[1] for one in wrong]
    click_beside(tab, wrong[int(np.argmax(apart))].point)
    sentence(tab, "Spurious: the other 18 equations leave")
    assert np.array_equal(page._arm.q, before)


def test_other_curves_are_chosen_and_none_are_drawn_when_off(contours):
    page, tab = contours
    drawn = tab.value(f"{PLOT}.querySelector('[data-curve=\"1\"]').getAttribute('d')")
    press(tab, field("First curve"))
    option = (
        "[...document.querySelectorAll('[role=option]')].find(o => o.innerText === 'rows 1 2 5')"
    )
    press(tab, option)
    tab.wait_for(f"{PLOT}.querySelector('[data-curve=\"1\"]').getAttribute('d') !== {drawn!r}")
    sentence(tab, "rows 1 2 5 = 0")
    press(tab, field("contours"))
    tab.wait_for(f"!{PLOT}")
    wait_until(lambda: not layer(page)._on)
    page.home()
    wait_until(lambda: not np.array_equal(page._arm.q, Q))
    assert layer(page)._target is None
    press(tab, field("contours"))
    tab.wait_for(f"{PLOT}.querySelector('[data-curve]')")


def test_an_arm_with_other_joints_is_told_what_is_missing():
    with view("panda", port=0) as page, browser(page.url) as tab:
        press(tab, heading("Contours"))
        sentence(tab, "arms of six revolute joints; this one has 7 joints")


def test_any_two_equations():
    def circle_hyperbola_line(x, y):
        root = np.sqrt(2.0 + np.sqrt(3.0)) - np.sqrt(2.0 - np.sqrt(3.0))
        return [x**2 + y**2 - 4.0, x * y - 1.0, x - y - root]

    big, small = np.sqrt(2.0 + np.sqrt(3.0)), np.sqrt(2.0 - np.sqrt(3.0))
    bounds = [[-np.pi, np.pi], [-np.pi, np.pi]]
    with view_equations(circle_hyperbola_line, bounds, port=0) as page, browser(page.url) as tab:
        tab.wait_for(f"{PLOT}.querySelector('[data-curve]')")
        click_beside(tab, (big, small))
        sentence(tab, "A root: the other equation leaves")
        found = page._view._found[-1]
        np.testing.assert_allclose(found.point, [big, small], atol=1e-12)
        click_beside(tab, (small, big))
        sentence(tab, "Spurious: the other equation leaves")
        write(tab, "Estimate", "-0.6, -2.0")
        sentence(tab, f"x = {-small:.6f}, y = {-big:.6f}")
        tab.wait_for(f"{PLOT}.querySelectorAll('[data-mark=root]').length === 2")
