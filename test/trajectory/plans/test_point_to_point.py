"""Common behaviour of all profiles: rejected requests, and properties of every motion."""

from types import SimpleNamespace

import numpy as np
import pytest

from robomech_ros.errors import (
    BadValueError,
    LimitExceededError,
    NonFiniteError,
    RobomechError,
    SeedOutsideLimitsError,
    WrongSizeError,
)
from robomech_ros.trajectory import PROFILES, Limits, point_to_point, verify

JOINTS = ("base", "shoulder", "elbow")
LIMITS = Limits(JOINTS, velocity=1.0, acceleration=2.0, jerk=9.0, lower=-2.0, upper=[2.0, 2.0, 1.0])
START, GOAL = np.array([0.0, 0.5, -1.0]), np.array([1.0, -0.5, 0.9])


@pytest.fixture(params=sorted(PROFILES))
def profile(request):
    return request.param


def test_the_names_of_profiles():
    names = {"poly345", "poly4567", "cycloidal", "cubic_spline", "trapezoidal"}
    assert set(PROFILES) == names | {"double_s", "ruckig", "time_optimal"}


def test_a_profile_is_found_in_capitals_as_well(profile):
    plain = point_to_point(START, GOAL, limits=LIMITS, profile=profile)
    assert isinstance(plain, PROFILES[profile])
    loud = point_to_point(START, GOAL, limits=LIMITS, profile=profile.upper())
    assert loud.duration == plain.duration


@pytest.mark.parametrize("name", ["spline", "", None, 3])
def test_an_unknown_profile_is_refused_with_those_there_are(name):
    with pytest.raises(BadValueError, match="one of cubic_spline, cycloidal, double_s, poly345"):
        point_to_point(START, GOAL, limits=LIMITS, profile=name)


@pytest.mark.parametrize(
    ("changes", "error", "text"),
    [
        ({"q0": [0.0, 0.0]}, WrongSizeError, r"start has shape \(2,\), expected \(3,\)"),
        ({"q1": [[0.0, 0.0, 0.0]]}, WrongSizeError, r"goal has shape \(1, 3\)"),
        ({"q0": [0.0, np.nan, 0.0]}, NonFiniteError, r"start\[1\] is nan"),
        ({"q1": [0.0, 0.0, np.inf]}, NonFiniteError, r"goal\[2\] is inf"),
        (
            {"q0": [0.0, 0.0, 1.5]},
            SeedOutsideLimitsError,
            r"start of joint 'elbow' is 1.5, outside its limits \[-2, 1\] by 0.5",
        ),
        (
            {"q1": [-2.25, 0.0, 0.0]},
            LimitExceededError,
            "goal position of joint 'base' is -2.25, over its limit -2 by 0.25",
        ),
        (
            {"q1": [0.0, 0.0, 1.5]},
            LimitExceededError,
            "goal position of joint 'elbow' is 1.5, over its limit 1 by 0.5",
        ),
        ({"velocity_scale": 0.0}, BadValueError, "velocity_scale is 0.0, expected at least 1e-06"),
        ({"acceleration_scale": 1.5}, BadValueError, "acceleration_scale is 1.5"),
        ({"jerk_scale": float("nan")}, NonFiniteError, "jerk_scale is nan"),
        ({"velocity_scale": -1.0}, BadValueError, "velocity_scale is -1.0"),
        ({"duration": -1.0}, BadValueError, "duration is -1.0"),
        ({"duration": float("inf")}, NonFiniteError, "duration is inf"),
        ({"duration": float("nan")}, NonFiniteError, "duration is nan"),
        ({"duration": 1e-12}, RobomechError, "too short"),
        ({"start_velocity": [0.0]}, RobomechError, "start_velocity"),
        ({"start_velocity": [0.0, 0.0, np.nan]}, NonFiniteError, r"start_velocity\[2\]"),
    ],
)
def test_bad_requests_are_refused(profile, changes, error, text):
    request = {"q0": START, "q1": GOAL, "limits": LIMITS, "profile": profile} | changes
    with pytest.raises(error, match=text):
        point_to_point(**request)


def test_only_some_profiles_start_moving():
    moving = {"limits": LIMITS, "start_velocity": [0.0, 0.1, 0.0]}
    with pytest.raises(BadValueError, match=r"poly345 starts from rest \(ruckig need not\)"):
        point_to_point(START, GOAL, profile="poly345", **moving)
    motion = point_to_point(START, GOAL, profile="ruckig", **moving)
    np.testing.assert_allclose(motion.sample(0.0).velocity, [0.0, 0.1, 0.0])
    resting = moving | {"start_velocity": np.zeros(3)}
    assert point_to_point(START, GOAL, profile="poly345", **resting).duration > 0.0


def test_a_motion_of_no_length_is_short_and_valid(profile):
    motion = point_to_point(START, START, limits=LIMITS, profile=profile)
    assert 0.0 < motion.duration <= 0.01
    assert verify(motion, LIMITS, start=START).ok
    sample = motion.sample(np.linspace(0.0, motion.duration, 5))
    np.testing.assert_array_equal(sample.position, np.tile(START, (5, 1)))
    assert not sample.velocity.any()
    stretched = point_to_point(START, START, limits=LIMITS, profile=profile, duration=2.0)
    assert stretched.duration == 2.0


def test_scales_act_on_their_limits(profile):
    scales = {"velocity_scale": 0.5, "acceleration_scale": 0.25, "jerk_scale": 0.125}
    motion = point_to_point(START, GOAL, limits=LIMITS, profile=profile, **scales)
    scaled = LIMITS.scaled(velocity=0.5, acceleration=0.25, jerk=0.125)
    assert verify(motion, scaled, start=START, to_rest=not motion.ACCELERATION_STEPS).ok
    full = point_to_point(START, GOAL, limits=LIMITS, profile=profile)
    assert motion.duration == pytest.approx(2.0 * full.duration, rel=1e-9)


def test_one_instant_or_many(profile):
    motion = point_to_point(START, GOAL, limits=LIMITS, profile=profile)
    instants = np.linspace(-0.1, motion.duration + 0.1, 40)
    many = motion.sample(instants)
    for k, instant in enumerate(instants):
        one = motion.sample(instant)
        for name in ("position", "velocity", "acceleration", "jerk"):
            assert getattr(one, name).shape == (3,)
            np.testing.assert_allclose(getattr(one, name), getattr(many, name)[k], atol=1e-11)
    with pytest.raises(NonFiniteError):
        motion.sample(np.nan)


def test_derivatives_are_derivatives(profile):
    motion = point_to_point(START, GOAL, limits=LIMITS, profile=profile)
    instants = np.linspace(0.01, motion.duration - 0.01, 60)
    h = 1e-6
    before, after, now = (motion.sample(instants + d) for d in (-h, h, 0.0))
    for value, rate in (("position", "velocity"), ("velocity", "acceleration")):
        slope = (getattr(after, value) - getattr(before, value)) / (2.0 * h)
        np.testing.assert_allclose(slope, getattr(now, rate), atol=1e-4)


def test_the_same_request_twice_gives_the_same_bytes(profile):
    instants = np.linspace(0.0, 3.0, 500)
    first, second = (
        point_to_point(START, GOAL, limits=LIMITS, profile=profile).sample(instants)
        for _ in range(2)
    )
    for name in ("position", "velocity", "acceleration", "jerk"):
        assert getattr(first, name).tobytes() == getattr(second, name).tobytes()


def test_anything_with_the_attributes_serves_as_limits(profile):
    loose = SimpleNamespace(
        joint_names=list(JOINTS), velocity=[1.0] * 3, acceleration=[2.0] * 3, jerk=[9.0] * 3
    )
    motion = point_to_point(START, GOAL, limits=loose, profile=profile)
    assert motion.duration == point_to_point(START, GOAL, limits=LIMITS, profile=profile).duration


def test_a_start_within_the_resolution_of_encoders_counts_as_on_the_limit(profile):
    start = np.array([2.0 + 5e-7, 0.0, 0.0])
    motion = point_to_point(start, GOAL, limits=LIMITS, profile=profile)
    assert verify(motion, LIMITS, start=start, to_rest=not motion.ACCELERATION_STEPS).ok


@pytest.mark.parametrize(
    ("arguments", "error", "text"),
    [
        ({"velocity": [1.0, 1.0]}, WrongSizeError, "velocity limits"),
        ({"velocity": [1.0, 0.0, 1.0]}, BadValueError, "velocity limit of joint 'shoulder' is 0.0"),
        ({"jerk": -1.0}, BadValueError, "jerk limit of joint 'base' is -1.0"),
        ({"lower": 1.0, "upper": 0.0}, BadValueError, "lower limit of joint 'base' is 1.0"),
    ],
)
def test_limits_that_are_none_are_refused(arguments, error, text):
    with pytest.raises(error, match=text):
        Limits(JOINTS, **arguments)
