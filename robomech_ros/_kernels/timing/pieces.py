"""Motion along a path as quintic pieces in time, from squared speeds at nodes."""

import math

import numpy as np

from robomech_ros._kernels.compiling.jit import inline, kernel
from robomech_ros._kernels.compiling.types import IIN1, IN1, IN3, IOUT1, OUT1, OUT3, f8, i8
from robomech_ros._kernels.timing.quintic import upper_coefficients

_upper_coefficients = inline(upper_coefficients)

# Gauss-Legendre quadrature of order 12 on [0, 1]: half the nodes and the weights.
_NODES = (0.03376524289842397, 0.16939530676686774, 0.38069040695840156)
_WEIGHTS = (0.08566224618958517, 0.1803807865240693, 0.23395696728634552)
_MOST = 64


@inline
def _coordinate(x0, x1, w):
    """Return sigma at the fraction w of the change of speed, if the speed were linear in time."""
    y0, y1 = math.sqrt(x0), math.sqrt(x1)
    return w * (2.0 * y0 + (y1 - y0) * w) / (y0 + y1)


@inline
def _duration(x0, x1, theta, span, w0, w1):
    """Return the time for part of a cell, from w0 to w1, by quadrature."""
    y0, y1 = math.sqrt(x0), math.sqrt(x1)
    bend = 0.5 * theta * (x0 + x1)
    if bend == 0.0:
        return 2.0 * span * (w1 - w0) / (y0 + y1)
    total = 0.0
    for i in range(6):
        node = _NODES[i] if i < 3 else 1.0 - _NODES[5 - i]
        weight = _WEIGHTS[i] if i < 3 else _WEIGHTS[5 - i]
        w = w0 + (w1 - w0) * node
        y = y0 + (y1 - y0) * w
        sigma = _coordinate(x0, x1, w)
        # For y = 0 at an end, (1 + bend ...) stays finite: divide by y first.
        total += weight / math.sqrt(1.0 + bend * sigma * (1.0 - sigma) / (y * y))
    return 2.0 * span * (w1 - w0) * total / (y0 + y1)


@inline
def _state(local, x0, x1, theta, span, sigma, state):
    """Write displacement from the start of the cell, velocity and acceleration of joints (3, n)."""
    bend = 0.5 * theta * (x0 + x1)
    x = max(x0 + sigma * (x1 - x0 + bend * (1.0 - sigma)), 0.0)
    speed, rate = math.sqrt(x), 0.5 * (x1 - x0 + bend * (1.0 - 2.0 * sigma)) / span
    size, s = local.shape[1], sigma * span
    for j in range(local.shape[0]):
        # The mean rate (q(s) - q(0)) / s keeps its digits for any s.
        value, first, second = local[j, size - 1], 0.0, 0.0
        for i in range(size - 2, 0, -1):
            second = second * s + 2.0 * first
            first = first * s + value
            value = value * s + local[j, i]
        second = second * s + 2.0 * first
        first = first * s + value
        state[0, j] = value * s
        state[1, j] = first * speed
        state[2, j] = first * rate + second * x


@inline
def _quintic(before, after, j, duration):
    """Return coefficients 3 to 5 of the quintic between two states of joint j."""
    rise = after[0, j] - before[0, j]
    return _upper_coefficients(duration, rise, before[1, j], after[1, j], before[2, j], after[2, j])


@kernel(f8(IN1, IN1, IN1))
def total_time(spans, thetas, x):
    """Return the total time (s) of all cells; the arguments are as for `piece_counts`."""
    total = 0.0
    for k in range(spans.shape[0]):
        total += _duration(x[k], x[k + 1], thetas[k], spans[k], 0.0, 1.0)
    return total


@kernel(i8(IN3, IN1, IN1, IN1, IN1, f8, IOUT1))
def piece_counts(local, spans, thetas, x, scales, accuracy, counts):
    """Write the numbers of pieces of cells for accurate accelerations; return their sum.

    ``local`` (m, n, d + 1) is the path in each cell, in powers of the coordinate from its start,
    ``spans`` and ``thetas`` (m,) are lengths and bends of cells, x (m + 1,) squared speeds at the
    nodes, and ``scales`` (n,) inverse unit accelerations of joints.  The ``accuracy`` is the
    largest error of the scaled acceleration in the middle of a piece.  ``counts`` (m,) is written.
    """
    joints = local.shape[1]
    states = np.empty((3, 3, joints))
    total = 0
    for k in range(spans.shape[0]):
        x0, x1 = x[k], x[k + 1]
        whole = _duration(x0, x1, thetas[k], spans[k], 0.0, 1.0)
        half = _duration(x0, x1, thetas[k], spans[k], 0.0, 0.5)
        for i in range(3):
            _state(local[k], x0, x1, thetas[k], spans[k], _coordinate(x0, x1, 0.5 * i), states[i])
        error = 0.0
        for j in range(joints):
            c3, c4, c5 = _quintic(states[0], states[2], j, whole)
            value = half * (6.0 * c3 + half * (12.0 * c4 + half * 20.0 * c5))
            error = max(error, abs(states[0, 2, j] + value - states[1, 2, j]) * scales[j])
        count = 1
        if error > accuracy:
            count = int(min(math.ceil((error / accuracy) ** 0.25), _MOST))
        counts[k] = count
        total += count
    return total


@kernel(i8(IN3, IN1, IN1, IN1, IIN1, OUT1, OUT1, OUT1, OUT3))
def write_pieces(local, spans, thetas, x, counts, times, coordinates, speeds, coefficients):
    """Write the motion as quintic pieces; the first five arguments are as for `piece_counts`.

    ``times`` (p + 1,) receives the ends of the pieces, from 0, ``coordinates`` and ``speeds``
    (p + 1,) the path coordinate from the start and its rate at these times, and ``coefficients``
    (6, p, n) those of powers of the time since the start of a piece.
    """
    joints = local.shape[1]
    before, after = np.empty((3, joints)), np.empty((3, joints))
    piece = 0
    reached = 0.0
    times[0], coordinates[0], speeds[0] = 0.0, 0.0, math.sqrt(x[0])
    for k in range(spans.shape[0]):
        x0, x1, theta, span = x[k], x[k + 1], thetas[k], spans[k]
        bend = 0.5 * theta * (x0 + x1)
        for i in range(counts[k]):
            w0, w1 = i / counts[k], (i + 1) / counts[k]
            sigma = _coordinate(x0, x1, w0)
            _state(local[k], x0, x1, theta, span, sigma, before)
            sigma = _coordinate(x0, x1, w1)
            _state(local[k], x0, x1, theta, span, sigma, after)
            duration = _duration(x0, x1, theta, span, w0, w1)
            for j in range(joints):
                c3, c4, c5 = _quintic(before, after, j, duration)
                coefficients[0, piece, j] = local[k, j, 0] + before[0, j]
                coefficients[1, piece, j] = before[1, j]
                coefficients[2, piece, j] = 0.5 * before[2, j]
                coefficients[3, piece, j], coefficients[4, piece, j] = c3, c4
                coefficients[5, piece, j] = c5
            times[piece + 1] = times[piece] + duration
            coordinates[piece + 1] = reached + sigma * span
            square = x0 + sigma * (x1 - x0 + bend * (1.0 - sigma))
            speeds[piece + 1] = math.sqrt(max(square, 0.0))
            piece += 1
        reached += span
    return piece
