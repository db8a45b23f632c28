"""Pages of robots that run over the ground: seen where they are, jogged and stopped, over DDS."""

import sys
import time
from pathlib import Path

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from geometry_msgs.msg import TwistStamped
from nav_msgs.msg import Odometry
from sensor_msgs.msg import JointState
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

pytest.importorskip("viser")
sys.path.insert(0, str(Path(__file__).resolve().parents[3] / "rvs"))

from browsers import Browser, hold_until
from raw_client import wait_until

from robomech_ros.nodes.common.messages.pose_messages import matrix_from_pose
from robomech_ros.nodes.joint_trajectory_controller.node import JointTrajectoryControllerNode
from robomech_ros.nodes.mobile_base.node import MobileBaseNode
from robomech_ros.nodes.rvs.node import RvsNode
from robomech_ros.nodes.walker.node import WalkerNode
from robomech_ros.rolling import list_rolling
from robomech_ros.rvs.layers.camera import all_points
from robomech_ros.rvs.model.camera import visible_points
from robomech_ros.spatial import matrix_from_quaternion
from robomech_ros.walking import list_legged

JOG_DIRECTIONS = {"linear 0": "base_x", "linear 1": "base_y", "angular 2": "base_heading"}


def page_of(graph, browse, robot):
    """Open the page of a robot whose nodes have been started, once it is drawn."""
    node = graph.start(
        RvsNode, robot_description=robot, port=0, jog_timeout=1.0, jog_linear_speed=0.2
    )
    browser = browse(node)
    wait_until(lambda: browser.page._panel is not None)
    wait_until(lambda: len(browser.page._arm.trail.points) and not browser.said("state"))
    wait_until(node._robot._jogger._twists.get_subscription_count)
    return browser


def place(browser):
    """Return the drawn position of the robot: x, y (m) and heading (rad)."""
    at = browser.page._arm.positions
    return np.array([at[name] for name in JOG_DIRECTIONS.values()])


def control(browser, label):
    """A control of the browser that commands, by its label."""
    handles = browser.layer._folder._handles
    (found,) = (one for one in handles if getattr(one, "label", "") == label)
    return found


def until_still(graph, browser, topic):
    """Let the button go, and wait until the robot stands, and is drawn where it stands."""
    browser.set(browser.layer._pads[0].handle, "")
    wait_until(lambda: not browser.node._robot.jogs)
    last = []

    def stands(message):
        pose, twist = message.pose.pose, message.twist.twist
        moving = [twist.linear.x, twist.linear.y, twist.angular.z]
        last.append([pose.position.x, pose.position.y])
        return len(last) > 30 and np.ptp(last[-30:], axis=0).max() == 0.0 and not any(moving)

    graph.receive(Odometry, topic, 10, stands)
    wait_until(lambda: np.allclose(place(browser)[:2], last[-1], atol=1e-9))


@pytest.mark.parametrize("name", list_rolling())
def test_a_base_is_jogged_and_drawn_where_it_drives(graph, browse, name):
    graph.start(MobileBaseNode, robot_description=name)
    browser = page_of(graph, browse, name)
    assert not place(browser).any()
    ways = [f"{one.kind} {one.axis}" for one in browser.page._arm.directions]
    wheels = dict(browser.page._arm.positions)
    hold_until(browser, "linear 0 +", lambda: place(browser)[0] > 0.05)
    until_still(graph, browser, browser.node._robot._feed._odometry.topic)
    assert any(browser.page._arm.positions[wheel] != at for wheel, at in wheels.items())
    assert len(browser.page._arm.trail.points) > 2
    if "linear 1" in ways:
        hold_until(browser, "linear 1 -", lambda: place(browser)[1] < -0.05)
        return
    browser.press()
    browser.hold("linear 1 +")
    wait_until(lambda: "Refused: jog is 'linear 1'" in browser.said())


@pytest.mark.parametrize("name", list_legged())
def test_a_walking_machine_is_jogged_and_drawn_on_its_feet(graph, browse, name):
    graph.start(JointTrajectoryControllerNode, robot_description=name)
    graph.start(WalkerNode, robot_description=name, lead=0.6)
    browser = page_of(graph, browse, name)
    lifted = []

    def walks():
        stance = browser.layer._stance
        lifted.append(stance is not None and not stance.support.contacts.all())
        return place(browser)[0] > 0.03 and any(lifted)

    hold_until(browser, "linear 0 +", walks)
    until_still(graph, browser, "odom")
    wait_until(lambda: browser.layer._stance.support.contacts.all())
    wait_until(lambda: "kept above" in browser.layer._table.content)
    robot = browser.node._robot
    legs = robot._robot.legged

    def feet_drawn():
        poses = browser.page._arm.description.link_poses(browser.page._arm.positions)
        return np.array([poses[f"{leg}_foot"][:3, 3] for leg in legs.leg_names])

    # Odometry and joint states are of two nodes, each with its own clock.
    wait_until(lambda: np.allclose(feet_drawn(), browser.layer._stance.support.feet, atol=1e-3))
    assert browser.layer._stance.margin == pytest.approx(
        browser.layer._stance.support.margin, abs=1e-6
    )


def test_a_gait_is_chosen_and_a_refused_command_is_shown_with_leg_and_joint(graph, browse):
    graph.start(JointTrajectoryControllerNode, robot_description="phantomx")
    walker = graph.start(WalkerNode, robot_description="phantomx", lead=0.6)
    browser = page_of(graph, browse, "phantomx")
    wait_until(browser.node._robot._gaits.get_subscription_count)
    gait = control(browser, "gait")
    browser.set(gait, "gallop")
    wait_until(lambda: "Refused: gait is 'gallop'" in browser.said())
    browser.set(gait, "wave")
    wait_until(lambda: walker._driver._walker.gait == "wave")
    wait_until(lambda: "Gait 'wave': as soon as it stands." in browser.said())
    wait_until(lambda: "wave" in browser.layer._table.content)
    wait_until(browser.node._robot._poses.get_subscription_count)
    roll, move = control(browser, "body roll"), control(browser, "Move trunk")
    for wild in (5.0, -1e300):
        browser.set(roll, wild)
        browser.set(move, True)
        text = f"Refused: body roll is {wild}, expected -0.6 to 0.6 rad"
        wait_until(lambda text=text: text in browser.said())
    browser.set(roll, 0.3)

    def told():
        browser.set(move, True)
        return "tibia" in browser.page._arm.study.sentence

    wait_until(told)
    assert "leg 'RM'" in browser.page._arm.study.sentence
    assert "Pose of the trunk commanded." in browser.said()


def test_the_trunk_is_moved_over_feet_that_stay_and_levelled(graph, browse):
    graph.start(JointTrajectoryControllerNode, robot_description="phantomx")
    graph.start(WalkerNode, robot_description="phantomx", lead=0.6)
    browser = page_of(graph, browse, "phantomx")
    wait_until(browser.node._robot._poses.get_subscription_count)
    hold_until(browser, "angular 2 +", lambda: browser.page._arm.positions["base_heading"] > 0.01)
    until_still(graph, browser, "odom")
    wanted = {"body x": 0.005, "body z": 0.003, "body pitch": 0.02, "body yaw": -0.02}
    for label, value in wanted.items():
        browser.set(control(browser, label), value)

    def reaches(button, z, pitch):
        # On a busy machine the robot may just have been let go: it then takes no pose.
        browser.set(control(browser, button), True)
        at = browser.page._arm.positions
        return abs(at["body_z"] - z) < 1e-6 and abs(at["body_pitch"] - pitch) < 1e-6

    wait_until(lambda: reaches("Move trunk", 0.003, 0.02))
    wait_until(lambda: reaches("Level trunk", 0.0, 0.0))
    assert all(control(browser, label).value == 0.0 for label in wanted)


@pytest.mark.parametrize("how", ["close", "silence", "stop"])
def test_a_page_that_goes_stops_the_base(graph, browse, how):
    graph.start(MobileBaseNode, robot_description="mecanum")
    browser = page_of(graph, browse, "mecanum")
    watching = Browser(browser.node) if how == "stop" else browser
    hold_until(browser, "linear 0 +", lambda: place(browser)[0] > 0.02)
    if how == "close":
        browser.close()
    if how == "stop":
        watching.stop()
        wait_until(lambda: "Commanded to stand." in browser.said())
    wait_until(lambda: not browser.node._robot.jogs)
    graph.receive(
        Odometry, "mobile_base/odometry", 10, lambda message: message.twist.twist.linear.x == 0.0
    )
    if how == "stop":
        watching.close()


def test_what_limits_a_base_is_said_and_its_wheels_are_marked(graph, browse):
    graph.start(MobileBaseNode, robot_description="mecanum")
    browser = page_of(graph, browse, "mecanum")
    arm = browser.page._arm
    commands = graph.client.create_publisher(TwistStamped, "mobile_base/reference", 10)

    def limited():
        command = TwistStamped()
        command.header.stamp = graph.client.get_clock().now().to_msg()
        command.twist.linear.x = command.twist.linear.y = 5.0
        commands.publish(command)
        return "limited by" in arm.study.sentence and arm.faulty_links

    wait_until(limited)
    assert set(arm.faulty_links) <= {f"{name}_link" for name in arm.joints}


def test_without_the_node_of_the_robot_the_page_says_so(graph, browse):
    node = graph.start(RvsNode, robot_description="mecanum", port=0)
    browser = browse(node)
    wait_until(lambda: browser.page._panel is not None)
    wait_until(lambda: "Nothing yet on '/mobile_base/odometry'" in browser.said("state"))
    browser.press()
    browser.hold("linear 0 +")
    wait_until(lambda: "Nobody listens on '/mobile_base/reference'." in browser.said("jog"))
    browser.stop()
    wait_until(lambda: "Stop may have failed: Nobody listens" in browser.said())
    base = graph.start(MobileBaseNode, robot_description="mecanum")
    wait_until(lambda: not browser.said("state"))
    reports = graph.client.create_publisher(DiagnosticArray, "/diagnostics", 10)
    status = DiagnosticStatus(name="mobile_base: motion", message="limited by rear_left")
    status.level = DiagnosticStatus.WARN
    status.values = [KeyValue(key="limited by", value="rear_left")]
    others = DiagnosticStatus(name="mobile_base_2: motion", message="of another")

    def marked():
        reports.publish(DiagnosticArray(status=[status, others]))
        return browser.page._arm.faulty_links == ("rear_left_link",)

    wait_until(marked)
    assert base is not None


def test_wheels_turn_on_the_page_while_odometry_is_silent(graph, browse):
    node = graph.start(RvsNode, robot_description="mecanum", port=0)
    browser = browse(node)
    odometry = graph.client.create_publisher(Odometry, "mobile_base/odometry", 10)
    states = graph.client.create_publisher(JointState, "joint_states", 10)
    names = list(node._robot._feed._joints)

    def drawn(angle):
        states.publish(JointState(name=names, position=[angle] * len(names)))
        # More seldom than the page is drawn.
        time.sleep(0.2)
        return browser.page._arm.positions[names[0]] == angle

    def placed():
        odometry.publish(Odometry())
        return drawn(0.5)

    wait_until(placed)
    for angle in (0.75, 1.0, 1.25):
        wait_until(lambda angle=angle: drawn(angle))


WILD = ["joint 0 + 1 1", "linear 2 + 1 1", "angular 0 - 1 1", "linear 0 + 1", "nan", ["x"]]


@pytest.mark.parametrize("text", WILD)
def test_wild_jogs_are_refused(graph, browse, text):
    graph.start(MobileBaseNode, robot_description="omni")
    browser = page_of(graph, browse, "omni")
    browser.set(browser.layer._pads[0].handle, text)
    wait_until(lambda: "Refused" in browser.said())
    assert not browser.node._robot.jogs and not place(browser).any()


def test_an_arm_is_drawn_on_its_floating_base(graph, browse):
    graph.start(JointTrajectoryControllerNode, robot_description="canadarm2")
    browser = browse(graph.start(RvsNode, robot_description="canadarm2", port=0))
    wait_until(lambda: not browser.said("state") and browser.layer._goal._robot is not None)
    q = browser.layer._goal._robot.copy()
    point = JointTrajectoryPoint(positions=(q + [0.4, 0.3, 0, 0, 0, 0, 0]).tolist())
    point.time_from_start.sec = 12
    names = list(browser.page._arm.chain.joint_names)
    topic = "joint_trajectory_controller/joint_trajectory"
    sender = graph.client.create_publisher(JointTrajectory, topic, 10)
    wait_until(sender.get_subscription_count)
    sender.publish(JointTrajectory(joint_names=names, points=[point]))
    wait_until(lambda: np.allclose(browser.layer._goal._robot, point.positions, atol=1e-6))
    odometry = graph.receive(Odometry, "odom", 10, lambda _: True)
    T = matrix_from_pose(odometry.pose.pose)
    assert np.abs(T - np.eye(4)).max() > 0.02
    # Robot, goal, ghosts and gizmo hang below these three nodes.
    stage = browser.page._stage
    for node in (stage._robot.node, stage._arm.node, stage._base_node):
        wait_until(lambda node=node: np.allclose(node.position, T[:3, 3], atol=1e-9))
        w, *xyz = node.wxyz
        np.testing.assert_allclose(matrix_from_quaternion([*xyz, w]), T[:3, :3], atol=1e-9)
    seen = visible_points(stage._seen, [browser.page._arm.positions])
    around = all_points(browser.page._layers[0]._context)
    np.testing.assert_allclose(around[: len(seen)], seen @ T[:3, :3].T + T[:3, 3], atol=1e-9)


def test_a_floating_base_without_odometry_is_told(graph, browse):
    graph.start(JointTrajectoryControllerNode, robot_description="canadarm2", floating_base="never")
    node = graph.start(RvsNode, robot_description="canadarm2", floating_base="always", port=0)
    browser = browse(node)
    told = "Nothing yet on '/odom': the pose of the floating base is unknown."
    wait_until(lambda: told in browser.said("state"))
