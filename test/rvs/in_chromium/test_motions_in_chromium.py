"""Plans, recordings and the address of the page in a real browser, without a network."""

from pathlib import Path
from tempfile import TemporaryDirectory

import controls
import numpy as np
import pytest
from browsing import IN_CHROMIUM, browser
from raw_client import wait_until
from world_cases import SCENE

from robomech_ros.rvs import Motion, view
from robomech_ros.rvs.layers.motions import MotionLayer

pytestmark = IN_CHROMIUM
BUTTON = "[...document.querySelectorAll('button')].find(b => b.textContent === '{text}')"
CURSOR = "parseFloat(getComputedStyle(document.querySelector('[data-cursor]')).left)"
WIDTH = "document.querySelector('[data-quantity]').clientWidth"
# Where what was asked for came from.
ELSEWHERE = (
    "performance.getEntriesByType('resource').map(e => e.name)"
    ".filter(n => !n.startsWith(location.origin) && !/^(data|blob):/.test(n))"
)


@pytest.fixture(scope="module")
def shown():
    """A page of a UR5e among objects with a plan, and a browser that shows it."""
    downloads = TemporaryDirectory(prefix="robomech-downloads-", ignore_cleanup_errors=True)
    with view("ur5e", port=0, scene=SCENE) as page, downloads as folder, browser(page.url) as tab:
        tab.send("Browser.setDownloadBehavior", behavior="allow", downloadPath=folder)
        tab.wait_for("document.querySelector('[data-postures]')")
        arm = page._arm.chain
        times = np.linspace(0.0, 4.0, 81)
        q = arm.home() + 0.4 * np.sin(times)[:, None]
        page.show_plan(Motion(arm, times, q), "wave")
        tab.wait_for("document.querySelector('[data-cursor]')")
        yield page, tab, Path(folder)
        assert tab.value(ELSEWHERE) == []


def motions(page):
    """The layer of plans."""
    return next(layer for layer in page._layers if isinstance(layer, MotionLayer))


def opened(tab, folder, inside):
    """Open a folder of the panel, in which there is something."""
    tab.value(
        "[...document.querySelectorAll('.mantine-Paper-root')]"
        f".find(e => e.childElementCount === 1 && e.textContent === '{folder}').click()"
    )
    tab.wait_for(f"{inside}.getBoundingClientRect().height > 5")
    tab.frames(3)


def downloaded(folder, name):
    """Wait for a file that is whole."""
    wait_until(lambda: (folder / name).is_file() and (folder / name).stat().st_size > 0)
    wait_until(lambda: not list(folder.glob("*.crdownload")))
    return folder / name


def test_the_scrubber_moves_the_ghost_and_the_cursor(shown):
    page, tab, _ = shown
    layer = motions(page)
    thumb = controls.thumb("Time")
    opened(tab, "Motion", thumb)
    tab.wait_for(f"{thumb}.ariaValueMax == 4")
    at = "__viserMutable.nodeRefFromName['/base/plan/now']"
    tab.wait_for(at)
    before = layer._scene._now.node.batched_positions.copy()
    tab.value(f"{thumb}.focus()")
    for kind in ("keyDown", "keyUp"):
        tab.send(
            "Input.dispatchKeyEvent", type=kind, key="End", code="End", windowsVirtualKeyCode=35
        )
    wait_until(lambda: layer.player.time == 4.0)
    wait_until(lambda: not np.array_equal(layer._scene._now.node.batched_positions, before))
    tab.wait_for(f"Math.abs({CURSOR} - {WIDTH}) < 3")
    page._ask("seek", lambda: layer.seek(1.0))
    tab.wait_for(f"Math.abs({CURSOR} - 0.25 * {WIDTH}) < 3")


def test_play_moves_the_cursor_until_pause(shown):
    page, tab, _ = shown
    layer = motions(page)
    layer.player.loop = True
    tab.value(BUTTON.format(text="Play") + ".click()")
    tab.wait_for(BUTTON.format(text="Pause"))
    first = tab.value(CURSOR)
    tab.wait_for(f"Math.abs({CURSOR} - {first}) > 5")
    tab.value(BUTTON.format(text="Pause") + ".click()")
    wait_until(lambda: not layer.player.playing)
    tab.wait_for(BUTTON.format(text="Play"))


def test_a_plan_is_made_from_start_to_goal_and_played(shown):
    page, tab, _ = shown
    layer = motions(page)
    layer.player.loop = False
    start = page._arm.q.copy()
    tab.value(BUTTON.format(text="Start here") + ".click()")
    tab.wait_for("document.querySelector('[data-plan]').innerText.includes('goal')")
    number = controls.number("shoulder pan")
    tab.value(f"(() => {{ const f = {number}; f.select(); f.focus(); }})()")
    tab.send("Input.insertText", text="0.75")
    wait_until(lambda: page._arm.q[0] == 0.75)
    goal = page._arm.q.copy()
    tab.value(BUTTON.format(text="Goal here") + ".click()")
    # That of the test before is shown until this one is there.
    wait_until(lambda: page._plan.name == "plan" and layer._plan.motion is page._plan.motion)
    motion = layer._plan.motion
    np.testing.assert_allclose(motion.q[[0, -1]], [start, goal], atol=1e-9)
    thumb = controls.thumb("Time")
    tab.wait_for(f"Math.abs({thumb}.ariaValueMax - {motion.duration}) < 1e-6")
    tab.wait_for("__viserMutable.nodeRefFromName['/base/plan/now']")
    tab.value(BUTTON.format(text="Play") + ".click()")
    wait_until(lambda: layer.player.time == motion.duration and not layer.player.playing)
    tab.wait_for(f"Math.abs({CURSOR} - {WIDTH}) < 3")
    tab.wait_for(BUTTON.format(text="Play"))


def test_a_plan_and_a_picture_are_saved_and_the_plan_plays_from_its_file(shown):
    _, tab, folder = shown
    opened(tab, "Keep", BUTTON.format(text="Record"))
    tab.value(BUTTON.format(text="Save a picture") + ".click()")
    assert downloaded(folder, "view.png").read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"
    tab.value(BUTTON.format(text="Save the plan") + ".click()")
    path = downloaded(folder, "ur5e.html")
    with browser(path.as_uri(), 800, 500) as other:
        nodes = "Object.entries(__viserMutable.nodeRefFromName)"
        pan = f"{nodes}.find(([name]) => /shoulder_link$/.test(name))[1]"
        other.wait_for(pan)
        turned = f"Math.round(1e4 * {pan}.quaternion.w)"
        first = other.value(turned)
        other.wait_for(f"{turned} !== {first}")
        # The objects of the page are there, those that a link carries too.
        objects = "Object.keys(__viserMutable.nodeRefFromName).filter(n => /object_\\d$/.test(n))"
        assert len(other.value(objects)) == len(SCENE["world"]["collision_objects"]) + 1


def test_the_address_brings_the_view_back(shown):
    page, tab, _ = shown
    wanted = page._arm.chain.home() + 0.25
    page._ask("there", lambda: page._arm.move_to(wanted))
    page.show("frames", True)
    page.show("dark", True)
    wait_until(lambda: np.array_equal(page._arm.q, wanted) and page._switched()["dark"])
    number = f"{wanted[0]:.9f}".rstrip("0")
    tab.wait_for(f"location.href.includes('view=q:{number}') && location.href.includes('dark')")
    assert "token" not in tab.value("location.href")
    page.home()
    page.show("frames", False)
    tab.wait_for("!location.href.includes('frames')")
    address = tab.value("location.href")
    # As somebody would who was sent it.
    first = page._audience.commander
    shared = address.split("view=")[0] + f"view=q:{','.join(['0.5'] * 6)};eye:2,-1,1;at:0,0,0.2;"
    tab.open(shared + "show:ghosts,frames")
    wait_until(lambda: page._audience.commander not in (None, first))
    wait_until(lambda: np.allclose(page._arm.q, 0.5))
    wait_until(lambda: page._switched()["frames"] and not page._switched()["ground"])
    tab.wait_for("location.href.includes('eye:2,-1,1')")
    second = page._audience.commander
    tab.open(shared.replace("0.5", "99") + "show:ghosts")
    wait_until(lambda: page._audience.commander not in (None, second))
    tab.wait_for("document.querySelector('[data-notice]').innerText.includes('Refused: joint')")
    np.testing.assert_allclose(page._arm.q, 0.5)
    assert page._switched()["frames"]
