"""Requirements of ros2_control's tests of its joint_trajectory_controller, under their names."""

import math

import numpy as np
import pytest
from control_msgs.action import FollowJointTrajectory
from drivers import NAME, seconds
from follow_cases import (
    ABORTED,
    CANCELED,
    CODES,
    FAR,
    JOINTS,
    NEAR,
    SLOWLY,
    START,
    SUCCEEDED,
    ZERO,
    lagging,
    tolerance,
)
from rcl_interfaces.srv import SetParameters
from rclpy.parameter import Parameter
from trajectory_msgs.msg import MultiDOFJointTrajectory

from robomech_ros.execution.motion_tolerances import Tolerances
from robomech_ros.nodes.joint_trajectory_controller.follow_messages import FollowMessages


def test_success_single_point_sendgoal(follower):
    arm = follower()
    assert arm.follow(arm.points((0.3, NEAR))) == (SUCCEEDED, CODES.SUCCESSFUL, "")
    arm.until_at(NEAR)


def test_success_multi_point_sendgoal(follower):
    arm = follower()
    trajectory = arm.points((0.2, NEAR), (0.5, FAR))
    assert arm.follow(trajectory) == (SUCCEEDED, CODES.SUCCESSFUL, "")
    arm.until_at(FAR)


@pytest.mark.slow
def test_time_from_start_populated(follower):
    arm, seen = follower(), []
    trajectory = arm.points((1.0, NEAR, ZERO), (2.0, FAR, ZERO))
    handle = arm.send_goal(trajectory, lambda message: seen.append(message.feedback))
    assert arm.outcome(handle)[0] == SUCCEEDED
    arm.until(lambda: len(seen) > 2)
    for feedback in seen:
        assert list(feedback.joint_names) == list(JOINTS)
        times = [
            getattr(feedback, point).time_from_start for point in ("desired", "actual", "error")
        ]
        assert times[0] == times[1] == times[2]
        elapsed = times[0].sec + 1e-9 * times[0].nanosec
        assert elapsed > 0.0
        if hasattr(feedback, "index"):
            assert feedback.index == (0 if elapsed < 1.0 else 1)
        np.testing.assert_array_equal(feedback.error.positions, ZERO)


def test_constraints_change_at_run_time(follower, capfd):
    """Those of ros2_control, by joint."""
    given = {"constraints.joint2.goal": 0.5, "constraints.joint9.goal": 0.5}
    arm = follower(tracking_lag=0.2, goal_time=0.1, goal_tolerance=1e-4, **given)
    assert "unknown parameter 'constraints.joint9.goal' is ignored" in capfd.readouterr().err
    trajectory = arm.points((0.5, FAR, ZERO, ZERO))
    status, code, text = arm.follow(trajectory)
    assert (status, code) == (ABORTED, CODES.GOAL_TOLERANCE_VIOLATED)
    assert "joint 'joint1' is" in text and "tolerance is 0.0001 rad" in text

    def change(**values):
        changed = [
            Parameter(f"constraints.{name.replace('__', '.')}", value=value).to_parameter_msg()
            for name, value in values.items()
        ]
        request = SetParameters.Request(parameters=changed)
        results = arm.graph.call(SetParameters, f"{NAME}/set_parameters", request).results
        return [(result.successful, result.reason) for result in results]

    assert change(joint1__goal=1.0, joint3__goal=0.0) == [(True, "")] * 2
    assert not change(joint1__goal=-1.0)[0][0]
    arm.until_still()
    assert arm.follow(arm.points((0.5, START, ZERO, ZERO)))[:2] == (ABORTED, -5)
    assert change(stopped_velocity_tolerance=0.0) == [(True, "")]
    arm.until_still()
    assert arm.follow(arm.points((0.5, FAR, ZERO, ZERO)))[:2] == (SUCCEEDED, 0)
    assert change(goal_time=0.0, joint1__goal=1e-4) == [(True, "")] * 2
    # Any time: it arrives at last.
    assert arm.follow(arm.points((0.5, START, ZERO, ZERO)))[:2] == (SUCCEEDED, 0)


def test_tolerances_via_actions(follower):
    arm = lagging(follower)
    trajectory = arm.points((0.5, FAR, ZERO, ZERO))
    path = [tolerance("joint3", 9.0), tolerance("joint1", 0.01), tolerance("joint2", 9.0)]
    status, code, text = arm.follow(trajectory, path_tolerance=path)
    assert (status, code) == (ABORTED, CODES.PATH_TOLERANCE_VIOLATED)
    assert "joint 'joint1' is 0.0" in text
    assert "off its path, the tolerance is 0.01 rad" in text
    # Without tolerances of its own the next goal has the defaults again.
    arm.until_still()
    assert arm.follow(arm.points((0.5, START, ZERO, ZERO)))[:2] == (SUCCEEDED, 0)


@pytest.mark.parametrize("field", ["velocity", "acceleration"])
def test_tolerances_of_rates_via_actions(follower, field):
    arm = lagging(follower)
    status, code, text = arm.follow(
        arm.points((0.5, FAR, ZERO, ZERO)), path_tolerance=[tolerance("joint2", **{field: 0.05})]
    )
    assert (status, code) == (ABORTED, CODES.PATH_TOLERANCE_VIOLATED)
    assert f"off the {field} of its path, the tolerance is 0.05 rad/s" in text
    assert "joint 'joint2'" in text


def test_deactivate_tolerances(follower):
    arm = lagging(follower, path_tolerance=0.001, goal_tolerance=1e-6)
    anything = [tolerance(joint, -1.0, -1.0, -1.0) for joint in JOINTS]
    trajectory = arm.points((0.5, FAR, ZERO, ZERO))
    outcome = arm.follow(trajectory, path_tolerance=anything, goal_tolerance=anything)
    assert outcome == (SUCCEEDED, CODES.SUCCESSFUL, "")


@pytest.mark.parametrize(
    ("given", "said"),
    [
        (tolerance("joint1", -123.0), "position of joint 'joint1' is -123.0"),
        (tolerance("joint1", math.nan), "position of joint 'joint1' is nan"),
        (tolerance("joint2", velocity=-2.0), "velocity of joint 'joint2' is -2.0"),
    ],
)
def test_invalid_tolerances(follower, given, said):
    arm = follower()
    for field in ("path_tolerance", "goal_tolerance"):
        status, code, text = arm.follow(arm.points((0.3, NEAR)), **{field: [given]})
        assert (status, code) == (SUCCEEDED, CODES.SUCCESSFUL)
        assert text.startswith("the default tolerances hold, as one of the goal cannot: ")
        assert f"{field}.{said}" in text


def test_invalid_joints_path_tolerance(follower):
    arm = follower()
    outcome = arm.follow(arm.points((0.3, NEAR)), path_tolerance=[tolerance("joint4", 1e-9)])
    assert outcome[:2] == (SUCCEEDED, CODES.SUCCESSFUL)
    assert "the default tolerances hold" in outcome[2]
    assert "unknown joint 'joint4'" in outcome[2]


def test_state_tolerances_fail(follower):
    arm = lagging(follower, path_tolerance=0.01)
    status, code, text = arm.follow(arm.points((0.5, FAR, ZERO, ZERO)))
    assert (status, code) == (ABORTED, CODES.PATH_TOLERANCE_VIOLATED)
    assert "off its path, the tolerance is 0.01 rad" in text
    arm.until_still()
    held = arm.position
    assert np.abs(held - FAR).max() > 0.05
    since = len(arm.states) + 20
    arm.until(lambda: len(arm.states) > since)
    np.testing.assert_array_equal(arm.position, held)


def test_goal_tolerances_fail(follower):
    arm = follower(tracking_lag=5.0, goal_time=0.1)
    status, code, text = arm.follow(arm.points((0.3, FAR, ZERO, ZERO)))
    assert (status, code) == (ABORTED, CODES.GOAL_TOLERANCE_VIOLATED)
    assert "joint 'joint1' is 0." in text
    assert "off its goal, the tolerance is 0.01 rad" in text
    arm.until_still()
    assert np.abs(arm.position - FAR).max() > 0.1


def test_goal_time_of_the_goal(follower):
    arm = follower(tracking_lag=0.3, goal_time=0.01)
    trajectory = arm.points((0.1, NEAR, ZERO, ZERO))
    assert arm.follow(trajectory)[1] == CODES.GOAL_TOLERANCE_VIOLATED
    arm.until_still()
    trajectory = arm.points((0.1, START, ZERO, ZERO))
    assert arm.follow(trajectory, goal_time_tolerance=seconds(-1))[0] == SUCCEEDED


def test_the_goal_time_of_a_goal_counts_its_nanoseconds():
    default = Tolerances(np.ones(1), np.ones(1), np.ones(1), 9.0)
    goal = FollowJointTrajectory.Goal(goal_time_tolerance=seconds(1.5))
    found, fault = FollowMessages(["joint1"]).tolerances(goal, default, ["joint1"])
    assert (found.goal_time, fault) == (1.5, "")


def test_no_time_from_start_state_tolerance_fail(follower):
    arm = follower()
    status, code, text = arm.follow(arm.points((0.0, FAR)))
    assert (status, code) == (ABORTED, CODES.PATH_TOLERANCE_VIOLATED)
    assert "joint 'joint1' at 1.5 rad, but the joint is at 1.1 rad: 0.4 rad apart" in text
    np.testing.assert_array_equal(arm.position, START)


def test_preempted_goal_receives_aborted_result(follower):
    arm = follower()
    first = arm.send_goal(arm.points((SLOWLY, FAR, ZERO, ZERO)))
    arm.until_moving()
    second = arm.send_goal(arm.points((0.5, START, ZERO, ZERO)))
    assert arm.outcome(first) == (
        ABORTED,
        CODES.INVALID_GOAL,
        "preempted by a newer goal of the action",
    )
    assert arm.outcome(second)[0] == SUCCEEDED
    arm.until_at(START)


def test_a_goal_of_one_action_preempts_that_of_the_other(follower):
    arm = follower()
    first = arm.send_goal(arm.points((SLOWLY, FAR, ZERO, ZERO)))
    arm.until_moving()
    second = arm.send(arm.points((0.5, START, ZERO, ZERO)))
    assert arm.outcome(first)[:2] == (ABORTED, CODES.INVALID_GOAL)
    assert arm.result(second)[0] == SUCCEEDED


@pytest.mark.slow
def test_blend_action_replaces_action_with_future_stamp(follower):
    arm = follower()
    first = arm.send_goal(arm.points((SLOWLY, FAR, ZERO, ZERO)))
    arm.until_moving()
    # The first goes on until the second begins, which is later than it is accepted.
    second = arm.send_goal(arm.stamped(arm.points((0.5, START, ZERO, ZERO)), 3.0))
    seen = len(arm.states)
    assert arm.outcome(first)[:2] == (ABORTED, CODES.INVALID_GOAL)
    assert arm.outcome(second)[0] == SUCCEEDED
    arm.until_at(START)
    speeds = np.array([state.velocity[0] for state in arm.states[seen:]])
    assert (speeds[: int(np.argmax(speeds < 0.0))] > 0.0).sum() > 5


def test_cancel_hold_position(follower):
    arm = follower()
    handle = arm.send_goal(arm.points((SLOWLY, FAR, ZERO, ZERO)))
    arm.until_moving()
    cancelled = arm.ask(handle.cancel_goal_async)
    status, code, text = arm.outcome(handle)
    assert (status, code) == (CANCELED, CODES.SUCCESSFUL)
    assert text == "cancelled by the client; the robot has stopped on its path"
    assert len(cancelled.result().goals_canceling) == 1
    arm.until_still()
    moved = (arm.position - START) / (FAR - START)
    np.testing.assert_allclose(moved, moved[0], atol=1e-9)
    held, since = arm.position, len(arm.states) + 20
    arm.until(lambda: len(arm.states) > since)
    np.testing.assert_array_equal(arm.position, held)


def test_cancel_decelerate_to_hold_position(follower):
    # The robot always slows down on its path.  No joint of this one states its acceleration: that
    # from its 5 rad/s in 0.25 s is taken, here less than a tenth of a second.
    arm = follower(publish_rate=500.0)
    handle = arm.send_goal(arm.points((1.5, START + 1.5, ZERO, ZERO)))
    arm.until(lambda: arm.velocity[0] > 1.5)
    handle.cancel_goal_async()
    assert arm.outcome(handle)[:2] == (CANCELED, CODES.SUCCESSFUL)
    arm.until_still()
    times, _, velocities = arm.path()
    speeds = velocities[:, 0]
    fast, still = np.flatnonzero(speeds > 1.4)[-1], np.flatnonzero(speeds)[-1]
    assert times[still + 1] - times[fast] > 0.8 * speeds[fast] / 20.0
    # From cycle to cycle, of which a busy machine leaves some out.
    braking, spans = np.diff(speeds[fast + 1 : still + 1]), np.diff(times[fast + 1 : still + 1])
    assert (braking <= -0.9 * 20.0 * spans).all()
    assert (np.diff(speeds[fast : still + 2]) <= 1e-12).all()


def test_allow_nonzero_velocity_at_trajectory_end_true(follower):
    arm = follower(allow_nonzero_velocity_at_trajectory_end=True)
    speed = np.array([0.4, -0.3, 0.2])
    outcome = arm.follow(arm.points((0.5, FAR, speed)))
    assert outcome == (SUCCEEDED, CODES.SUCCESSFUL, "")
    arm.until_still()
    # It brakes within 0.02 s, beyond the last point.
    np.testing.assert_allclose(arm.position, FAR + 0.01 * speed, atol=1e-9)
    np.testing.assert_allclose(arm.query().position, arm.position, atol=1e-9)


def test_allow_nonzero_velocity_at_trajectory_end_false(follower):
    arm = follower()
    status, code, text = arm.follow(arm.points((0.5, FAR, [0.4, -0.3, 0.2])))
    assert (status, code) == (ABORTED, CODES.INVALID_GOAL)
    assert "velocity of joint 'joint1' in the last point is 0.4" in text
    np.testing.assert_array_equal(arm.position, START)


def _changed(trajectory, **fields):
    for name, value in fields.items():
        setattr(trajectory.points[-1], name, value)


MUTATIONS = {
    "no joints": (lambda t: setattr(t, "joint_names", []), -2, "missing: joint1"),
    "missing joint": (lambda t: setattr(t, "joint_names", JOINTS[:2]), -2, "missing: joint3"),
    "wrong name": (
        lambda t: setattr(t, "joint_names", ["bad", "joint2", "joint3"]),
        -2,
        "unknown joint 'bad'",
    ),
    "repeated": (
        lambda t: setattr(t, "joint_names", ["joint1", "joint1", "joint3"]),
        -2,
        "'joint1' is repeated",
    ),
    "no points": (lambda t: setattr(t, "points", []), -1, "no points"),
    "few positions": (lambda t: _changed(t, positions=[1.0]), -1, "positions has size 1"),
    "many positions": (lambda t: _changed(t, positions=[1.0] * 4), -1, "positions has size 4"),
    "no positions": (lambda t: _changed(t, positions=[]), -1, "positions has size 0"),
    "velocities": (lambda t: _changed(t, velocities=[1.0]), -1, "velocities has size 1"),
    "accelerations": (lambda t: _changed(t, accelerations=[0.0]), -1, "accelerations has size 1"),
    "effort": (lambda t: _changed(t, effort=[1.0] * 3), -1, "are read, no effort"),
    "times": (lambda t: _changed(t, time_from_start=seconds(0.1)), -1, "time_from_start is 0.1"),
    "nan": (lambda t: _changed(t, positions=[math.nan, 2.0, 3.0]), -1, "joint 'joint1' is nan"),
    "inf": (lambda t: _changed(t, velocities=[0.0, math.inf, 0.0]), -1, "joint 'joint2' is inf"),
    "limit": (lambda t: _changed(t, positions=[6.3, 2.0, 3.0]), -1, "joint 'joint1' is 6.3"),
    "old": (lambda t: setattr(t.header.stamp, "sec", 1), -3, "the trajectory ended"),
}


def test_invalid_message(follower):
    arm = follower()
    for case, (change, code, text) in MUTATIONS.items():
        trajectory = arm.points((0.2, NEAR), (4.0, FAR))
        change(trajectory)
        outcome = arm.follow(trajectory)
        assert outcome[:2] == (ABORTED, code), (case, outcome)
        assert text in outcome[2], case
    np.testing.assert_array_equal(arm.position, START)


def test_joints_of_several_freedoms_are_refused(follower):
    arm = follower()
    goal = arm.points((0.3, NEAR))
    compound = MultiDOFJointTrajectory(joint_names=["floating"])
    status, code, text = arm.follow(goal, multi_dof_trajectory=compound)
    assert (status, code) == (ABORTED, CODES.INVALID_JOINTS)
    assert "multi_dof_trajectory has floating" in text


def test_jumbled_joint_order(follower):
    arm = follower()
    trajectory = arm.points((0.3, FAR[[1, 2, 0]]), names=("joint2", "joint3", "joint1"))
    assert arm.follow(trajectory)[0] == SUCCEEDED
    arm.until_at(FAR)


def test_partial_joint_list(follower):
    arm = follower(allow_partial_joints_goal=True)
    trajectory = arm.points((0.3, FAR[[2, 0]], [0.0, 0.0]), names=("joint3", "joint1"))
    path = [tolerance("joint1", 0.1)]
    assert arm.follow(trajectory, path_tolerance=path)[0] == SUCCEEDED
    arm.until_at([FAR[0], START[1], FAR[2]])
    # By our own action, with tolerances in the order of the trajectory.
    back = arm.points((0.3, [START[2]]), names=("joint3",))
    assert arm.execute(back, path_position_tolerance=[0.1])[0] == SUCCEEDED
    arm.until_at([FAR[0], START[1], START[2]])
    assert arm.follow(arm.points(names=()))[:2] == (ABORTED, CODES.INVALID_JOINTS)


def test_partial_joint_list_while_the_others_move(follower):
    arm = follower(allow_partial_joints_goal=True)
    arm.send_goal(arm.points((SLOWLY, FAR, ZERO, ZERO)))
    arm.until_moving()
    assert arm.follow(arm.points((0.5, [START[0]], [0.0]), names=("joint1",)))[0] == SUCCEEDED
    arm.until_still()
    assert arm.position[0] == pytest.approx(START[0], abs=1e-9)
    assert 0.0 < START[1] - arm.position[1] < 0.3


def test_partial_joint_list_not_allowed(follower):
    arm = follower()
    status, code, text = arm.follow(arm.points((0.3, FAR[[2, 0]]), names=("joint3", "joint1")))
    assert (status, code) == (ABORTED, CODES.INVALID_JOINTS)
    assert "missing: joint2" in text


def test_trajectory_replace(follower):
    arm = follower()
    arm.publish(arm.points((SLOWLY, FAR, ZERO, ZERO)))
    arm.until_moving()
    arm.publish(arm.points((0.5, START, ZERO, ZERO)))
    arm.until(lambda: any(state.velocity[0] < 0.0 for state in arm.states))
    arm.until_at(START)


def test_ignore_old_trajectory(follower):
    arm = follower()
    arm.publish(arm.stamped(arm.points((0.2, FAR)), -1.0))
    status = arm.diagnosis(lambda status: "refused" in status.message)
    assert "the trajectory ended 0." in status.message
    outcome = arm.follow(arm.stamped(arm.points((0.2, FAR)), -1.0))
    assert outcome[:2] == (ABORTED, CODES.OLD_HEADER_TIMESTAMP)
    np.testing.assert_array_equal(arm.position, START)


def test_ignore_partial_old_trajectory(follower):
    arm = follower()
    # What should have been reached a second ago is passed over.
    trajectory = arm.points((0.5, START - 1.0), (3.0, NEAR))
    assert arm.follow(arm.stamped(trajectory, -1.5))[0] == SUCCEEDED
    arm.until_at(NEAR)
    assert min(state.position[0] for state in arm.states) >= START[0] - 1e-9


@pytest.mark.slow
def test_execute_partial_traj_in_future(follower):
    arm = follower()
    arm.publish(arm.points((0.4, NEAR, ZERO)))
    arm.publish(arm.stamped(arm.points((0.4, FAR, ZERO)), 2.0))
    arm.until_at(NEAR)
    arm.until_at(FAR)


def test_position_error_angle_wraparound(follower):
    arm = follower(kind="continuous", path_tolerance=0.5)
    turned = START + np.array([2.0 * math.pi, -2.0 * math.pi, 4.0 * math.pi])
    trajectory = arm.points((0.0, turned), (0.4, turned + 0.1))
    assert arm.follow(trajectory) == (SUCCEEDED, CODES.SUCCESSFUL, "")
    # The short way, not a turn.
    arm.until_at(START + 0.1)
