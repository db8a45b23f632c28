"""Rolling robots and walking machines as RViz would see them: description, frames and joints."""

import pytest
from diagnostic_msgs.msg import DiagnosticArray
from display_cases import (
    LATCHED,
    LIFT,
    PinocchioRobot,
    StatePublisher,
    pose_of,
    poses_in_root as chained,
)
from geometry_msgs.msg import Twist
from numpy.testing import assert_allclose
from sensor_msgs.msg import JointState
from std_msgs.msg import String
from twist_driver import Driver

from robomech_ros.nodes.joint_trajectory_controller.node import JointTrajectoryControllerNode
from robomech_ros.nodes.mobile_base.drives import INTERFACES
from robomech_ros.nodes.mobile_base.node import MobileBaseNode
from robomech_ros.nodes.walker.node import WalkerNode
from robomech_ros.robots import load_description
from robomech_ros.rolling import list_rolling, rolling_robot
from robomech_ros.walking import load_legged

# Wheels that look anywhere, with rollers of all angles, and names that are taken or need care.
ODD = """
kind: rolling
name: odd & <own>
source: this test
drive: omni
wheels:
  - {name: base, kind: omni, position: [0.3, 0.2], radius: 0.1, heading: 0.4, roller: 0.3}
  - {name: 'grö"ße', kind: omni, position: [-0.3, 0.25], radius: 0.07, heading: -1.9, roller: -0.5}
  - {name: a<&b, kind: omni, position: [-0.1, -0.35], radius: 0.05, heading: 2.9, roller: 1.2}
  - {name: odom, kind: caster, position: [0.2, -0.2], radius: 0.03, trail: 0.02, heading: 1.0}
"""
SKID = {
    "drive": "diff",
    "left_wheel_names": ["a", "b"],
    "right_wheel_names": ["c", "d"],
    "wheel_separation": 0.4,
    "wheel_radius": 0.1,
    "left_wheel_radius_multiplier": 0.9,
}
# Of its steered wheel joint_states has no joint that rolls.
TRICYCLE = {
    "drive": "tricycle",
    "traction_joints_names": ["rear_right", "rear_left"],
    "steering_joints_names": ["front"],
    "wheelbase": 1.2,
    "traction_track_width": 0.8,
    "traction_wheels_radius": 0.15,
}
BASES = {name: {"robot_description": name} for name in list_rolling()}
BASES |= {"odd": {"robot_description": ODD}, "skid": SKID, "tricycle of parameters": TRICYCLE}


def drive_of(given):
    return given.get("drive") or rolling_robot(given["robot_description"]).drive


def started(graph, given, **more):
    """Start a base that drives in a bend, and note its joint states by their stamps."""
    states = {}

    def take(message):
        states[message.header.stamp.sec, message.header.stamp.nanosec] = message

    graph.client.create_subscription(JointState, "joint_states", take, 1000)
    node = graph.start(MobileBaseNode, reference_timeout=1.0, **given, **more)
    Driver(graph, INTERFACES[drive_of(given)].command.replace("~", "mobile_base")).command(
        0.3, 0.05, 0.3
    )
    return node, states


def described(graph):
    return graph.receive(String, "robot_description", LATCHED, lambda message: message.data).data


def joints_of(robot):
    return {name for name in robot.model.names if name != "universe"}


def frames_at_a_state(listener, states, links, far):
    """Wait for frames of links with the stamp of a joint state in which a joint is far."""
    found = []

    def there():
        for message in reversed(listener.moving):
            entries = {entry.child_frame_id: entry for entry in message.transforms}
            if not entries.keys() <= links:
                continue
            when = message.transforms[0].header.stamp
            state = states.get((when.sec, when.nanosec))
            if state is not None and max(map(abs, state.position)) > far:
                found[:] = entries, state
                return True
        return False

    listener.until(there)
    return found


@pytest.mark.parametrize("name", BASES)
def test_wheels_are_where_pinocchio_has_them_in_the_description(graph, listener, name):
    _, states = started(graph, BASES[name])
    text = described(graph)
    robot = PinocchioRobot(text)
    moving, state = frames_at_a_state(listener, states, robot.links - {"base_link"}, 1.5)
    assert joints_of(robot) == set(state.name)
    frames = {child: e for child, e in listener.latest().items() if child in robot.links}
    placing = frames.pop("base_link", None)
    frames |= moving
    assert frames.keys() == robot.links - {"base_link"}
    expected = robot.poses(dict(zip(state.name, state.position, strict=True)))
    found = chained(frames)
    for link, pose in expected.items():
        assert_allclose(found[link], pose, atol=1e-12)
    # Where the base is comes from odometry alone, on the topic of its drive.
    assert (placing is None) == (INTERFACES[drive_of(BASES[name])].frames != "/tf")
    assert placing is None or placing.header.frame_id == "odom"
    assert load_description(text).root == "base_link"


def test_odometry_and_wheels_share_tf_and_others_are_given_way_to(graph, listener):
    """Also for a base whose odometry is on /tf: its own publisher there is nobody else."""
    started(graph, BASES["differential"])
    listener.until_said("/tf: nobody else publishes frames of differential: this node does, all 4")
    tree = load_description(described(graph))
    edges = {joint.child: joint.parent for joint in tree.joints}
    graph.start(lambda **given: StatePublisher(tree.document, edges, [*edges], **given))
    # In any order.
    news = (
        "/tf: all 4 frames of differential come from /robot_state_publisher, not from here",
        "'/robot_description' comes from /robot_state_publisher, not from here",
    )
    listener.until(lambda: {*news} <= {log.msg for log in listener.logs})
    found = listener.frames()
    assert found.keys() == {*edges, "base_link"}
    assert {entry.header.frame_id for entry in found["base_link"]} == {"odom"}
    places = {joint.child: joint.origin[2, 3] for joint in tree.joints}
    for child in edges:
        lifts = {round(pose_of(entry)[2, 3] - places[child], 9) for entry in found[child]}
        assert lifts == {LIFT}


def test_each_of_two_bases_has_its_description_and_its_frames(graph, listener):
    for side in ("left", "right"):
        graph.start(MobileBaseNode, namespace=side, robot_description="omni", base_frame_id="hub")
    wheels = {f"{side}/wheel_{i}_link" for side in ("left", "right") for i in (1, 2, 3)}
    listener.until(lambda: wheels <= listener.latest().keys())
    for child in wheels:
        assert listener.latest()[child].header.frame_id == f"{child.split('/')[0]}/hub"
    for side in ("left", "right"):
        text = graph.receive(String, f"{side}/robot_description", LATCHED, lambda m: m.data).data
        assert load_description(text).root == "hub"
        # Without the prefix, which RViz and robot_state_publisher put in front.
        assert f"{side}/" not in text


@pytest.mark.parametrize(
    ("given", "shown"),
    [
        ({"publish_frames": "never", "publish_description": False}, (False, False)),
        ({"publish_frames": "never"}, (False, True)),
        ({"enable_odom_tf": False}, (False, True)),
        ({"publish_frames": "always", "enable_odom_tf": False}, (True, True)),
    ],
)
def test_what_is_not_wanted_is_not_published(graph, listener, given, shown):
    node = graph.start(MobileBaseNode, robot_description="mecanum", **given)
    if shown[1]:
        described(graph)
    if shown[0]:
        listener.until(lambda: "front_left_link" in listener.latest())
    # By then, a second after the start, a description would have been published, too.
    graph.receive(DiagnosticArray, "/diagnostics", 10, lambda m: True)
    topics = {publisher.topic_name for publisher in node.publishers}
    assert ("/tf" in topics, "/robot_description" in topics) == shown


def test_a_base_that_no_urdf_describes_drives_all_the_same(graph, listener):
    text = ODD.replace("name: base,", f"name: {'b' * 300},")
    started(graph, {"robot_description": text})
    listener.until_said("no robot_description and no frames of wheels: ")
    graph.receive(JointState, "joint_states", 10, lambda m: max(map(abs, m.position)) > 0.5)


@pytest.mark.parametrize("name", ["phantomx", "go1"])
def test_a_walking_machine_is_shown_by_its_controller_and_placed_by_the_walker(
    graph, listener, name
):
    states = {}

    def take(message):
        states[message.header.stamp.sec, message.header.stamp.nanosec] = message

    graph.client.create_subscription(JointState, "joint_states", take, 1000)
    graph.start(JointTrajectoryControllerNode, robot_description=name)
    graph.start(WalkerNode, robot_description=name, lead=0.6)
    publisher = graph.client.create_publisher(Twist, "cmd_vel_unstamped", 10)
    graph.client.create_timer(0.05, lambda: publisher.publish(Twist()))
    robot = PinocchioRobot(described(graph))
    root = load_legged(name).trunk
    listener.until(lambda: robot.links <= listener.latest().keys())
    moving, state = frames_at_a_state(listener, states, robot.links - {root}, 0.1)
    assert joints_of(robot) == set(state.name)
    frames = {child: e for child, e in listener.latest().items() if child in robot.links}
    assert frames.pop(root).header.frame_id == "odom"
    frames |= moving
    expected = robot.poses(dict(zip(state.name, state.position, strict=True)))
    found = chained(frames)
    assert found.keys() == expected.keys() == robot.links
    for link, pose in expected.items():
        assert_allclose(found[link], pose, atol=1e-12)
