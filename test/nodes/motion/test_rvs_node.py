"""The node rvs over real DDS, with pages that are no browsers."""

import html
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("viser")
sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "rvs"))

import msgspec.msgpack
from diagnostic_msgs.msg import DiagnosticArray
from drivers import Driver
from geometry_msgs.msg import Point, Vector3
from raw_client import Client, camera, wait_until
from rcl_interfaces.msg import ParameterType, ParameterValue
from rcl_interfaces.srv import GetParameters
from servo_operator import START
from std_srvs.srv import Trigger
from trajectory_msgs.msg import JointTrajectory
from visualization_msgs.msg import Marker, MarkerArray

from robomech_interfaces.srv import AnalyzeSingularity, Execute
from robomech_ros.errors import BadValueError
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.nodes.common.robot_description import LATCHED, RobotModel
from robomech_ros.nodes.kinematics.node import KinematicsNode
from robomech_ros.nodes.rvs.messages import seen_marker
from robomech_ros.nodes.rvs.node import RvsNode
from robomech_ros.nodes.servo.node import ServoNode
from robomech_ros.nodes.trajectory_planner.node import TrajectoryPlannerNode
from robomech_ros.nodes.trajectory_publisher.node import TrajectoryPublisherNode
from robomech_ros.robots import load_description
from robomech_ros.rvs.serving.server import PortTakenError

PACK = msgspec.msgpack.encode
ROBOT = "puma560"


class Browser:
    """A connection to the page of a node, and what the node shows there."""

    def __init__(self, node):
        self.node, self.page = node, node._page
        self.layer = self.page._layers[0]
        self.client = Client(node)
        self._socket = self.client.connect()
        self._presses, self._pressed_at = 0, 0.0
        self.send(camera())
        wait_until(lambda: self.layer._controls is not None)

    def send(self, message):
        self._socket.send(PACK(message))

    def set(self, handle, value):
        """Set a control as a page does."""
        message = {"type": "GuiUpdateMessage", "uuid": handle._impl.uuid}
        self.send(message | {"updates": {"value": value}})

    def click(self, what):
        """Click one of the buttons about the goal."""
        self.set(self.layer._controls._handles[0], what)

    def stop(self):
        """Click Stop."""
        handles = self.page._server.viser.gui._gui_input_handle_from_uuid.values()
        self.set(next(one for one in handles if getattr(one, "label", "") == "Stop"), True)

    def press(self):
        self._presses, self._pressed_at = self._presses + 1, time.monotonic()

    @property
    def press_has_ended(self):
        """Whether the node takes the present press for over."""
        switch = self.node._robot._jogger._switch
        return switch.held() is None and switch._ended == self._presses

    def hold(self, direction):
        """Say that a button is held."""
        age = round(1000 * (time.monotonic() - self._pressed_at))
        text = f"{direction} {self._presses} {age}"
        self.set(self.layer._controls._field, text)

    def said(self, line="result"):
        """What the page says."""
        return html.unescape(self.layer._lines[line])

    def close(self):
        self._socket.close()


@pytest.fixture
def browse():
    """Open pages of nodes; all are closed at the end."""
    opened = []

    def start(node):
        opened.append(Browser(node))
        return opened[-1]

    yield start
    for one in opened:
        one.close()


@pytest.fixture
def shown(graph, arm, browse):
    """A simulated PUMA, and a page of it."""
    return browse(graph.start(RvsNode, robot_description=ROBOT, port=0))


def drawn(browser):
    """Where the robot is drawn (rad), shape (n,)."""
    latest = browser.layer._goal._robot
    return np.full(6, np.nan) if latest is None else latest


def test_the_robot_is_drawn_where_its_joints_are_and_the_goal_follows(shown, arm):
    wait_until(lambda: np.allclose(drawn(shown), arm.position, atol=1e-6))
    arm.execute(arm.trajectory((0.5, 0.3)))
    wait_until(lambda: np.allclose(drawn(shown), arm.position, atol=1e-6))
    wait_until(lambda: np.allclose(shown.page._arm.q, arm.position, atol=1e-6))
    assert not shown.layer._goal.is_apart and shown.said("state") == ""


def test_states_that_fail_to_come_are_told(graph, browse):
    browser = browse(graph.start(RvsNode, robot_description=ROBOT, port=0))
    wait_until(lambda: "nothing received" in browser.said("state"))
    status = graph.receive(
        DiagnosticArray, "/diagnostics", 10, lambda m: "nothing received" in m.status[0].message
    ).status[0]
    assert status.level == status.WARN and status.hardware_id == ROBOT
    values = {entry.key: entry.value for entry in status.values}
    assert values["address"] == browser.node.url.split("?")[0] and "token" not in str(status)


@pytest.fixture
def suite(graph, shown):
    """The nodes that plan and execute."""
    graph.start(TrajectoryPlannerNode, robot_description=ROBOT)
    graph.start(TrajectoryPublisherNode, robot_description=ROBOT)
    motions = shown.node._robot._motions
    wanted = [motions._planner, motions._executor, motions._reader, *stoppers(motions)]
    wait_until(lambda: all(client.service_is_ready() for client in wanted))
    return shown


def goal_beside(browser, arm, by):
    """Put the goal beside the robot, by a slider."""
    wait_until(lambda: np.allclose(browser.page._arm.q, arm.position, atol=1e-6))
    browser.set(browser.page._panel._sliders[0], float(arm.position[0] + by))
    wait_until(lambda: browser.layer._goal.is_apart)


def test_executes_to_the_goal(suite, arm):
    goal_beside(suite, arm, 0.25)
    goal = suite.page._arm.q
    assert not np.allclose(arm.position, goal, atol=0.1)
    suite.click("Execute")
    wait_until(lambda: "arrived after" in suite.said())
    np.testing.assert_allclose(arm.position, goal, atol=2e-3)
    wait_until(lambda: not suite.layer._goal.is_apart)
    plan = suite.page._plan.motion
    np.testing.assert_allclose(plan.q[-1], goal, atol=1e-9)


def test_a_plan_alone_moves_nothing(suite, arm):
    goal_beside(suite, arm, 0.25)
    start = arm.position
    suite.click("Plan")
    wait_until(lambda: "executes every plan at once" in suite.said())
    suite.set(suite.layer._controls._waiting, True)
    wait_until(lambda: "Plans wait for Execute" in suite.said())
    suite.click("Plan")
    wait_until(lambda: "the motion takes" in suite.said())
    wait_until(lambda: suite.page._plan.motion is not None)
    np.testing.assert_array_equal(arm.position, start)
    suite.click("Execute")
    wait_until(lambda: "arrived after" in suite.said())
    np.testing.assert_allclose(arm.position, start + [0.25, 0, 0, 0, 0, 0], atol=2e-3)


def test_stop_stops_and_says_why_the_motion_ended(suite, arm):
    goal_beside(suite, arm, 2.0)
    suite.click("Execute")
    arm.until_moving()
    suite.stop()
    wait_until(lambda: suite.said() and "Stopped" in suite.said())
    until_still(arm)
    rest = arm.position
    assert abs(rest[0] - suite.page._arm.q[0]) > 0.1
    # Nothing that was planned before moves it after.
    suite.click("Plan")
    wait_until(lambda: "executes every plan at once" in suite.said())
    np.testing.assert_array_equal(arm.position, rest)


@pytest.mark.parametrize("what", ["Plan", "Execute"])
def test_what_waits_when_stop_is_clicked_is_not_done(suite, arm, what):
    goal_beside(suite, arm, 0.25)
    start, held, free = arm.position, threading.Event(), threading.Event()
    suite.page._run("hold the page up", lambda: held.set() or free.wait(60.0))
    assert held.wait(60.0)
    try:
        suite.click(what)
        suite.stop()
        wait_until(lambda: "Stopped" in suite.said())
    finally:
        free.set()
    wait_until(lambda: "Stop was clicked after it" in suite.said("dropped"))
    assert "Stopped" in suite.said()
    np.testing.assert_array_equal(arm.position, start)
    # A later click counts.
    suite.click("Execute")
    wait_until(lambda: "arrived after" in suite.said())
    assert suite.said("dropped") == ""


@pytest.mark.parametrize(("what", "kind"), [("Plan", "plan to goal"), ("Execute", "execute")])
def test_what_waits_when_command_is_lost_is_not_done(suite, arm, what, kind):
    goal_beside(suite, arm, 0.25)
    other = Browser(suite.node)
    wait_until(lambda: suite.page._audience._watching)
    ((number, (_, button)),) = suite.page._audience._watching.items()
    start, held, free = arm.position, threading.Event(), threading.Event()
    suite.page._run("hold the page up", lambda: held.set() or free.wait(60.0))
    assert held.wait(60.0)
    try:
        other.set(button, True)
        wait_until(lambda: "take over" in suite.page._worker._waiting)
        suite.click(what)
        wait_until(lambda: kind in suite.page._worker._waiting)
    finally:
        free.set()
    wait_until(lambda: "another browser has taken command" in suite.said("dropped"))
    assert suite.page._audience.commander == number
    np.testing.assert_array_equal(arm.position, start)
    other.click("Execute")
    wait_until(lambda: "arrived after" in suite.said())
    other.close()


def test_who_is_not_there_is_named(shown, arm):
    wait_until(lambda: np.allclose(drawn(shown), arm.position, atol=1e-6))
    shown.click("Execute")
    wait_until(lambda: "/trajectory_planner/plan_joint" in shown.said())
    assert "Nobody serves" in shown.said()
    shown.press()
    shown.hold("linear 2 +")
    wait_until(lambda: "No servo listens" in shown.said())


def serve(graph, kind, name, take):
    """Serve something in place of a node of the suite."""
    return graph.client.create_service(kind, name, take)


def stoppers(motions):
    """Clients of the services that Stop calls."""
    return motions._stopping._cancel, motions._stopping._hold


def ready(*clients):
    wait_until(lambda: all(client.service_is_ready() for client in clients))


def trigger(success, message=""):
    return lambda _request, response: Trigger.Response(success=success, message=message)


def test_stop_says_who_is_not_there_and_who_refuses(graph, shown, arm):
    motions = shown.node._robot._motions
    hold = stoppers(motions)[1]
    ready(hold)
    shown.stop()
    wait_until(lambda: "nobody serves '/trajectory_publisher/cancel'" in shown.said())
    assert "may have failed" in shown.said() and "hold" not in shown.said()
    serve(graph, Trigger, "trajectory_publisher/cancel", trigger(False, "not now"))
    ready(*stoppers(motions))
    shown.stop()
    wait_until(lambda: "'/trajectory_publisher/cancel' refused: not now" in shown.said())
    assert "Stopped" not in shown.said()


def test_stop_is_said_to_have_stopped_when_all_have_answered(graph, shown, arm):
    asked, free = threading.Event(), threading.Event()

    def cancel(_request, response):
        asked.set()
        free.wait(60.0)
        return trigger(True)(_request, response)

    serve(graph, Trigger, "trajectory_publisher/cancel", cancel)
    motions = shown.node._robot._motions
    ready(*stoppers(motions))
    shown.stop()
    try:
        assert asked.wait(60.0)
        wait_until(lambda: "'/trajectory_publisher/cancel' does not answer" in shown.said())
    finally:
        free.set()
    wait_until(lambda: "Stopped." in shown.said())
    wait_until(lambda: motions._requests.waiting <= 1)


def test_what_the_publisher_sends_when_it_cancels_moves_nothing_after_stop(graph, shown, arm):
    """As a trajectory that brakes on the path, which comes after the controller held."""
    motions, start = shown.node._robot._motions, arm.position
    braking = arm.trajectory((20.0, 1.0))
    _, hold = stoppers(motions)

    def cancel(_request, response):
        wait_until(lambda: hold not in motions._stopping._open)
        arm._topic.publish(braking)
        wait_until(lambda: not np.allclose(drawn(shown), start, atol=1e-4))
        return trigger(True)(_request, response)

    serve(graph, Trigger, "trajectory_publisher/cancel", cancel)
    ready(*stoppers(motions))
    wait_until(lambda: np.allclose(drawn(shown), start, atol=1e-6))
    shown.stop()
    wait_until(lambda: "Stopped." in shown.said())
    until_still(arm)
    assert np.abs(arm.position - start).max() < 0.5


def test_stop_does_not_wait_for_the_thread_of_the_node(graph, shown, arm):
    motions = shown.node._robot._motions
    asked, held, free = threading.Event(), threading.Event(), threading.Event()

    def cancel(_request, response):
        asked.set()
        return trigger(True)(_request, response)

    serve(graph, Trigger, "trajectory_publisher/cancel", cancel)
    ready(*stoppers(motions))
    shown.node.executor.create_task(lambda: held.set() or free.wait(60.0))
    assert held.wait(60.0)
    try:
        shown.stop()
        assert asked.wait(30.0)
        assert not free.is_set() and "Stopped." not in shown.said()
    finally:
        free.set()
    wait_until(lambda: "Stopped." in shown.said())


def test_nothing_is_planned_where_nobody_tells_whether_plans_are_executed(graph, shown, arm):
    graph.start(TrajectoryPlannerNode, robot_description=ROBOT)
    motions = shown.node._robot._motions
    ready(motions._planner)
    received = []
    topic = "trajectory_planner/planned_trajectory"
    graph.client.create_subscription(JointTrajectory, topic, received.append, LATCHED)
    wait_until(lambda: motions._readers_of_plans())
    goal_beside(shown, arm, 0.25)
    for what in ("Plan", "Execute"):
        shown.click(what)
        wait_until(lambda: "plans are read by '/test_client'" in shown.said())
        shown.layer.show_result("")
    # The parameter is served, but is no truth value.
    serve(graph, GetParameters, "trajectory_publisher/get_parameters", lambda _, answer: answer)
    ready(motions._reader)
    shown.click("Plan")
    wait_until(lambda: "plans are read by '/test_client'" in shown.said())
    assert not received


def test_looks_that_nobody_answers_do_not_pile_up(graph, shown, arm):
    free, asked = threading.Event(), []

    def read(_request, response):
        asked.append(None)
        free.wait(60.0)
        return response

    serve(graph, GetParameters, "trajectory_publisher/get_parameters", read)
    motions = shown.node._robot._motions
    try:
        wait_until(lambda: asked)
        pending = motions._reader._pending_requests
        for _ in range(5):
            motions.look()
            assert len(pending) <= 1
        # It is given up after a time, and asked again.
        first = next(iter(pending))
        wait_until(lambda: pending and first not in list(pending))
        assert len(pending) <= 1
    finally:
        free.set()


@pytest.mark.parametrize("automatic", [False, True])
def test_executes_its_own_plan_where_plans_wait(graph, shown, arm, automatic):
    """Not the trajectory planned last, which may be somebody else's."""
    asked = []

    def read(_request, response):
        kind = ParameterType.PARAMETER_BOOL
        response.values = [ParameterValue(type=kind, bool_value=automatic)]
        return response

    def execute(request, response):
        asked.append(request.trajectory)
        return response

    serve(graph, GetParameters, "trajectory_publisher/get_parameters", read)
    serve(graph, Execute, "trajectory_publisher/execute", execute)
    graph.start(TrajectoryPlannerNode, robot_description=ROBOT)
    motions = shown.node._robot._motions
    ready(motions._planner, motions._reader, motions._executor)
    goal_beside(shown, arm, 0.25)
    goal = shown.page._arm.q.copy()
    shown.click("Execute")
    wait_until(lambda: "arrived after" in shown.said())
    (sent,) = asked
    if automatic:
        # It is under way; sent again it would be executed twice.
        assert not sent.points
    else:
        assert tuple(sent.joint_names) == tuple(arm.names)
        np.testing.assert_allclose(sent.points[-1].positions, goal, atol=1e-9)


def lines(number, points):
    """A marker of lines between so many points."""
    marker = Marker(type=Marker.LINE_LIST, id=number)
    marker.points = [Point()] * points
    marker.pose.orientation.w = 1.0
    return marker


def test_points_of_all_markers_together_are_bounded(graph, shown):
    robot = shown.node._robot
    shown.layer.want_markers(True)
    publisher = graph.client.create_publisher(MarkerArray, "kinematics/markers", LATCHED)
    wait_until(lambda: publisher.get_subscription_count())
    publisher.publish(MarkerArray(markers=[lines(n, 40_000) for n in range(4)]))
    wait_until(lambda: len(robot._markers["markers_0"]) == 2)
    # Room that is given back is free.
    delete = Marker(id=0, action=Marker.DELETE)
    publisher.publish(MarkerArray(markers=[delete, lines(9, 50_000)]))
    wait_until(lambda: set(robot._markers["markers_0"]) == {"/1", "/9"})


@pytest.fixture
def jogged(graph, drive, browse):
    """A PUMA away from singularities, its servo, and a page."""
    robot = drive(initial_positions=START)
    parameters = {"characteristic_length": 0.283, "publish_rate": 50.0}
    graph.start(ServoNode, robot_description=ROBOT, **parameters)
    browser = browse(graph.start(RvsNode, robot_description=ROBOT, port=0, jog_silence=1.0))
    jogger = browser.node._robot._jogger
    wait_until(lambda: np.allclose(drawn(browser), robot.position, atol=1e-6))
    for publisher in (jogger._twists, jogger._joints):
        wait_until(publisher.get_subscription_count)
    return browser, robot


def hold_until(browser, direction, condition):
    """Hold a button until something is so.

    A press ends where the machine is too busy for its beats; then the button is pressed again.
    """
    browser.press()
    deadline = time.monotonic() + 60.0
    while not condition():
        assert time.monotonic() < deadline, browser.said()
        if browser.press_has_ended:
            browser.press()
        browser.hold(direction)
        time.sleep(0.05)


def until_still(robot):
    """Wait until the robot has stood for some states."""
    seen = len(robot.states)
    robot.until(lambda: len(robot.states) > seen + 30)
    robot.until(
        lambda: np.ptp([s.position for s in robot.states[-30:]], axis=0).max() == 0.0,
    )


def test_a_button_moves_the_tip_while_it_is_held(jogged):
    browser, robot = jogged

    def tip():
        return forward_kinematics(robot.chain, robot.position)[:3, 3]

    start = tip()
    hold_until(browser, "linear 2 +", lambda: tip()[2] > start[2] + 0.03)
    browser.set(browser.layer._controls._field, "")
    until_still(robot)
    assert not browser.node._robot.jogs
    moved = tip() - start
    assert np.abs(moved[:2]).max() < 0.1 * moved[2]
    # The goal comes along.
    wait_until(lambda: np.allclose(browser.page._arm.q, robot.position, atol=1e-6))


def test_a_joint_is_jogged_to_its_limit_and_no_further(jogged):
    browser, robot = jogged
    browser.set(browser.layer._controls._speed, 1.0)
    upper = robot.chain.upper[4]
    hold_until(browser, "joint 4 +", lambda: robot.position[4] > upper - 0.05)
    hold_until(browser, "joint 4 +", lambda: robot.names[4] in browser.said("servo"))
    browser.set(browser.layer._controls._field, "")
    until_still(robot)
    for state in robot.states:
        assert state.position[4] <= upper + 1e-9


@pytest.mark.parametrize("how", ["close", "silence", "take over"])
def test_a_page_that_goes_stops_the_robot(jogged, browse, how):
    browser, robot = jogged
    start = robot.position[1]
    hold_until(browser, "joint 1 +", lambda: robot.position[1] > start + 0.03)
    if how == "close":
        browser.close()
    elif how == "take over":
        lost = browser.layer._controls
        other = Browser(browser.node)
        wait_until(lambda: browser.page._audience._watching)
        ((number, (_, button)),) = browser.page._audience._watching.items()
        other.set(button, True)
        wait_until(lambda: browser.page._audience.commander == number)
        # What it said last may come after.
        lost._hold("joint 1 + 99 0")
        assert not browser.node._robot.jogs
        other.close()
    until_still(robot)
    assert not browser.node._robot.jogs


WILD = [
    "linear 0 + 1",
    "joint 99 + 1 1",
    "linear 0 + 1 1; drop",
    "nan",
    "joint 0 +" * 300,
    7,
    ["joint 0 + 1 1"],
]


@pytest.mark.parametrize("text", WILD)
def test_wild_jogs_are_refused(jogged, text):
    browser, robot = jogged
    start = robot.position
    browser.set(browser.layer._controls._field, text)
    wait_until(lambda: "Refused" in browser.said())
    controls = browser.layer._controls
    # A slider takes what can be read as a number.
    for field, value, right, word in (
        (controls._speed, 1e300, 0.5, "speed is 1e+300"),
        (controls._speed, "nan", 0.5, "speed is nan"),
        (controls._frame, "sideways", "base", "axes is 'sideways'"),
    ):
        browser.set(field, value)
        browser.press()
        browser.hold("linear 0 +")
        wait_until(lambda w=word: w in browser.said())
        browser.set(field, right)
    assert not browser.node._robot.jogs
    np.testing.assert_array_equal(robot.position, start)


def test_a_jog_that_fails_is_told_and_the_next_one_moves(jogged):
    browser, robot = jogged
    browser.node.destroy_publisher(browser.node._robot._jogger._joints)
    browser.press()
    browser.hold("joint 1 +")
    wait_until(lambda: "The jog failed" in browser.said())
    assert not browser.node._robot.jogs
    start = robot.position
    hold_until(browser, "linear 2 +", lambda: np.abs(robot.position - start).max() > 0.01)


def test_what_cannot_be_drawn_ends_no_watch_on_the_states(shown, arm):
    robot, names = shown.node._robot, shown.layer._names
    shown.layer._names = (*names, "no such joint")
    wait_until(lambda: "no such joint" in robot._feed.condition)
    shown.layer._names = names
    wait_until(lambda: robot._feed.condition == "")
    arm.execute(arm.trajectory((0.3, 0.2)))
    wait_until(lambda: np.allclose(drawn(shown), arm.position, atol=1e-6))


def marker(x=0.0, **size):
    """A box in the frame of the base."""
    made = Marker(type=Marker.CUBE)
    made.pose.position.x, made.pose.orientation.w = x, 1.0
    made.scale = Vector3(**({"x": 1.0, "y": 1.0, "z": 1.0} | size))
    return made


@pytest.mark.parametrize("wild", [{"x": 1e300}, {"y": -1e300}, {"z": 1.1e6}])
def test_markers_beyond_single_precision_are_refused(wild):
    model = RobotModel(load_description(ROBOT))
    assert seen_marker(model, marker(x=1e6)).pose[0, 3] == 1e6
    with pytest.raises(BadValueError, match="marker is"):
        seen_marker(model, marker(**wild))


def test_two_robots_have_pages_of_their_own(graph, browse):
    sides = {}
    for side, start in (("left", 0.2), ("right", -0.2)):
        robot = Driver(graph, graph.start, namespace=side, initial_positions=[start] * 6)
        node = graph.start(RvsNode, namespace=side, robot_description=ROBOT, port=0)
        sides[side] = robot, browse(node)
    for robot, browser in sides.values():
        wait_until(lambda r=robot, b=browser: np.allclose(drawn(b), r.position, atol=1e-6))
    assert sides["left"][1].node.url != sides["right"][1].node.url
    robot, browser = sides["left"]
    robot.execute(robot.trajectory((0.5, 0.3)))
    wait_until(lambda: np.allclose(drawn(browser), robot.position, atol=1e-6))
    np.testing.assert_allclose(drawn(sides["right"][1]), [-0.2] * 6, atol=1e-6)


def test_a_port_that_is_taken_is_told(graph, shown):
    port = shown.client.port
    with pytest.raises(PortTakenError, match=f"port {port} of 127.0.0.1 is taken"):
        graph.start(RvsNode, robot_description=ROBOT, port=port)


def test_markers_are_drawn_where_they_are_wanted(graph, shown):
    graph.start(KinematicsNode, robot_description=ROBOT)
    box = next(
        handle
        for handle in shown.node._page._server.viser.get_clients()[
            shown.layer._controls.client_id
        ].gui._gui_input_handle_from_uuid.values()
        if getattr(handle, "label", "") == "markers"
    )
    shown.set(box, True)
    graph.call(AnalyzeSingularity, "kinematics/analyze_singularity", AnalyzeSingularity.Request())
    nodes = shown.layer._markers._nodes
    wait_until(lambda: len(nodes.get("markers_0", ())) > 2)
    shown.set(box, False)
    wait_until(lambda: nodes.get("markers_0") == [])


def test_without_anybody_nothing_is_drawn(graph, arm):
    node = graph.start(RvsNode, robot_description=ROBOT, port=0)
    layer = node._page._layers[0]
    arm.execute(arm.trajectory((0.3, 0.2)))
    assert layer._goal._robot is None and not layer.wait_until_seen(0.0)
