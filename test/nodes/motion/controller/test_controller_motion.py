"""Motion of the simulated robot without faults, and when plans change."""

import itertools
import math
import re

import numpy as np
import pytest
from action_msgs.msg import GoalStatus
from rosgraph_msgs.msg import Clock
from std_srvs.srv import Trigger

from robomech_interfaces.msg import ErrorCode
from robomech_ros.nodes.joint_trajectory_controller import commands

SUCCEEDED, ABORTED, CANCELED = (
    GoalStatus.STATUS_SUCCEEDED,
    GoalStatus.STATUS_ABORTED,
    GoalStatus.STATUS_CANCELED,
)
TURNTABLE = """
<robot name="turntable">
  <link name="base"/><link name="table"/><link name="tool0"/><link name="jaw"/>
  <joint name="turn" type="continuous">
    <parent link="base"/><child link="table"/><axis xyz="0 0 1"/><limit effort="1" velocity="2"/>
  </joint>
  <joint name="lift" type="prismatic">
    <parent link="table"/><child link="tool0"/><axis xyz="0 0 1"/>
    <limit lower="0" upper="1" effort="1" velocity="2"/>
  </joint>
  <joint name="finger" type="prismatic">
    <parent link="tool0"/><child link="jaw"/><axis xyz="0 1 0"/>
    <limit lower="0.01" upper="0.05" effort="1" velocity="2"/>
  </joint>
</robot>"""
MOVE = np.array([0.1, -0.05, 0.08, 0.0, 0.1, -0.1])
# Longer than a busy machine takes to do something about the motion, s.
SLOWLY = 10.0


def trigger(arm, service):
    return arm.graph.call(Trigger, f"joint_trajectory_controller/{service}", Trigger.Request())


def test_states_at_rest(arm):
    state = arm.states[-1]
    assert list(state.name) == list(arm.chain.joint_names)
    np.testing.assert_array_equal(state.position, arm.chain.home())
    np.testing.assert_array_equal(state.velocity, np.zeros(6))
    assert len(state.effort) == 0

    def periods():
        stamps = [s.header.stamp.sec + 1e-9 * s.header.stamp.nanosec for s in arm.states[-50:]]
        return np.diff(stamps)

    # A busy machine may be late now and then.
    arm.until(lambda: len(arm.states) >= 50 and 0.008 < np.median(periods()) < 0.012)
    assert (periods() > 0.0).all()


def test_initial_positions_rate_and_namespace(drive):
    initial = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6]
    arm = drive(namespace="left", initial_positions=initial, publish_rate=50.0)
    np.testing.assert_array_equal(arm.position, initial)
    goal = arm.position + MOVE
    assert arm.execute(arm.trajectory((0.3, MOVE)))[0] == SUCCEEDED
    arm.until_at(goal)


def test_topic(arm):
    goal = arm.position + MOVE
    arm.publish(arm.trajectory((0.4, MOVE)))
    arm.until_at(goal)
    arm.assert_smooth()
    status = arm.diagnosis(lambda status: "goals reached" in str(status.values))
    values = {entry.key: entry.value for entry in status.values}
    assert values["trajectories accepted"] == "1"


@pytest.mark.slow
def test_action_with_feedback(arm):
    seen = []
    goal = arm.position + MOVE
    duration = 3.0
    handle = arm.send(
        arm.trajectory((duration, MOVE)), lambda message: seen.append(message.feedback)
    )
    status, result = arm.result(handle)
    assert (status, result.error_code, result.error_msg) == (SUCCEEDED, ErrorCode.NONE, "")
    assert list(result.joint_names) == arm.names
    np.testing.assert_allclose(result.final_position_error, 0.0, atol=1e-12)
    arm.until_at(goal)
    arm.until(lambda: seen and seen[-1].progress > 0.5)
    assert 2 <= len(seen) <= duration * 20 + 2
    progress = [feedback.progress for feedback in seen]
    assert progress == sorted(progress)
    assert 0.0 < progress[0] < 0.5 < progress[-1] <= 1.0
    last = seen[-1]
    assert list(last.joint_names) == arm.names
    np.testing.assert_array_equal(last.desired.positions, last.actual.positions)
    np.testing.assert_array_equal(last.error.positions, np.zeros(6))
    time = last.desired.time_from_start
    # The time goes on while the end is being settled, the progress does not.
    assert min(time.sec + 1e-9 * time.nanosec, duration) == pytest.approx(duration * last.progress)


def test_joints_in_any_order(arm):
    goal = arm.position + MOVE
    order = [3, 1, 0, 5, 4, 2]
    trajectory = arm.trajectory(
        (0.3, MOVE[order]), start=arm.position[order], names=[arm.names[k] for k in order]
    )
    assert arm.execute(trajectory)[0] == SUCCEEDED
    arm.until_at(goal)


def test_a_single_point_is_reached_from_the_present_state(arm):
    goal = arm.position + MOVE
    trajectory = arm.trajectory((0.3, MOVE), velocities=False)
    del trajectory.points[0]
    assert arm.execute(trajectory)[0] == SUCCEEDED
    arm.until_at(goal)


def test_cancel_stops_smoothly_on_the_path(arm):
    start = arm.position
    handle = arm.send(arm.trajectory((SLOWLY, 5 * MOVE)))
    arm.until(lambda: abs(arm.position[0] - start[0]) > 0.02)
    cancelled = arm.ask(handle.cancel_goal_async)
    status, result = arm.result(handle)
    arm.until(lambda: not arm.velocity.any())
    assert len(cancelled.result().goals_canceling) == 1
    assert (status, result.error_code) == (CANCELED, ErrorCode.PREEMPTED)
    assert "cancelled by the client" in result.error_msg
    assert result.final_position_error[0] > 0.05
    position = arm.position
    moved = (position - start)[MOVE != 0.0] / MOVE[MOVE != 0.0]
    np.testing.assert_allclose(moved, moved[0], atol=1e-9)
    arm.assert_smooth()


@pytest.mark.slow
def test_a_second_goal_preempts_the_first(arm):
    start = arm.position
    first = arm.send(arm.trajectory((SLOWLY, 4 * MOVE)))
    arm.until(lambda: abs(arm.position[0] - start[0]) > 0.02)
    back = arm.trajectory((0.6, 0.0), start=start)
    del back.points[0]
    second = arm.send(back)
    status, result = arm.result(first)
    assert (status, result.error_code) == (ABORTED, ErrorCode.PREEMPTED)
    assert result.error_msg == "preempted by a newer goal of the action"
    assert arm.result(second)[0] == SUCCEEDED
    arm.until_at(start)
    arm.assert_smooth()


@pytest.mark.slow
def test_a_goal_from_a_position_just_passed_is_taken_over_smoothly(arm):
    first = arm.send(arm.trajectory((SLOWLY, 10 * MOVE)))
    arm.until(lambda: arm.velocity[0] > 0.1)
    # On a busy machine it may have been passed too long ago.
    while arm.execute(arm.trajectory((1.0, MOVE)))[0] != SUCCEEDED:
        assert arm.velocity.any(), "the first motion is over"
    assert arm.result(first)[1].error_code == ErrorCode.PREEMPTED
    arm.assert_smooth()


def test_a_topic_trajectory_ends_an_action_with_a_text(arm):
    start = arm.position
    handle = arm.send(arm.trajectory((SLOWLY, 4 * MOVE)))
    arm.until_moving()
    back = arm.trajectory((0.5, 0.0), start=start)
    del back.points[0]
    arm.publish(back)
    status, result = arm.result(handle)
    assert (status, result.error_code) == (ABORTED, ErrorCode.PREEMPTED)
    assert "trajectory on the topic" in result.error_msg
    arm.until_at(start)


def test_hold(arm):
    assert trigger(arm, "hold").message == "the robot holds"
    handle = arm.send(arm.trajectory((SLOWLY, 4 * MOVE)))
    arm.until_moving()
    answer = trigger(arm, "hold")
    assert answer.success
    assert "slows down" in answer.message
    status, result = arm.result(handle)
    assert (status, result.error_code) == (ABORTED, ErrorCode.PREEMPTED)
    assert result.error_msg == "stopped by the service hold"
    arm.until(lambda: not arm.velocity.any())
    assert arm.execute(arm.trajectory((0.3, -MOVE)))[0] == SUCCEEDED


def test_reset(arm):
    initial = arm.position
    handle = arm.send(arm.trajectory((SLOWLY, 4 * MOVE)))
    arm.until(lambda: np.abs(arm.position - initial).max() > 0.01)
    assert trigger(arm, "reset").success
    assert "reset" in arm.result(handle)[1].error_msg
    arm.until_at(initial)


@pytest.mark.slow
def test_stamps(arm):
    start = arm.position
    past = arm.trajectory((0.5, MOVE), (3.0, 2 * MOVE))
    now = arm.graph.client.get_clock().now().nanoseconds
    begin = now - 600_000_000
    past.header.stamp.sec, past.header.stamp.nanosec = divmod(begin, 1_000_000_000)
    assert arm.execute(past)[0] == SUCCEEDED
    arm.until_at(start + 2 * MOVE)
    future = arm.trajectory((0.3, -2 * MOVE))
    begin = arm.graph.client.get_clock().now().nanoseconds + 1_500_000_000
    future.header.stamp.sec, future.header.stamp.nanosec = divmod(begin, 1_000_000_000)
    since = len(arm.states)
    assert arm.execute(future)[0] == SUCCEEDED
    moved = next(s for s in arm.states[since:] if any(s.velocity))
    assert moved.header.stamp.sec * 10**9 + moved.header.stamp.nanosec >= begin
    arm.until_at(start)


def test_a_whole_turn_of_a_continuous_joint_does_not_matter(drive):
    arm = drive(robot_description=TURNTABLE, tip_link="tool0")
    start = arm.position[:2]
    trajectory = arm.trajectory((0.3, 0.1), start=start + np.array([2.0 * math.pi, 0.0]))
    assert arm.execute(trajectory)[0] == SUCCEEDED
    # Joints outside the chain are published, too.
    assert list(arm.states[-1].name) == ["turn", "lift", "finger"]
    arm.until_at(np.array([0.1, start[1] + 0.1, 0.01]))


def test_tolerances_of_the_goal(drive):
    arm = drive(tracking_lag=0.05)
    names = [arm.names[k] for k in (5, 4, 3, 2, 1, 0)]
    reverse = MOVE[::-1]
    trajectory = arm.trajectory((0.4, reverse), start=arm.position[::-1], names=names)
    path = [-1.0, -1.0, -1.0, -1.0, -1.0, 0.005]
    status, result = arm.execute(trajectory, path_position_tolerance=path)
    assert (status, result.error_code) == (ABORTED, ErrorCode.PATH_TOLERANCE)
    assert re.search(r"joint 'waist' is 0\.0\d* rad off its path", result.error_msg)
    assert "the tolerance is 0.005 rad" in result.error_msg
    # Without tolerances of its own the next goal has the defaults again.
    arm.until(lambda: not arm.velocity.any())
    status, result = arm.execute(arm.trajectory((0.4, -0.5 * MOVE)))
    assert (status, result.error_code) == (SUCCEEDED, ErrorCode.NONE)


def test_goal_tolerance(drive):
    arm = drive(tracking_lag=0.5, goal_time=0.1)
    status, result = arm.execute(arm.trajectory((0.3, MOVE)))
    assert (status, result.error_code) == (ABORTED, ErrorCode.GOAL_TOLERANCE)
    assert "off its goal, the tolerance is 0.01 rad" in result.error_msg
    assert "joint '" in result.error_msg


def test_a_client_that_disappears(arm):
    goal = arm.position + MOVE
    arm.send(arm.trajectory((0.4, MOVE)))
    arm._action.destroy()
    arm.until_at(goal)
    status = arm.diagnosis(lambda status: status.message == "holding")
    assert {entry.key: entry.value for entry in status.values}["goals reached"] == "1"


@pytest.mark.slow
def test_ten_motions_in_a_row(arm):
    start = arm.position
    for k in range(10):
        change = MOVE * (1.0 if k % 2 == 0 else -1.0)
        assert arm.execute(arm.trajectory((0.2, change)))[0] == SUCCEEDED
        arm.until(lambda: not arm.velocity.any())
    arm.until(lambda: np.abs(arm.position - start).max() < 1e-9)


def test_simulated_time_drives_the_motion(graph, drive):
    clock = graph.client.create_publisher(Clock, "/clock", 10)
    now = Clock()
    ticks = itertools.count(1)

    def tick():
        now.clock.sec, now.clock.nanosec = divmod(next(ticks) * 10_000_000, 1_000_000_000)
        clock.publish(now)

    # Time passes at about half its speed.
    graph.client.create_timer(0.02, tick)
    arm = drive(use_sim_time=True)
    goal = arm.position + MOVE
    begin = arm.states[-1].header.stamp
    assert arm.execute(arm.trajectory((0.3, MOVE)))[0] == SUCCEEDED
    arm.until_at(goal)
    end = arm.states[-1].header.stamp
    took = end.sec - begin.sec + 1e-9 * (end.nanosec - begin.nanosec)
    assert 0.29 < took < 30.0
    assert end.sec < 1000


@pytest.mark.parametrize("soon", [True, False])
def test_the_rest_of_a_stream_does_not_end_a_goal_that_came_after_it(arm, monkeypatch, soon):
    """Messages on the topic that end where the last one did, and come at once, add nothing."""
    monkeypatch.setattr(commands, "_STREAM", 60.0 if soon else 0.0)
    here = arm.trajectory((0.5, 0.0))
    del here.points[0]
    for _ in range(5):
        arm.publish(here)
    arm.diagnosis(lambda s: ("trajectories accepted", "5") in [(v.key, v.value) for v in s.values])
    handle = arm.send(arm.trajectory((0.5 if soon else 20.0, 0.1)))
    arm.publish(here)
    status, result = arm.result(handle)
    if soon:
        assert (status, result.error_msg) == (GoalStatus.STATUS_SUCCEEDED, "")
        arm.until_at(np.array(here.points[-1].positions) + 0.1)
    else:
        # Long after the stream somebody wants the robot there.
        assert "preempted by a trajectory on the topic" in result.error_msg
