r"""Limits of accelerations and torques along a path, as rows valid throughout every cell.

The path coordinate is divided into cells, in which the squared speed is

.. math::

    x(\sigma) = x_0 (1 - \sigma) + x_1 \sigma + \theta \frac{x_0 + x_1}{2} \sigma (1 - \sigma),
    \qquad 0 \le \sigma \le 1

with a known bend theta.  Then quantities linear in x and in the acceleration x'/2 along the path
are polynomials of sigma with coefficients linear in the values x_0 and x_1 at the ends of the cell.
Their Bernstein coefficients bound them in between, too.
"""

import numpy as np

from robomech_ros._kernels.algebra.bernstein import to_bernstein
from robomech_ros._kernels.compiling.jit import inline, kernel
from robomech_ros._kernels.compiling.types import IN1, IN3, OUT2, OUT3, i8


@inline
def _write_rows(a, size_a, b, size_b, theta, span, scale, degree, first, second):
    """Write a(sigma) x'/2 + b(sigma) x, times `scale`, as rows in x_0 and x_1."""
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
    """Write the path in each cell, in powers of the coordinate from the start of the cell.

    ``breaks`` (s + 1,) are the ends of the path's pieces, ``coefficients`` (d + 1, s, n) the
    pieces, lowest power first, and ``nodes`` (m + 1,) the ends of the cells, which include the
    breaks.  ``local`` (m, n, d + 1) is written.
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
    return 0


@kernel(i8(IN3, IN1, IN1, IN1, OUT2, OUT2))
def joint_rows(local, spans, thetas, scales, first, second):
    """Write the accelerations q' x'/2 + q'' x of the joints over their limits as rows.

    ``local`` (m, n, d + 1) comes from `local_path`, ``spans`` and ``thetas`` (m,) are lengths and
    bends of cells, and ``scales`` (n,) inverse limits of joints.  The first n (d + 1) columns of
    ``first`` and ``second`` (m, r) are written, d + 1 for each joint.
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
            # Bernstein products with the linear x'/2 and the quadratic x, whose middle coefficient
            # for each end is (1 + half) / 2.
            scale = scales[j] / (degree * span)
            left, right = 0.0, 0.0
            for i in range(degree + 1):
                here = rate[i] if i < degree else 0.0
                before = rate[i - 1] if i > 0 else 0.0
                slow, fast = 0.5 * (degree - i) * here, 0.5 * i * before
                # The step of the rates is q'' times the length of the cell over degree - 1.
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
    return 0


@kernel(i8(IN3, IN3, IN3, IN1, IN1, i8, OUT2, OUT2, OUT2))
def other_rows(a, b, c, spans, thetas, start, first, second, rest):
    """Write a x'/2 + b x + c as rows, from column ``start`` on: 7 for each of l quantities.

    a, b and c (m, l, 5) are quartics in every cell: powers of sigma, lowest first, scaled to limits
    of -1 and 1.  ``spans`` and ``thetas`` (m,) are lengths and bends of cells.  ``first``,
    ``second`` and ``rest`` (m, r) are written.
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
    return 0
