"""Verification finds what is wrong, where, and by how much, between samples as well."""

import subprocess
import sys
from dataclasses import dataclass

import numpy as np
import pytest
from counting import lines_executed

from robomech_ros.errors import BadValueError, LimitExceededError, NonFiniteError, WrongSizeError
from robomech_ros.trajectory import (
    PROFILES,
    Limits,
    PiecewisePolynomial,
    Waypoints,
    interpolant,
    point_to_point,
    verify,
)
from robomech_ros.trajectory.plans.verification import first_violation

JOINTS = ("base", "elbow")
LIMITS = Limits(JOINTS, velocity=1.0, acceleration=2.0, jerk=30.0, lower=-3.0, upper=3.0)
START, GOAL = np.array([0.0, 0.5]), np.array([1.0, -1.5])


@pytest.fixture
def waypoints():
    motion = point_to_point(START, GOAL, limits=LIMITS)
    times = np.linspace(0.0, motion.duration, 41)
    sample = motion.sample(times)
    return Waypoints(times, sample.position, sample.velocity, sample.acceleration)


def changed(waypoints, **fields):
    values = {name: getattr(waypoints, name).copy() for name in vars(waypoints) if name != "curve"}
    for name, (place, value) in fields.items():
        values[name][place] = value
    return Waypoints(**values)


def test_a_good_trajectory(waypoints):
    report = verify(waypoints, LIMITS, start=START)
    assert report.ok
    report.require_ok()
    peaks = (report.peak_velocity_ratio, report.peak_acceleration_ratio, report.peak_jerk_ratio)
    assert np.max(peaks) == pytest.approx(1.0, rel=1e-7)
    assert report.peak_velocity_ratio[0] == pytest.approx(report.peak_velocity_ratio[1] / 2.0)


def test_a_peak_between_two_samples_is_seen():
    # Cubic from rest to rest in one segment: the peak speed 1.5 d / T lies in the middle.
    two = Waypoints(np.array([0.0, 2.0]), np.array([[0.0, 0.0], [0.0, 2.0]]), np.zeros((2, 2)))
    free = Limits(JOINTS, velocity=1.0)
    report = verify(two, free, start=[0.0, 0.0], to_rest=False)
    assert report.peak_velocity_ratio[1] == pytest.approx(1.5)
    found = report.violation
    assert (found.what, found.joint) == ("velocity", "elbow")
    assert (found.time, found.value, found.limit) == (pytest.approx(1.0), pytest.approx(1.5), 1.0)
    assert found.amount == pytest.approx(0.5)
    text = "velocity of joint 'elbow' is 1.5 at t = 1 s, off its limit 1 by 0.5"
    assert str(found) == text
    with pytest.raises(LimitExceededError, match=r"at t = 1 s velocity of joint 'elbow' is 1\.5"):
        report.require_ok()


@pytest.mark.parametrize(
    ("fields", "what", "joint", "instant"),
    [
        ({"velocities": ((20, 0), -2.5)}, "velocity", "base", 20),
        ({"accelerations": ((20, 1), 9.0)}, "acceleration", "elbow", 20),
        ({"velocities": ((-1, 1), 0.5)}, "final velocity", "elbow", 40),
        ({"accelerations": ((-1, 0), 0.5)}, "final acceleration", "base", 40),
    ],
)
def test_what_is_wrong_at_a_sample(waypoints, fields, what, joint, instant):
    report = verify(
        changed(waypoints, **fields),
        LIMITS,
        start=START,
        rates=("velocity", "acceleration") if what == "acceleration" else ("velocity",),
    )
    assert (report.violation.what, report.violation.joint) == (what, joint)
    times = waypoints.times
    assert report.violation.time == pytest.approx(times[instant], abs=2 * times[1])


def test_the_earliest_violation_is_named(waypoints):
    bad = changed(waypoints, velocities=(([30, 12, 25], [0, 1, 0]), [5.0, 5.0, -5.0]))
    report = verify(bad, LIMITS, start=START, rates=("velocity",))
    assert report.violation.joint == "elbow"
    assert waypoints.times[11] <= report.violation.time <= waypoints.times[13]


def test_position_limits(waypoints):
    tight = Limits(JOINTS, velocity=1.0, acceleration=2.0, lower=[-9.0, -1.2], upper=9.0)
    report = verify(waypoints, tight, start=START)
    found = report.violation
    assert (found.what, found.joint, found.limit) == ("position", "elbow", -1.2)
    assert found.value < -1.2
    higher = Limits(JOINTS, velocity=1.0, acceleration=2.0, upper=[0.9, 9.0])
    assert verify(waypoints, higher).violation.joint == "base"


def test_the_start_must_be_where_the_joints_are(waypoints):
    elsewhere = START + np.array([0.0, 0.25])
    found = verify(waypoints, LIMITS, start=elsewhere).violation
    assert (found.what, found.joint, found.time) == ("start position", "elbow", 0.0)
    assert found.amount == pytest.approx(0.25)
    assert "off its wanted value 0.75 by 0.25" in str(found)
    assert verify(waypoints, LIMITS, start=elsewhere, start_tolerance=0.3).ok


def test_the_first_instant_must_be_zero(waypoints):
    late = Waypoints(
        waypoints.times + 1.0, waypoints.positions, waypoints.velocities, waypoints.accelerations
    )
    found = verify(late, LIMITS, start=START).violation
    assert (found.what, found.value) == ("start time", 1.0)
    assert verify(late, LIMITS, start=START, from_zero=False).ok


@pytest.mark.parametrize(("order", "what"), [(0, "step of position"), (1, "step of velocity")])
def test_a_curve_that_steps_between_its_segments_is_none(order, what):
    curve = PiecewisePolynomial(np.array([0.0, 1.0, 2.0]), np.zeros((4, 2, 2)))
    assert verify(curve, LIMITS).ok
    # After the step it comes to rest at the end: v - 2 v t + v t^2.
    step = [1e-3] if order == 0 else [0.0, 1e-3, -1e-3, 1e-3 / 3.0]
    curve.coefficients[: len(step), 1, 1] = step
    found = verify(curve, LIMITS).violation
    assert (found.what, found.joint, found.time) == (what, JOINTS[1], 1.0)
    assert found.value == pytest.approx(1e-3)
    free = verify(curve, LIMITS, rates=("velocity",))
    assert free.ok is (order == 1)


@dataclass(frozen=True)
class Motion:
    """A motion whose profile says whether its acceleration steps."""

    pieces: PiecewisePolynomial
    ACCELERATION_STEPS: bool


def test_steps_of_acceleration_are_told_and_forbidden_where_the_profile_promises_none():
    free = Limits(JOINTS, velocity=1.0, acceleration=2.0)
    pieces = point_to_point(START, GOAL, limits=free, profile="trapezoidal").pieces
    report = verify(Motion(pieces, True), free, to_rest=False)
    assert report.ok
    np.testing.assert_allclose(report.largest_acceleration_step, [1.0, 2.0])
    found = verify(Motion(pieces, False), free, to_rest=False).violation
    assert (found.what, found.joint) == ("step of acceleration", "base")
    assert (found.time, found.value) == (pieces.breaks[1], pytest.approx(-1.0))
    assert verify(Motion(pieces, False), free, to_rest=False, rates=("velocity",)).ok


@pytest.mark.parametrize("profile", sorted(PROFILES))
def test_profiles_keep_what_they_promise_of_their_acceleration(profile):
    motion = point_to_point(START, GOAL, limits=LIMITS, profile=profile)
    report = verify(motion, LIMITS, start=START, to_rest=profile != "trapezoidal")
    assert report.ok
    assert (report.largest_acceleration_step > 1e-3).any() == motion.ACCELERATION_STEPS
    assert np.isinf(report.peak_jerk_ratio).any() == motion.ACCELERATION_STEPS


def test_the_first_violation_alone_is_that_of_the_report_and_takes_no_compiled_code(waypoints):
    bad = changed(waypoints, velocities=(([30, 12, 25], [0, 1, 0]), [5.0, 5.0, -5.0]))
    for limits in (LIMITS, Limits(JOINTS, velocity=1.0, acceleration=2.0, upper=0.7)):
        for given in (waypoints, bad):
            assert first_violation(given, limits, start=START) == (
                verify(given, limits, start=START).violation
            )
    code = (
        "import sys\n"
        "from robomech_ros.trajectory.limits import Limits\n"
        "from robomech_ros.trajectory.curves.interpolation import interpolant\n"
        "from robomech_ros.trajectory.plans.verification import first_violation\n"
        "curve = interpolant([0, 1], [[0], [1]], [[0], [0]], [[0], [0]])\n"
        "print(first_violation(curve, Limits(['joint'], velocity=1.0)), 'numba' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.startswith("velocity of joint 'joint' is 1.875 at t = 0.5 s, off its limit")
    assert done.stdout.endswith("False\n")


def test_only_the_wanted_rates_are_checked(waypoints):
    slow = Limits(JOINTS, velocity=1.0, acceleration=2.0, jerk=1e-3)
    assert verify(waypoints, slow).violation.what == "jerk"
    report = verify(waypoints, slow, rates=("velocity", "acceleration"))
    assert report.ok
    assert report.peak_jerk_ratio.max() > 1.0


def test_waypoints_that_make_no_curve_are_errors(waypoints):
    with pytest.raises(BadValueError, match="time of waypoint 7"):
        verify(changed(waypoints, times=(7, waypoints.times[6])), LIMITS)
    with pytest.raises(NonFiniteError, match="positions of waypoint 3"):
        verify(changed(waypoints, positions=((3, 1), np.nan)), LIMITS)
    with pytest.raises(WrongSizeError, match="joints of the trajectory has size 2, expected 3"):
        verify(waypoints, Limits(("a", "b", "c"), velocity=1.0))
    with pytest.raises(WrongSizeError, match="start"):
        verify(waypoints, LIMITS, start=[0.0])


def test_positions_only():
    line = interpolant([0.0, 1.0, 2.0], [[0.0, 0.0], [0.5, 0.0], [0.5, 2.0]])
    report = verify(line, LIMITS, to_rest=False)
    assert report.violation.joint == "elbow"
    assert report.peak_velocity_ratio == pytest.approx([0.5, 2.0])


def test_a_hundred_thousand_points_are_verified_without_a_loop_of_python():
    limits = Limits([f"joint_{k}" for k in range(6)], velocity=1.1, acceleration=1.1, jerk=1.1)

    def verified(count):
        times = np.arange(count) * 0.01
        phases = times[:, None] + 0.3 * np.arange(6)
        points = Waypoints(times, np.sin(phases), np.cos(phases), -np.sin(phases))
        return verify(points, limits, to_rest=False)

    report = verified(100_000)
    assert report.ok
    np.testing.assert_allclose(report.peak_velocity_ratio, 1.0 / 1.1, rtol=1e-9)
    few = lines_executed(verified, 1000)
    assert 0 < lines_executed(verified, 100_000) < 1.1 * few


@pytest.mark.parametrize(
    ("breaks", "coefficients", "error", "message"),
    [
        ([0, 1, 1], np.zeros((2, 2, 1)), BadValueError, r"breaks of the trajectory\[2\] is 1"),
        ([1, 0], np.zeros((2, 1, 1)), BadValueError, r"more than the one before, 1.0"),
        ([], np.zeros((2, 0, 1)), WrongSizeError, "breaks of the trajectory"),
        ([0, 1], np.zeros((2, 2, 1)), WrongSizeError, "coefficients of the trajectory"),
        ([0, 1], np.zeros((11, 1, 1)), BadValueError, "order of the trajectory is 10"),
        ([0, 1], np.full((2, 1, 1), np.nan), NonFiniteError, "coefficients of the trajectory"),
        ([0, np.inf], np.zeros((2, 1, 1)), NonFiniteError, "breaks of the trajectory"),
        ([0, 1], np.full((4, 1, 1), 1e308), BadValueError, "largest position on the trajectory"),
    ],
)
def test_pieces_that_make_no_curve_are_refused(breaks, coefficients, error, message):
    limits = Limits(["joint"], velocity=1.0, acceleration=1.0, jerk=1.0)
    with pytest.raises(error, match=message):
        verify(PiecewisePolynomial(np.array(breaks, dtype=float), coefficients), limits)
