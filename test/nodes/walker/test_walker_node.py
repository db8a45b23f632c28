"""Walking machines over real DDS: they walk as commanded, stop, and refuse by leg and joint."""

import itertools
import math
import re
import threading
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import PolygonStamped, Pose
from nav_msgs.msg import Odometry
from rcl_interfaces.msg import Log
from sensor_msgs.msg import JointState, MultiDOFJointState
from std_msgs.msg import Float64, String
from tf2_msgs.msg import TFMessage
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint
from twist_driver import Driver
from waiting import until

from robomech_interfaces.msg import FootContacts
from robomech_ros.errors import RobomechError
from robomech_ros.nodes.common.messages.pose_messages import pose_from_matrix
from robomech_ros.nodes.common.motion_clock import MotionClock
from robomech_ros.nodes.joint_trajectory_controller.node import JointTrajectoryControllerNode
from robomech_ros.nodes.middleware.throttled_log import MOST as MOST_LOGGED
from robomech_ros.nodes.walker.command_intake import CommandIntake
from robomech_ros.nodes.walker.node import WalkerNode
from robomech_ros.outcomes import Code
from robomech_ros.spatial import matrix_from_roll_pitch_yaw
from robomech_ros.spatial.poses import assembled
from robomech_ros.walking import GAITS, load_legged, stability_margin

ROBOTS = {
    "wave": "phantomx",
    "ripple": "phantomx",
    "tripod": "phantomx",
    "crawl": "go1",
    "trot": "go1",
}
BOUNDS = {"trot": -0.04}
ROBOT_FILES = Path(__file__).parents[3] / "config" / "robots" / "walking"
CONTROLLER = "joint_trajectory_controller/joint_trajectory"


class Listener:
    """Keeps all messages of some topics by their stamps (ns)."""

    def __init__(self, graph):
        self.contacts, self.states = {}, []
        self.margins = []
        client = graph.client
        client.create_subscription(FootContacts, "foot_contacts", self._contacts, 1000)
        client.create_subscription(JointState, "joint_states", self.states.append, 1000)
        client.create_subscription(Float64, "walker/stability_margin", self.margins.append, 1000)

    def _contacts(self, message):
        self.contacts[stamp(message)] = message


def stamp(message):
    return message.header.stamp.sec * 10**9 + message.header.stamp.nanosec


def start(graph, robot, positions=(), **parameters):
    """Start the walker and its controller; on a busy machine messages may come late."""
    more = {"initial_positions": list(positions)} if len(positions) else {}
    graph.start(JointTrajectoryControllerNode, robot_description=robot, **more)
    graph.start(WalkerNode, robot_description=robot, lead=0.6, **parameters)


def at_rest(graph):
    """Wait until all feet stand and the trunk does not move."""
    graph.receive(
        Odometry, "odom", 10, lambda m: not m.twist.twist.linear.x and not m.twist.twist.angular.z
    )
    return graph.receive(FootContacts, "foot_contacts", 10, lambda m: all(m.contacts))


def refused(graph, text):
    """Wait for diagnostics that say what was refused."""

    def says(message):
        values = {one.key: one.value for one in message.status[0].values}
        return text in values.get("last ignored", "") and message.status[0].level == b"\x01"

    return graph.receive(DiagnosticArray, "/diagnostics", 10, says).status[0].message


@pytest.mark.slow
@pytest.mark.parametrize("gait", ROBOTS)
def test_every_gait_follows_twists_and_stops_with_all_feet_down(graph, gait):
    name = ROBOTS[gait]
    robot, heard = load_legged(name), Listener(graph)
    start(graph, name, gait=gait)
    at_rest(graph)
    driver = Driver(graph, "cmd_vel", old=0)
    driver.command(0.015, 0.004, 0.03)
    lifted = set()

    def all_lifted(message):
        names = zip(message.names, message.contacts, strict=True)
        lifted.update(leg for leg, down in names if not down)
        return lifted == set(robot.leg_names)

    graph.receive(FootContacts, "foot_contacts", 1000, all_lifted)
    walked = graph.receive(Odometry, "odom", 10, lambda m: m.pose.pose.position.x > 0.02)
    assert min(walked.pose.covariance[k] for k in (0, 7, 35)) > 0.0
    driver.silent()
    at_rest(graph)
    fewest = 3 if GAITS[gait].static else 2
    for contacts in [*heard.contacts.values()]:
        assert sum(contacts.contacts) >= fewest
    assert min(one.data for one in heard.margins) >= BOUNDS.get(gait, 0.01) - 1e-9
    for state in [*heard.states]:
        q, rates = np.array(state.position), np.array(state.velocity)
        assert (q >= robot.lower - 1e-9).all() and (q <= robot.upper + 1e-9).all()
        assert (np.abs(rates) <= robot.velocity * (1.0 + 1e-9)).all()


def test_the_trunk_moves_as_commanded(graph):
    start(graph, "phantomx", gait="tripod", cycle=2.4)
    driver = Driver(graph, "cmd_vel_unstamped", stamped=False)
    driver.command(0.004, 0.002, 0.02)

    def there(message):
        linear, angular = message.twist.twist.linear, message.twist.twist.angular
        found = [linear.x, linear.y, linear.z, angular.x, angular.y, angular.z]
        return np.abs(np.array(found) - [0.004, 0.002, 0.0, 0.0, 0.0, 0.02]).max() <= 1e-9

    message = graph.receive(Odometry, "odom", 10, there)
    assert (message.header.frame_id, message.child_frame_id) == ("odom", "base_link")


def test_margin_polygon_and_frame_of_a_robot_that_stands(graph):
    start(graph, "phantomx", frame_prefix="left/")
    robot = load_legged("phantomx")
    margin = graph.receive(Float64, "walker/stability_margin", 10, lambda m: True).data
    polygon = graph.receive(PolygonStamped, "walker/support_polygon", 10, lambda m: True)
    corners = np.array([[one.x, one.y] for one in polygon.polygon.points])
    assert polygon.header.frame_id == "left/odom" and len(corners) >= 3
    assert stability_margin([0.0, 0.0], corners) == pytest.approx(margin, abs=1e-6)
    odometry = graph.receive(Odometry, "odom", 10, lambda m: True)
    assert odometry.pose.pose.position.z == pytest.approx(-robot.feet(robot.home)[0, 2])
    graph.receive(
        TFMessage,
        "/tf",
        100,
        lambda m: (
            m.transforms[0].header.frame_id == "left/odom"
            and m.transforms[0].child_frame_id == "left/base_link"
        ),
    )


def test_forces_at_the_feet_carry_the_weight_and_torques_exert_them(graph):
    start(graph, "phantomx")
    robot = load_legged("phantomx")
    weight = 9.81 * (1.2 + 6 * 0.17)

    def carried(message):
        lifted = [one.force.x == one.force.y == one.force.z == 0.0 for one in message.wrench]
        return any(lifted) and not all(lifted)

    driver = Driver(graph, "cmd_vel", old=0)
    driver.command(0.015, 0.004, 0.03)
    forces = graph.receive(MultiDOFJointState, "walker/foot_forces", 20, carried)
    assert forces.joint_names == list(robot.leg_names) and forces.header.frame_id == "odom"
    total = sum(one.force.z for one in forces.wrench)
    assert total == pytest.approx(weight, rel=0.05)
    assert abs(forces.transforms[0].translation.z) < 0.04
    efforts = graph.receive(JointState, "walker/joint_efforts", 20, lambda m: True)
    assert efforts.name == list(robot.joint_names)
    assert 0.05 < np.abs(efforts.effort).max() < 1.5
    published = set()
    graph.client.create_subscription(
        JointState, "walker/joint_efforts", lambda m: published.add(tuple(m.effort)), 100
    )

    def shown(message):
        assert len(message.effort) in (0, robot.n)
        return message.name == efforts.name and tuple(message.effort) in published

    graph.receive(JointState, "joint_states", 20, shown)


def test_joint_states_have_no_efforts_without_masses_or_without_a_number_for_each_joint(graph):
    heard, robot = Listener(graph), load_legged("phantomx")
    document = (ROBOT_FILES / "phantomx.yaml").read_text(encoding="utf-8")
    start(graph, re.sub(r",\s*body: .*}(?=})|trunk_body: .*", "", document))
    driver = Driver(graph, "cmd_vel", old=0)
    driver.command(0.015, 0.004, 0.03)
    graph.receive(Odometry, "odom", 20, lambda m: m.pose.pose.position.x > 0.005)
    assert heard.states and not any(len(one.effort) for one in [*heard.states])
    publisher = graph.client.create_publisher(JointState, "walker/joint_efforts", 10)

    def send(efforts):
        message = JointState(name=list(robot.joint_names), effort=efforts)
        message.header.stamp = graph.client.get_clock().now().to_msg()
        publisher.publish(message)

    timer = graph.client.create_timer(0.05, lambda: send([math.nan] + [1.0] * (robot.n - 1)))
    ignored = f"ignored: none, or not a finite one, of joint '{robot.joint_names[0]}'"
    graph.receive(Log, "/rosout", 20, lambda m: ignored in m.msg)
    assert not any(len(one.effort) for one in [*heard.states])
    graph.client.destroy_timer(timer)
    send([*map(float, range(robot.n))])
    graph.receive(JointState, "joint_states", 5, lambda m: [*m.effort] == [*range(robot.n)])
    graph.receive(JointState, "joint_states", 5, lambda m: not len(m.effort))


def test_a_body_pose_turns_the_trunk_as_it_says(graph):
    given, told = np.array([0.1, -0.2, 0.05, 0.1, 0.2, 0.3]), []

    def command_pose(values, duration):
        told.append([*values, duration])
        return SimpleNamespace(status=Code.NONE)

    walker = SimpleNamespace(command_pose=command_pose, command_gait=None)
    intake = CommandIntake(graph.client, walker, MotionClock(graph.client), 0.5)
    publisher = graph.client.create_publisher(Pose, "body_pose", 10)
    message = pose_from_matrix(assembled(matrix_from_roll_pitch_yaw(given[3:]), given[:3]))

    def arrived():
        publisher.publish(message)
        intake.take(stands=True)
        return told

    until(arrived)
    np.testing.assert_allclose(told[0], [*given, 0.5], atol=1e-12)


def test_body_poses_move_the_trunk_over_planted_feet_or_are_refused_by_leg_and_joint(graph):
    heard = Listener(graph)
    start(graph, "phantomx")
    at_rest(graph)
    publisher = graph.client.create_publisher(Pose, "body_pose", 10)

    def send(z, y=0.0):
        pose = Pose()
        pose.position.z, pose.position.y, pose.orientation.w = z, y, 1.0
        publisher.publish(pose)

    timer = graph.client.create_timer(0.2, lambda: send(0.5))
    high = refused(graph, "too short")
    assert "201 OUT_OF_REACH" in high and "leg '" in high and "joint '" in high
    graph.client.destroy_timer(timer)
    timer = graph.client.create_timer(0.2, lambda: send(0.0, 0.3))
    assert "mass centre" in refused(graph, "mass centre")
    graph.client.destroy_timer(timer)
    level = graph.receive(Odometry, "odom", 10, lambda m: True).pose.pose.position.z
    timer = graph.client.create_timer(0.2, lambda: send(0.01))
    graph.receive(Odometry, "odom", 10, lambda m: abs(m.pose.pose.position.z - level - 0.01) < 1e-9)
    graph.client.destroy_timer(timer)
    feet = [[(one.x, one.y, one.z) for one in m.feet] for m in [*heard.contacts.values()]]
    assert np.ptp(np.array(feet), axis=0).max() == 0.0


def test_gaits_are_changed_and_those_for_other_robots_refused(graph):
    start(graph, "phantomx")
    at_rest(graph)
    publisher = graph.client.create_publisher(String, "walker/gait", 10)

    def gait(name):
        return graph.client.create_timer(0.2, lambda: publisher.publish(String(data=name)))

    timer = gait("trot")
    assert "number of legs for the gait 'trot'" in refused(graph, "trot")
    graph.client.destroy_timer(timer)
    timer = gait("wave")

    def waves(message):
        return {one.key: one.value for one in message.status[0].values}.get("gait") == "wave"

    graph.receive(DiagnosticArray, "/diagnostics", 10, waves)
    graph.client.destroy_timer(timer)


@pytest.mark.parametrize(
    ("old", "value", "text"),
    [(1, 0.02, "age of the command"), (None, math.nan, "command"), (None, math.inf, "command")],
)
def test_what_is_ignored_is_said_and_moves_nothing(graph, old, value, text):
    heard = Listener(graph)
    start(graph, "phantomx")
    at_rest(graph)
    Driver(graph, "cmd_vel", old=old).command(value)
    refused(graph, text)
    assert all(all(message.contacts) for message in [*heard.contacts.values()])


def test_what_is_refused_again_and_again_does_not_fill_the_log(graph):
    start(graph, "phantomx")
    at_rest(graph)
    logged, names = [], (f"gallop_{k}" for k in itertools.count())
    graph.client.create_subscription(Log, "/rosout", logged.append, 1000)
    publisher = graph.client.create_publisher(String, "walker/gait", 10)
    timer = graph.client.create_timer(0.01, lambda: publisher.publish(String(data=next(names))))

    def ignored(message):
        values = {one.key: one.value for one in message.status[0].values}
        return int(values.get("ignored commands", 0)) >= MOST_LOGGED**2

    graph.receive(DiagnosticArray, "/diagnostics", 10, ignored)
    graph.client.destroy_timer(timer)
    texts = [log.msg for log in [*logged] if "gallop" in log.msg]
    # A period of the log may end in between, on a busy machine several.
    assert 0 < len(texts) <= MOST_LOGGED**2 // 2


@pytest.mark.slow
def test_a_robot_that_lies_rises_at_the_first_command_and_again_after_others_moved_it(graph):
    robot = load_legged("phantomx")
    lying = (robot.home + np.tile([0.0, 0.5, 0.0], 6)).tolist()
    start(graph, "phantomx", lying, rising_speed=0.5)

    def says(text):
        return graph.receive(
            DiagnosticArray, "/diagnostics", 10, lambda m: text in m.status[0].message
        )

    says("it rises at the first command")
    driver = Driver(graph, "cmd_vel", old=0)
    driver.command(0.0)
    at_rest(graph)
    driver.silent()
    publisher = graph.client.create_publisher(JointTrajectory, CONTROLLER, 10)
    point = JointTrajectoryPoint(positions=lying)
    point.time_from_start.sec = 1
    moved = threading.Event()

    def send():
        if not moved.is_set():
            names = list(robot.joint_names)
            publisher.publish(JointTrajectory(joint_names=names, points=[point]))

    timer = graph.client.create_timer(2.0, send)
    says("was moved by")
    moved.set()
    graph.client.destroy_timer(timer)
    driver.command(0.02)
    graph.receive(Odometry, "odom", 10, lambda m: m.pose.pose.position.x > 0.005)


@pytest.mark.parametrize(
    ("given", "text"),
    [
        ({"robot_description": "puma560"}, "phantomx"),
        ({"robot_description": "go1", "gait": "tripod"}, "number of legs for the gait 'tripod'"),
        ({"robot_description": "go1", "stability_bound": 1.0}, "margin of the gait 'crawl'"),
        ({"robot_description": "go1", "gait": "gallop"}, "gallop"),
    ],
)
def test_what_cannot_walk_is_refused_at_the_start(graph, given, text):
    with pytest.raises(RobomechError, match=text):
        graph.start(WalkerNode, **given)
