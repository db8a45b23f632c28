"""One polynomial through via points: conditions, limits, and what is refused."""

import numpy as np
import pytest

from robomech_ros.errors import (
    BadValueError,
    DurationTooShortError,
    LimitExceededError,
    MissingLimitsError,
    NonFiniteError,
    WrongSizeError,
)
from robomech_ros.trajectory import Limits, point_to_point, through_points, verify, via_polynomial

LIMITS = Limits(("x", "y", "z"), velocity=1.0, acceleration=5.0, jerk=90.0)
# Pick, lift off, set down, place.
POINTS = np.array([[0.0, 0, 0], [0.1, 0.05, 0.3], [0.7, 0.45, 0.3], [0.8, 0.5, 0.0]])


@pytest.mark.parametrize("profile", ["poly345", "poly4567"])
@pytest.mark.parametrize("via", [[], [1], [2], [1, 2]])
def test_all_points_are_passed_and_the_ends_are_at_rest(profile, via):
    points = POINTS[[0, *via, 3]]
    motion = via_polynomial(points, limits=LIMITS, profile=profile)
    np.testing.assert_allclose(motion.sample(motion.knots).position, points, atol=1e-12)
    first, last = motion.sample(0.0), motion.sample(motion.duration)
    np.testing.assert_array_equal([first.velocity, first.acceleration], 0.0)
    np.testing.assert_array_equal([last.velocity, last.acceleration], 0.0)
    near = motion.pieces.sample(motion.duration)
    np.testing.assert_allclose([near.velocity, near.acceleration], 0.0, atol=1e-10)
    if profile == "poly4567":
        np.testing.assert_allclose([first.jerk, near.jerk], 0.0, atol=1e-8)
    assert len(motion.pieces.coefficients) == (6 if profile == "poly345" else 8) + len(via)
    report = verify(motion, LIMITS, start=points[0])
    assert report.ok, report.violation
    peaks = [
        getattr(report, f"peak_{rate}_ratio").max() for rate in ("velocity", "acceleration", "jerk")
    ]
    assert max(peaks) == pytest.approx(1.0, rel=1e-9)


@pytest.mark.parametrize("profile", ["poly345", "poly4567"])
def test_without_via_points_it_is_the_law(profile):
    motion = via_polynomial(POINTS[[0, 3]], limits=LIMITS, profile=profile)
    law = point_to_point(POINTS[0], POINTS[3], limits=LIMITS, profile=profile)
    assert motion.duration == pytest.approx(law.duration, rel=1e-9)
    instants = np.linspace(0.0, law.duration, 50)
    np.testing.assert_allclose(
        motion.sample(instants).position, law.sample(instants).position, atol=1e-9
    )


def test_instants_and_durations_of_choice():
    motion = via_polynomial(POINTS, limits=LIMITS, at=[0.25, 0.75], duration=8.0)
    assert motion.duration == 8.0
    np.testing.assert_allclose(motion.sample([2.0, 6.0]).position, POINTS[1:3], atol=1e-12)
    shortest = via_polynomial(POINTS, limits=LIMITS, at=[0.25, 0.75]).duration
    with pytest.raises(DurationTooShortError):
        via_polynomial(POINTS, limits=LIMITS, at=[0.25, 0.75], duration=0.99 * shortest)


@pytest.mark.parametrize(
    ("changes", "error", "text"),
    [
        ({"points": np.zeros((5, 3))}, WrongSizeError, "m from 2 to 4"),
        ({"points": np.zeros((3, 2))}, WrongSizeError, r"\(m, 3\)"),
        ({"points": np.full((3, 3), np.nan)}, NonFiniteError, r"points\[0\]"),
        ({"profile": "cycloidal"}, BadValueError, "poly345, poly4567"),
        ({"at": [0.5]}, WrongSizeError, "at"),
        ({"at": [0.7, 0.5]}, BadValueError, "between 0 and 1"),
        ({"at": [0.5, np.nan]}, BadValueError, "between 0 and 1"),
        ({"limits": Limits(("x", "y", "z"), velocity=1.0)}, MissingLimitsError, "acceleration"),
        (
            {"limits": Limits(("x", "y", "z"), velocity=1, acceleration=5, upper=[1, 1, 0.2])},
            LimitExceededError,
            "joint 'z'|joint z",
        ),
    ],
)
def test_bad_requests_are_refused(changes, error, text):
    request = {"points": POINTS, "limits": LIMITS} | changes
    with pytest.raises(error, match=text):
        via_polynomial(request.pop("points"), **request)


@pytest.mark.parametrize("near", [1e-3, 1e-6, 0.0])
@pytest.mark.parametrize("profile", ["poly345", "poly4567", "cubic_spline", "time_optimal"])
def test_issue_12_a_via_point_near_an_end_costs_no_time(profile, near):
    limits = Limits(("x", "y"), velocity=1.0, acceleration=2.0, jerk=20.0)
    for points in ([[0, 0], [near, 0], [1, 1]], [[1, 1], [1 - near, 1], [0, 0]]):
        motion = through_points(points, limits=limits, profile=profile)
        # By poly4567 it took 37.5 s where 2.4 s do, and 29,954 s for 1e-6.
        direct = point_to_point(points[0], points[-1], limits=limits, profile="poly4567")
        assert motion.duration < 1.2 * direct.duration
        np.testing.assert_allclose(motion.sample(motion.knots).position, points, atol=1e-9)
        assert verify(motion, limits, start=points[0]).ok


@pytest.mark.parametrize("profile", ["poly345", "poly4567"])
def test_issue_12_free_instants_are_the_best_of_all(profile):
    rng = np.random.default_rng(12)
    for vias in (1, 1, 1, 2, 2, 2):
        points = rng.uniform(-1.0, 1.0, (vias + 2, 3))
        best = via_polynomial(points, limits=LIMITS, profile=profile).duration
        tried = np.sort(rng.uniform(0.01, 0.99, (400, vias)), axis=1)
        durations = [
            via_polynomial(points, limits=LIMITS, profile=profile, at=at).duration for at in tried
        ]
        assert best <= min(durations)


def test_issue_12_free_instants_keep_inside_position_limits():
    points = np.array([[0.0, 0.0], [0.9, 0.3], [0.9, 1.0]])
    bounds = {"velocity": 1.0, "acceleration": 5.0, "jerk": 90.0}
    swing = via_polynomial(points, limits=Limits(("x", "y"), **bounds))
    highest = swing.sample(np.linspace(0.0, swing.duration, 500)).position[:, 0].max()
    assert highest > 0.91
    tight = Limits(("x", "y"), **bounds, upper=[0.5 * (0.9 + highest), 2.0])
    inside = via_polynomial(points, limits=tight)
    assert verify(inside, tight, start=points[0]).ok
    assert swing.duration < inside.duration < 1.3 * swing.duration
