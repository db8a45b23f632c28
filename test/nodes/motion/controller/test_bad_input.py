"""Floods, giants, and controllers that die: nothing moves that should not."""

import signal
import time

import numpy as np
import pytest
from action_msgs.msg import GoalStatus
from drivers import NAME, ROBOT, TIMEOUT, Driver, Suite, ended
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from robomech_interfaces.msg import ErrorCode
from robomech_ros.nodes.joint_trajectory_controller.node import JointTrajectoryControllerNode
from robomech_ros.nodes.trajectory_publisher.node import TrajectoryPublisherNode
from robomech_ros.robots import load_robot

# The waist goes farthest, so that it is the joint that errors name.
MOVE = np.array([0.12, -0.05, 0.08, 0.0, 0.1, -0.1])
COUNT = 100_000


def assert_no_jump(arm, since=0):
    """No joint moved farther between two states than it can at its speed."""
    times, positions, _ = arm.path(since)
    steps = np.abs(np.diff(positions, axis=0))
    assert (steps <= arm.chain.velocity * (np.diff(times) + 0.03)[:, None]).all()


@pytest.fixture(scope="module")
def long_trajectory():
    """100,000 points from where the robot is at its start, in 2 s."""
    chain = load_robot(ROBOT)
    message = JointTrajectory(joint_names=list(chain.joint_names))
    points = np.linspace(chain.home(), chain.home() + MOVE, COUNT)
    for k, row in enumerate(points.tolist()):
        point = JointTrajectoryPoint(positions=row)
        point.time_from_start.sec, point.time_from_start.nanosec = divmod(k * 20_000, 10**9)
        message.points.append(point)
    return message


def test_a_hundred_thousand_points_are_too_many_by_default(arm, long_trajectory):
    start = arm.position
    status, result = arm.execute(long_trajectory)
    assert (status, result.error_code) == (GoalStatus.STATUS_ABORTED, ErrorCode.WRONG_SIZE)
    assert result.error_msg == "points has size 100000, expected at most 10000"
    np.testing.assert_array_equal(arm.position, start)
    assert arm.execute(arm.trajectory((0.3, MOVE)))[0] == GoalStatus.STATUS_SUCCEEDED


@pytest.mark.slow
def test_a_hundred_thousand_points_are_executed_where_they_may_be(drive, long_trajectory):
    arm = drive(max_points=COUNT)
    start = arm.position
    assert arm.execute(long_trajectory)[0] == GoalStatus.STATUS_SUCCEEDED
    arm.until_at(start + MOVE)
    assert_no_jump(arm)


@pytest.mark.slow
def test_a_flood_of_replacements(arm):
    start, since = arm.position, len(arm.states)
    before, last = arm.send(arm.trajectory((20.0, MOVE))), None
    for k in range(1000):
        goal = start + MOVE * (1.0 if k % 2 else -1.0)
        last = arm.trajectory((0.5, 0.0), start=goal)
        del last.points[0]
        arm.publish(last)
        time.sleep(0.001)
    status, result = arm.result(before)
    assert (status, result.error_code) == (GoalStatus.STATUS_ABORTED, ErrorCode.PREEMPTED)
    assert result.error_msg == "preempted by a trajectory on the topic joint_trajectory"
    arm.until_at(np.array(last.points[0].positions))
    assert_no_jump(arm, since)
    # The flood leaves the robot its cycles.
    times, _, _ = arm.path(since)
    assert len(times) > 10.0 * times[-1]
    assert arm.execute(arm.trajectory((0.3, -MOVE)))[0] == GoalStatus.STATUS_SUCCEEDED


def test_a_flood_of_goals(arm):
    start = arm.position
    handles = []
    for k in range(100):
        goal = arm.trajectory((0.5, 0.0), start=start + MOVE * (1.0 if k % 2 else -1.0))
        del goal.points[0]
        handles.append(arm.send(goal))
    outcomes = [arm.result(handle) for handle in handles]
    assert outcomes[-1][0] == GoalStatus.STATUS_SUCCEEDED
    for status, result in outcomes[:-1]:
        assert (status, result.error_code) == (GoalStatus.STATUS_ABORTED, ErrorCode.PREEMPTED)
        assert result.error_msg == "preempted by a newer goal of the action"
    assert_no_jump(arm)


def test_two_publishers_of_trajectories_at_once(graph, arm):
    other = graph.client.create_publisher(JointTrajectory, f"{NAME}/joint_trajectory", 10)
    start = arm.position
    ours = arm.send(arm.trajectory((20.0, 5 * MOVE)))
    arm.until_moving()
    theirs = arm.trajectory((1.0, 0.0), start=start - MOVE)
    del theirs.points[0]
    other.publish(theirs)
    status, result = arm.result(ours)
    assert (status, result.error_code) == (GoalStatus.STATUS_ABORTED, ErrorCode.PREEMPTED)
    assert result.error_msg == "preempted by a trajectory on the topic joint_trajectory"
    arm.until_at(start - MOVE)
    assert_no_jump(arm)


def test_two_trajectory_publishers_at_once(graph):
    first = Suite(graph)
    second = graph.start(
        lambda **options: TrajectoryPublisherNode(
            cli_args=["--ros-args", "-r", "__node:=second", "-r", "planned_trajectory:=other_plan"],
            **options,
        ),
        auto_execute=True,
    )
    waiting = first.start_execute(first.trajectory(0.0, 5 * MOVE, duration=20.0))
    first.until_moving()
    client = graph.client.create_publisher(JointTrajectory, "other_plan", 10)
    graph.client.wait_for_node("second", TIMEOUT)
    while not client.get_subscription_count():
        time.sleep(0.01)
    plan = first.trajectory(0.0, -MOVE, duration=1.0)
    del plan.points[0]
    client.publish(plan)
    answer = ended(waiting)
    assert answer.error_code == ErrorCode.PREEMPTED
    assert "trajectory on the topic" in answer.error_msg
    first.until_at(first.home - MOVE)
    assert second.get_name() == "second"


@pytest.mark.slow
def test_a_controller_that_dies_in_mid_motion_and_comes_back(graph, process):
    controllers = [process(JointTrajectoryControllerNode, robot_description=ROBOT)]
    arm = Suite(graph, with_controller=False, controller_timeout=TIMEOUT)
    arm.until(lambda: arm.states)
    lost = arm.start_execute(arm.trajectory(0.0, 5 * MOVE, duration=20.0))
    queued = arm.start_execute(arm.trajectory(5 * MOVE, 0.0, duration=1.0))
    arm.until(lambda: np.abs(arm.position - arm.home).max() > 0.01)
    controllers[0].send_signal(signal.SIGKILL)
    answer = ended(lost)
    assert answer.error_code == ErrorCode.REJECTED
    assert "the controller has died" in answer.error_msg
    assert "how the motion ended is not known; at last joint 'waist' is at" in answer.error_msg
    since, last = len(arm.states), arm.position
    process(JointTrajectoryControllerNode, robot_description=ROBOT)
    # What waited begins where the robot is not: it is refused, and the robot, which came back where
    # it was, stays.
    answer = ended(queued)
    assert answer.error_code == ErrorCode.REJECTED
    # The publisher of this test does not know the robot, and so no units.
    assert (
        "the trajectory starts with joint 'waist' at 0.6, but the joint is at " in answer.error_msg
    )
    assert answer.error_msg.endswith(" apart, allowed is 0.01")
    arm.until(lambda: len(arm.states) > since + 20)
    places = np.array([state.position for state in arm.states[since + 1 :]])
    np.testing.assert_array_equal(places, np.broadcast_to(places[0], places.shape))
    np.testing.assert_allclose(places[0], last, atol=0.02)
    here = arm.position - arm.home
    answer = arm.execute(arm.trajectory(here, here + MOVE, duration=0.5))
    assert (answer.error_code, answer.error_msg) == (ErrorCode.NONE, "")


@pytest.mark.slow
def test_a_client_of_a_controller_that_dies_is_not_moved_again(graph, process):
    started = []
    arm = Driver(graph, lambda *args, **given: started.append(process(*args, **given)))
    arm.send(arm.trajectory((20.0, 5 * MOVE)))
    arm.until_moving()
    started[0].send_signal(signal.SIGKILL)
    started[0].wait(TIMEOUT)
    since = len(arm.states)
    process(JointTrajectoryControllerNode, robot_description=ROBOT)
    arm.until(lambda: len(arm.states) > since + 50)
    places = np.array([state.position for state in arm.states[since + 1 :]])
    np.testing.assert_array_equal(places, np.broadcast_to(places[-1], places.shape))
