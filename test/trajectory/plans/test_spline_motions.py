"""Splines: golden numbers, scipy, ends, spacings, limits, and what is refused."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.interpolate import CubicSpline, make_interp_spline

from robomech_ros.errors import (
    BadValueError,
    DurationTooShortError,
    LimitExceededError,
    MissingLimitsError,
    NonFiniteError,
    RobomechError,
    SeedOutsideLimitsError,
    WrongSizeError,
)
from robomech_ros.trajectory import (
    Limits,
    point_to_point,
    spline_like,
    spline_through,
    through_points,
    verify,
)

GOLDEN = json.loads(
    (Path(__file__).parents[2] / "data" / "golden" / "cubic_spline.json").read_text()
)
JOINTS = tuple(f"joint_{k}" for k in range(4))
LIMITS = Limits(JOINTS, velocity=1.5, acceleration=4.0, jerk=40.0, lower=-3.0, upper=3.0)
RATES = ("velocity", "acceleration", "jerk")


def random_points(seed, count=8, joints=4):
    rng = np.random.default_rng(seed)
    return rng.uniform(-2.0, 2.0, (count, joints)), np.cumsum(rng.uniform(0.1, 1.0, count))


def test_golden_natural_spline():
    spline = spline_through(np.array(GOLDEN["s"])[:, None], times=GOLDEN["x"], ends="natural")
    for power, name in enumerate("DCBA"):
        np.testing.assert_allclose(
            spline.pieces.coefficients[power, :, 0], GOLDEN[name], rtol=1e-12, atol=1e-12
        )


def test_golden_periodic_spline():
    points = np.array(GOLDEN["s_periodic"])[:, None]
    spline = spline_through(points, times=GOLDEN["x"], ends="periodic")
    second = spline.sample(np.array(GOLDEN["x"])).acceleration[:, 0]
    np.testing.assert_allclose(second, GOLDEN["second_derivatives_periodic"], atol=1e-12)


@pytest.mark.parametrize("count", [2, 3, 4, 30])
@pytest.mark.parametrize("ends", ["natural", "clamped"])
def test_scipy_gives_the_same_cubic_spline(ends, count):
    points, times = random_points(count, count)
    slopes = np.random.default_rng(1).normal(size=(2, 4)) if ends == "clamped" else None
    conditions = ends if slopes is None else tuple((1, slope) for slope in slopes)
    theirs = CubicSpline(times, points, bc_type=conditions)
    ours = spline_through(points, times=times, ends=ends, slopes=slopes)
    instants = np.linspace(times[0], times[-1], 500)
    sample = ours.sample(instants)
    scale = 1.0 + np.abs(theirs(instants, 2)).max()
    np.testing.assert_allclose(sample.position, theirs(instants), atol=1e-12)
    np.testing.assert_allclose(sample.acceleration, theirs(instants, 2), atol=1e-12 * scale)


@pytest.mark.parametrize("count", [3, 4, 30])
def test_scipy_gives_the_same_periodic_spline(count):
    points, times = random_points(count, count)
    points[-1] = points[0]
    theirs = CubicSpline(times, points, bc_type="periodic")
    instants = np.linspace(times[0], times[-1], 500)
    ours = spline_through(points, times=times, ends="periodic").sample(instants)
    np.testing.assert_allclose(ours.position, theirs(instants), atol=1e-12)


def test_parabolic_ends_have_constant_acceleration():
    points, times = random_points(5)
    spline = spline_through(points, times=times, ends="parabolic")
    np.testing.assert_allclose(spline.pieces.coefficients[3, [0, -1]], 0.0, atol=1e-12)
    np.testing.assert_allclose(spline.sample(times).position, points, atol=1e-12)


@pytest.mark.parametrize("count", [2, 3, 4, 9])
@pytest.mark.parametrize("degree", [3, 5])
def test_ends_at_rest(degree, count):
    points, times = random_points(7, count)
    times -= times[0]
    spline = spline_through(points, times=times, degree=degree)
    np.testing.assert_allclose(spline.sample(times).position, points, atol=1e-12)
    first, last = spline.sample(times[0]), spline.sample(times[-1])
    # Rounding of the accelerations on the way, which differs between processors.
    largest = np.abs(spline.sample(np.linspace(0.0, times[-1], 500)).acceleration).max()
    rounding = 1e-12 * max(10.0, largest)
    np.testing.assert_allclose([first.velocity, first.acceleration], 0.0, atol=rounding)
    np.testing.assert_array_equal(last.position, points[-1])
    np.testing.assert_array_equal([last.velocity, last.acceleration], 0.0)
    breaks, step = spline.pieces.breaks[1:-1], 1e-9
    before, after = spline.sample(breaks - step), spline.sample(breaks + step)
    for name in ("position", "velocity", "acceleration") + (("jerk",) if degree == 5 else ()):
        one, other = getattr(before, name), getattr(after, name)
        np.testing.assert_allclose(one, other, atol=1e-4 * (1.0 + np.abs(one).max(initial=0.0)))


def test_scipy_gives_the_same_natural_quintic_spline():
    points, times = random_points(3, 9)
    zero = np.zeros(4)
    theirs = make_interp_spline(times, points, 5, bc_type=([(3, zero), (4, zero)],) * 2)
    instants = np.linspace(times[0], times[-1], 300)
    ours = spline_through(points, times=times, ends="natural", degree=5).sample(instants)
    np.testing.assert_allclose(ours.position, theirs(instants), atol=1e-10)
    np.testing.assert_allclose(ours.jerk, theirs(instants, 3), atol=1e-7)


def test_scipy_gives_the_same_periodic_quintic_spline():
    points, times = random_points(3, 9)
    points[-1] = points[0]
    theirs = make_interp_spline(times, points, 5, bc_type="periodic")
    instants = np.linspace(times[0], times[-1], 300)
    ours = spline_through(points, times=times, ends="periodic", degree=5).sample(instants)
    np.testing.assert_allclose(ours.position, theirs(instants), atol=1e-9)


@pytest.mark.parametrize("spacing", ["uniform", "chord", "centripetal", "balanced", "optimal"])
@pytest.mark.parametrize("seed", range(5))
def test_the_fastest_motion_fills_the_limits(seed, spacing):
    points, _ = random_points(seed, 6)
    wide = Limits(JOINTS, velocity=1.5, acceleration=4.0, jerk=40.0)
    spline = spline_through(points, limits=wide, spacing=spacing)
    report = verify(spline, wide, start=points[0])
    assert report.ok, report.violation
    peaks = [getattr(report, f"peak_{rate}_ratio").max() for rate in RATES]
    assert max(peaks) == pytest.approx(1.0, rel=1e-9)
    np.testing.assert_allclose(spline.sample(spline.knots).position, points, atol=1e-10)
    slow = spline_through(points, limits=wide, spacing=spacing, duration=60.0)
    assert slow.duration == pytest.approx(60.0) and verify(slow, wide).ok
    with pytest.raises(DurationTooShortError):
        spline_through(points, limits=wide, spacing=spacing, duration=0.98 * spline.duration)


def test_optimal_knots_are_the_fastest():
    gains = []
    for seed in range(10):
        points, _ = random_points(seed, 8)
        wide = Limits(JOINTS, velocity=1.5, acceleration=4.0, jerk=40.0)
        durations = {
            spacing: spline_through(points, limits=wide, spacing=spacing).duration
            for spacing in ("uniform", "chord", "centripetal", "balanced", "optimal")
        }
        assert durations["optimal"] <= durations["centripetal"]
        gains.append(durations["optimal"] / min(durations.values()))
    np.testing.assert_allclose(gains, 1.0)


def test_points_that_coincide_are_passed_twice():
    points = np.array([[0.0], [1.0], [1.0], [2.0]])
    limits = Limits(("slide",), velocity=1.0, acceleration=2.0)
    spline = spline_through(points, limits=limits)
    np.testing.assert_allclose(spline.sample(spline.knots).position, points, atol=1e-12)
    still = spline_through(np.ones((3, 1)), limits=limits)
    assert still.duration == pytest.approx(1e-3) and (still.sample([0.0, 5e-4]).position == 1).all()


@pytest.mark.parametrize(
    ("changes", "error", "text"),
    [
        ({"points": [[0.0, 0, 0, 0]]}, WrongSizeError, "points"),
        ({"points": [0.0, 1.0]}, WrongSizeError, "points"),
        ({"points": [[0.0] * 4, [np.nan] * 4]}, NonFiniteError, r"points\[1\]"),
        ({"points": "fast"}, BadValueError, "points"),
        ({"points": [[0.0] * 3, [1.0] * 3]}, WrongSizeError, "joints of points"),
        ({"points": [[9.0] * 4, [1.0] * 4]}, SeedOutsideLimitsError, "start"),
        ({"points": [[0.0] * 4, [3.5] * 4, [0.0] * 4]}, LimitExceededError, "on the way"),
        ({"limits": None}, BadValueError, "limits"),
        ({"limits": Limits(JOINTS, velocity=1.0)}, MissingLimitsError, "acceleration"),
        ({"spacing": "even"}, BadValueError, "uniform, centripetal, chord, balanced, optimal"),
        ({"ends": "loose"}, BadValueError, "natural, clamped, parabolic, rest, periodic"),
        ({"ends": "periodic"}, BadValueError, r"points\[2\]"),
        ({"ends": "parabolic", "points": [[0.0] * 4, [1.0] * 4]}, WrongSizeError, "at least 3"),
        ({"degree": 4}, BadValueError, "3 or 5"),
        ({"degree": 5, "ends": "parabolic"}, BadValueError, "clamped, rest, periodic$"),
        ({"degree": 5, "spacing": "optimal"}, BadValueError, "spacing"),
        ({"degree": 5, "spacing": "balanced"}, BadValueError, "spacing"),
        ({"duration": np.nan}, NonFiniteError, "duration"),
        ({"duration": -1.0}, BadValueError, "duration"),
        ({"times": [0.0, 1.0, 1.0]}, BadValueError, r"times\[2\]"),
        ({"times": [0.0, 1.0]}, WrongSizeError, "times"),
        ({"times": [0.0, np.inf, 2.0]}, NonFiniteError, "times"),
        ({"times": [0.0, 1.0, 2.0], "duration": 2.0}, BadValueError, "duration"),
        ({"slopes": np.zeros((2, 4))}, BadValueError, "slopes"),
        ({"times": [0, 1, 2], "ends": "clamped", "slopes": [0]}, WrongSizeError, "slopes"),
        (
            {"times": [0, 1, 2], "ends": "clamped", "slopes": np.full((2, 4), np.nan)},
            NonFiniteError,
            "slopes",
        ),
    ],
)
def test_bad_requests_are_refused(changes, error, text):
    request = {"points": np.array([[0.0] * 4, [1.0] * 4, [0.5] * 4]), "limits": LIMITS} | changes
    with pytest.raises(error, match=text):
        spline_through(request.pop("points"), **request)


# Largest errors of the natural spline through even points of a law.
NATURAL_ERRORS = {
    "cycloidal": {5: 3.186e-3, 6: 1.427e-3, 8: 3.190e-4, 11: 7.118e-5},
    "poly4567": {5: 8.620e-3, 8: 1.315e-3, 11: 3.921e-4},
    "poly345": {5: 8.354e-3, 8: 9.217e-4, 11: 2.257e-4},
}


def law_of(profile):
    free = Limits(("a",), velocity=1e9, acceleration=1e9)
    return point_to_point([0.0], [1.0], limits=free, profile=profile, duration=1.0)


@pytest.mark.parametrize("profile", NATURAL_ERRORS)
def test_golden_errors_of_natural_splines_through_points_of_a_law(profile):
    law, tau = law_of(profile), np.linspace(0.0, 1.0, 20_001)
    for count, golden in NATURAL_ERRORS[profile].items():
        knots = np.linspace(0.0, 1.0, count)
        spline = spline_through(law.sample(knots).position, times=knots, ends="natural")
        error = np.abs(spline.sample(tau).position - law.sample(tau).position).max()
        assert error == pytest.approx(golden, rel=5e-4)


@pytest.mark.parametrize("profile", NATURAL_ERRORS)
def test_a_spline_like_a_law_is_at_rest_at_both_ends_and_nearer_than_through_its_points(profile):
    free = Limits(("a",), velocity=1e9, acceleration=1e9, lower=-9.0, upper=9.0)
    law, tau = law_of(profile), (np.arange(4000) + 0.5) / 4000
    before = np.inf
    for count in (4, 5, 9, 17):
        like = spline_like([0.0], [1.0], limits=free, profile=profile, knots=count, duration=1.0)
        for end in (like.sample(0.0), like.sample(like.duration)):
            assert max(abs(end.velocity[0]), abs(end.acceleration[0])) < 1e-12
        knots = np.linspace(0.0, 1.0, count)
        through = spline_through(law.sample(knots).position, times=knots, ends="rest")
        error, other = (
            np.linalg.norm(one.sample(tau).position - law.sample(tau).position)
            for one in (like, through)
        )
        assert error < other
        if count > 9:
            assert error < 0.25 * before
        before = error
    shortest = spline_like([0.0], [1.0], limits=Limits(("a",), velocity=1.0, acceleration=4.0))
    assert verify(shortest, Limits(("a",), velocity=1.0, acceleration=4.0)).ok


@pytest.mark.parametrize(
    ("changes", "text"),
    [
        ({"knots": 2}, "knots is 2, expected a whole number from 3 to 1000"),
        ({"knots": 3.5}, "knots is 3.5"),
        ({"profile": "ruckig"}, "profile is 'ruckig', expected one of poly345, poly4567, cycloid"),
        ({"q1": [1.0, 2.0]}, r"goal has shape \(2,\), expected \(1,\)"),
    ],
)
def test_bad_requests_for_a_spline_like_a_law(changes, text):
    request = {"q0": [0.0], "q1": [1.0], "limits": Limits(("a",), velocity=1.0, acceleration=1.0)}
    with pytest.raises(RobomechError, match=text):
        spline_like(**(request | changes))


def test_many_points_are_passed_in_balanced_time_also_where_one_is_there_twice():
    limits = Limits(list("ab"), velocity=1.0, acceleration=2.0, jerk=20.0)
    s = np.linspace(0.0, 6.0, 40)
    points = np.column_stack([s / 6.0, 0.3 * np.sin(s)])
    fast = through_points(points, limits=limits)
    assert verify(fast, limits).ok
    assert fast.duration < 0.8 * spline_through(points, limits=limits).duration
    for twice in (0, 17):
        again = through_points(np.insert(points, twice, points[twice], axis=0), limits=limits)
        assert verify(again, limits).ok
        assert again.duration < 2.0 * fast.duration
    still = through_points(np.zeros((30, 2)), limits=limits)
    assert still.duration == pytest.approx(1e-3)


def test_a_spline_that_swings_out_too_far_is_spaced_by_distances():
    rng = np.random.default_rng(3)
    points = rng.uniform(-1.0, 1.0, (30, 2))
    limits = Limits(list("ab"), velocity=1.0, acceleration=2.0, jerk=20.0)
    wide = spline_through(points, limits=limits, spacing="balanced")
    plain = spline_through(points, limits=limits)
    far, near = (
        np.abs(motion.sample(np.linspace(0.0, motion.duration, 20_001)).position).max()
        for motion in (wide, plain)
    )
    assert far > near
    limits = replace(limits, lower=-0.5 * (far + near), upper=0.5 * (far + near))
    assert through_points(points, limits=limits).duration == pytest.approx(plain.duration)


@pytest.mark.parametrize("ends", ["rest", "clamped", "natural"])
def test_instants_that_make_no_numbers_are_refused(ends):
    with pytest.raises(BadValueError, match="times is"):
        spline_through([[0.0], [0.5], [1.0]], times=[0.0, 1e-300, 1.0], ends=ends)
