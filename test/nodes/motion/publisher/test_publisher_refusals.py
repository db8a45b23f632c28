"""Rejected trajectories are reported with code and text, and the publisher goes on."""

import time

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from drivers import ended
from rcl_interfaces.msg import Log
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from std_srvs.srv import Trigger
from trajectory_msgs.msg import JointTrajectory

from robomech_interfaces.msg import ErrorCode
from robomech_ros.errors import RobomechError
from robomech_ros.nodes.common.messages.rejection_status import (
    Refusal,
    refusal_values,
    trajectory_label,
)
from robomech_ros.nodes.trajectory_publisher.controller_client import ControllerRefusals
from robomech_ros.nodes.trajectory_publisher.node import TrajectoryPublisherNode

MOVE = np.array([0.05, -0.05, 0.05, 0.0, 0.05, -0.05])
TIMEOUT = 30.0
JOINTS = ("waist", "shoulder", "elbow", "wrist_roll", "wrist_bend", "wrist_swivel")


def no_joints(trajectory):
    trajectory.joint_names = []
    for point in trajectory.points:
        point.positions = point.velocities = point.accelerations = []


def five_joints(trajectory):
    trajectory.joint_names = JOINTS[:5]
    for point in trajectory.points:
        point.positions = point.positions[:5]
        point.velocities = point.accelerations = []


def unknown_joint(trajectory):
    trajectory.joint_names[5] = "thumb"


def facts(status):
    return {entry.key: entry.value for entry in status.values}


def unchanged(trajectory):
    """Return the trajectory as it is; the numbers are wrong."""


CASES = {
    "far start": (0.5, 0.0, 0.2, unchanged, 221, "starts with joint 'waist' at 0.5"),
    "too fast": (0.0, MOVE, 0.01, unchanged, 213, "velocity of joint '"),
    "nan": (0.0, MOVE * np.nan, 0.2, unchanged, 104, "points[1].positions of joint 'waist' is nan"),
    "unknown joint": (0.0, MOVE, 0.2, unknown_joint, 107, "joint states of waist, shoulder"),
    "missing joint": (0.0, MOVE, 0.2, five_joints, 108, "missing: wrist_swivel"),
    "no joints": (0.0, MOVE, 0.2, no_joints, 108, "joint_names has size 0"),
}


def test_execute_says_what_is_wrong(suite):
    arm = suite(controller_timeout=1.0)
    for case, (start, goal, duration, change, code, text) in CASES.items():
        trajectory = arm.trajectory(start, goal, duration)
        change(trajectory)
        answer = arm.execute(trajectory)
        assert answer.error_code == code, (case, answer.error_msg)
        assert text in answer.error_msg, case
    assert arm.execute(arm.trajectory(0.0, MOVE)).error_code == ErrorCode.NONE


def test_joints_are_checked_at_once_where_the_robot_is_known(suite):
    arm = suite(robot_description="puma560")
    trajectory = arm.trajectory(0.0, MOVE)
    unknown_joint(trajectory)
    answer = arm.execute(trajectory)
    assert answer.error_code == ErrorCode.UNKNOWN_JOINT
    assert "unknown joint 'thumb'" in answer.error_msg and "wrist_swivel" in answer.error_msg


@pytest.mark.slow
def test_the_node_serves_while_it_waits(suite):
    arm = suite()
    slow = arm.start_execute(arm.trajectory(0.0, MOVE, duration=2.5))
    arm.until_moving()
    refused = arm.execute(arm.trajectory(0.0, MOVE, names=["waist"] * 6))
    assert refused.error_code == ErrorCode.WRONG_SIZE
    assert "'waist' is repeated" in refused.error_msg
    assert not slow.done()
    arm.until_at(arm.home + MOVE)
    assert ended(slow).error_code == ErrorCode.NONE


def test_execute_without_a_controller(suite):
    arm = suite(with_controller=False, controller_timeout=0.3)
    answer = arm.execute(arm.trajectory(0.0, MOVE))
    assert answer.error_code == ErrorCode.REJECTED
    assert "'/joint_trajectory_controller/execute_trajectory' not there" in answer.error_msg
    assert answer.duration.sec == answer.duration.nanosec == 0


def test_a_plan_refused_by_the_controller_is_reported(suite):
    """Without what the controller says on /diagnostics it was said not to move, 1 s later."""
    arm = suite(standstill_timeout=TIMEOUT, arrival_timeout=TIMEOUT)
    reason = (
        "at t = 0.005 s the velocity of joint 'shoulder' is -9.375 rad/s, over its limit -2 rad/s "
        "by 7.37 rad/s"
    )
    expected = f"trajectory failed (213 LIMIT): {reason}"
    arm.plan(0.0, MOVE, duration=0.01)
    latched = QoSProfile(depth=100, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    arm.graph.receive(Log, "/rosout", latched, lambda line: line.msg == expected)
    # The same plan again gets a refusal of its own.
    for count in ("2", "3"):
        arm.plan(0.0, MOVE, duration=0.01)
        failed = arm.condition(lambda status, n=count: facts(status)["failed"] == n)
        assert failed.message == f"idle; {reason}"
    # A refusal of somebody else's trajectory is not ours.
    arm.plan(0.0, 3 * MOVE, duration=2.0)
    waiting = arm.start_execute()
    arm.until_moving()
    foreign = arm.graph.client.create_publisher(
        JointTrajectory, "joint_trajectory_controller/joint_trajectory", 10
    )
    arm.until(foreign.get_subscription_count)
    foreign.publish(arm.trajectory(0.0, MOVE, names=["thumb"] * 6))
    arm.controller_condition(lambda status: "thumb" in status.message)
    assert ended(waiting).error_code == ErrorCode.NONE


def test_the_first_refusal_of_a_controller_that_was_started_again(graph):
    """It counts from the beginning: a refusal with a number known from before was passed over."""
    found = []
    node = Node("listener", context=graph.context)
    refusals = ControllerRefusals(node, "arm", lambda _, code, text: found.append((code, text)))
    message = JointTrajectory(joint_names=["a"])
    label = trajectory_label(message)

    def status(*refusal):
        values = refusal_values(Refusal(*refusal))
        entries = [KeyValue(key=key, value=str(value)) for key, value in values.items()]
        return DiagnosticArray(status=[DiagnosticStatus(name="arm: motion", values=entries)])

    refusals.expect(None, message)
    refusals._take(status(1, 213, "too fast", label, "first run"))
    refusals.expect(None, message)
    # The same status again, as once a second, is no answer to what was sent since.
    refusals._take(status(1, 213, "too fast", label, "first run"))
    assert found == [(213, "too fast")]
    refusals._take(status(1, 221, "too far", label, "second run"))
    assert found == [(213, "too fast"), (221, "too far")]
    node.destroy_node()


def test_who_publishes_best_effort_is_told(suite):
    arm = suite()
    sender = Node("hasty", context=arm.graph.context)
    qos = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
    sender.create_publisher(JointTrajectory, "joint_trajectory_controller/joint_trajectory", qos)
    expected = "messages on '/joint_trajectory_controller/joint_trajectory' by /hasty do not arrive"
    latched = QoSProfile(depth=100, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    arm.graph.receive(Log, "/rosout", latched, lambda line: expected in line.msg)
    sender.destroy_node()


@pytest.mark.slow
def test_a_motion_stopped_by_hold_is_reported_at_once(suite):
    arm = suite()
    arm.plan(0.0, 5 * MOVE, duration=10.0)
    waiting = arm.start_execute()
    arm.until_moving()
    arm.until(lambda: np.abs(arm.position - arm.home).max() > 0.02)
    arm.graph.call(Trigger, "joint_trajectory_controller/hold", Trigger.Request())
    arm.until(waiting.done)
    answer = waiting.result()
    assert answer.error_code == ErrorCode.PREEMPTED, answer.error_msg
    assert "the robot stands for" in answer.error_msg
    assert "it was stopped" in answer.error_msg
    assert "off its goal" in answer.error_msg
    assert answer.duration.sec < 10


def test_a_bad_plan_is_reported_and_the_next_one_executed(suite):
    arm = suite()
    arm.plan(0.0, MOVE + np.inf)
    status = arm.condition(lambda status: "waist" in status.message)
    assert status.level == status.WARN
    assert "points[1].positions of joint 'waist' is inf" in status.message
    arm.plan(0.0, MOVE)
    arm.until_at(arm.home + MOVE)
    arm.condition(lambda status: status.message == "idle")


def test_a_full_queue_is_reported(suite):
    arm = suite(with_controller=False, queue_size=2)
    for _ in range(3):
        arm.plan(0.0, MOVE)
    assert arm.value("waiting", lambda status: "the queue is full" in status.message) == "2"


def test_a_flood_of_plans(suite):
    arm = suite(with_controller=False, controller_timeout=0.3)
    plan = arm.trajectory(0.0, MOVE)
    for _ in range(1000):
        arm._planned.publish(plan)
        time.sleep(0.001)
    said = "the queue is full, with 50 waiting; send it again later"
    refused = ("last refusal", said)
    full = arm.condition(lambda status: refused in [(v.key, v.value) for v in status.values])
    assert ("waiting", "50") in [(value.key, value.value) for value in full.values]
    # It still serves, and those who ask are told.
    answer = arm.execute(plan)
    assert (answer.error_code, answer.error_msg) == (ErrorCode.REJECTED, said)
    arm.start_controller()
    arm.until_at(arm.home + MOVE)


def test_too_many_points(suite):
    arm = suite(with_controller=False, max_points=20)
    trajectory = arm.trajectory(0.0, MOVE)
    trajectory.points *= 11
    answer = arm.execute(trajectory)
    assert answer.error_code == ErrorCode.WRONG_SIZE
    assert answer.error_msg == "points has size 22, expected at most 20"


@pytest.mark.slow
def test_stopping_answers_those_who_wait(suite):
    arm = suite()
    waiting = arm.start_execute(arm.trajectory(0.0, MOVE, duration=2.5))
    arm.until_moving()
    arm.node.executor.create_task(arm.node.stop)
    arm.until(waiting.done)
    assert waiting.result().error_code == ErrorCode.REJECTED
    assert "shuts down" in waiting.result().error_msg
    # The motion goes on to its end.
    arm.until_at(arm.home + MOVE)


@pytest.mark.parametrize(
    ("parameters", "text"),
    [
        ({"transport": "pigeon"}, "'transport' is 'pigeon'; allowed is one of 'topic', 'action'"),
        ({"queue_size": 0}, "'queue_size' is 0"),
        ({"robot_description": "puma650"}, "did you mean 'puma560'"),
    ],
)
def test_bad_parameters(graph, parameters, text):
    with pytest.raises(RobomechError, match=text):
        graph.start(TrajectoryPublisherNode, **parameters)
