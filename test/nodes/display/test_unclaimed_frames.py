"""/tf where others publish frames, too: those of the robot come from one place only."""

import numpy as np
import pytest
from display_cases import LATCHED, LIFT, StatePublisher, pose_of, poses_in_root
from geometry_msgs.msg import TransformStamped
from tf2_msgs.msg import TFMessage

from robomech_ros.nodes.joint_trajectory_controller.node import JointTrajectoryControllerNode
from robomech_ros.robots import load_description, load_robot

UR5E = load_description("ur5e")
EDGES = {joint.child: joint.parent for joint in UR5E.joints}
MOVING = [joint.child for joint in UR5E.joints if joint.moves]


def other(graph, edges=EDGES, moving=MOVING, **options):
    """Start somebody else who publishes frames of the UR5e."""
    return graph.start(
        lambda **given: StatePublisher(UR5E.document, edges, moving, **options, **given)
    )


def stop(graph, node):
    graph.client.executor.create_task(node.destroy_node)


def lifts(frames):
    """Return how far frames are lifted, which is the mark of the other one."""
    home = dict(zip(load_robot("ur5e").joint_names, load_robot("ur5e").home(), strict=True))
    poses = UR5E.link_poses(home)
    found = {}
    for child, entries in frames.items():
        step = np.linalg.inv(poses[EDGES[child]]) @ poses[child]
        found[child] = {round(pose_of(e)[2, 3] - step[2, 3], 6) for e in entries}
    return found


def test_who_was_there_first_goes_on_alone(graph, robot, listener):
    other(graph)
    robot(robot_description="ur5e")
    count = len(UR5E.joints)
    listener.until_said(f"/tf: all {count} frames of ur5e come from /robot_state_publisher")
    assert lifts(listener.frames()) == {child: {LIFT} for child in MOVING}
    for message in listener.fixed:
        assert lifts({e.child_frame_id: [e] for e in message.transforms}) == {
            e.child_frame_id: {LIFT} for e in message.transforms
        }


def test_who_comes_later_takes_over_and_gives_back(graph, robot, listener):
    robot(robot_description="ur5e")
    listener.until_said(
        f"/tf: nobody else publishes frames of ur5e: this node does, all {len(EDGES)}"
    )
    listener.until(lambda: listener.moving)
    assert lifts(listener.frames()) == {child: {0.0} for child in MOVING}
    comer = other(graph)
    listener.until_said(f"/tf: all {len(EDGES)} frames of ur5e come from /robot_state_publisher")
    assert lifts(listener.frames()) == {child: {LIFT} for child in MOVING}
    listener.fixed.clear()
    stop(graph, comer)
    listener.until_said("/tf: nobody else publishes frames of ur5e: this node does")
    listener.until(lambda: listener.fixed)
    assert lifts(listener.frames()) == {child: {0.0} for child in MOVING}
    fixed = {entry.child_frame_id: [entry] for entry in listener.fixed[-1].transforms}
    assert lifts(fixed) == {child: {0.0} for child in EDGES if child not in MOVING}


def test_who_falls_silent_gives_back_too(graph, robot, listener):
    """A process that is killed stays in the graph for up to 20 s."""
    comer = other(graph)
    robot(robot_description="ur5e")
    listener.until_said("come from /robot_state_publisher")
    comer._moving = []
    listener.until_said("the others from here")
    assert lifts(listener.frames()) == {child: {0.0} for child in MOVING}


def test_frames_that_others_publish_are_left_to_them_one_by_one(graph, robot, listener):
    """A calibrated camera, and a driver that knows one joint better."""
    robot(robot_description="ur5e")
    listener.until_said("nobody else")
    hand = {child: EDGES[child] for child in ("tool0", "wrist_3_link")}
    other(graph, edges=hand, moving=["wrist_3_link"], describe=False)
    listener.until_said("tool0, wrist_3_link; the others from here")
    found = lifts(listener.frames())
    assert found == {child: {LIFT if child in hand else 0.0} for child in MOVING}
    assert "tool0" not in {entry.child_frame_id for entry in listener.fixed[-1].transforms}


def test_frames_of_others_that_are_none_of_the_robot_do_not_matter(graph, robot, listener):
    mount = TransformStamped(child_frame_id=UR5E.root)
    mount.header.frame_id = "world"
    publisher = graph.client.create_publisher(TFMessage, "/tf", 10)
    fixed = graph.client.create_publisher(TFMessage, "/tf_static", LATCHED)
    fixed.publish(TFMessage(transforms=[mount]))

    def publish():
        mount.header.stamp = graph.client.get_clock().now().to_msg()
        publisher.publish(TFMessage(transforms=[mount]))

    graph.client.create_timer(0.02, publish)
    robot(robot_description="ur5e")
    listener.until_said("/tf: nobody else publishes frames of ur5e")
    listener.until(lambda: len(listener.latest()) > len(EDGES))
    assert set(listener.frames()) == {*MOVING, UR5E.root}


def test_topics_may_be_those_of_the_namespace(graph, listener):
    """As `bringup --ros-args -r /tf:=tf` has it."""
    remaps = ["--ros-args", "-r", "/tf:=tf", "-r", "/tf_static:=tf_static"]

    def remapped(**options):
        return JointTrajectoryControllerNode(cli_args=remaps, **options)

    for side in ("left", "right"):
        graph.start(remapped, namespace=side, robot_description="ur5e")
        listener.until_said(f"/{side}/tf: nobody else publishes frames of ur5e")
    for side in ("left", "right"):
        moving = graph.receive(TFMessage, f"{side}/tf", 100, lambda message: True)
        fixed = graph.receive(TFMessage, f"{side}/tf_static", LATCHED, lambda message: True)
        found = [*moving.transforms, *fixed.transforms]
        assert {entry.child_frame_id for entry in found} == set(EDGES)
    assert not listener.moving and not listener.fixed


def test_bytes_that_are_no_frames_harm_nobody(graph, robot, listener):
    fixed = graph.client.create_publisher(TFMessage, "/tf_static", LATCHED)
    fixed.publish(b"\x00\x01\x00\x00\xff\xff\xff\x00\x01\x02\x03\x04")
    moving = graph.client.create_publisher(TFMessage, "/tf", 10)
    bad = b"\x00\x01\x00\x00\x01\x00\x00\x00\xff\xff\xff\xff\x01\x02\x03\x04"
    graph.client.create_timer(0.05, lambda: moving.publish(bad))
    robot(robot_description="ur5e")
    listener.until_said("passed over on '/tf")
    listener.until_said("/tf: nobody else publishes frames of ur5e")


@pytest.mark.parametrize("wanted", ["always", "never"])
def test_always_and_never_look_at_nobody(graph, robot, listener, wanted):
    other(graph)
    robot(robot_description="ur5e", publish_frames=wanted)
    listener.until(lambda: len(listener.moving) > 50)
    expected = {0.0, LIFT} if wanted == "always" else {LIFT}
    assert lifts(listener.frames()) == dict.fromkeys(MOVING, expected)


def test_two_robots_in_two_namespaces_have_two_trees(graph, listener):
    postures = {"scara": [0.1, 0.2, 0.15, -0.4], "ur5e": [-0.5, 0.6, -0.7, 0.8, 0.9, -1.0]}
    sides = {"left": "scara", "right": "ur5e"}
    for side, name in sides.items():
        graph.start(
            JointTrajectoryControllerNode,
            namespace=side,
            robot_description=name,
            frame_prefix=f"{side}/",
            initial_positions=postures[name],
        )
    for _ in sides:
        listener.until_said("/tf: nobody else publishes frames of")
    wanted = {
        f"{side}/{joint.child}"
        for side, name in sides.items()
        for joint in load_description(name).joints
    }
    listener.until(lambda: wanted <= listener.latest().keys())
    frames = listener.latest()
    for side, name in sides.items():
        own = {child: entry for child, entry in frames.items() if child.startswith(f"{side}/")}
        found = poses_in_root(own, f"{side}/")
        positions = dict(zip(load_robot(name).joint_names, postures[name], strict=True))
        for link, pose in load_description(name).link_poses(positions).items():
            np.testing.assert_allclose(found[link], pose, atol=1e-12)


def test_two_robots_with_the_same_frames_are_told_apart_in_the_log(graph, listener):
    for side in ("left", "right"):
        graph.start(JointTrajectoryControllerNode, namespace=side, robot_description="ur5e")
    hint = "set frame_prefix (bringup --namespace does)"
    listener.until(
        lambda: (
            any(hint in log.msg for log in listener.logs)
            and any("this node does" in log.msg for log in listener.logs)
        )
    )
