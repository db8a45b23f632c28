"""Sampling of piecewise polynomials and their first three derivatives, and interpolation."""

import math

import numpy as np

from robomech_ros._kernels.compiling.jit import inline, kernel
from robomech_ros._kernels.compiling.types import IN1, IN2, IN3, OUT1, OUT3, b1, f8, i8
from robomech_ros._kernels.timing.quintic import rounding_bounds, upper_coefficients

_NANOSECONDS = 1e9

_upper_coefficients = inline(upper_coefficients)
_rounding_bounds = inline(rounding_bounds)


@inline
def _piece(breaks, pieces, t, known):
    """Return the last piece that starts at or before t; try the piece `known` first."""
    if breaks[known] <= t and (known + 1 == pieces or t < breaks[known + 1]):
        return known
    low, high = 0, pieces
    while high - low > 1:
        middle = (low + high) // 2
        if breaks[middle] <= t:
            low = middle
        else:
            high = middle
    return low


@kernel(i8(IN1, IN3, IN1, OUT3))
def sample_pieces(breaks, coefficients, times, rates):
    """Sample positions and three derivatives, ``rates`` (4, m, n), at ``times`` (m,).

    ``breaks`` (s + 1,) are the increasing ends of the pieces; outside them the joints rest.
    ``coefficients`` (d + 1, max(s, 1), n) belong to powers of the time since the start of a piece,
    lowest first.
    """
    size, pieces, joints = coefficients.shape
    last = breaks[breaks.shape[0] - 1]
    k = 0
    for i in range(times.shape[0]):
        t = min(max(times[i], breaks[0]), last)
        k = _piece(breaks, pieces, t, k)
        elapsed = t - breaks[k]
        moving = 1.0 if t == times[i] else 0.0
        for j in range(joints):
            # Horner's scheme for the derivatives over their factorials.
            value, first, second, third = coefficients[size - 1, k, j], 0.0, 0.0, 0.0
            for p in range(size - 2, -1, -1):
                third = third * elapsed + second
                second = second * elapsed + first
                first = first * elapsed + value
                value = value * elapsed + coefficients[p, k, j]
            rates[0, i, j] = value
            rates[1, i, j] = moving * first
            rates[2, i, j] = moving * 2.0 * second
            rates[3, i, j] = moving * 6.0 * third
    return 0


@kernel(f8(IN1, f8, OUT1))
def spread_instants(breaks, period, instants):
    """Return the number of times at breaks (s + 1,) and evenly between, at most ``period`` apart.

    If ``instants`` is not empty, it receives all but the last time, rounded to nanoseconds.
    """
    count = 0.0
    for k in range(breaks.shape[0] - 1):
        span = breaks[k + 1] - breaks[k]
        parts = max(math.ceil(span / period * (1.0 - 1e-9)), 1.0)
        for i in range(int(parts) if instants.shape[0] else 0):
            t = breaks[k] + span / parts * i
            instants[int(count) + i] = np.rint(t * _NANOSECONDS) / _NANOSECONDS
        count += parts
    return count + 1.0


@kernel(b1(IN1, IN2, IN2, IN2, OUT3, OUT3))
def quintic_pieces(times, positions, velocities, accelerations, coefficients, doubts):
    """Interpolate samples (m, n) at ``times`` (m,), m at least 2, by quintics.

    Returns whether all numbers are finite and the times increase.  If so, ``coefficients``
    (6, m - 1, n) receives those of powers of the time since the start of a piece, and ``doubts``
    (4, m - 1, n) bounds of rounding errors of position and three rates.
    """
    samples, joints = positions.shape
    largest = np.zeros((3, joints))
    total = 0.0
    for k in range(samples - 1):
        for j in range(joints):
            largest[0, j] = max(largest[0, j], abs(positions[k, j]))
            largest[1, j] = max(largest[1, j], abs(velocities[k, j]))
            largest[2, j] = max(largest[2, j], abs(accelerations[k, j]))
    for k in range(samples - 1):
        h = times[k + 1] - times[k]
        if not (h > 0.0 and h < np.inf):
            return False
        for j in range(joints):
            v, a = velocities[k, j], accelerations[k, j]
            coefficients[0, k, j], coefficients[1, k, j] = positions[k, j], v
            coefficients[2, k, j] = 0.5 * a
            rise = positions[k + 1, j] - positions[k, j]
            upper = _upper_coefficients(
                h, rise, v, velocities[k + 1, j], a, accelerations[k + 1, j]
            )
            bounds = _rounding_bounds(h, times[k + 1], largest[0, j], largest[1, j], largest[2, j])
            coefficients[3, k, j], coefficients[4, k, j], coefficients[5, k, j] = upper
            for order in range(4):
                doubts[order, k, j] = bounds[order]
            # A single number that is not finite makes the total NaN.
            total += 0.0 * coefficients[5, k, j]
    return total == 0.0
