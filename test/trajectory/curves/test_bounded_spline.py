"""Splines that stay inside bounds between their points: against the problem's own conditions."""

import numpy as np
import pytest
from scipy.optimize import minimize

from robomech_ros.trajectory.curves.bounded_spline import bounded_spline
from robomech_ros.trajectory.curves.bounds import extremes
from robomech_ros.trajectory.curves.cubic_spline import cubic_spline

LOWER, UPPER = np.array([-3.0, 0.0]), np.array([3.0, 3.0])


@pytest.mark.parametrize("ends", ["rest", "natural"])
@pytest.mark.parametrize("seed", range(8))
def test_it_passes_the_points_inside_the_bounds_with_continuous_acceleration(seed, ends):
    rng = np.random.default_rng(seed)
    points = rng.uniform(LOWER, UPPER, (3 + seed % 4, 2))
    points[rng.random(points.shape) < 0.3] = 0.0  # the lower bound of the second joint
    knots = np.cumsum(rng.uniform(0.3, 1.0, len(points)))
    curve = bounded_spline(knots, points, LOWER, UPPER, ends)
    np.testing.assert_allclose(curve.sample(knots).position, points, atol=1e-12)
    (low, *_), (high, *_) = extremes(curve)
    assert (low > LOWER - 1e-6).all() and (high < UPPER + 1e-6).all()
    inner = curve.breaks[1:-1]
    before, after = (curve.sample(inner + step) for step in (-1e-9, 1e-9))
    np.testing.assert_allclose(before.velocity, after.velocity, atol=1e-6)
    np.testing.assert_allclose(before.acceleration, after.acceleration, atol=1e-5)
    ended = curve.sample(knots[[0, -1]] + [1e-12, -1e-12])
    np.testing.assert_allclose(ended.acceleration, 0.0, atol=1e-8)
    if ends == "rest":
        np.testing.assert_allclose(ended.velocity, 0.0, atol=1e-8)


def test_no_other_spline_inside_the_bounds_bends_less():
    """A search by another method finds the same values at the free knots."""
    knots, points = np.arange(3.0), np.array([[0.0], [0.01], [1.0]])
    curve = bounded_spline(knots, points, np.zeros(1), np.array([np.inf]))
    finer = np.linspace(0.0, 2.0, 5)
    unit = cubic_spline(finer, np.eye(5), "rest")
    lengths = np.diff(unit.breaks)
    weights = np.append(lengths, 0.0) + np.append(0.0, lengths)
    at = np.linspace(0.0, 2.0, 400)
    basis, bending = unit.sample(at).position, unit.sample(unit.breaks).acceleration

    def values(x):
        return np.array([0.0, x[0], 0.01, x[1], 1.0])

    found = minimize(
        lambda x: weights @ (bending @ values(x)) ** 2,
        [0.005, 0.5],
        method="SLSQP",
        constraints={"type": "ineq", "fun": lambda x: basis @ values(x)},
        options={"ftol": 1e-14},
    )
    np.testing.assert_allclose(curve.sample(finer[[1, 3]]).position[:, 0], found.x, atol=2e-4)


def test_points_outside_the_bounds_have_none():
    points = np.array([[0.0], [4.0], [1.0]])
    assert bounded_spline(np.arange(3.0), points, np.zeros(1), np.full(1, 3.0)) is None
