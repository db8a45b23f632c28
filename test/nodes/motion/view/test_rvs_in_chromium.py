"""The page of a running robot in a real browser, over real DDS."""

import sys
from contextlib import closing
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[3] / "rvs"))

from browsing import IN_CHROMIUM
from chromium import Tab
from raw_client import wait_until
from servo_operator import START

from robomech_ros.nodes.rvs.node import RvsNode
from robomech_ros.nodes.servo.node import ServoNode
from robomech_ros.nodes.trajectory_planner.node import TrajectoryPlannerNode
from robomech_ros.nodes.trajectory_publisher.node import TrajectoryPublisherNode

pytestmark = IN_CHROMIUM
ROBOT = "puma560"
BUTTON = "[...document.querySelectorAll('button')].find(b => b.innerText === '{text}')"
PAD = "document.querySelector('[data-jog=\"joint 1 +\"]')"
FOLDER = (
    "[...document.querySelectorAll('div')].find(d => d.childNodes.length && "
    "d.childNodes[0].nodeValue === 'Jog')"
)


@pytest.fixture
def seen(graph, drive):
    """A simulated PUMA with all that moves it, its page, and a browser that shows it."""
    robot = drive(initial_positions=START)
    graph.start(TrajectoryPlannerNode, robot_description=ROBOT)
    graph.start(TrajectoryPublisherNode, robot_description=ROBOT)
    servo = {"characteristic_length": 0.283, "publish_rate": 50.0}
    graph.start(ServoNode, robot_description=ROBOT, **servo)
    # A page that is drawn in software on a busy machine says seldom what is held.
    node = graph.start(RvsNode, robot_description=ROBOT, port=0, jog_timeout=2.0)
    motions, jogger = node._robot._motions, node._robot._jogger
    wait_until(lambda: motions._planner.service_is_ready() and motions._executor.service_is_ready())
    wait_until(jogger._joints.get_subscription_count)
    # Of a page that loses its node, a browser complains.
    with closing(Tab(f"{node.url}&fixedDpr=1", 1000, 600)) as tab:
        tab.wait_for(PAD)
        wait_until(lambda: np.allclose(node._page._arm.q, robot.position, atol=1e-6))
        yield node, robot, tab


def test_plans_and_executes_from_the_page(seen):
    node, robot, tab = seen
    goal = robot.position + [0.3, 0, 0, 0, 0, 0]
    node._page.set_joint(0, float(goal[0]))
    tab.wait_for("__viserMutable.nodeRefFromName['/goal'].visible")
    tab.value(f"{BUTTON.format(text='Execute')}.click()")
    tab.wait_for("document.querySelector('[data-result]').innerText.includes('arrived')")
    np.testing.assert_allclose(robot.position, goal, atol=2e-3)
    tab.wait_for("!__viserMutable.nodeRefFromName['/goal'].visible")
    assert tab.errors == []


def press(tab):
    """Press the button that jogs joint 2, and keep it pressed; gives its place."""
    tab.wait_for(FOLDER)
    if not tab.value(f"{PAD}.getBoundingClientRect().height > 0 && {PAD}.offsetParent !== null"):
        tab.value(f"{FOLDER}.click()")
    # The folder opens slowly, and what is on top of it may still move.
    inside = (
        f"(() => {{ const b = {PAD}; b.scrollIntoView({{block: 'center'}}); "
        "const r = b.getBoundingClientRect(); "
        "const e = document.elementFromPoint(r.left + r.width / 2, r.top + r.height / 2); "
        "return e === b })()"
    )
    tab.wait_for(inside)
    tab.frames(3)
    x, y = tab.value(
        f"(() => {{ const r = {PAD}.getBoundingClientRect(); "
        "return [r.left + r.width / 2, r.top + r.height / 2] })()"
    )
    tab.mouse("mouseMoved", x, y)
    tab.mouse("mousePressed", x, y, buttons=1)
    return x, y


def until_still(robot):
    """Wait until the robot has stood for some states."""
    count = len(robot.states)
    robot.until(lambda: len(robot.states) > count + 30)
    robot.until(lambda: not any(any(state.velocity) for state in robot.states[-30:]))


def press_until_moved(node, robot, tab):
    """Hold the button until the robot has moved, again where the page was too slow to say so."""
    start, switch = robot.position[1], node._robot._jogger._switch

    def moved():
        return robot.position[1] > start + 0.02

    while True:
        before = switch._ended
        x, y = press(tab)
        robot.until(lambda before=before: moved() or switch._ended != before)
        if moved():
            return x, y
        tab.mouse("mouseReleased", x, y)


@pytest.mark.parametrize("how", ["let go", "hidden", "reloaded", "closed"])
def test_a_jog_ends_with_its_button_and_with_its_page(seen, how):
    node, robot, tab = seen
    x, y = press_until_moved(node, robot, tab)
    if how == "let go":
        tab.mouse("mouseReleased", x, y)
    elif how == "hidden":
        hide = "Object.defineProperty(document, 'hidden', {value: true, configurable: true})"
        tab.value(f"{hide}; document.dispatchEvent(new Event('visibilitychange'))")
    elif how == "reloaded":
        tab.send("Page.reload")
    else:
        tab.close()
    wait_until(lambda: not node._robot.jogs)
    until_still(robot)
    if how == "reloaded":
        # The button is down, but nobody pressed it on this page.
        tab.wait_for(PAD)
        until_still(robot)
        assert not node._robot.jogs
    assert (robot.position <= robot.chain.upper).all()
