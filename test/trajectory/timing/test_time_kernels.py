"""The kernels of trajectories against plain NumPy."""

from math import comb

import numpy as np
import pytest

from robomech_ros._kernels.timing import constraint_rows as time_rows
from robomech_ros.errors import NonFiniteError
from robomech_ros.trajectory import PiecewisePolynomial
from robomech_ros.trajectory.curves.compiled_sampling import sample_many


@pytest.mark.parametrize("degree", [1, 2, 3, 5])
def test_rows_are_the_bernstein_coefficients_of_the_acceleration(degree):
    rng = np.random.default_rng(degree)
    local = rng.normal(size=(3, 2, degree + 1))
    spans, bends, scales = rng.uniform(0.1, 1, 3), rng.uniform(-0.5, 0.5, 3), rng.uniform(0.5, 2, 2)
    first, second = np.empty((2, 3, 2 * (degree + 1)))
    time_rows.joint_rows(local, spans, bends, scales, first, second)
    sigma = np.linspace(0, 1, 7)
    basis = [comb(degree, i) * sigma**i * (1 - sigma) ** (degree - i) for i in range(degree + 1)]
    for k in range(3):
        x0, x1 = rng.uniform(0, 1, 2)
        bow = 0.5 * bends[k] * (x0 + x1)
        x = x0 + (x1 - x0) * sigma + bow * sigma * (1 - sigma)
        rate = (x1 - x0 + bow * (1 - 2 * sigma)) / (2 * spans[k])
        for j in range(2):
            path = np.polynomial.Polynomial(local[k, j])
            s = sigma * spans[k]
            exact = scales[j] * (path.deriv(1)(s) * rate + path.deriv(2)(s) * x)
            mine = slice(j * (degree + 1), (j + 1) * (degree + 1))
            found = (first[k, mine] * x0 + second[k, mine] * x1) @ np.array(basis)
            np.testing.assert_allclose(found, exact, atol=1e-12)


@pytest.mark.parametrize("size", [1, 2, 4, 6, 10])
@pytest.mark.parametrize("segments", [0, 1, 7])
def test_many_samples_are_those_of_the_curve(size, segments):
    rng = np.random.default_rng(size)
    breaks = np.cumsum(rng.uniform(0.1, 1.0, segments + 1))
    coefficients = rng.normal(size=(max(segments, 1), 3, size)).T
    curve = PiecewisePolynomial(breaks, coefficients.transpose(0, 2, 1))
    instants = np.concatenate([rng.uniform(breaks[0] - 1.0, breaks[-1] + 1.0, 50), breaks])
    many, one = sample_many(curve, instants), sample_many(curve, instants[7])
    for rates, wanted, single in zip(many, curve.sample(instants), one, strict=True):
        np.testing.assert_allclose(rates, wanted, rtol=1e-12, atol=1e-12)
        np.testing.assert_allclose(single, wanted[7], rtol=1e-12, atol=1e-12)
    with pytest.raises(NonFiniteError):
        sample_many(curve, [0.0, np.nan])
