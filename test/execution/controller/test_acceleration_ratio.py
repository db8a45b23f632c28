"""Accelerations of the curve through given points, compared with limits."""

import pickle

import numpy as np
import pytest
from execution_cases import ACCELERATION, follower, run, single_point, to_rest, tolerances

from robomech_ros.errors import LimitExceededError
from robomech_ros.execution.controller.follower import TrajectoryFollower
from robomech_ros.execution.controller.simulated_joints import SimulatedJoints
from robomech_ros.execution.joints import Joints
from robomech_ros.execution.rejections import AccelerationRefusedError
from robomech_ros.robots import load_robot
from robomech_ros.trajectory import Waypoints


def cubic(ratio, duration=0.5, first=0.0):
    """From rest to rest, so that the first joint begins at so many times its limit."""
    way = ratio * ACCELERATION * duration**2 / 6.0
    still = np.zeros((2, 3))
    times = np.array([first, first + duration])
    return Waypoints(times, np.array([[0.0] * 3, [way, 0.0, 0.0]]), still)


def with_a_pause(given):
    """The same motion, and a while at its end."""
    rows = (np.vstack([row, row[-1:]]) for row in (given.positions, given.velocities))
    return Waypoints(np.append(given.times, given.times[-1] + 0.1), *rows)


def sampled_bang_bang(limit, switch, period=0.1):
    """Full acceleration, then full braking of a joint, as MoveIt's planner TOTG samples it."""
    times = np.append(np.arange(0.0, 2.0 * switch, period), 2.0 * switch)
    braking = times > switch
    left = 2.0 * switch - times
    position = np.where(braking, switch**2 - left**2 / 2.0, times**2 / 2.0)
    velocity, change = np.where(braking, left, times), np.where(braking, -1.0, 1.0)
    along = np.array([limit, 0.0, 0.0])
    return Waypoints(times, *(np.outer(row, along) for row in (position, velocity, change)))


def test_far_over_the_limit_is_refused_with_joint_time_value_and_limit():
    arm = follower()
    with pytest.raises(LimitExceededError) as refused:
        arm.start(cubic(5.2, 0.15), tolerances(), 0.0)
    assert str(refused.value) == (
        "the acceleration of joint 'shoulder' is 52 rad/s^2 at t = 0 s, 5.2 times its limit "
        "10 rad/s^2; at most 5 times is accepted (max_acceleration_ratio)"
    )
    assert refused.value.value == pytest.approx(52.0)
    assert (refused.value.joint, refused.value.limit) == ("shoulder", ACCELERATION)
    copied = pickle.loads(pickle.dumps(refused.value))
    assert (type(copied), str(copied)) == (AccelerationRefusedError, str(refused.value))
    assert arm.active is None


def test_the_cubic_of_the_ur5e_at_6_4_times_its_limit_is_refused():
    """It was executed with code 0."""
    chain = load_robot("ur5e")
    home, limit = chain.home(), float(chain.acceleration[2])
    goal = home.copy()
    goal[2] += 6.4 * limit * 0.4**2 / 6.0
    still = np.zeros((2, chain.n))
    arm = TrajectoryFollower(Joints.of(chain), SimulatedJoints(home, 0.0))
    given = Waypoints(np.array([0.0, 0.4]), np.array([home, goal]), still)
    with pytest.raises(
        LimitExceededError, match=r"'elbow_joint' is 20.11 rad/s\^2 at t = 0 s, 6.4"
    ):
        arm.start(given, tolerances_of(chain), 0.0)


def tolerances_of(chain):
    found = tolerances()
    return type(found)(
        *(np.full(chain.n, row[0]) for row in (found.path, found.goal, found.velocity)), 0.5
    )


def test_a_little_over_the_limit_is_executed_and_said():
    arm = follower()
    goal = arm.start(cubic(1.5, 0.3), tolerances(), 0.0)
    run(arm, 0.0, 0.4)
    text = (
        "the acceleration of joint 'shoulder' is 15 rad/s^2 at t = 0 s, "
        "1.5 times its limit 10 rad/s^2"
    )
    assert goal.strain == text
    assert (goal.result.code, goal.result.text) == (0, "")


def test_within_a_percent_nothing_is_said():
    arm = follower()
    assert not arm.start(cubic(1.009, 0.4), tolerances(), 0.0).strain
    assert not arm.start(to_rest((0.3, 0.2, 0.1)), tolerances(), 0.0).strain


@pytest.mark.parametrize("ratio", [0.0, 5.5])
def test_the_owner_may_allow_more(ratio):
    arm = follower(max_acceleration_ratio=ratio)
    assert "5.2 times" in arm.start(cubic(5.2, 0.15), tolerances(), 0.0).strain


def test_the_way_to_a_first_point_counts_for_a_robot_that_stands_and_is_in_time():
    point = single_point((0.195, 0.0, 0.0), 0.15)
    point = Waypoints(point.times, point.positions, point.velocities)
    arm = follower()
    with pytest.raises(AccelerationRefusedError, match="5.2 times its limit"):
        arm.start(point, tolerances(), 0.0)
    linear = Waypoints(point.times, point.positions)
    assert not arm.start(linear, tolerances(), 0.0).strain


def test_points_without_velocities_and_streams_are_not_judged():
    corner = np.array([[0.0] * 3, [0.3, 0.0, 0.0], [0.0] * 3])
    arm = follower()
    assert not arm.start(Waypoints(np.array([0.0, 0.2, 0.4]), corner), tolerances(), 0.0).strain
    arm = follower()
    assert not arm.start(cubic(5.2, 0.15), tolerances(), 0.0, streamed=True).strain
    with pytest.raises(AccelerationRefusedError):
        follower().start(cubic(5.2, 0.15), tolerances(), 0.0)
    with pytest.raises(AccelerationRefusedError):
        follower().start(with_a_pause(cubic(5.2, 0.15)), tolerances(), 0.0, streamed=True)


def test_points_one_at_a_time_have_no_curve():
    arm = follower(interpolate=False)
    assert not arm.start(cubic(5.2, 0.15), tolerances(), 0.0).strain


def test_joints_that_are_not_named_do_not_count():
    given = cubic(5.2, 0.15)
    positions, velocities = given.positions.copy(), given.velocities.copy()
    positions[:, 1], velocities[:, 1] = np.nan, np.nan
    arm = follower()
    with pytest.raises(AccelerationRefusedError, match="'shoulder'"):
        arm.start(Waypoints(given.times, positions, velocities), tolerances(), 0.0)


def test_plans_sampled_as_moveit_does_are_executed():
    """Wherever between two samples the acceleration changes: the quintic reaches 1.75 times it."""
    highest = 0.0
    for switch in np.linspace(0.05, 0.12, 71):
        given = sampled_bang_bang(1.6 * ACCELERATION, switch, 0.1)
        arm = follower()
        goal = arm.start(given, tolerances(), 0.0)
        highest = max(highest, float(goal.strain.split(", ")[1].split(" times")[0]))
    assert 2.6 < highest < 2.9
