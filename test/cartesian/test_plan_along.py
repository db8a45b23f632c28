"""Cartesian plans of every library robot: on the path, within the limits, as far as they go."""

import numpy as np
import pytest

from robomech_ros.cartesian import (
    PathStopLimits,
    Sampling,
    follow_path,
    link_speed_limit,
    plan_along,
    plan_followed,
    serial_arm,
    waypoint_path,
)
from robomech_ros.errors import BadValueError, MissingLimitsError, RobomechError, UnknownJointError
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.robots import list_robots, load_description, load_robot
from robomech_ros.trajectory import (
    PATH_PROFILES,
    Limits,
    PathTrackingStatus,
    TipSpeeds,
    along_path,
    tracking_error,
    verify,
)

PUMA = load_robot("puma560")
START = np.array([0.3, -0.4, 0.2, 0.5, 0.6, -0.7])
HERE = forward_kinematics(PUMA, START)


def shifted(*steps, of=HERE):
    poses = np.tile(of, (len(steps), 1, 1))
    poses[:, :3, 3] += steps
    return poses


def limits_of(chain):
    """Limits of the robot, with velocities and accelerations where it states none."""
    stated = Limits.of(chain)
    velocity, acceleration = (
        np.where(np.isfinite(values), values, usual)
        for values, usual in ((stated.velocity, 1.0), (stated.acceleration, 5.0))
    )
    position = {"lower": stated.lower, "upper": stated.upper}
    return Limits(chain.joint_names, velocity, acceleration, stated.jerk, **position)


def off_the_path(path, poses):
    """How far the origins of poses are from the nearest place of a path (m)."""
    places = path.sample(np.linspace(0.0, path.length, 20_001)).pose[:, :3, 3]
    nearest = [np.linalg.norm(places - pose[:3, 3], axis=1).min() for pose in poses]
    return max(nearest)


@pytest.mark.parametrize("enough", [2, pytest.param(4, marks=pytest.mark.long)])
@pytest.mark.parametrize("name", list_robots())
def test_plans_of_all_robots_keep_to_path_and_limits(name, enough):
    """Random lines, often too long to be followed: what is planned holds, the rest has a reason."""
    chain = load_robot(name)
    limits, rng = limits_of(chain), np.random.default_rng(3)
    middle = chain.midrange()
    low, high = np.maximum(chain.lower, middle - 1.0), np.minimum(chain.upper, middle + 1.0)
    planned = 0
    for _ in range(4):
        if planned == enough:
            break
        start = low + (high - low) * rng.uniform(0.2, 0.8, chain.n)
        here = forward_kinematics(chain, start)
        ends = shifted(rng.uniform(-0.15, 0.15, 3), of=here)
        path = waypoint_path(here, ends)
        plan = plan_along(chain, path, start, limits=limits)
        assert 0.0 <= plan.fraction <= 1.0 and (plan.stop is None) == (plan.fraction == 1.0)
        if plan.stop is not None:
            assert plan.stop.kind is not PathTrackingStatus.COMPLETE and plan.stop.index == 0
            assert plan.stop.text and plan.stop.joint in (None, *chain.joint_names)
        if plan.trajectory is None:
            assert plan.fraction == 0.0 and plan.samples is None
            continue
        planned += 1
        points = plan.samples
        report = verify(points, limits, start=start, start_tolerance=1e-6)
        assert report.ok, report.violation
        assert not points.velocities[-1].any() and not points.accelerations[-1].any()
        q = points.curve.sample(np.linspace(0.0, points.times[-1], 50)).position
        assert off_the_path(path, forward_kinematics(chain, q)) < 1e-5
        s = np.linspace(0.0, plan.followed.joints.length, 50)
        errors = tracking_error(path, serial_arm(chain), plan.followed.joints, s)
        assert np.abs(errors).max() < 2e-7
    assert planned or chain.n < 6


@pytest.mark.parametrize("profile", PATH_PROFILES)
def test_every_profile_gives_the_partial_motion(profile):
    waypoints = shifted([0.1, 0.0, 0.0], [2.0, 0.0, 0.0])
    path = waypoint_path(HERE, waypoints)
    plan = plan_along(PUMA, path, START, profile=profile, speeds=TipSpeeds(linear=0.4))
    assert plan.stop.index == 1 and 0.1 < plan.fraction < 0.9
    last = forward_kinematics(PUMA, plan.trajectory.sample(plan.trajectory.duration).position)
    np.testing.assert_allclose(last, path.sample(plan.fraction * path.length).pose, atol=1e-6)
    assert verify(plan.trajectory, PUMA, start=START).ok
    tips = forward_kinematics(PUMA, plan.samples.positions)[:, :3, 3]
    speeds = np.linalg.norm(np.diff(tips, axis=0), axis=1) / np.diff(plan.samples.times)
    assert speeds.max() < 0.4 * (1.0 + 1e-6)


def test_samples_are_as_fine_and_as_few_as_wanted():
    path = waypoint_path(HERE, shifted([0.2, 0.0, 0.0]))
    usual = plan_along(PUMA, path, START)
    assert np.diff(usual.samples.times).max() <= 0.01 * (1.0 + 1e-9)
    slow = TipSpeeds(linear=0.01)
    few = plan_along(PUMA, path, START, speeds=slow, sampling=Sampling(max_points=400))
    assert 200 < len(few.samples.times) <= 400
    followed = follow_path(PUMA, path, START)
    fine = plan_followed(followed, sampling=Sampling(period=1.0, max_step=0.002))
    tips = forward_kinematics(PUMA, fine.waypoints.positions)[:, :3, 3]
    assert np.linalg.norm(np.diff(tips, axis=0), axis=1).max() <= 0.002

    def largest(**sampling):
        plan = plan_followed(followed, sampling=Sampling(period=1.0, **sampling))
        places = forward_kinematics(PUMA, plan.waypoints.positions)[:, :3, 3]
        return np.linalg.norm(np.diff(places, axis=0), axis=1).max()

    widest = largest()
    assert largest(max_step=0.7 * widest) <= 0.7 * widest
    for sampling, text in (
        (Sampling(max_duration=3.0), "at most 3 s, the parameter max_duration"),
        (Sampling(max_points=10), "at most 10, the parameter max_points"),
        (Sampling(max_step=1e-6), "the parameter max_points, are enough"),
    ):
        with pytest.raises(BadValueError, match=text):
            plan_followed(followed, speeds=slow, sampling=sampling)


def test_the_speed_of_another_link_is_kept():
    path = waypoint_path(HERE, shifted([0.2, 0.0, 0.0]))
    followed = follow_path(PUMA, path, START)
    elbow = load_robot("puma560", tip="link_3")
    hand = load_description("puma560").chain("link_1", "tool0")
    for link, first in ((elbow, 0), (hand, 1)):
        slow = link_speed_limit(PUMA, followed.joints, link, 0.02)
        plan = plan_followed(followed, speed_limits=[slow], profile="time_optimal")
        q = plan.waypoints.positions[:, first : first + link.n]
        places = forward_kinematics(link, q)[:, :3, 3]
        speeds = np.linalg.norm(np.diff(places, axis=0), axis=1) / np.diff(plan.waypoints.times)
        assert 0.019 < speeds.max() < 0.02 * (1.0 + 1e-5)
    with pytest.raises(UnknownJointError, match="waist"):
        link_speed_limit(load_robot("scara"), followed.joints, PUMA, 0.1)


def test_a_stricter_position_limit_ends_the_motion_there():
    path = waypoint_path(HERE, shifted([0.2, 0.0, 0.0]))
    whole = plan_along(PUMA, path, START)
    end = whole.samples.positions[-1]
    k = int(np.argmax(np.abs(end - START)))
    half = 0.5 * (START[k] + end[k])
    edges = {"lower": PUMA.lower.copy(), "upper": PUMA.upper.copy()}
    edges["upper" if end[k] > START[k] else "lower"][k] = half
    tight = Limits(PUMA.joint_names, PUMA.velocity, PUMA.acceleration, **edges)
    plan = plan_along(PUMA, path, START, limits=tight)
    assert plan.stop.kind is PathTrackingStatus.LIMIT
    assert plan.stop.joint == PUMA.joint_names[k] and 0.0 < plan.fraction < 1.0
    assert plan.samples.positions[-1, k] == pytest.approx(half, abs=1e-8)
    assert verify(plan.samples, tight, start=START).ok


@pytest.mark.parametrize("near_limit", [0.0, 0.05])
def test_along_path_gives_the_same_partial_motion(near_limit):
    """Also from a seed at its limit, which the inverse kinematics would refuse from beyond."""
    q = START.copy()
    q[0] = PUMA.upper[0] - near_limit
    here = forward_kinematics(PUMA, q)
    back, beyond = (
        forward_kinematics(PUMA, q + [turn, 0, 0, 0, 0, 0]) for turn in (-0.1, 0.1 + near_limit)
    )
    path = waypoint_path(here, [back, beyond])
    motion = along_path(path, serial_arm(PUMA), limits=PUMA, start=q)
    assert motion.tracking.status is PathTrackingStatus.LIMIT and motion.tracking.joint == 0
    assert "joint 'waist' would leave its limits" in motion.reason
    followed = follow_path(PUMA, path, q, bounds=PathStopLimits(1e6, 0.01, np.inf, np.inf))
    assert motion.fraction == followed.fraction
    assert followed.stop.text == f"before waypoints[1], {motion.reason}"
    assert 0.0 < motion.fraction < 1.0
    last = motion.sample(motion.duration)
    assert last.position[0] == pytest.approx(PUMA.upper[0], abs=1e-8)
    assert not last.velocity.any() and verify(motion, PUMA, start=q).ok
    out = along_path(waypoint_path(here, [beyond]), serial_arm(PUMA), limits=PUMA, start=q)
    assert (out.fraction < 1e-4) == (near_limit == 0.0) and "waist" in out.reason


def test_a_limit_that_is_missing_is_named():
    chain = load_robot("puma560")
    limits = Limits(chain.joint_names, velocity=1.0)
    path = waypoint_path(HERE, shifted([0.1, 0.0, 0.0]))
    with pytest.raises(MissingLimitsError, match="waist"):
        plan_along(chain, path, START, limits=limits)
    for options in ({"profile": "sledge"}, {"sampling": 0.01}, {"speeds": 3.0}):
        with pytest.raises(RobomechError, match=next(iter(options))):
            plan_along(chain, path, START, **options)
    with pytest.raises(BadValueError, match="a PathFollowingResult"):
        plan_followed(None)


@pytest.mark.parametrize(
    ("field", "value"),
    [("period", -1.0), ("period", np.inf), ("max_points", 1), ("max_duration", 0.0)]
    + [("max_points", 2.5), ("max_step", np.nan)],
)
def test_a_sampling_that_cannot_be_is_refused(field, value):
    with pytest.raises(BadValueError, match=field):
        Sampling(**{field: value})
