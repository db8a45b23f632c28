"""Bytes that are no message of their topic's type disturb nobody."""

import struct

import pytest
from control_msgs.msg import JointJog
from geometry_msgs.msg import TwistStamped
from raw_writer import RawWriter
from rclpy.serialization import serialize_message
from sensor_msgs.msg import JointState
from trajectory_msgs.msg import JointTrajectory
from waiting import until

from robomech_interfaces.msg import ErrorCode
from robomech_interfaces.srv import AnalyzeSingularity, SolveIK
from robomech_ros.nodes.joint_trajectory_controller.node import JointTrajectoryControllerNode
from robomech_ros.nodes.kinematics.node import KinematicsNode
from robomech_ros.nodes.middleware.polled_subscription import UnreadableMessageError, unpack
from robomech_ros.nodes.servo.node import ServoNode
from robomech_ros.robots import load_robot

ROBOT = "puma560"
WHOLE = serialize_message(
    JointState(name=["waist", "shoulder"], position=[1.0, 2.0], velocity=[0.0, 0.0])
)
CORRUPT = {
    "nothing": b"",
    "one byte": b"\x00",
    "cut": WHOLE[: len(WHOLE) // 2],
    "no such encoding": b"\xff" * 64,
    "two thousand million names": WHOLE[:20] + struct.pack("<I", 2**31 - 1) + WHOLE[24:],
}


@pytest.mark.parametrize("what", CORRUPT)
def test_unpacking_says_what_came(what):
    data = CORRUPT[what]
    with pytest.raises(UnreadableMessageError, match=f"^{len(data)} bytes are no message of the"):
        unpack(data, JointState)


def flood(graph, kind, topic):
    """Send all kinds of corrupt bytes, some times, to whoever listens there."""
    publisher = graph.client.create_publisher(kind, topic, 100)
    until(publisher.get_subscription_count, f"nobody listens to {topic}")
    for data in 5 * list(CORRUPT.values()):
        publisher.publish(data)
    return publisher


def test_requests_that_need_the_joint_state_are_answered_beside_them(graph):
    graph.start(KinematicsNode, robot_description=ROBOT)
    publisher = flood(graph, JointState, "joint_states")
    names = list(load_robot(ROBOT).joint_names)
    publisher.publish(JointState(name=names, position=[0.1] * 6))
    for data in CORRUPT.values():
        publisher.publish(data)
    answer = graph.ask(AnalyzeSingularity, "kinematics/analyze_singularity")
    assert answer.error_code == ErrorCode.NONE, answer.error_msg


def test_the_reason_names_them_where_nothing_else_came(graph):
    graph.start(KinematicsNode, robot_description=ROBOT, state_timeout=0.2)
    flood(graph, JointState, "joint_states")
    answer = graph.ask(AnalyzeSingularity, "kinematics/analyze_singularity")
    assert answer.error_code == ErrorCode.NO_STATE
    assert "bytes are no message of the type JointState" in answer.error_msg


def test_corrupt_requests_do_not_keep_others_waiting(graph):
    graph.start(KinematicsNode, robot_description=ROBOT)
    request = SolveIK.Request()
    assert graph.call(SolveIK, "kinematics/solve_ik", request).error_code
    writer = RawWriter(graph.client, SolveIK, "/kinematics/solve_ik")
    until(writer.readers, "the service does not read from here")
    sent = [writer.write(data) for data in 20 * list(CORRUPT.values())]
    assert sum(sent) >= 60
    for _ in range(3):
        assert graph.call(SolveIK, "kinematics/solve_ik", request).error_code
    writer.close()


def test_commands_of_robot_and_servo_go_on(graph):
    graph.start(JointTrajectoryControllerNode, robot_description=ROBOT)
    graph.start(ServoNode, robot_description=ROBOT)
    flood(graph, JointTrajectory, "joint_trajectory_controller/joint_trajectory")
    for kind, topic in (
        (TwistStamped, "delta_twist_cmds"),
        (JointState, "joint_velocity_cmds"),
        (JointJog, "delta_joint_cmds"),
    ):
        publisher = flood(graph, kind, f"servo/{topic}")
    names = list(load_robot(ROBOT).joint_names)
    jog = JointJog(joint_names=names[:1], velocities=[0.3])
    moved = []

    def command_until_it_moves(state):
        jog.header.stamp = graph.client.get_clock().now().to_msg()
        publisher.publish(jog)
        moved.append(state.position[0])
        return abs(moved[-1] - moved[0]) > 0.02

    graph.receive(JointState, "joint_states", 10, command_until_it_moves)
