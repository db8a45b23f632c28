"""Extremes between samples: never missed, and exact."""

import numpy as np
import pytest

from robomech_ros.trajectory import PiecewisePolynomial, interpolant
from robomech_ros.trajectory.curves.bounds import (
    extremes,
    extremes_and_steps,
    first_above,
    hull,
    steps,
)

NAMES = ("position", "velocity", "acceleration", "jerk")


def random_curve(seed, fields):
    generator = np.random.default_rng(seed)
    times = np.cumsum(generator.uniform(0.05, 0.5, 12))
    return interpolant(times, *(generator.normal(size=(12, 4)) for _ in range(fields)))


def polynomial_extremes(curve, order):
    """Extremes by the roots of the derivative, segment by segment."""
    coefficients, slopes = curve.derivative(order), curve.derivative(order + 1)
    values = [[] for _ in range(curve.joints)]
    for segment, span in enumerate(curve.spans):
        for joint in range(curve.joints):
            roots = np.roots(slopes[::-1, segment, joint])
            real = roots[np.abs(roots.imag) < 1e-9].real
            places = [0.0, span, *real[(real > 0.0) & (real < span)]]
            values[joint].extend(np.polyval(coefficients[::-1, segment, joint], places))
    return [min(of_joint) for of_joint in values], [max(of_joint) for of_joint in values]


@pytest.mark.parametrize("order", range(4))
@pytest.mark.parametrize("fields", [1, 2, 3])
@pytest.mark.parametrize("seed", range(5))
def test_extremes_equal_those_by_roots(seed, fields, order):
    curve = random_curve(seed, fields)
    low, high = (values[order] for values in extremes(curve))
    wanted_low, wanted_high = polynomial_extremes(curve, order)
    np.testing.assert_allclose(low, wanted_low, rtol=1e-8, atol=1e-8)
    np.testing.assert_allclose(high, wanted_high, rtol=1e-8, atol=1e-8)


@pytest.mark.parametrize("order", range(4))
def test_the_hull_holds_the_curve(order):
    curve = random_curve(3, 3)
    coefficients = hull(curve, order)
    for segment, (begin, end) in enumerate(zip(curve.breaks[:-1], curve.breaks[1:], strict=True)):
        instants = np.linspace(begin, np.nextafter(end, 0.0), 30)
        values = getattr(curve.sample(instants), NAMES[order])
        slack = 1e-9 * np.abs(coefficients[:, segment]).max()
        assert (values <= coefficients[:, segment].max(axis=0) + slack).all()
        assert (values >= coefficients[:, segment].min(axis=0) - slack).all()


@pytest.mark.parametrize("seed", range(10))
def test_the_first_excess_is_in_the_first_segment_that_has_one(seed):
    curve = random_curve(seed, 3)
    bound = 0.5 * extremes(curve)[1][1]
    segment, joint = first_above(hull(curve, 1), bound)
    peaks = [
        curve.sample(np.linspace(begin, np.nextafter(end, 0.0), 2001)).velocity.max(axis=0)
        for begin, end in zip(curve.breaks[:-1], curve.breaks[1:], strict=True)
    ]
    over = np.array(peaks) > bound
    assert segment == int(np.argmax(over.any(axis=1)))
    assert joint == int(np.argmax(over[segment]))


def test_a_bound_that_is_touched_is_not_exceeded():
    curve = interpolant([0.0, 1.0, 2.0], [[0.0], [1.0], [0.0]], [[0.0]] * 3, [[0.0]] * 3)
    assert first_above(hull(curve, 0), 1.0) is None
    assert first_above(hull(curve, 0), np.nextafter(1.0, 0.0)) == (0, 0)


def test_joints_that_stand_still():
    curve = interpolant([1.0], [[2.0, -3.0]])
    for extreme in extremes(curve):
        np.testing.assert_array_equal(extreme, [[2.0, -3.0], [0.0, 0.0], [0.0, 0.0], [0.0, 0.0]])
    assert not extremes_and_steps(curve)[2].any()


def test_values_count_only_as_far_as_they_are_certain():
    curve = random_curve(1, 3)
    slack = np.zeros((4, *curve.coefficients.shape[1:]))
    slack[1] = 0.25
    low, high, _, _ = extremes_and_steps(curve, slack)
    sure_low, sure_high = extremes(curve)
    np.testing.assert_array_equal(low[[0, 2, 3]], sure_low[[0, 2, 3]])
    np.testing.assert_allclose(low[1], sure_low[1] + 0.25, atol=1e-10)
    np.testing.assert_allclose(high[1], sure_high[1] - 0.25, atol=1e-10)


@pytest.mark.parametrize("size", [1, 2, 4, 6, 10])
def test_steps_between_segments(size):
    rng = np.random.default_rng(size)
    breaks = np.cumsum(rng.uniform(0.1, 1.0, 8))
    curve = PiecewisePolynomial(breaks, rng.normal(size=(size, 7, 3)))
    inner = breaks[1:-1]
    before, after = curve.sample(np.nextafter(inner, 0.0)), curve.sample(inner)
    found = steps(curve, (0, 1, 2, 3))
    for order in range(4):
        np.testing.assert_allclose(found[order], after[order] - before[order], atol=1e-9)
    largest = np.abs(found).max(axis=1)
    np.testing.assert_allclose(extremes_and_steps(curve)[2], largest, rtol=1e-12, atol=1e-11)
    fewer = np.maximum(largest - 0.5, 0.0)
    some = extremes_and_steps(curve, np.full((4, 7, 3), 0.5))[2]
    np.testing.assert_allclose(some, fewer, rtol=1e-12, atol=1e-11)
