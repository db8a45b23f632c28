"""Largest squared speed along a path within limits of joint speeds, throughout every cell."""

import numpy as np

from robomech_ros._kernels.algebra.bernstein import to_bernstein
from robomech_ros._kernels.compiling.jit import inline, kernel
from robomech_ros._kernels.compiling.types import IN1, IN3, OUT1, OUT3, i8

# Largest ratio of the bounds of x at neighbouring nodes: without joint motion, x has no bound.
STEEPEST = 4.0


@inline
def _square_peak(rate, size, x0, x1, theta, product):
    """Return a bound of rate(sigma)^2 x(sigma) on [0, 1]: its largest Bernstein coefficient."""
    degree = 2 * size
    bend = 0.5 * theta * (x0 + x1)
    slope = x1 - x0 + bend
    for k in range(degree + 1):
        product[k] = 0.0
    for i in range(size):
        for j in range(size):
            value = rate[i] * rate[j]
            product[i + j] += value * x0
            product[i + j + 1] += value * slope
            product[i + j + 2] -= value * bend
    to_bernstein(product, degree)
    peak = 0.0
    for k in range(degree + 1):
        peak = max(peak, product[k])
    return peak


@kernel(i8(IN3, IN1, IN1, OUT3))
def joint_rates(local, spans, scales, rates):
    """Write the derivatives q' of the joints over their speed limits.

    ``local`` (m, n, d + 1) comes from `local_path`, ``spans`` (m,) are lengths of cells, and
    ``scales`` (n,) inverse speed limits of joints.  ``rates`` (m, n, d) receives coefficients of
    powers of sigma, lowest first.
    """
    for k in range(local.shape[0]):
        for j in range(local.shape[1]):
            power = scales[j]
            for i in range(local.shape[2] - 1):
                rates[k, j, i] = (i + 1) * local[k, j, i + 1] * power
                power *= spans[k]
    return 0


@inline
def _bound_at_nodes(rates, bounds):
    """Lower the bounds until no rate exceeds 1 at a node."""
    for k in range(rates.shape[0]):
        left, right = 0.0, 0.0
        for j in range(rates.shape[1]):
            total = 0.0
            for i in range(rates.shape[2]):
                total += rates[k, j, i]
            left = max(left, rates[k, j, 0] * rates[k, j, 0])
            right = max(right, total * total)
        if left * bounds[k] > 1.0:
            bounds[k] = 1.0 / left
        if right * bounds[k + 1] > 1.0:
            bounds[k + 1] = 1.0 / right


@kernel(i8(IN3, IN1, OUT1))
def speed_bounds(rates, thetas, bounds):
    """Lower ``bounds`` (m + 1,) of x at the nodes until ``rate^2 x <= 1`` throughout the cells.

    ``rates`` (m, l, c) are derivatives by the path coordinate over their speed limits, in powers
    of sigma, and ``thetas`` (m,) the bends of the cells.
    """
    cells, size = rates.shape[0], rates.shape[2]
    _bound_at_nodes(rates, bounds)
    for k in range(cells):
        bounds[k + 1] = min(bounds[k + 1], STEEPEST * bounds[k])
    for k in range(cells - 1, -1, -1):
        bounds[k] = min(bounds[k], STEEPEST * bounds[k + 1])
    product, hull = np.empty(2 * size + 1), np.empty(size)
    worst = np.ones(cells + 1)
    for k in range(cells):
        highest = max(bounds[k], bounds[k + 1]) * (1.0 + 0.25 * abs(thetas[k]))
        for j in range(rates.shape[1]):
            largest = 0.0
            for i in range(size):
                hull[i] = rates[k, j, i]
                largest += abs(hull[i])
            if largest * largest * highest <= 1.0:
                continue
            to_bernstein(hull, size - 1)
            largest = 0.0
            for i in range(size):
                largest = max(largest, abs(hull[i]))
            if largest * largest * highest <= 1.0:
                continue
            peak = _square_peak(rates[k, j], size, bounds[k], bounds[k + 1], thetas[k], product)
            worst[k] = max(worst[k], peak)
            worst[k + 1] = max(worst[k + 1], peak)
    for k in range(cells + 1):
        bounds[k] /= worst[k]
    return 0
