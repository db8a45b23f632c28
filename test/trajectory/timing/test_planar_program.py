"""The speeds that rows of limits allow in one cell, against vertices in rational numbers."""

from fractions import Fraction

import numpy as np
import pytest

from robomech_ros._kernels.timing.optimal import DONE, speed_profile


def largest_exactly(first, second, rest, bounds):
    """The largest x_0 of all vertices that keep to all rows and bounds."""
    one, zero = Fraction(1), Fraction(0)
    lines = [(-one, zero, zero), (zero, -one, zero)]
    lines += [(one, zero, Fraction(bounds[0])), (zero, one, Fraction(bounds[1]))]
    for row in zip(first.tolist(), second.tolist(), rest.tolist(), strict=True):
        a, b, c = map(Fraction, row)
        lines += [(a, b, 1 - c), (-a, -b, 1 + c)]
    found = []
    for i, (a, b, c) in enumerate(lines):
        for d, e, f in lines[:i]:
            crossing = a * e - b * d
            if crossing:
                x, y = (c * e - b * f) / crossing, (a * f - c * d) / crossing
                if all(p * x + q * y <= most for p, q, most in lines):
                    found.append(x)
    return float(max(found))


def largest(first, second, rest, bounds):
    """The status of the kernel, and the largest x_0 from which it finds a way."""
    lowest, highest, x = np.empty((3, 2))
    where = np.zeros(1, np.int64)
    rows = first[None], second[None], rest[None]
    status = speed_profile(*rows, np.array(bounds), -1.0, -1.0, lowest, highest, x, where)
    return status, highest[0]


def nearly_parallel(seed):
    """Rows that differ by rounding, as of drives without gravity, and by a little load."""
    rng = np.random.default_rng(seed)
    count = int(rng.integers(2, 5))
    slope = rng.uniform(0.5, 1.0)
    size = 10.0 ** rng.uniform(2.0, 6.0)
    scales = size * rng.choice([-1.0, 1.0], count) * 10.0 ** rng.uniform(-1.0, 0.0, count)
    scales[:2] = size
    first, second = (
        part * scales * (1.0 + 5e-16 * rng.integers(-20, 20, count)) for part in (1.0, -slope)
    )
    rest = rng.normal(size=count) * 10.0 ** rng.uniform(-9.0, -4.0)
    return first, second, rest, 10.0 ** rng.uniform(0.0, 4.0, 2)


def test_a_line_beside_another_one_is_met_where_the_box_is_long_enough():
    first, second = np.array([72189.5187519281, 72189.51875192858]), [-42124.4946434104] * 2
    rest, bounds = np.array([9.784711420837258e-10, -1.3205703112636719e-09]), (8467.8, 193.0)
    status, found = largest(first, np.array(second), rest, bounds)
    assert status == DONE
    exact = largest_exactly(first, np.array(second), rest, bounds)
    assert found == pytest.approx(exact, rel=1e-9)


def test_rows_that_are_nearly_parallel_refuse_no_cell():
    for seed in range(120):
        rows = nearly_parallel(seed)
        status, found = largest(*rows)
        assert status == DONE, seed
        assert found == pytest.approx(largest_exactly(*rows), rel=1e-9), seed
