"""Time-optimal motion along paths: closed forms, limits between samples, and what is refused."""

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from counting import lines_executed
from scipy.integrate import quad
from scipy.interpolate import CubicSpline, PchipInterpolator, make_interp_spline

from robomech_ros.errors import (
    BadValueError,
    LimitExceededError,
    MissingLimitsError,
    NonFiniteError,
    RobomechError,
    SeedOutsideLimitsError,
    WrongSizeError,
)
from robomech_ros.trajectory import (
    Limits,
    PiecewisePolynomial,
    SpeedLimit,
    TimeOptimal,
    TorqueLimits,
    discretise,
    point_to_point,
    time_optimal,
    verify,
)

TOPPRA = Path(__file__).parents[2] / "data" / "time_optimal_toppra.csv"
RATES = ("velocity", "acceleration")
# What the limits are kept below, so that rounding does not exceed them, costs this part of time.
ROUNDING = 1e-6


def named(velocity, acceleration, jerk=None, **positions):
    joints = [f"joint{k}" for k in range(len(velocity))]
    return Limits(joints, velocity=velocity, acceleration=acceleration, jerk=jerk, **positions)


def as_path(spline):
    """Turn scipy's spline into a path."""
    return PiecewisePolynomial(spline.x, np.ascontiguousarray(spline.c[::-1]))


def line(*rises):
    """A straight line from 0, with s from 0 to 1."""
    return PiecewisePolynomial(
        np.array([0.0, 1.0]), np.array([np.zeros(len(rises)), rises], float)[:, None]
    )


def random_path(index):
    """A spline of seven joints through random waypoints, and limits of velocity, acceleration."""
    rng = np.random.default_rng(index)
    count = 20 if index < 100 else int(rng.integers(3, 25))
    if index % 3 == 0:
        waypoints = rng.uniform(-2, 2, (count, 7))
    elif index % 3 == 1:
        waypoints = np.cumsum(rng.normal(0, 0.4, (count, 7)), axis=0)
    else:
        waypoints = rng.normal(0, 1, (count, 7))
    chords = np.linalg.norm(np.diff(waypoints, axis=0), axis=1)
    even = np.linspace(0, 1, count)
    knots = even if index % 2 == 0 else np.concatenate([[0], np.cumsum(chords)])
    limits = rng.uniform(1, 3, 7), rng.uniform(2, 12, 7)
    return as_path(CubicSpline(knots, waypoints)), *limits


def checked(path, limits, **options):
    """Plan, and check by dense sampling that it is on the path and within the limits."""
    motion = time_optimal(path, limits, **options)
    times = np.linspace(0.0, motion.duration, 20_000)
    sample = motion.sample(times)
    ratios = np.maximum(
        np.abs(sample.velocity / limits.velocity), np.abs(sample.acceleration / limits.acceleration)
    )
    assert ratios.max() <= 1.0 + 1e-6
    # Between the breaks, the path coordinate follows from the speeds at the breaks.
    at_breaks = motion.sample(motion.pieces.breaks).position
    assert np.abs(path.sample(motion.coordinates).position - at_breaks).max() < 1e-11
    assert (np.diff(motion.coordinates) >= 0.0).all()
    return motion, ratios.max(axis=1)


@pytest.mark.parametrize("speed", [0.3, 1.0, 50.0])
@pytest.mark.parametrize("way", [0.02, 1.0, -7.0])
def test_a_straight_line_is_a_trapezoid(way, speed):
    limits = named([speed, 1000.0], [2.0, 1000.0])
    motion, _ = checked(line(way, 0.5 * way), limits)
    ramp = speed**2 / 2.0
    full = abs(way) > ramp
    exact = abs(way) / speed + speed / 2.0 if full else 2.0 * np.sqrt(abs(way) / 2.0)
    assert motion.duration == pytest.approx(exact, rel=ROUNDING)
    middle = motion.sample(motion.duration / 2.0)
    np.testing.assert_allclose(middle.position, [0.5 * way, 0.25 * way], rtol=1e-6)
    np.testing.assert_allclose(motion.sample(0.0).position, 0.0, atol=1e-15)
    np.testing.assert_allclose(motion.sample(motion.duration).position, [way, 0.5 * way], rtol=1e-9)
    assert verify(motion, limits, rates=RATES, to_rest=False).ok


def test_the_slowest_joint_decides():
    limits = named([1.0, 2.0, 0.5], [4.0, 4.0, 8.0])
    rises = np.array([1.0, -3.0, 0.6])
    # Along the line of unit length the limits are those of the joints over their rises.
    speed, rate = (limits.velocity / np.abs(rises)).min(), (limits.acceleration / abs(rises)).min()
    motion, _ = checked(line(*rises), limits)
    assert motion.duration == pytest.approx(1.0 / speed + speed / rate, rel=ROUNDING)


def test_a_path_that_starts_and_ends_moving():
    limits = named([2.0], [1.5])
    motion, _ = checked(line(3.0), limits, path_speed=(0.2, 0.5))
    # Speeds of the joint 0.6 and 1.5; up to 2 and down again.
    ramps = (4.0 - 0.36) / 3.0, (4.0 - 2.25) / 3.0
    exact = (1.4 + 0.5) / 1.5 + (3.0 - sum(ramps)) / 2.0
    assert motion.duration == pytest.approx(exact, rel=ROUNDING)
    assert motion.sample(0.0).velocity[0] == pytest.approx(0.6)
    assert motion.sample(motion.duration).velocity[0] == pytest.approx(1.5)


def test_a_parabola_switches_where_the_closed_form_does():
    # q = (s, s^2 / 2), both accelerations at most 1.  From rest x = 2 s, as joint 1 binds, up to
    # s = 1/3; then joint 2 binds, s x'/2 + x = 1, with x = 1 - 1 / (27 s^2); at last x = 2 (1 - s).
    path = PiecewisePolynomial(np.array([0.0, 1.0]), np.zeros((3, 1, 2)))
    path.coefficients[1, 0, 0], path.coefficients[2, 0, 1] = 1.0, 0.5
    motion, binding = checked(path, named([9.0, 9.0], [1.0, 1.0]))

    def square(s):
        rising = 2.0 * s if s < 1.0 / 3.0 else 1.0 - 1.0 / (27.0 * s * s)
        return min(rising, 2.0 * (1.0 - s))

    switch = np.roots([2.0, -1.0, 0.0, -1.0 / 27.0])
    switch = float(switch[np.abs(switch.imag) < 1e-12].real[0])
    breaks = [0.0, 1.0 / 3.0, switch, 1.0]
    exact = sum(quad(lambda s: square(s) ** -0.5, a, b)[0] for a, b in pairwise(breaks))
    assert motion.duration == pytest.approx(exact, rel=1e-4)
    assert motion.duration > exact
    assert np.median(binding) > 0.9999
    found = np.interp([0.2, 0.5, 0.7], motion.coordinates, motion.speeds) ** 2
    np.testing.assert_allclose(found, [square(s) for s in (0.2, 0.5, 0.7)], rtol=2e-3)


def circle(laps):
    angles = np.linspace(0.0, 2.0 * np.pi * laps, 100 * laps + 1)
    points = np.c_[np.cos(angles), np.sin(angles)]
    return as_path(CubicSpline(angles, points, bc_type="periodic"))


def test_a_lap_of_a_circle_through_four_singular_points():
    # Where a joint turns round, its acceleration does not depend on s''.  In each eighth of a lap
    # one joint has its full acceleration a: from q = 1 on q = 1 - a t^2 / 2 = cos(angle).
    acceleration = 2.0
    limits = named([50.0, 50.0], [acceleration] * 2)
    (two, binding), (three, _) = checked(circle(2), limits), checked(circle(3), limits)
    eighth = np.sqrt(2.0 * (1.0 - np.sqrt(0.5)) / acceleration)
    assert three.duration - two.duration == pytest.approx(8.0 * eighth, rel=2e-5)
    assert np.median(binding) > 0.999
    assert binding.min() > 0.99


def test_a_singular_point_of_the_binding_joint():
    # q1 = (s - 1/2)^2 turns round in the middle, where its acceleration is 2 x; q2 = s.
    path = PiecewisePolynomial(np.array([0.0, 1.0]), np.zeros((3, 1, 2)))
    path.coefficients[:, 0] = [[0.25, 0.0], [-1.0, 1.0], [1.0, 0.0]]
    motion, binding = checked(path, named([9.0, 9.0], [0.1, 1.0]))
    middle = np.interp(0.5, motion.coordinates, motion.speeds) ** 2
    assert middle == pytest.approx(0.05, rel=1e-4)
    assert np.quantile(binding, 0.02) > 0.995


def test_a_path_that_turns_back_on_itself():
    # q = (s - 1/2)^2: back along the same way; a rest in the middle for the joint, none for s.
    path = PiecewisePolynomial(np.array([0.0, 1.0]), np.array([0.25, -1.0, 1.0])[:, None, None])
    motion, _ = checked(path, named([9.0], [1.0]))
    # A quarter there and back, from rest to rest: each bang-bang, but without a stop between.
    assert motion.duration == pytest.approx(2.0, rel=1e-3)


@pytest.mark.slow
def test_two_hundred_random_paths():
    durations = dict(np.loadtxt(TOPPRA, delimiter=","))
    assert len(durations) == 200
    for index, duration in durations.items():
        path, velocity, acceleration = random_path(int(index))
        motion, binding = checked(path, named(velocity, acceleration))
        assert motion.duration <= 1.001 * duration, index
        assert binding.max() >= 0.999, index
        assert np.median(binding) > 0.99, index


@pytest.mark.parametrize("index", range(0, 200, 40))
def test_the_verifier_agrees_between_all_samples(index):
    path, velocity, acceleration = random_path(index)
    limits = named(velocity, acceleration)
    report = verify(time_optimal(path, limits), limits, rates=RATES, to_rest=False)
    assert report.ok
    peaks = np.maximum(report.peak_velocity_ratio, report.peak_acceleration_ratio)
    assert 0.999 < peaks.max() <= 1.0 + 1e-6


@pytest.mark.parametrize("scale", [1e-6, 1e6])
def test_the_unit_of_the_path_coordinate_does_not_matter(scale):
    path, velocity, acceleration = random_path(7)
    limits = named(velocity, acceleration)
    powers = scale ** -np.arange(4.0)[:, None, None]
    other = PiecewisePolynomial(path.breaks * scale, path.coefficients * powers)
    motion, _ = checked(other, limits)
    assert motion.duration == pytest.approx(time_optimal(path, limits).duration, rel=1e-4)


@pytest.mark.parametrize("seed", range(20))
def test_limits_a_million_times_apart(seed):
    path, _, _ = random_path(seed)
    rng = np.random.default_rng(seed)
    limits = named(10.0 ** rng.uniform(-3, 3, 7), 10.0 ** rng.uniform(-3, 3, 7))
    motion, binding = checked(path, limits)
    assert binding.max() > 0.999
    # The grid does not refine itself without end.
    assert len(motion.coordinates) < 200 * len(path.breaks)


def test_paths_of_other_orders():
    rng = np.random.default_rng(0)
    knots, waypoints = np.arange(8.0), rng.normal(size=(8, 3))
    limits = named([1.0, 2.0, 3.0], [4.0, 3.0, 5.0])
    spline = make_interp_spline(knots, waypoints, k=5)
    breaks = np.unique(spline.t)
    factors = np.cumprod([1.0, 1.0, 2.0, 3.0, 4.0, 5.0])
    rows = [spline.derivative(k)(breaks[:-1]) / factors[k] for k in range(1, 6)]
    quintic = PiecewisePolynomial(breaks, np.stack([spline(breaks[:-1]), *rows]))
    _, binding = checked(quintic, limits)
    assert np.median(binding) > 0.99
    # Only the first derivative is continuous: the acceleration steps at the knots.
    _, binding = checked(as_path(PchipInterpolator(knots, waypoints)), limits)
    assert np.median(binding) > 0.99


def test_a_motion_is_timed_anew_as_a_path():
    limits = named([1.0, 2.0], [3.0, 4.0], [50.0, 50.0])
    slow = point_to_point([0.0, 0.0], [2.0, 1.0], limits=limits)
    motion, _ = checked(slow.pieces, limits)
    straight, _ = checked(line(2.0, 1.0), limits)
    assert motion.duration == pytest.approx(straight.duration, rel=2e-3)


def test_corners_are_stopped_at():
    waypoints = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    path = PiecewisePolynomial(
        np.arange(4.0), np.stack([waypoints[:-1], np.diff(waypoints, axis=0)])
    )
    limits = named([0.5, 0.5], [2.0, 2.0])
    motion, _ = checked(path, limits)
    side = 1.0 / 0.5 + 0.5 / 2.0
    assert motion.duration == pytest.approx(3.0 * side, rel=ROUNDING)
    corner = motion.sample(motion.duration / 3.0)
    np.testing.assert_allclose(corner.position, [1.0, 0.0], atol=1e-9)
    np.testing.assert_allclose(corner.velocity, 0.0, atol=1e-6)


@pytest.mark.parametrize(
    "path",
    [
        PiecewisePolynomial(np.array([2.0]), np.array([[[0.3, 0.4]]])),
        PiecewisePolynomial(np.array([0.0, 1.0]), np.array([[[0.3, 0.4]]])),
        PiecewisePolynomial(np.array([0.0, 1.0]), np.full((4, 1, 2), [[[1e-14, 0.0]]])),
    ],
)
def test_a_path_without_length(path):
    motion = time_optimal(path, named([1.0, 1.0], [1.0, 1.0]))
    assert motion.duration == 1e-3
    assert verify(motion, named([1.0, 1.0], [1.0, 1.0])).ok
    np.testing.assert_array_equal(motion.sample(1.0).position, path.coefficients[0, 0])


def test_a_part_where_nothing_moves_takes_no_time():
    there = [0.0, 1.0, 1.0]
    path = PiecewisePolynomial(np.arange(4.0), np.zeros((2, 3, 1)))
    path.coefficients[0, :, 0], path.coefficients[1, :, 0] = there, [1.0, 0.0, 1.0]
    motion = time_optimal(path, named([9.0], [1.0]))
    assert motion.duration == pytest.approx(4.0, rel=ROUNDING)
    np.testing.assert_allclose(motion.sample(motion.duration).position, 2.0, rtol=1e-9)
    # The same where the path comes to rest without a corner, and where it begins with such a part.
    smooth = PiecewisePolynomial(np.arange(5.0), np.zeros((4, 4, 1)))
    smooth.coefficients[0, :, 0] = [0.0, 0.0, 1.0, 1.0]
    smooth.coefficients[2:, 1::2, 0] = [[3.0], [-2.0]]
    motion = time_optimal(smooth, named([9.0], [1.0]))
    assert motion.duration == pytest.approx(4.0, rel=2e-3)
    np.testing.assert_allclose(motion.sample(motion.duration).position, 2.0, rtol=1e-9)


def test_a_very_short_path_lasts_a_millisecond():
    motion, _ = checked(line(1e-9), named([1.0], [1.0]))
    assert motion.duration == 1e-3
    assert motion.sample(1.0).position[0] == pytest.approx(1e-9)


def test_many_pieces_are_no_more_work_each_than_a_few():
    rng, limits = np.random.default_rng(3), named([1.0] * 3, [2.0] * 3)
    waypoints = np.cumsum(rng.normal(size=(2000, 3)), axis=0)
    whole = as_path(CubicSpline(np.arange(2000.0), waypoints))
    few = as_path(CubicSpline(np.arange(100.0), waypoints[:100]))
    motion, _ = checked(whole, limits)
    assert len(motion.coordinates) < 1.5 * 20 * len(time_optimal(few, limits).coordinates)
    lines = lines_executed(time_optimal, few, limits)
    assert 0 < lines_executed(time_optimal, whole, limits) < 1.1 * lines


# --- Speeds of the tip, torques ---


def test_the_speed_of_the_tip_on_a_straight_line():
    limits = named([100.0], [2.0])
    given = SpeedLimit(lambda s: np.full(len(s), 3.0), 1.5)
    motion, _ = checked(line(1.0), limits, speed_limits=given)
    assert motion.duration == pytest.approx(1.0 / 0.5 + 0.5 / 2.0, rel=ROUNDING)
    table = SpeedLimit(([0.0, 1.0], [3.0, 3.0]), 1.5)
    assert time_optimal(line(1.0), limits, speed_limits=[table]).duration == motion.duration


def test_the_speed_of_the_tip_of_a_planar_arm():
    rng = np.random.default_rng(5)
    path = as_path(CubicSpline(np.linspace(0, 1, 6), rng.uniform(-2, 2, (6, 2))))
    limits = named([4.0, 4.0], [30.0, 30.0])

    def rate(s):
        at = path.sample(s)
        one, both = at.position[:, 0], at.position.sum(axis=1)
        first, second = at.velocity[:, 0], at.velocity.sum(axis=1)
        x = -np.sin(one) * first - np.sin(both) * second
        return np.hypot(x, np.cos(one) * first + np.cos(both) * second)

    tip = SpeedLimit(rate, 1.2)
    motion, _ = checked(path, limits, speed_limits=tip)
    sample = motion.sample(np.linspace(0.0, motion.duration, 20_000))
    one, both = sample.position[:, 0], sample.position.sum(axis=1)
    first, second = sample.velocity[:, 0], sample.velocity.sum(axis=1)
    speed = np.hypot(
        -np.sin(one) * first - np.sin(both) * second, np.cos(one) * first + np.cos(both) * second
    )
    assert 0.999 < speed.max() / 1.2 < 1.0 + 1e-6
    assert motion.duration > 1.05 * time_optimal(path, limits).duration


def pendulum(s):
    """Torque of a pendulum along q = pi s: inertia 0.5, gravity 3 sin(q)."""
    angle = np.pi * s[:, None]
    return np.full_like(angle, 0.5 * np.pi), np.zeros_like(angle), 3.0 * np.sin(angle)


def test_torque_limits_without_gravity_are_acceleration_limits():
    given = TorqueLimits(lambda s: (*pendulum(s)[:2], np.zeros((len(s), 1))), -2.0, 2.0)
    motion = time_optimal(line(np.pi), Limits(["a"], velocity=9.0), torque_limits=given)
    assert motion.duration == pytest.approx(2.0 * np.sqrt(np.pi / 4.0), rel=ROUNDING)


@pytest.mark.parametrize("constant", [0.0, 0.3, 0.45, 0.8])
def test_torque_limits_far_below_what_the_speed_limits_allow(constant):
    def coefficients(s):
        ones = np.ones((len(s), 1))
        return ones, 0.0 * ones, constant * ones

    given = TorqueLimits(coefficients, -1.0, 1.0)
    motion = time_optimal(line(1.0), Limits(["a"], velocity=1e3), torque_limits=given)
    up, down = 1.0 - constant, 1.0 + constant
    assert motion.duration == pytest.approx(np.sqrt(2.0 * (1.0 / up + 1.0 / down)), rel=2e-6)


def test_torque_limits_that_exclude_each_other():
    def coefficients(s):
        return np.ones((len(s), 2)), np.zeros((len(s), 2)), np.tile([3.0, -3.0], (len(s), 1))

    both = TorqueLimits(coefficients, [-1.0, -1.0], [1.0, 1.0])
    with pytest.raises(BadValueError, match="these allow none"):
        time_optimal(line(1.0), Limits(["a"], velocity=9.0), torque_limits=both)


def test_torque_limits_with_gravity():
    limits = Limits(["a"], velocity=9.0)
    motion = time_optimal(line(np.pi), limits, torque_limits=TorqueLimits(pendulum, [-3.5], [4.0]))
    sample = motion.sample(np.linspace(0.0, motion.duration, 20_000))
    torque = 0.5 * sample.acceleration + 3.0 * np.sin(sample.position)
    assert torque.max() == pytest.approx(4.0, rel=1e-5)
    assert torque.min() == pytest.approx(-3.5, rel=1e-5)
    assert torque.max() < 4.0 * (1.0 + 1e-6)
    assert torque.min() > -3.5 * (1.0 + 1e-6)
    assert np.quantile(np.maximum(torque / 4.0, torque / -3.5), 0.01) > 0.99


def test_a_swing_that_rest_does_not_allow():
    # 2 N m do not lift the arm past the side, where gravity takes 3; with enough speed it passes.
    weak = TorqueLimits(pendulum, [-2.0], [2.0])
    limits = Limits(["a"], velocity=9.0)
    with pytest.raises(BadValueError, match="initial path speed is 0.0, expected at least") as told:
        time_optimal(line(np.pi), limits, torque_limits=weak)
    # The work left is least where gravity takes 2 again, on the far side.
    far = np.pi - np.arcsin(2.0 / 3.0)
    energy = 3.0 * (1.0 - np.cos(far)) - 2.0 * far
    least = np.sqrt(2.0 * energy / 0.5) / np.pi
    assert float(told.value.expected.split()[2].rstrip(",")) == pytest.approx(least, rel=0.03)
    motion = time_optimal(line(np.pi), limits, torque_limits=weak, path_speed=(1.5, 1.5))
    sample = motion.sample(np.linspace(0.0, motion.duration, 5000))
    torque = 0.5 * sample.acceleration + 3.0 * np.sin(sample.position)
    assert np.abs(torque).max() == pytest.approx(2.0, rel=1e-5)


def test_torques_of_a_curved_path_hold_between_samples():
    # Two joints, each with its own inertia and viscous-like coupling by the speed squared.
    rng = np.random.default_rng(8)
    path = as_path(CubicSpline(np.linspace(0, 1, 7), rng.uniform(-1, 1, (7, 2))))
    inertia = np.array([[2.0, 0.4], [0.4, 0.7]])

    def coefficients(s):
        at = path.sample(s)
        return at.velocity @ inertia, at.acceleration @ inertia, np.sin(at.position)

    bound = np.array([6.0, 3.0])
    given = TorqueLimits(coefficients, -bound, bound)
    limits = Limits(["a", "b"], velocity=20.0)
    motion = time_optimal(path, limits, torque_limits=given)
    sample = motion.sample(np.linspace(0.0, motion.duration, 20_000))
    ratios = np.abs(sample.acceleration @ inertia + np.sin(sample.position)) / bound
    assert 0.999 < ratios.max() <= 1.0 + 1e-6
    assert np.median(ratios.max(axis=1)) > 0.99


def test_torques_that_allow_no_motion():
    held = TorqueLimits(lambda s: (np.ones((len(s), 1)), 0.0 * s[:, None], s[:, None] + 1.5), -1, 1)
    with pytest.raises(BadValueError, match="at path coordinate .* these allow none"):
        time_optimal(line(1.0), Limits(["a"], velocity=1.0), torque_limits=held)


def test_a_speed_limit_that_allows_no_motion():
    wall = SpeedLimit(lambda s: 1.0 + 1e300 * (s > 0.5), 1e-3)
    expected = r"speed limits is \[0.001\], expected .* at path coordinate .* these allow none"
    with np.errstate(over="ignore"), pytest.raises(BadValueError, match=expected):
        time_optimal(line(1.0), Limits(["a"], velocity=1.0, acceleration=2.0), speed_limits=wall)


# --- Limited jerk ---


@pytest.mark.parametrize("way", [1.0, 3.0])
def test_a_smoothed_straight_line_is_a_double_s(way):
    limits = named([1.0], [2.0], [10.0])
    motion = time_optimal(line(way), limits, jerk_smoothing=True)
    assert motion.duration == pytest.approx(way + 0.5 + 0.2, rel=1e-12)
    assert verify(motion, limits).ok


@pytest.mark.parametrize("jerk", [0.1, 5.0, 1000.0])
@pytest.mark.parametrize("way", [0.02, 1.0])
def test_a_smoothed_straight_line_takes_as_long_as_ruckig(way, jerk):
    limits = named([1.0, 2.0], [2.0, 3.0], [jerk, 2.0 * jerk])
    motion = time_optimal(line(way, -0.7 * way), limits, jerk_smoothing=True)
    goal = [way, -0.7 * way]
    fastest = point_to_point([0.0, 0.0], goal, limits=limits, profile="ruckig")
    assert motion.duration == pytest.approx(fastest.duration, rel=1e-9)
    assert verify(motion, limits, start=[0.0, 0.0]).ok
    np.testing.assert_allclose(motion.sample(motion.duration).position, goal, atol=1e-12)
    assert motion.coordinates[-1] == pytest.approx(line(way).breaks[-1])
    assert motion.speeds[[0, -1]] == pytest.approx([0.0, 0.0], abs=1e-9)


@pytest.mark.parametrize("index", [1, 104, 155, 160])
@pytest.mark.parametrize("ratio", [4.0, 30.0])
def test_smoothed_paths_keep_the_jerk(index, ratio):
    path, velocity, acceleration = random_path(index)
    limits = named(velocity, acceleration, ratio * acceleration)
    motion, _ = checked(path, limits, jerk_smoothing=True)
    report = verify(motion, limits)
    assert report.ok
    peaks = (report.peak_velocity_ratio, report.peak_acceleration_ratio, report.peak_jerk_ratio)
    assert 0.999 < np.max(peaks) <= 1.0 + 1e-6
    shortest = time_optimal(path, limits).duration
    assert shortest < motion.duration < 2.0 * shortest
    times = np.linspace(0.0, motion.duration, 20_000)
    accelerations = motion.sample(times).acceleration
    assert np.abs(np.diff(accelerations, axis=0) / times[1] / limits.jerk).max() <= 1.0 + 1e-5
    np.testing.assert_allclose(accelerations[[0, -1]], 0.0, atol=1e-6)


def test_a_controller_can_follow_a_smoothed_path():
    path, velocity, acceleration = random_path(160)
    limits = named(velocity, acceleration, 10.0 * acceleration)
    tighter = limits.scaled(velocity=0.999, acceleration=0.999, jerk=0.98)
    motion = time_optimal(path, tighter, jerk_smoothing=True)
    report = verify(discretise(motion, 0.01, 10_000), limits, start=path.coefficients[0, 0])
    assert report.ok, report.violation


def test_smoothing_keeps_the_speed_of_the_tip_and_stops_at_corners():
    waypoints = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]])
    path = PiecewisePolynomial(
        np.arange(3.0), np.stack([waypoints[:-1], np.diff(waypoints, axis=0)])
    )
    limits = named([2.0, 2.0], [2.0, 2.0], [10.0, 10.0])
    tip = SpeedLimit(lambda s: np.ones_like(s), 0.5)
    motion = time_optimal(path, limits, speed_limits=tip, jerk_smoothing=True)
    assert verify(motion, limits).ok
    sample = motion.sample(np.linspace(0.0, motion.duration, 5000))
    assert np.linalg.norm(sample.velocity, axis=1).max() == pytest.approx(0.5, rel=1e-5)
    assert np.linalg.norm(sample.velocity, axis=1).max() <= 0.5 * (1.0 + 1e-6)
    assert motion.duration == pytest.approx(2.0 * (1.0 / 0.5 + 0.5 / 2.0 + 0.2), rel=1e-4)


# --- What is refused ---

GOOD = named([1.0, 1.0], [2.0, 2.0], [9.0, 9.0], lower=-2.0, upper=[2.0, 1.5])
STRAIGHT = line(1.0, 1.0)


def with_breaks(*breaks):
    return PiecewisePolynomial(np.array(breaks), STRAIGHT.coefficients)


STEP = PiecewisePolynomial(np.array([0.0, 1.0, 2.0]), np.array([[[0.0] * 2, [0.5] * 2]]))
BENT = PiecewisePolynomial(np.array([0.0, 1.0, 2.0]), np.zeros((3, 2, 2)))
BENT.coefficients[0, 1], BENT.coefficients[1], BENT.coefficients[2, 0] = 0.45, 0.5, -0.05
BENT.coefficients[1, 1] = 0.4


@pytest.mark.parametrize(
    ("changes", "error", "text"),
    [
        ({"path": None}, BadValueError, "path is None, expected a PiecewisePolynomial"),
        ({"path": line(1.0)}, WrongSizeError, "joints of the path has size 1, expected 2"),
        ({"path": line(1.0, np.nan)}, NonFiniteError, r"coefficients of the path\[1, 0, 1\]"),
        ({"path": with_breaks(0.0, 0.0)}, BadValueError, r"breaks of the path\[1\] is 0.0"),
        ({"path": with_breaks(0.0, np.inf)}, NonFiniteError, r"breaks of the path\[1\] is inf"),
        ({"path": with_breaks(0.0, 1.0, 2.0)}, WrongSizeError, r"\(order \+ 1, 2, n\)"),
        ({"path": STEP}, BadValueError, "step of the path at its coordinate 1 is 0.5"),
        (
            {"path": PiecewisePolynomial(np.array([0.0, 1.0]), np.zeros((7, 1, 2)))},
            BadValueError,
            "order of the path is 6, expected at most 5",
        ),
        ({"path": line(1.0, 1e7)}, BadValueError, "largest position on the path is 10000000.0"),
        (
            {"path": line(1.0, 1.75)},
            LimitExceededError,
            "position on the way of joint 'joint1' is 1.75, over its limit 1.5 by 0.25",
        ),
        (
            {"path": PiecewisePolynomial(STRAIGHT.breaks, STRAIGHT.coefficients - 3.0)},
            SeedOutsideLimitsError,
            "start of joint 'joint0' is -3",
        ),
        ({"limits": None}, BadValueError, "limits is None"),
        (
            {"limits": named([1.0, np.inf], [2.0, 2.0])},
            MissingLimitsError,
            "no velocity limit for joint joint1",
        ),
        (
            {"limits": named([1.0, 1.0], [np.inf, 2.0])},
            MissingLimitsError,
            "no acceleration limit for joint joint0",
        ),
        ({"path_speed": 1.0}, WrongSizeError, "path_speed has shape"),
        ({"path_speed": (0.0, -1.0)}, BadValueError, "two speeds, zero or above"),
        ({"path_speed": (np.nan, 0.0)}, NonFiniteError, r"path_speed\[0\] is nan"),
        (
            {"path_speed": (3.0, 0.0)},
            BadValueError,
            "initial path speed is 3.0, expected at most 0.9999",
        ),
        (
            {"path_speed": (0.0, 7.0)},
            BadValueError,
            "final path speed is 7.0, expected at most 0.9999",
        ),
        ({"speed_limits": 3}, BadValueError, "speed_limits is 3, expected a SpeedLimit or a list"),
        (
            {"speed_limits": SpeedLimit(lambda s: s[1:], 1.0)},
            WrongSizeError,
            "rate of a speed limit has shape",
        ),
        (
            {"speed_limits": SpeedLimit(lambda s: s * np.nan, 1.0)},
            NonFiniteError,
            r"rate of a speed limit\[0\] is nan",
        ),
        (
            {"torque_limits": TorqueLimits(lambda s: s, -1.0, 1.0)},
            BadValueError,
            "expected a tuple of a, b and c",
        ),
        (
            {"torque_limits": TorqueLimits(lambda s: (s, s, s), -1.0, 1.0)},
            WrongSizeError,
            "a of torque limits has shape",
        ),
        ({"jerk_smoothing": "yes"}, BadValueError, "jerk_smoothing is 'yes'"),
        (
            {"jerk_smoothing": True, "limits": named([1.0, 1.0], [2.0, 2.0])},
            MissingLimitsError,
            "no jerk limit for joints joint0, joint1",
        ),
        (
            {"jerk_smoothing": True, "path_speed": (0.1, 0.0)},
            BadValueError,
            r"expected \(0, 0\), with jerk_smoothing",
        ),
        (
            {"jerk_smoothing": True, "path": BENT},
            BadValueError,
            "step of the path's second derivative at its coordinate 1 is 0.1",
        ),
    ],
)
def test_what_is_refused(changes, error, text):
    arguments = {"path": STRAIGHT, "limits": GOOD} | changes
    with pytest.raises(error, match=text):
        time_optimal(**arguments)


@pytest.mark.parametrize(
    ("make", "text"),
    [
        (lambda: SpeedLimit(np.ones_like, 0.0), "speed limit is 0.0, expected a number above 0"),
        (lambda: SpeedLimit(np.ones_like, "x"), "speed limit is 'x'"),
        (lambda: SpeedLimit(3.0, 1.0), "rate of a speed limit is 3.0, expected a callable"),
        (lambda: SpeedLimit(([0, 0], [1, 1]), 1.0), "at least two increasing path coordinates"),
        (lambda: SpeedLimit(([0, 1], [1]), 1.0), r"rate of a speed limit has shape \(1,\)"),
        (lambda: TorqueLimits(pendulum, [1.0], [1.0]), r"lower torque limit \[0\] is 1.0"),
        (lambda: TorqueLimits(pendulum, [1.0], [1.0, 2.0]), "upper torque limits has shape"),
        (lambda: TorqueLimits(pendulum, [-np.inf], [1.0]), r"lower torque limits\[0\] is -inf"),
        (lambda: TorqueLimits(None, [-1.0], [1.0]), "coefficients of torque limits is None"),
    ],
)
def test_limits_that_are_none(make, text):
    with pytest.raises(RobomechError, match=text):
        make()


ANYTHING = (
    *(None, True, "", -1, np.nan, np.inf, 10**400, 2 + 3j, object(), int, {}, [], ["a"]),
    *([np.nan] * 2, [1e300] * 2, [[1, 2], [3]], np.empty((0, 2)), np.zeros(2, complex)),
)


@pytest.mark.parametrize("name", ["limits", "path_speed", "speed_limits", "torque_limits",
                                  "jerk_smoothing", "breaks", "coefficients", "path"])  # fmt: skip
def test_anything_is_answered_or_refused(name):
    for value in ANYTHING:
        arguments = {"path": STRAIGHT, "limits": GOOD}
        if name in ("breaks", "coefficients"):
            fields = {"breaks": STRAIGHT.breaks, "coefficients": STRAIGHT.coefficients}
            arguments["path"] = PiecewisePolynomial(**(fields | {name: value}))
        else:
            arguments[name] = value
        try:
            assert isinstance(time_optimal(**arguments), TimeOptimal)
        except RobomechError as error:
            assert str(error)
