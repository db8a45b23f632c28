"""Pieces of curves: what changes at their breaks, another pace, and what goes by."""

import numpy as np
import pytest
from numpy.polynomial import Polynomial

from robomech_ros.execution.controller.curve_parts import jerks_over, paced, peaks, shifted
from robomech_ros.execution.controller.late_start import ScheduleShift, extend_schedule
from robomech_ros.execution.joints import Joints
from robomech_ros.robots import load_robot
from robomech_ros.trajectory import Waypoints
from robomech_ros.trajectory.curves.interpolation import interpolant
from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial

CYCLE = 0.002
# A place that is 20 ms behind, at another pace, and all that fades out in 0.2 s.
FADING = Polynomial([-0.02, 0.1, 0.5]) * Polynomial([1.0, -5.0]) ** 3


def two_pieces(step=0.0, jerk=0.0):
    """An acceleration of 1, then 1 and a step more, and a jerk."""
    first, then = [0.0, 0.0, 0.5, 0.0], [0.005, 0.1, 0.5 * (1.0 + step), jerk / 6.0]
    coefficients = np.array([first, then]).T[:, :, None]
    return PiecewisePolynomial(np.array([0.0, 0.1, 0.3]), coefficients)


@pytest.mark.parametrize(("step", "jerk", "over"), [(2.0, 0.0, 1000.0), (2.0, 10.0, 1010.0)])
def test_a_step_of_the_acceleration_is_a_jerk_of_a_cycle(step, jerk, over):
    assert jerks_over(two_pieces(step, jerk), CYCLE) == pytest.approx([over], rel=1e-9)
    assert jerks_over(two_pieces(-step, -jerk), CYCLE) == pytest.approx([over], rel=1e-9)


def test_what_goes_against_a_step_leaves_the_step():
    assert jerks_over(two_pieces(2.0, -10.0), CYCLE) == pytest.approx([1000.0], rel=1e-9)
    assert jerks_over(two_pieces(0.0, 10.0), CYCLE) == pytest.approx([10.0], rel=1e-9)


def test_another_pace_has_no_steps_where_the_curve_has_none():
    """It is the curve at other places, with the accelerations that follow from the pace."""
    times = np.linspace(-0.2, 1.0, 25)
    waves = np.stack([np.sin(3.0 * times), np.cos(5.0 * times)], axis=1)
    rates = np.stack([3.0 * np.cos(3.0 * times), -5.0 * np.sin(5.0 * times)], axis=1)
    changes = -waves * (9.0, 25.0)
    curve = interpolant(times, waves, rates, changes)
    way = paced(curve, FADING.coef, 0.2)
    for at in np.random.default_rng(0).uniform(0.0, 0.2, 50):
        there = curve.sample(at + FADING(at))
        pace, rate = 1.0 + FADING.deriv()(at), FADING.deriv(2)(at)
        found = way.sample(at)
        np.testing.assert_allclose(found.position, there.position, atol=1e-7)
        exact = there.acceleration * pace**2 + there.velocity * rate
        np.testing.assert_allclose(found.acceleration, exact, atol=2e-2)
    assert (jerks_over(way, CYCLE) <= 1.01 * peaks(way, 3)).all()


def test_another_pace_keeps_the_steps_of_the_curve():
    """No quintic swings beyond the accelerations on both sides of a step."""
    curve = shifted(two_pieces(-2.0), -0.05)
    way = paced(curve, np.array([-1e-3, 0.0, 0.0, 0.0, 0.0, 0.0]), 0.2)
    assert peaks(way, 2) == pytest.approx([1.0], abs=1e-3)
    assert jerks_over(way, CYCLE) == pytest.approx([1000.0], rel=0.01)


def test_what_goes_by_is_remembered_on_the_path():
    """A robot that cannot follow yet, and brakes, lost the path: what came later was far away."""
    joints = Joints.of(load_robot("puma560"))
    slope = np.array([0.5, -0.2, 0.0, 0.1, 0.0, 0.0])
    times = np.array([0.0, 0.1, 0.2])
    before = interpolant(times - 0.15, np.outer(times, slope), np.tile(slope, (3, 1)))
    later = np.array([0.0, 0.1, 0.3])
    rates = np.vstack((slope, slope, 0.0 * slope))
    ends = np.outer([0.15, 0.25, 0.35], slope)
    late = Waypoints(later, ends, rates)
    belt = extend_schedule(late, joints, 0.02, ScheduleShift(before, 0.02, -0.1))
    # 20 ms late, and a robot that is 20 ms behind: they are where their stamps have them.
    for time in (-0.1, 0.0, 0.05, 0.1):
        expected = (time + 0.15) * slope
        np.testing.assert_allclose(belt.curve.sample(time).position, expected, atol=1e-12)
    np.testing.assert_allclose(belt.curve.sample(0.3).position, ends[-1], atol=1e-12)
    assert (belt.lag, belt.merged) == (0.02, -0.1)
