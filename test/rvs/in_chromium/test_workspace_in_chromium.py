"""The folder "Workspace" in a real browser: the section and a point of a map clicked."""

import numpy as np
import pytest
from browsing import IN_CHROMIUM, browser
from controls import button, field, heading, press, settled
from raw_client import wait_until

from robomech_ros.rvs import view
from robomech_ros.rvs.model.workspace.section_drawing import section_points

pytestmark = IN_CHROMIUM
SECTION = "document.querySelector('[data-section]')"
ROWS = "document.querySelectorAll('tr[data-posture]')"


@pytest.fixture(scope="module")
def shown():
    """A page of a PUMA 560 with its section, and a browser that shows it."""
    with view("puma560", port=0) as page, browser(page.url) as tab:
        tab.wait_for("document.querySelector('[data-postures]')")
        press(tab, heading("Workspace"))
        tab.wait_for(field("boundary"))
        # Nothing is computed before it is asked for.
        assert not layer(page)._asked
        press(tab, field("boundary"))
        tab.wait_for(f"{SECTION}.querySelector('[data-count]')")
        yield page, tab


def layer(page):
    """The workspace of a page."""
    return next(one for one in page._layers if type(one).__name__ == "WorkspaceLayer")


def seen_at(tab, point):
    """Return the pixel of a point of the picture (in its own units), once the page is still."""
    x, y = point
    script = f"""(() => {{
        const s = {SECTION};
        s.scrollIntoView({{block: 'center'}});
        const p = new DOMPoint({x}, {y}).matrixTransform(s.getScreenCTM());
        return [p.x, p.y]; }})()"""
    return settled(tab, script)


def assert_listed(page, tab):
    """The table has the postures that the arm has there."""
    count = len(page._arm.study.postures)
    assert count > 0
    tab.wait_for(f"{ROWS}.length === {count}")


def test_a_click_in_the_section_lists_the_postures_there(shown):
    page, tab = shown
    section, R = layer(page)._view, page._arm.tip[:3, :3]
    wanted = np.array([0.5, 0.3])
    tab.click(*seen_at(tab, section_points(section, wanted).tolist()))
    # A pixel is about 6 mm.
    wait_until(lambda: np.abs(section.coordinates(page._arm.target) - wanted).max() < 0.02)
    wait_until(lambda: np.allclose(page._arm.tip, page._arm.target, atol=1e-9))
    np.testing.assert_allclose(page._arm.tip[:3, :3], R, atol=1e-9)
    assert_listed(page, tab)
    # The ring is there, and the curves of the section stand in the half-plane of the point.
    x, y = section_points(section, section.coordinates(page._arm.tip)).tolist()
    ring = f"getComputedStyle({SECTION}.querySelector('[data-workspace-here]')).transform"
    tab.wait_for(f"(m => Math.hypot(m.e - {x}, m.f - {y}) < 0.1)(new DOMMatrix({ring}))")
    tab.wait_for("__viserMutable.nodeRefFromName['/base/workspace_surface']")


def test_a_click_where_nothing_is_reached_says_why(shown):
    page, tab = shown
    section, q = layer(page)._view, page._arm.q
    far = np.array([0.85, 0.75])
    tab.click(*seen_at(tab, section_points(section, far).tolist()))
    wait_until(lambda: not page._arm.study.postures)
    tab.wait_for(f"{ROWS}.length === 0")
    tab.wait_for("document.querySelector('[data-sentence]').innerText.includes('reach')")
    np.testing.assert_array_equal(page._arm.q, q)


def test_a_point_of_a_map_is_clicked_in_the_scene(shown):
    page, tab = shown
    press(tab, field("reach map"))
    press(tab, button("Compute the map"))
    tab.wait_for("document.querySelector('[data-reach-map]')")
    node = "__viserMutable.nodeRefFromName['/base/reach_map']"
    tab.wait_for(node)
    press(tab, field("boundary"))
    tab.wait_for("!__viserMutable.nodeRefFromName['/base/workspace_surface']")
    press(tab, button("See all of it"))
    points = layer(page)._shown.points

    # The nearest point to the eye is hidden by none.
    def chosen():
        eye = next(iter(page._server.viser.get_clients().values())).camera.position
        return int(np.argmin(np.linalg.norm(points - eye, axis=1)))

    place = points[chosen()]
    x, y, z = place.tolist()
    script = f"""(() => {{
        const c = __viserMutable.camera, r = __viserMutable.canvas.getBoundingClientRect();
        const p = c.position.clone().set({x}, {y}, {z});
        {node}.localToWorld(p);
        p.project(c);
        return [r.left + (p.x + 1) * r.width / 2, r.top + (1 - p.y) * r.height / 2]; }})()"""
    tab.click(*settled(tab, script))
    wait_until(lambda: np.abs(page._arm.target[:3, 3] - place).max() < 1e-6)
    wait_until(lambda: bool(page._arm.study.sentence))
    count = len(page._arm.study.postures)
    tab.wait_for(f"{ROWS}.length === {count}")
