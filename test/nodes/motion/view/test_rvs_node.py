"""The node rvs over real DDS, with pages that are no browsers."""

import sys
import threading
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("viser")
sys.path.insert(0, str(Path(__file__).resolve().parents[3] / "rvs"))

from browsers import Browser, drawn, until_still
from diagnostic_msgs.msg import DiagnosticArray
from drivers import Driver
from geometry_msgs.msg import Point, Vector3
from raw_client import wait_until
from rcl_interfaces.srv import GetParameters
from std_srvs.srv import Trigger
from trajectory_msgs.msg import JointTrajectory
from visualization_msgs.msg import Marker, MarkerArray

from robomech_interfaces.srv import AnalyzeSingularity, Execute
from robomech_ros.errors import BadValueError
from robomech_ros.nodes.common.robot.robot_description import LATCHED, RobotModel
from robomech_ros.nodes.kinematics.node import KinematicsNode
from robomech_ros.nodes.rvs.messages import read_marker
from robomech_ros.nodes.rvs.node import RvsNode
from robomech_ros.nodes.trajectory_planner.node import TrajectoryPlannerNode
from robomech_ros.nodes.trajectory_publisher.node import TrajectoryPublisherNode
from robomech_ros.robots import load_description
from robomech_ros.rvs import PortTakenError

ROBOT = "puma560"


@pytest.fixture
def shown(graph, arm, browse):
    """A simulated PUMA, and a page of it."""
    return browse(graph.start(RvsNode, robot_description=ROBOT, port=0))


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
def publisher(graph):
    """The node that executes."""
    return graph.start(TrajectoryPublisherNode, robot_description=ROBOT)


@pytest.fixture
def suite(graph, shown, publisher):
    """The nodes that plan and execute."""
    graph.start(TrajectoryPlannerNode, robot_description=ROBOT)
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


@pytest.mark.parametrize("waiting", [False, True])
def test_a_plan_is_shown_and_moves_nothing(suite, publisher, arm, waiting):
    goal_beside(suite, arm, 0.25)
    suite.node._robot.let_plans_wait(waiting)
    said = "Plans wait for Execute" if waiting else "Plans are executed at once"
    wait_until(lambda: said in suite.said())
    start = arm.position
    suite.click("Plan")
    wait_until(lambda: "the motion takes" in suite.said())
    wait_until(lambda: suite.page._plan.motion is not None)
    planned = suite.page._plan.motion
    np.testing.assert_allclose(planned.q[-1], start + [0.25, 0, 0, 0, 0, 0], atol=1e-9)
    # The publisher, which executes each plan that it receives, has received none.
    assert publisher._plans.latest is None
    np.testing.assert_array_equal(arm.position, start)
    suite.click("Execute")
    wait_until(lambda: "arrived after" in suite.said())
    np.testing.assert_allclose(arm.position, planned.q[-1], atol=2e-3)


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
    wait_until(lambda: "the motion takes" in suite.said())
    np.testing.assert_array_equal(arm.position, rest)


@pytest.mark.parametrize("what", ["Plan", "Execute"])
def test_what_waits_when_stop_is_clicked_is_not_done(suite, arm, what):
    goal_beside(suite, arm, 0.25)
    start, held, free = arm.position, threading.Event(), threading.Event()
    suite.page._worker.submit("hold the page up", lambda: held.set() or free.wait(60.0))
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
    suite.page._worker.submit("hold the page up", lambda: held.set() or free.wait(60.0))
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
    wait_until(lambda: "No servo listens" in shown.said("jog"))


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
    wait_until(lambda: len(motions._requests._waiting) <= 1)


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


def test_executes_its_own_plan(graph, shown, arm):
    """Not the trajectory planned last, which may be somebody else's."""
    asked, received = [], []

    def execute(request, response):
        asked.append(request.trajectory)
        return response

    serve(graph, Execute, "trajectory_publisher/execute", execute)
    graph.start(TrajectoryPlannerNode, robot_description=ROBOT)
    topic = "trajectory_planner/planned_trajectory"
    graph.client.create_subscription(JointTrajectory, topic, received.append, LATCHED)
    motions = shown.node._robot._motions
    ready(motions._planner, motions._executor)
    goal_beside(shown, arm, 0.25)
    goal = shown.page._arm.q.copy()
    shown.click("Execute")
    wait_until(lambda: "arrived after" in shown.said())
    (sent,) = asked
    assert tuple(sent.joint_names) == tuple(arm.names)
    np.testing.assert_allclose(sent.points[-1].positions, goal, atol=1e-9)
    # Nobody else may execute it a second time.
    assert not received


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
    assert read_marker(model, marker(x=1e6)).pose[0, 3] == 1e6
    with pytest.raises(BadValueError, match="marker is"):
        read_marker(model, marker(**wild))


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
            shown.layer._commander
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
    assert layer._goal._robot is None and not layer.wait_for_viewer(0.0)
