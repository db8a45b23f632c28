"""The laws from rest to rest: golden extremes, shortest durations, wanted durations."""

import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from robomech_ros.errors import DurationTooShortError, MissingLimitsError, RobomechError
from robomech_ros.trajectory import (
    Cycloidal,
    Limits,
    Polynomial345,
    Polynomial4567,
    Sample,
    point_to_point,
    spline_through,
    verify,
)
from robomech_ros.trajectory.profiles.rest_to_rest import CubicSplineMotion

GOLDEN = json.loads(
    (Path(__file__).parents[2] / "data" / "golden" / "ppo_profiles.json").read_text()
)
JOINTS = ("base", "shoulder", "elbow")
UNLIMITED = Limits(JOINTS, velocity=[1e9] * 3, acceleration=[1e9] * 3)
LAWS = {"poly345": "345", "poly4567": "4567", "cycloidal": "cycloidal"}
ALL = (*LAWS, "cubic_spline")


def rates(sample):
    return {"velocity": sample.velocity, "acceleration": sample.acceleration, "jerk": sample.jerk}


@pytest.mark.parametrize("duration", [1.0, 0.25, 7.0])
@pytest.mark.parametrize("profile", LAWS)
def test_golden_extremes(profile, duration):
    rise = np.array([1.0, -2.0, 0.5])
    motion = point_to_point(np.zeros(3), rise, limits=UNLIMITED, profile=profile, duration=duration)
    golden = GOLDEN["profiles"][LAWS[profile]]
    for order, name in enumerate(("velocity", "acceleration", "jerk"), 1):
        scaled = rise / duration**order
        for end in ("max", "min"):
            for place in golden[name][f"at_{end}"]:
                tau = eval(place, {"sqrt": np.sqrt})
                value = rates(motion.sample(tau * duration))[name]
                np.testing.assert_allclose(
                    value, golden[name][f"{end}_num"] * scaled, rtol=1e-12, atol=1e-12
                )
        peak = np.abs([golden[name]["max_num"], golden[name]["min_num"]]).max()
        assert motion.LAW.peaks[name] == pytest.approx(peak, rel=1e-14)


@pytest.mark.parametrize(
    ("limits", "shortest", "joint", "limit"),
    [
        ({"velocity": [1e3, 0.5, 1e3], "acceleration": 1e3}, 15 / 8 / 0.5, "shoulder", "velocity"),
        (
            {"velocity": 1e3, "acceleration": [1e3, 1e3, 2.0]},
            (10 * np.sqrt(3) / 3 / 2.0) ** 0.5,
            "elbow",
            "acceleration",
        ),
        (
            {"velocity": 1e3, "acceleration": 1e3, "jerk": [7.0, np.nan, np.nan]},
            (60 / 7.0) ** (1 / 3),
            "base",
            "jerk",
        ),
    ],
)
def test_the_shortest_duration_and_what_binds(limits, shortest, joint, limit):
    allowed = Limits(JOINTS, **limits)
    start, goal = np.array([0.1, 0.2, 0.3]), np.array([1.1, 1.2, -0.7])
    motion = point_to_point(start, goal, limits=allowed, profile="poly345")
    assert motion.duration == pytest.approx(shortest, rel=1e-12)
    peaks = verify(motion, allowed, start=start)
    assert peaks.ok
    peak = getattr(peaks, f"peak_{limit}_ratio")[JOINTS.index(joint)]
    assert peak == pytest.approx(1.0, rel=1e-9)
    longer = point_to_point(start, goal, limits=allowed, profile="poly345", duration=9.0)
    assert longer.duration == 9.0
    with pytest.raises(DurationTooShortError) as caught:
        point_to_point(start, goal, limits=allowed, profile="poly345", duration=shortest * 0.99)
    assert (caught.value.joint, caught.value.limit) == (joint, limit)
    assert caught.value.shortest == pytest.approx(shortest, rel=1e-12)
    for part in (f"{shortest:.9g}", joint, limit):
        assert part in str(caught.value)


def test_the_duration_of_a_plan_rounded_to_nanoseconds_can_be_asked_for_again():
    allowed = Limits(JOINTS, velocity=0.7, acceleration=1.9, jerk=13.0)
    start, goal = np.zeros(3), np.array([1.0, 2.0, 3.0])
    shortest = point_to_point(start, goal, limits=allowed, profile="poly345").duration
    rounded = np.floor(shortest * 1e9) / 1e9
    again = point_to_point(start, goal, limits=allowed, profile="poly345", duration=rounded)
    assert again.duration == shortest


@pytest.mark.parametrize("profile", ALL)
def test_ends_are_exact(profile):
    start, goal = np.array([0.1, -2.3, 3.0]), np.array([1 / 3, 2.7, -2.9])
    motion = point_to_point(start, goal, limits=UNLIMITED, profile=profile, duration=1.7)
    for instant, place in ((0.0, start), (motion.duration, goal), (-1.0, start), (99.0, goal)):
        sample = motion.sample(instant)
        np.testing.assert_array_equal(sample.position, place)
        np.testing.assert_array_equal(sample.velocity, 0.0)
        np.testing.assert_array_equal(sample.acceleration, 0.0)
        if not 0.0 <= instant <= motion.duration:
            np.testing.assert_array_equal(sample.jerk, 0.0)


@pytest.mark.parametrize("profile", ALL)
def test_pieces_are_the_same_curve(profile):
    start, goal = np.array([0.1, -2.3, 3.0]), np.array([1 / 3, 2.7, -2.9])
    motion = point_to_point(start, goal, limits=UNLIMITED, profile=profile, duration=1.7)
    instants = np.linspace(0.0, 1.7, 101)
    one, other = motion.sample(instants), motion.pieces.sample(instants)
    # The cycloidal motion is no polynomial; its pieces are so near to it.
    for name, tolerance in zip(Sample._fields, (1e-13, 1e-11, 1e-9, 1e-7), strict=True):
        np.testing.assert_allclose(getattr(one, name), getattr(other, name), atol=tolerance)


def test_velocity_and_acceleration_limits_are_needed_and_jerk_limits_are_not():
    with pytest.raises(MissingLimitsError, match="no acceleration limit for joint elbow"):
        point_to_point(
            np.zeros(3),
            np.ones(3),
            limits=Limits(JOINTS, velocity=1.0, acceleration=[1.0, 1.0, np.nan]),
        )
    with pytest.raises(MissingLimitsError, match="no velocity limit for joints base, shoulder"):
        point_to_point(np.zeros(3), np.ones(3), limits=Limits(JOINTS, acceleration=1.0))
    free = Limits(JOINTS, velocity=1.0, acceleration=1.0)
    assert point_to_point(np.zeros(3), np.ones(3), limits=free).duration > 0.0
    with pytest.raises(MissingLimitsError, match="no jerk limit"):
        point_to_point(np.zeros(3), np.ones(3), limits=free, jerk_scale=0.5)


@pytest.mark.parametrize("profile", ALL)
@settings(max_examples=60, deadline=None)
@given(
    rise=st.lists(st.floats(-6.0, 6.0), min_size=3, max_size=3),
    velocity=st.floats(0.01, 10.0),
    acceleration=st.floats(0.01, 100.0),
    jerk=st.one_of(st.none(), st.floats(0.1, 1e4)),
)
def test_any_motion_is_within_its_limits_and_no_slower_than_needed(
    profile, rise, velocity, acceleration, jerk
):
    allowed = Limits(JOINTS, velocity=velocity, acceleration=acceleration, jerk=jerk)
    motion = point_to_point(np.zeros(3), rise, limits=allowed, profile=profile)
    report = verify(motion, allowed, start=np.zeros(3))
    assert report.ok, report.violation
    peaks = (report.peak_velocity_ratio, report.peak_acceleration_ratio, report.peak_jerk_ratio)
    assert motion.duration == 1e-3 or np.max(peaks) == pytest.approx(1.0, rel=1e-9)


def test_the_law_of_cubic_spline_is_the_spline_through_both_points():
    allowed = Limits(JOINTS, velocity=1.0, acceleration=2.0, jerk=9.0)
    start, goal = np.array([0.1, 0.2, 0.3]), np.array([1.1, -0.4, 0.3])
    motion = point_to_point(start, goal, limits=allowed, profile="cubic_spline")
    spline = spline_through([start, goal], limits=allowed, ends="rest")
    assert motion.duration == pytest.approx(spline.duration, rel=1e-13)
    instants = (np.arange(1000) + 0.5) / 1000 * motion.duration  # the jerk steps at breaks
    for one, other in zip(motion.sample(instants), spline.sample(instants), strict=True):
        np.testing.assert_allclose(one, other, rtol=0.0, atol=1e-11)


@pytest.mark.parametrize("law", [Polynomial345, Polynomial4567, Cycloidal, CubicSplineMotion])
def test_a_motion_may_be_made_from_lists(law):
    made, same = law([0, 1], [1, 1], 2), law(np.array([0.0, 1.0]), np.array([1.0, 1.0]), 2.0)
    for one, other in zip(made.sample([0.0, 0.7, 2.0]), same.sample([0.0, 0.7, 2.0]), strict=True):
        np.testing.assert_array_equal(one, other)
    for wrong, text in (
        (([0.0], [1.0, 2.0], 1.0), "goal has shape"),
        ((0.0, 1.0, 1.0), "start has shape"),
        (([], [], 1.0), "start has shape"),
        ((["a"], [1.0], 1.0), "start is"),
        (([0.0], [np.nan], 1.0), "goal"),
        (([0.0], [1.0], 0.0), "duration is 0.0, expected 0.001 s or more"),
        (([0.0], [1.0], np.inf), "duration is inf"),
    ):
        with pytest.raises(RobomechError, match=text):
            law(*wrong)
