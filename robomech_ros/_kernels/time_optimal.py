r"""Largest speed along a path, cell by cell, within bounds that hold all along every cell.

The path coordinate is cut into cells, in which the square x of the speed is

.. math::

    x(\sigma) = x_0 (1 - \sigma) + x_1 \sigma + \theta \frac{x_0 + x_1}{2} \sigma (1 - \sigma),
    \qquad 0 \le \sigma \le 1

with a bend theta that is known beforehand.  Then everything that is linear in x and in the
acceleration x'/2 along the path is a polynomial of sigma with coefficients linear in the values
x_0 and x_1 at the ends of the cell, and its Bernstein coefficients bound it in between, too.

References
----------
H. Pham and Q.-C. Pham, "A new approach to time-optimal path parameterization based on
reachability analysis", IEEE Transactions on Robotics 34(3), 2018: the two passes.
R. T. Farouki, "The Bernstein polynomial basis: a centennial retrospective", Computer Aided
Geometric Design 29, 2012, section 3.3: the hull.
"""

import math

import numpy as np

from robomech_ros._kernels._jit import (
    IIN1,
    IN1,
    IN2,
    IN3,
    IOUT1,
    OUT1,
    OUT2,
    OUT3,
    f8,
    i8,
    inline,
    kernel,
)
from robomech_ros._kernels.planar_program import farthest
from robomech_ros._kernels.tolerances import ROW_SLACK

__all__ = [
    "BLOCKED",
    "DONE",
    "STALLED",
    "binding_rows",
    "joint_rates",
    "joint_rows",
    "local_path",
    "other_rows",
    "speed_bounds",
    "speed_profile",
]

# What the passes end with.
DONE, BLOCKED, STALLED = 0, 1, 2
# The bounds of x at neighbouring nodes differ by this factor at most: where no joint moves there
# is no bound at all.
STEEPEST = 4.0
# One over the binomial coefficients, up to the degree of the square of a speed.
_INVERSE_BINOMIALS = np.array(
    [[1.0 / math.comb(n, k) if k <= n else 0.0 for k in range(13)] for n in range(13)]
)
# A row this near to its bound counts as binding.
_BINDING = 0.999


@inline
def to_bernstein(values, degree):
    """Turn power coefficients on [0, 1] into Bernstein coefficients, in place."""
    for k in range(1, degree):
        values[k] *= _INVERSE_BINOMIALS[degree, k]
    for r in range(1, degree + 1):
        for k in range(degree, r - 1, -1):
            values[k] += values[k - 1]


@inline
def _write_rows(a, size_a, b, size_b, theta, span, scale, degree, first, second):
    """Write a(sigma) x'/2 + b(sigma) x, times `scale`, as rows for x at both ends of the cell."""
    for k in range(degree + 1):
        first[k] = 0.0
        second[k] = 0.0
    half = 0.5 * theta
    bend = -2.0 * half
    rate = 0.5 * scale / span
    for k in range(size_a):
        value = a[k] * rate
        first[k] += value * (half - 1.0)
        second[k] += value * (half + 1.0)
        if bend != 0.0:
            first[k + 1] += value * bend
            second[k + 1] += value * bend
    for k in range(size_b):
        value = b[k] * scale
        first[k] += value
        first[k + 1] += value * (half - 1.0)
        second[k + 1] += value * (half + 1.0)
        if bend != 0.0:
            first[k + 2] -= value * half
            second[k + 2] -= value * half
    to_bernstein(first, degree)
    to_bernstein(second, degree)


@kernel(i8(IN1, IN3, IN1, OUT3))
def local_path(breaks, coefficients, nodes, local):
    """Write the path cell by cell, in powers of the coordinate since the cell's beginning.

    Parameters
    ----------
    breaks : ndarray, shape (s + 1,)
        Path coordinates where its pieces begin and end.
    coefficients : ndarray, shape (d + 1, s, n)
        Its pieces, lowest power first.
    nodes : ndarray, shape (m + 1,)
        Where the cells begin and end, the breaks among them.
    local : ndarray, shape (m, n, d + 1)
        Filled.
    """
    size = coefficients.shape[0]
    piece = 0
    for k in range(local.shape[0]):
        while piece + 1 < coefficients.shape[1] and nodes[k] >= breaks[piece + 1]:
            piece += 1
        offset = nodes[k] - breaks[piece]
        for j in range(local.shape[1]):
            row = local[k, j]
            for i in range(size):
                row[i] = coefficients[i, piece, j]
            for r in range(size - 1):
                for i in range(size - 2, r - 1, -1):
                    row[i] += offset * row[i + 1]
    return DONE


@kernel(i8(IN3, IN1, IN1, IN1, OUT2, OUT2))
def joint_rows(local, spans, thetas, scales, first, second):
    """Write the accelerations q' x'/2 + q'' x of the joints over their limits, as rows.

    Parameters
    ----------
    local : ndarray, shape (m, n, d + 1)
        As `local_path` gives them.
    spans, thetas : ndarray, shape (m,)
        Length and bend of each cell.
    scales : ndarray, shape (n,)
        One over the limit of each joint.
    first, second : ndarray, shape (m, r) with r >= n (d + 1)
        The first n (d + 1) columns are filled, d + 1 for each joint.
    """
    degree = local.shape[2] - 1
    rate = np.empty(degree)
    for k in range(local.shape[0]):
        half, span = 0.5 * thetas[k], spans[k]
        for j in range(local.shape[1]):
            power = 1.0
            for i in range(degree):
                rate[i] = (i + 1) * local[k, j, i + 1] * power
                power *= span
            to_bernstein(rate, degree - 1)
            start = j * (degree + 1)
            # The rows in Bernstein form: products with the linear x'/2 and the quadratic x, whose
            # middle coefficient at either end is (1 + half) / 2.
            scale = scales[j] / (degree * span)
            left, right = 0.0, 0.0
            for i in range(degree + 1):
                here = rate[i] if i < degree else 0.0
                before = rate[i - 1] if i > 0 else 0.0
                slow, fast = 0.5 * (degree - i) * here, 0.5 * i * before
                # q'' times the length of the cell, over degree - 1, is the step of the rates.
                right = rate[i + 1] - here if i + 1 < degree else 0.0
                middle = left
                left = right
                bow = i * (degree - i) * (1.0 + half) * middle
                first[k, start + i] = scale * (
                    slow * (half - 1.0) - fast * (half + 1.0)
                    + (degree - i) * (degree - i - 1) * right + bow
                )  # fmt: skip
                last = before - rate[i - 2] if i > 1 else 0.0
                second[k, start + i] = scale * (
                    slow * (half + 1.0) - fast * (half - 1.0) + bow + i * (i - 1) * last
                )
    return DONE


@kernel(i8(IN3, IN3, IN3, IN1, IN1, i8, OUT2, OUT2, OUT2))
def other_rows(a, b, c, spans, thetas, start, first, second, rest):
    """Write a x'/2 + b x + c as rows, from `start` on; all three are quartics in every cell.

    Parameters
    ----------
    a, b, c : ndarray, shape (m, l, 5)
        Powers of sigma, lowest first, scaled so that -1 and 1 are the limits.
    spans, thetas : ndarray, shape (m,)
        Length and bend of each cell.
    start : int
        First column to fill; 7 for each of the l quantities.
    first, second, rest : ndarray, shape (m, r)
        Filled from column `start` on.
    """
    for k in range(a.shape[0]):
        for j in range(a.shape[1]):
            at = start + 7 * j
            _write_rows(a[k, j], 5, b[k, j], 5, thetas[k], spans[k], 1.0, 6,
                        first[k, at : at + 7], second[k, at : at + 7])  # fmt: skip
            row = rest[k, at : at + 7]
            for i in range(7):
                row[i] = c[k, j, i] if i < 5 else 0.0
            to_bernstein(row, 6)
    return DONE


@inline
def _square_peak(rate, size, x0, x1, theta, product):
    """Bound rate(sigma)^2 x(sigma) on [0, 1] by its largest Bernstein coefficient."""
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

    Parameters
    ----------
    local : ndarray, shape (m, n, d + 1)
        As `local_path` gives them.
    spans : ndarray, shape (m,)
        Length of each cell.
    scales : ndarray, shape (n,)
        One over the speed limit of each joint.
    rates : ndarray, shape (m, n, d)
        Filled with powers of sigma, lowest first.
    """
    for k in range(local.shape[0]):
        for j in range(local.shape[1]):
            power = scales[j]
            for i in range(local.shape[2] - 1):
                rates[k, j, i] = (i + 1) * local[k, j, i + 1] * power
                power *= spans[k]
    return DONE


@inline
def _bound_at_nodes(rates, bounds):
    """Lower the bounds until all rates keep to 1 at the nodes."""
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
    """Lower bounds of x at the nodes until ``rate^2 x <= 1`` all along the cells.

    Parameters
    ----------
    rates : ndarray, shape (m, l, c)
        Derivatives by the path coordinate over their speed limits, in powers of sigma.
    thetas : ndarray, shape (m,)
        Bend of each cell.
    bounds : ndarray, shape (m + 1,)
        Largest x at the nodes; lowered.
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
    return DONE


@inline
def _next(first, second, rest, x, lowest, highest):
    """Find the largest x_1 in [lowest, highest] that the rows allow after x_0 = x."""
    low, high = lowest, highest
    for i in range(first.shape[0]):
        slope = second[i]
        value = first[i] * x + rest[i]
        if slope > 0.0:
            if value + slope * high > 1.0 + ROW_SLACK:
                high = (1.0 - value) / slope
            if value + slope * low < -1.0 - ROW_SLACK:
                low = (-1.0 - value) / slope
        elif slope < 0.0:
            if value + slope * high < -1.0 - ROW_SLACK:
                high = (-1.0 - value) / slope
            if value + slope * low > 1.0 + ROW_SLACK:
                low = (1.0 - value) / slope
    # Only rounding makes the range empty.
    found = high if high >= low else 0.5 * (low + high)
    return max(lowest, min(highest, found))


@inline
def _scaled_down(first, second, x, y):
    """Scale x_0 = x and x_1 = y until rows without rest allow them; return x_0."""
    largest = 1.0
    for i in range(first.shape[0]):
        largest = max(largest, abs(first[i] * x + second[i] * y))
    return x / largest


@kernel(i8(IN2, IN2, IN2, IN1, f8, f8, OUT1, OUT1, OUT1, IOUT1))
def speed_profile(first, second, rest, bounds, begin, end, lowest, highest, x, where):
    """Find the largest x at all nodes within the rows of the cells, from end to beginning and back.

    Parameters
    ----------
    first, second : ndarray, shape (m, r)
        In cell k, ``|first x_k + second x_k+1 + rest| <= 1``.
    rest : ndarray, shape (m, r), or (1, r) of zeros
        A single row where there is no drift.
    bounds : ndarray, shape (m + 1,)
        Largest x at the nodes.
    begin, end : float
        Wanted x at both ends; negative for any, and the nearest one possible at the beginning.
    lowest, highest : ndarray, shape (m + 1,)
        Filled with the range of x from which the end can be reached.
    x : ndarray, shape (m + 1,)
        Filled.
    where : ndarray of int, shape (1,)
        Filled with the cell at fault.

    Returns
    -------
    status : int
        DONE; BLOCKED: no x allows to pass a cell, or none that leads to the wanted end; STALLED:
        a cell is entered and left at rest.
    """
    cells, rows = first.shape
    drift = rest.shape[0] == cells
    order = np.arange(rows)
    lowest[cells] = min(max(end, 0.0), bounds[cells])
    highest[cells] = min(end, bounds[cells]) if end >= 0.0 else bounds[cells]
    for k in range(cells - 1, -1, -1):
        box = (0.0, bounds[k], lowest[k + 1], highest[k + 1])
        row = rest[k if drift else 0]
        found = farthest(first[k], second[k], row, order, box, 1.0)
        where[0] = k
        free = not drift and lowest[k + 1] == 0.0
        if free and not found > 0.0:
            found = _scaled_down(first[k], second[k], bounds[k], highest[k + 1])
        if not found >= 0.0:
            return BLOCKED
        highest[k] = found
        lowest[k] = 0.0
        if not free:
            found = farthest(first[k], second[k], row, order, box, -1.0)
            if not found >= 0.0:
                return BLOCKED
            lowest[k] = min(found, highest[k])
    if begin < 0.0:
        # The largest next x counts; where x_0 binds as well, less of it may allow more of that.
        row = rest[0]
        box = (lowest[1], highest[1], lowest[0], highest[0])
        reached = farthest(second[0], first[0], row, order, box, 1.0)
        if reached >= 0.0:
            begin = _next(second[0], first[0], row, reached, lowest[0], highest[0])
    x[0] = min(max(begin, lowest[0]), highest[0])
    for k in range(cells):
        row = rest[k if drift else 0]
        x[k + 1] = _next(first[k], second[k], row, x[k], lowest[k + 1], highest[k + 1])
        if not x[k + 1] + x[k] > 0.0:
            where[0] = k
            return STALLED
    return DONE


@kernel(i8(IN2, IN2, IN2, IN1, IN1, IIN1, IOUT1))
def binding_rows(first, second, rest, bounds, x, owners, binding):
    """Find what binds in each cell.

    Parameters
    ----------
    first, second, rest, bounds, x
        As for `speed_profile`.
    owners : ndarray of int, shape (r,)
        To which quantity each row belongs, counted from 1.
    binding : ndarray of int, shape (m,)
        Filled with the number of the quantity and the sign of its bound; 0 where x is at its
        bounds instead, and a number of its own for each cell where nothing binds all along.
    """
    drift = rest.shape[0] == first.shape[0]
    for k in range(first.shape[0]):
        largest = _BINDING
        bounded = x[k] >= largest * bounds[k] and x[k + 1] >= largest * bounds[k + 1]
        binding[k] = 0 if bounded else first.shape[1] + 1 + k
        row = rest[k if drift else 0]
        for i in range(first.shape[1]):
            value = first[k, i] * x[k] + second[k, i] * x[k + 1] + row[i]
            if abs(value) > largest:
                largest = abs(value)
                binding[k] = owners[i] if value > 0.0 else -owners[i]
    return DONE
