"""Simulated time that jumps: robots do not, and what happened is said."""

import re
import time

import numpy as np
import pytest
from action_msgs.msg import GoalStatus
from drivers import ROBOT, TIMEOUT, Suite, ended

from robomech_interfaces.msg import ErrorCode
from robomech_ros.nodes.joint_trajectory_controller.node import JointTrajectoryControllerNode

MOVE = np.array([0.1, -0.05, 0.08, 0.0, 0.1, -0.1])
SAID = "the clock jumped {} s on the way, and the robot went on from where it was"


def assert_no_jump(arm, forward=True):
    """No state is farther from the one before than a slow motion leads in some cycles."""
    positions = np.array([state.position for state in arm.states])
    assert np.abs(np.diff(positions, axis=0)).max() < 0.02
    if forward:
        # Nothing is done twice.
        assert (np.diff(positions[:, 0]) >= -1e-9).all()


@pytest.mark.parametrize(
    ("jump", "said"),
    [
        (-3600.0, SAID.format("back by 3600")),
        (-0.3, SAID.format(r"back by 0\.\d+")),
        (0.4, SAID.format(r"forward by 0\.[34]\d*")),
        (5.0, SAID.format(r"forward by (5|5\.0\d|4\.9\d)")),
        (3600.0, SAID.format("forward by 3600")),
    ],
    ids=("back", "a little back", "a little forward", "forward", "far forward"),
)
def test_a_motion_under_way(simulated_time, drive, jump, said):
    arm = drive(use_sim_time=True)
    start = arm.position
    handle = arm.send(arm.trajectory((1.5, MOVE)))
    arm.until(lambda: abs(arm.position[0] - start[0]) > 0.02)
    simulated_time.jump(jump)
    status, result = arm.result(handle)
    assert (status, result.error_code) == (GoalStatus.STATUS_SUCCEEDED, ErrorCode.NONE)
    # A message of /clock may be lost on the way.
    assert re.fullmatch(said, result.error_msg)
    arm.until_at(start + MOVE)
    assert_no_jump(arm)


def test_a_cancel_after_a_jump(simulated_time, drive):
    arm = drive(use_sim_time=True)
    handle = arm.send(arm.trajectory((20.0, 5 * MOVE)))
    arm.until_moving()
    simulated_time.jump(100.0)
    seen = len(arm.states)
    arm.until(lambda: len(arm.states) > seen + 5)
    handle.cancel_goal_async()
    status, result = arm.result(handle)
    assert (status, result.error_code) == (GoalStatus.STATUS_CANCELED, ErrorCode.PREEMPTED)
    stopped = "cancelled by the client; the robot has stopped on its path"
    # Messages of /clock may be lost on the way.
    said = SAID.format(r"forward by (100|100\.\d+|99\.\d+)")
    assert re.fullmatch(f"{stopped}; {said}", result.error_msg)
    assert_no_jump(arm)


def test_what_waits_for_a_stamp_that_is_jumped_over(simulated_time, drive):
    arm = drive(use_sim_time=True)
    start = arm.position
    trajectory = arm.trajectory((1.0, MOVE))
    trajectory.header.stamp = simulated_time.stamp(60.0)
    handle = arm.send(trajectory)
    arm.diagnosis(lambda status: "waits for its time" in status.message)
    simulated_time.jump(100.0)
    status, result = arm.result(handle)
    assert (status, result.error_code) == (GoalStatus.STATUS_ABORTED, ErrorCode.REJECTED)
    assert result.error_msg.startswith("when its time had come: the trajectory ended 3")
    np.testing.assert_array_equal(arm.position, start)
    # Its last point is still to come when only the begin is passed over.
    trajectory = arm.trajectory((1.0, 0.5 * MOVE), (18.0, MOVE))
    del trajectory.points[0]
    trajectory.header.stamp = simulated_time.stamp(60.0)
    handle = arm.send(trajectory)
    arm.diagnosis(lambda status: "waits for its time" in status.message)
    simulated_time.jump(76.0)
    status, result = arm.result(handle)
    assert (status, result.error_code, result.error_msg) == (GoalStatus.STATUS_SUCCEEDED, 0, "")
    arm.until_at(start + MOVE)
    assert_no_jump(arm)


@pytest.mark.parametrize("jump", [-100.0, 100.0])
def test_the_publisher_waits_for_what_is_under_way(graph, simulated_time, jump):
    parameters = {"robot_description": ROBOT, "use_sim_time": True}
    arm = Suite(graph, with_controller=False, **parameters)
    graph.start(JointTrajectoryControllerNode, **parameters)
    arm.plan(0.0, MOVE, duration=1.5)
    waiting = arm.start_execute()
    arm.until_moving()
    simulated_time.jump(jump)
    answer = ended(waiting)
    assert (answer.error_code, answer.error_msg) == (ErrorCode.NONE, "")
    arm.until_at(arm.home + MOVE)
    assert_no_jump(arm)


@pytest.mark.slow
@pytest.mark.parametrize("transport", ["topic", "action"])
def test_the_publisher_waits_for_a_stamp_that_the_clock_jumped_away_from(
    graph, simulated_time, transport
):
    """The robot begins when simulated time comes to the stamp; nobody gives up before."""
    parameters = {"robot_description": ROBOT, "use_sim_time": True}
    patience = {"controller_timeout": 0.5, "arrival_timeout": 0.3, "standstill_timeout": 0.3}
    arm = Suite(graph, with_controller=False, transport=transport, **parameters, **patience)
    graph.start(JointTrajectoryControllerNode, **parameters)
    arm.until(lambda: arm.states)
    trajectory = arm.trajectory(0.0, MOVE, duration=0.5)
    trajectory.header.stamp = simulated_time.stamp(1.0)
    waiting = arm.start_execute(trajectory) if transport == "action" else None
    if waiting is None:
        arm.send(trajectory)
    arm.controller_condition(lambda status: "waits for its time" in status.message)
    simulated_time.jump(-4.0)
    if waiting is not None:
        answer = ended(waiting)
        assert (answer.error_code, answer.error_msg) == (ErrorCode.NONE, "")
    else:
        assert arm.value("arrived", lambda status: status.message == "idle") == "1"
        assert arm.value("failed") == "0"
    arm.until_at(arm.home + MOVE)
    assert_no_jump(arm)


def without_time(graph, patience):
    """Start a publisher and a robot that wait for /clock."""
    options = {"controller_timeout": patience, "auto_execute": False, "use_sim_time": True}
    arm = Suite(graph, with_controller=False, **options)
    arm.start_controller(use_sim_time=True)
    return arm


@pytest.mark.parametrize("latest", [False, True])
def test_without_time_execute_answers_with_the_reason(graph, latest):
    """Nothing moves while the simulated time is 0; the caller waited for ever."""
    arm = without_time(graph, 0.3)
    trajectory = arm.trajectory(0.0, MOVE)
    if latest:
        arm.send(trajectory)
        deadline = time.monotonic() + TIMEOUT
        while arm.node._plans.latest is None:
            assert time.monotonic() < deadline, "the plan did not come"
            time.sleep(0.01)
    answer = arm.execute(None if latest else trajectory)
    assert answer.error_code == ErrorCode.REJECTED
    assert answer.error_msg == "not sent: use_sim_time is true, but nobody publishes '/clock'"


def test_what_is_asked_for_before_there_is_time_is_done_in_time(graph, request):
    arm = without_time(graph, 30.0)
    asked = arm.start_execute(arm.trajectory(0.0, MOVE, duration=0.5))
    request.getfixturevalue("simulated_time")
    assert ended(asked).error_code == ErrorCode.NONE
