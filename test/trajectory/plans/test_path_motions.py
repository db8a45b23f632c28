"""Motions along pose paths by every profile: on the path, within all limits, at rest at corners."""

from functools import cache, partial

import numpy as np
import pytest

from robomech_ros.errors import BadValueError, DurationTooShortError, MissingLimitsError
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.kinetostatics import jacobian
from robomech_ros.robots import load_robot
from robomech_ros.spatial import matrix_from_axis_angle
from robomech_ros.trajectory import (
    PATH_PROFILES,
    Limits,
    SerialArm,
    SpeedLimit,
    TipSpeeds,
    along_joint_path,
    along_path,
    arc_path,
    spline_path,
    straight_path,
    track_path,
    verify,
)
from robomech_ros.trajectory.profiles.laws import CUBIC
from robomech_ros.trajectory.profiles.velocity_profiles import unit_double_s, unit_double_s_samples

PUMA = load_robot("puma560")
LIMITS = Limits.of(PUMA)
Q = np.array([0.3, -0.4, 0.2, 0.5, 0.6, -0.7])
START = forward_kinematics(PUMA, Q)
FORWARD = partial(forward_kinematics, PUMA)
ARM = SerialArm(FORWARD, lambda T, near: None, partial(jacobian, PUMA))


def shifted(step, turn=0.0):
    pose = START.copy()
    pose[:3, 3] += step
    pose[:3, :3] = START[:3, :3] @ matrix_from_axis_angle([0.0, 0.0, 1.0], turn)
    return pose


POSES = [START, shifted([0.1, 0.0, 0.0], 0.2), shifted([0.1, 0.1, 0.05])]
PATHS = {
    "straight": straight_path(POSES),
    "spline": spline_path(POSES),
    "arc": arc_path(START, [(shifted([0.05, 0.05, 0.0]), shifted([0.1, 0.0, 0.0]))]),
}


@cache
def followed(kind):
    return track_path(PATHS[kind], ARM, Q)


@cache
def motion(kind, profile, linear=np.inf, angular=np.inf):
    speeds = TipSpeeds(linear, angular)
    path = PATHS[kind]
    return along_joint_path(path, followed(kind), limits=LIMITS, profile=profile, speeds=speeds)


def tool_speeds(one, count=4000):
    """Linear and angular speeds of the tool."""
    sample = one.sample(np.linspace(0.0, one.duration, count))
    twists = np.einsum("kij,kj->ki", jacobian(PUMA, sample.position), sample.velocity)
    return (np.linalg.norm(twists[:, part], axis=1).max() for part in (slice(3, 6), slice(0, 3)))


def test_all_profiles_are_there():
    six = ("poly345", "poly4567", "cycloidal", "cubic_spline", "ruckig", "time_optimal")
    assert six == PATH_PROFILES


@pytest.mark.parametrize("profile", PATH_PROFILES)
@pytest.mark.parametrize("kind", sorted(PATHS))
def test_on_the_path_within_the_limits(kind, profile):
    one = motion(kind, profile)
    report = verify(one, LIMITS, start=Q)
    assert report.ok, report.violation
    ratios = report.peak_velocity_ratio, report.peak_acceleration_ratio, report.peak_jerk_ratio
    assert max(map(max, ratios)) > 0.98
    path = followed(kind).path
    dense = path.derivatives(np.linspace(0.0, path.length, 20_000))[0]
    for q in one.sample(np.linspace(0.0, one.duration, 60)).position:
        assert np.linalg.norm(dense - q, axis=1).min() < 1e-4
    np.testing.assert_allclose(
        FORWARD(one.goal), PATHS[kind].sample(PATHS[kind].length).pose, atol=1e-7
    )


@pytest.mark.parametrize("profile", PATH_PROFILES)
def test_the_motion_rests_at_corners(profile):
    one, corner = motion("straight", profile), followed("straight").path.stops[0]
    q = followed("straight").path.derivatives(corner)[0]
    near = np.linalg.norm(one.pieces.coefficients[0] - q, axis=1)
    at = one.sample(one.pieces.breaks[int(np.argmin(near))])
    np.testing.assert_allclose(at.position, q, atol=1e-9)
    np.testing.assert_allclose(at.velocity, 0.0, atol=1e-9)
    np.testing.assert_allclose(at.acceleration, 0.0, atol=1e-6)


@pytest.mark.parametrize("profile", PATH_PROFILES)
@pytest.mark.parametrize("kind", ["straight", "spline"])
def test_the_tool_keeps_its_speeds(kind, profile):
    one = motion(kind, profile, 0.08, 0.15)
    assert verify(one, LIMITS, start=Q).ok
    linear, angular = tool_speeds(one)
    assert linear < 0.08 * (1.0 + 1e-5) and angular < 0.15 * (1.0 + 1e-5)
    assert linear > 0.079 or angular > 0.149


@pytest.mark.parametrize("kind", sorted(PATHS))
def test_the_time_optimal_motion_is_the_fastest(kind):
    durations = {profile: motion(kind, profile).duration for profile in PATH_PROFILES}
    assert durations["time_optimal"] <= min(durations.values())
    assert durations["ruckig"] < min(durations["cycloidal"], durations["cubic_spline"])


@pytest.mark.parametrize("profile", PATH_PROFILES)
def test_a_wanted_duration_slows_the_whole_motion_down(profile):
    along = partial(along_joint_path, PATHS["arc"], followed("arc"), limits=LIMITS, profile=profile)
    slow = along(duration=5.0)
    assert slow.duration == pytest.approx(5.0, rel=1e-12) and verify(slow, LIMITS, start=Q).ok
    with pytest.raises(DurationTooShortError):
        along(duration=0.9 * motion("arc", profile).duration)


def test_what_is_missing_or_unknown_is_refused():
    without = Limits(PUMA.joint_names, velocity=PUMA.velocity, acceleration=PUMA.acceleration)
    along = partial(along_joint_path, PATHS["arc"], followed("arc"))
    with pytest.raises(MissingLimitsError, match="jerk"):
        along(limits=without, profile="ruckig")
    fast = along(limits=without, profile="time_optimal")
    assert verify(fast, without, start=Q).ok
    assert fast.duration < motion("arc", "time_optimal").duration
    with pytest.raises(BadValueError, match="time_optimal"):
        along(limits=LIMITS, profile="double_s")
    with pytest.raises(BadValueError, match="linear speed"):
        along(limits=LIMITS, speeds=TipSpeeds(-1.0))


@pytest.mark.parametrize("profile", ["poly345", "ruckig", "time_optimal"])
def test_other_speeds_may_be_limited_too(profile):
    """The speed of the path coordinate itself."""
    slow = SpeedLimit(np.ones_like, 0.02)
    one = along_joint_path(
        PATHS["arc"], followed("arc"), limits=LIMITS, profile=profile, speed_limits=[slow]
    )
    linear, _ = tool_speeds(one)
    assert 0.0195 < linear < 0.02 * (1.0 + 1e-5)


def test_along_path_follows_and_times_at_once():
    both = along_path(PATHS["arc"], ARM, limits=LIMITS, start=Q, profile="time_optimal")
    assert both.duration == motion("arc", "time_optimal").duration


def test_where_a_path_cannot_begin_the_motion_rests_at_the_start():
    far = START.copy()
    far[0, 3] += 9.0
    beyond = far.copy()
    beyond[1, 3] += 0.1
    still = along_path(straight_path([far, beyond]), ARM, limits=LIMITS, start=Q)
    assert still.duration == 0.0 and still.fraction == 0.0
    assert "no posture" in still.reason and still.tracking.path is None
    for t in (-1.0, 0.0, 2.0, [0.0, 1.0]):
        sample = still.sample(t)
        assert (sample.position == Q).all() and sample.position.shape == (*np.shape(t), 6)
        assert not np.any([sample.velocity, sample.acceleration, sample.jerk])
    assert verify(still, LIMITS, start=Q).ok


def test_the_law_of_the_cubic_spline():
    assert CUBIC.peaks == pytest.approx({"velocity": 2.0, "acceleration": 8.0, "jerk": 32.0})
    tau = np.linspace(0.0, 1.0, 33)
    way = CUBIC.pieces.sample(tau).position[:, 0]
    np.testing.assert_allclose(CUBIC.progress(tau[:17]), way[:17], atol=1e-15)
    np.testing.assert_allclose(way, 1.0 - way[::-1], atol=1e-15)
    rates = CUBIC.rates(tau)
    np.testing.assert_array_equal([rates.velocity[[0, -1]], rates.acceleration[[0, -1]]], 0.0)


@pytest.mark.parametrize("shape", [(0.5, 1.0), (0.5, 0.3), (0.2, 1.0), (0.01, 0.05)])
def test_double_s_profiles_of_every_shape(shape):
    one = unit_double_s(*shape)
    end = one.sample(one.breaks[-1])
    assert one.duration == pytest.approx(1.0, rel=1e-12)
    np.testing.assert_allclose([*end.position, *end.velocity], [1.0, 0.0], atol=1e-9)
    np.testing.assert_allclose(end.acceleration, 0.0, atol=1e-6)
    middle = one.sample(0.5)
    np.testing.assert_allclose([*middle.position, *middle.velocity], [0.5, 1.0 / (1.0 - shape[0])])


def test_many_double_s_profiles_at_once():
    ramps, roundings, inside = np.array([0.2, 0.01, 0.4]), np.array([0.5, 0.05, 0.9]), [0.25, 0.75]
    many = unit_double_s_samples(ramps, roundings, np.array(inside))
    assert many.shape == (4, 3, 14)
    for k in range(3):
        one = unit_double_s(ramps[k], roundings[k])
        at = (one.breaks[:-1, None] + one.spans[:, None] * inside).ravel()
        for order, values in enumerate(one.sample(at)):
            close = 1e-12 * np.abs(values).max()
            np.testing.assert_allclose(many[order, k], values[:, 0], rtol=1e-9, atol=close)


def test_a_spline_that_turns_straight_back_names_the_pose():
    there_and_back = [START, shifted([0.1, 0.0, 0.0]), shifted([0.02, 0.0, 0.0])]
    with pytest.raises(BadValueError, match=r"poses\[1\] .*need not go straight back"):
        spline_path(there_and_back)


def test_a_motion_does_not_leave_the_path_where_the_joints_turn_within_micrometres():
    """A line of UR5e past its wrist singularity and up to where it can reach no farther."""
    robot = load_robot("ur5e")
    q = np.array([-2.02112, 0.51150177815, 1.60323960568, -2.11269744225, 0.89088395357, -1.755535])
    start = forward_kinematics(robot, q)
    end = start.copy()
    end[:3, 3] += (-0.0884218675075, 0.1448710820146, -0.0759289263756)
    forward = partial(forward_kinematics, robot)
    arm = SerialArm(forward, lambda T, near: None, partial(jacobian, robot))
    path = straight_path([start, end])
    tracking = track_path(path, arm, q)
    assert 0.09 < tracking.reached < 0.1
    one = along_joint_path(path, tracking, limits=Limits.of(robot), profile="ruckig")
    places = forward(one.sample(np.linspace(0.0, one.duration, 20_000)).position)[:, :3, 3]
    way = (end - start)[:3, 3] / np.linalg.norm((end - start)[:3, 3])
    off = np.linalg.norm(np.cross(places - start[:3, 3], way), axis=1)
    assert off.max() < 1e-6
