"""The page in a real browser: headless, drawn in software, without a network."""

import controls
import numpy as np
import pytest
from browsing import IN_CHROMIUM, browser
from gizmo_mouse import GizmoMouse
from raw_client import wait_until

from robomech_ros.robots import load_description
from robomech_ros.rvs import Choice, Motion, NamedPosture, view, write_motion

pytestmark = IN_CHROMIUM
GIZMO = "/base/target"
NODE = f"__viserMutable.nodeRefFromName['{GIZMO}']"


@pytest.fixture(scope="module")
def shown():
    """A page of a UR5e, and a browser that shows it."""
    with view("ur5e", port=0) as page, browser(page.url) as tab:
        tab.wait_for("document.querySelector('[data-postures]')")
        tab.wait_for(NODE)
        tab.frames(5)
        yield page, tab


@pytest.fixture
def at_home(shown):
    """The same, with the arm at home."""
    page, tab = shown
    page.home()
    home = page._arm.chain.home()
    wait_until(lambda: np.array_equal(page._arm.q, home) and page._arm.study.postures)
    tab.wait_for("document.querySelectorAll('[data-posture]').length === 8")
    return page, tab


def test_the_address_keeps_no_token(shown):
    _, tab = shown
    assert "token" not in tab.value("location.href")
    assert tab.value("document.cookie") == ""


def test_a_row_takes_its_posture(at_home):
    page, tab = at_home
    for number in (5, 1, 5):
        tab.value(f"document.querySelector('[data-posture=\"{number}\"] td').click()")
        wait_until(lambda n=number: page._arm.study.postures[n - 1].is_here)
        tab.wait_for(
            f"document.querySelector('[data-posture=\"{number}\"]').innerText.includes('here')"
        )


def test_a_number_typed_into_a_slider_moves_the_joint(at_home):
    page, tab = at_home
    field = controls.number("elbow")
    # The field may still be about to show where the arm came from.
    tab.wait_for(f"Math.abs({field}.value - {page._arm.q[2]}) < 1e-3")
    tab.value(f"{field}.focus()")
    tab.wait_for(f"document.activeElement === {field}")
    tab.value(f"{field}.select()")
    tab.send("Input.insertText", text="1.25")
    wait_until(lambda: page._arm.q[2] == 1.25)
    # A field that is left later, with another value behind it, says its own again.
    tab.value("document.activeElement.blur()")
    tab.frames(5)


def test_a_slider_moves_by_its_arrow_keys_and_stays_inside(at_home):
    page, tab = at_home
    thumb = controls.thumb("shoulder pan")
    tab.wait_for(f"Math.abs({thumb}.ariaValueNow - {page._arm.q[0]}) < 1e-6")
    tab.value(f"{thumb}.focus()")
    tab.wait_for(f"document.activeElement === {thumb}")
    before = page._arm.q[0]
    for step in (1, 2, 3):
        press(tab, "ArrowRight", 39)
        wait_until(lambda k=step: abs(page._arm.q[0] - before - 0.001 * k) < 1e-6)
        # The next step counts from what the slider has drawn.
        tab.wait_for(f"Math.abs({thumb}.ariaValueNow - {page._arm.q[0]}) < 1e-6")
    press(tab, "End", 35)
    wait_until(lambda: page._arm.q[0] > 6.28)
    assert page._arm.q[0] <= page._arm.chain.upper[0]


def press(tab, key, code):
    """Press a key and let it go."""
    for kind in ("keyDown", "keyUp"):
        tab.send("Input.dispatchKeyEvent", type=kind, key=key, code=key, windowsVirtualKeyCode=code)


def mouse(page, tab):
    """The mouse of the browser, at the gizmo of the tip."""
    return GizmoMouse(tab, GIZMO, 0.17, lambda: page._panel._held)


def test_the_arm_follows_the_gizmo(at_home):
    page, tab = at_home
    tip = page._arm.tip
    x, y = mouse(page, tab).drag(6, (-25, 20))
    wait_until(lambda: np.abs(page._arm.tip - tip).max() > 0.005)
    mouse(page, tab).release(x, y)
    wait_until(lambda: page._arm.study.postures)
    # The last step of the way may still be under way: both are asked until they agree.
    wait_until(lambda: np.allclose(gizmo_place(tab), page._arm.tip[:3, 3], atol=1e-4))


def gizmo_place(tab):
    """Return the gizmo's position in the base (m); its own position stays while it is dragged."""
    script = f"""(() => {{
        const base = __viserMutable.nodeRefFromName['/base'], o = {NODE};
        base.updateWorldMatrix(true, false); o.updateWorldMatrix(true, false);
        const p = o.position.clone().setFromMatrixPosition(o.matrixWorld);
        return p.applyMatrix4(base.matrixWorld.clone().invert()).toArray(); }})()"""
    return np.array(tab.value(script))


def test_out_of_reach_the_reason_is_shown_and_the_gizmo_snaps_back(at_home):
    page, tab = at_home
    tip = page._arm.tip
    x, y = mouse(page, tab).drag(12, (300, -330))
    wait_until(lambda: page._arm.study.nearest is not None)
    tab.wait_for("document.querySelector('[data-sentence]').innerText.startsWith('No posture: ')")
    tab.wait_for("document.body.innerText.includes('The nearest posture, in grey, misses it by')")
    assert not np.allclose(gizmo_place(tab), tip[:3, 3], atol=1e-2)
    ghosts = page._stage.ghosts._shown
    assert len(ghosts) == 1 and len(set(ghosts[0].colour)) == 1
    mouse(page, tab).release(x, y)
    wait_until(lambda: page._arm.study.postures)
    wait_until(lambda: np.allclose(gizmo_place(tab), page._arm.tip[:3, 3], atol=1e-4))


def test_a_ghost_is_taken_by_a_click(at_home):
    page, tab = at_home
    # The middle of a long bar of the ghosts, where no other posture and nothing of the robot is.
    places = ghost_places(page)
    for x, y in (seen(tab, place) for place in places):
        before = page._arm.q
        tab.click(x, y)
        try:
            wait_until(lambda q=before: not np.array_equal(page._arm.q, q), patience=3.0)
        except AssertionError:
            continue
        assert sum(posture.is_here for posture in page._arm.study.postures) == 1
        return
    pytest.fail("no ghost could be clicked")


def ghost_places(page):
    """Points inside bars of ghosts, in the base (m)."""
    nodes = page._stage.ghosts
    pieces = nodes._ghosts.placed(
        [one.q for one in nodes._shown], [one.colour for one in nodes._shown]
    )
    long = np.argsort(-pieces.scales[:, 2])[:14]
    return pieces.positions[long]


def seen(tab, place):
    """Return the pixel of a point in the base."""
    script = f"""(() => {{
        const v = __viserMutable, o = v.nodeRefFromName['/base'], c = v.camera;
        o.updateWorldMatrix(true, false); c.updateMatrixWorld();
        const p = o.position.clone().set(...{list(map(float, place))});
        p.applyMatrix4(o.matrixWorld).project(c);
        const r = v.canvas.getBoundingClientRect();
        return [r.left + (p.x + 1) / 2 * r.width, r.top + (1 - p.y) / 2 * r.height]; }})()"""
    return tab.value(script)


def test_a_second_browser_watches_and_takes_over(shown):
    page, tab = shown
    with browser(page.url, 1000, 600) as other:
        other.wait_for("document.querySelector('[data-watching]')")
        assert not other.value(f"Boolean({NODE})")
        button = (
            "[...document.querySelectorAll('button')].find(b => b.innerText === 'Take command')"
        )
        other.value(f"{button}.click()")
        other.wait_for(NODE)
        tab.wait_for("document.querySelector('[data-watching]')")
    wait_until(lambda: page._audience.commander is None)
    tab.value(f"{button}.click()")
    tab.wait_for(NODE)


def test_a_motion_plays_from_a_file(tmp_path):
    robot = load_description("puma560")
    arm = robot.chain()
    times = np.linspace(0.0, 2.0, 21)
    q = arm.home() + 0.4 * np.sin(times)[:, None]
    other = NamedPosture("elbow-up", arm.home() + 0.5)
    choices = (Choice(0.0, "pick", "elbow-down", (other,)),)
    path = write_motion(tmp_path / "motion.html", robot, Motion(arm, times, q, choices))
    with browser(path.as_uri(), 800, 500) as tab:
        nodes = "Object.entries(__viserMutable.nodeRefFromName)"
        waist = f"{nodes}.find(([name]) => /\\/\\d+_waist_frame$|\\/1_[^/]*$/.test(name))[1]"
        tab.wait_for(waist)
        tab.wait_for("document.querySelector('[data-legend]').innerText.includes('elbow-up')")
        turned = f"Math.round(1e4 * {waist}.quaternion.w)"
        first = tab.value(turned)
        tab.wait_for(f"{turned} !== {first}")
