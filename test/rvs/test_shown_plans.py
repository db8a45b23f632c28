"""Plans that a page shows."""

import numpy as np
import pytest

pytest.importorskip("viser")

from raw_client import send_value, wait_until

from robomech_ros.errors import BadValueError
from robomech_ros.robots import load_description
from robomech_ros.rvs import Motion
from robomech_ros.rvs.layers.motions import MotionLayer


def motion(chain):
    """Two seconds of all joints."""
    times = np.linspace(0.0, 2.0, 41)
    return Motion(chain, times, chain.home() + 0.3 * np.sin(times)[:, None])


def test_a_page_shows_plans_of_its_own_arm_only(page):
    plan = motion(page._arm.chain)
    page.show_plan(plan, "pick")
    wait_until(lambda: page._plan.motion is plan and page._plan.name == "pick")
    other = load_description("scara").chain()
    with pytest.raises(BadValueError, match="joints of the motion"):
        page.show_plan(Motion(other, [0.0], [other.home()]))
    with pytest.raises(BadValueError, match="a Motion"):
        page.show_plan("plan")
    page.forget_plan()
    wait_until(lambda: page._plan.motion is None)


def motions(page):
    """The layer of plans."""
    return next(layer for layer in page._layers if isinstance(layer, MotionLayer))


@pytest.fixture
def layer(page):
    """The plans of the page."""
    return motions(page)


def press(commander, layer, name):
    """Press a button of the folder Motion as a page does."""
    send_value(commander, getattr(layer, name)._impl.uuid, True)


def test_a_plan_is_swept_drawn_and_sought(page, layer, commander):
    page.show_plan(motion(page._arm.chain), "from elsewhere")
    wait_until(lambda: "data-quantity" in layer._picture.content)
    assert layer._scene._sweep.node.visible and layer._scene._now.node.visible
    wait_until(lambda: "from elsewhere: 2.00 s" in layer._status.content)
    send_value(commander, layer._time._impl.uuid, 0.5)
    wait_until(lambda: layer.player.time == 0.5)
    wait_until(lambda: "left:25.000%" in layer._cursor.content)
    before = layer._scene._now.node.batched_positions.copy()
    for value in (np.nan, "later", [1.0], -3.0, 1e300):
        send_value(commander, layer._time._impl.uuid, value)
    wait_until(lambda: layer.player.time == 2.0)
    wait_until(lambda: not np.array_equal(layer._scene._now.node.batched_positions, before))
    page.forget_plan()
    wait_until(lambda: not layer._scene._now.node.visible and not layer._picture.content)


def test_a_plan_plays_at_its_speed_and_pauses(page, layer, commander):
    page.show_plan(motion(page._arm.chain))
    wait_until(lambda: layer.player.duration == 2.0)
    layer.player.loop = True
    press(commander, layer, "_play")
    wait_until(lambda: layer.player.playing and layer._play.label == "Pause")
    wait_until(lambda: layer.player.time > 0.1)
    press(commander, layer, "_play")
    wait_until(lambda: not layer.player.playing and layer._play.label == "Play")


def test_a_plan_from_here_to_there(page, layer, commander):
    arm, home = page._arm, page._arm.chain.home()
    page._ask("remember", lambda: layer.remember("start"))
    wait_until(lambda: "goal of a plan: not chosen" in layer._status.content)
    send_value(commander, page._panel._sliders[2]._impl.uuid, 1.0)
    wait_until(lambda: arm.q[2] == 1.0)
    page._ask("remember", lambda: layer.remember("goal"))
    wait_until(lambda: page._plan.motion is not None)
    np.testing.assert_allclose(page._plan.motion.q[0], home)
    np.testing.assert_allclose(page._plan.motion.q[-1], arm.q)
    page._ask("way", lambda: layer.choose_plan("line of the tip", "trapezoidal"))
    wait_until(lambda: "one of poly345" in layer._status.content and page._plan.motion is None)
    assert layer.warns
    page._ask("way", lambda: layer.choose_plan("by train", "poly345"))
    wait_until(lambda: "Refused: way is" in page._stage._notice.content)
    assert layer.path_kind == "line of the tip"


def test_the_arm_goes_along_if_wanted(page, layer, commander):
    plan = motion(page._arm.chain)
    page.show_plan(plan)
    wait_until(lambda: layer.player.duration == 2.0)
    layer.along = True
    page._ask("seek", lambda: layer.seek(1.0))
    wait_until(lambda: np.allclose(page._arm.q, plan.at(1.0)))


def test_another_robot_has_no_plan(page, layer, commander):
    page.show_plan(motion(page._arm.chain))
    wait_until(lambda: layer.player.duration == 2.0)
    other = load_description("scara")
    page.replace(other, other.chain())
    wait_until(lambda: page._arm.chain.n == 4)
    wait_until(lambda: page._plan.motion is None and motions(page) is not layer)
