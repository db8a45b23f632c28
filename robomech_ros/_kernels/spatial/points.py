"""Angular velocity and acceleration from the motion of points, and derivatives of noisy tracks."""

import math

from robomech_ros._kernels.compiling.jit import kernel, lean
from robomech_ros._kernels.compiling.types import IN1, IN2, IN3, OUT1, OUT2, OUT3, i8
from robomech_ros._kernels.spatial.conversions import STATUSES
from robomech_ros._kernels.spatial.rates import SINGULAR
from robomech_ros._kernels.spatial.vectors import combined, cramer, cross, dot, scaled

# Determinant over the cube of the size, below which a matrix is singular: points are on a line to
# 3e-7 of their extent.
_SINGULAR = 1e-13


@lean
def _at(rows, k, i):
    return rows[k, i, 0], rows[k, i, 1], rows[k, i, 2]


@lean
def _mean(rows, k):
    total = (0.0, 0.0, 0.0)
    for i in range(rows.shape[1]):
        total = combined(total, _at(rows, k, i), 1.0)
    return scaled(total, 1.0 / rows.shape[1])


@lean
def _solved(one, two, three, size, right):
    """Return status and solution of [one two three] x = right by Cramer's rule."""
    volume, found = cramer(one, two, three, right)
    if not abs(volume) > _SINGULAR * size * size * size:
        return SINGULAR, (0.0, 0.0, 0.0)
    return 0, scaled(found, 1.0 / volume)


@lean
def _columns(points, k, robust):
    """Return the columns of the matrix for angular rates, and its size."""
    centre = _mean(points, k)
    if not robust:
        # D = (tr(P) 1 - P) / 2 with the points as columns of P.
        a = combined(_at(points, k, 0), centre, -1.0)
        b = combined(_at(points, k, 1), centre, -1.0)
        c = combined(_at(points, k, 2), centre, -1.0)
        half = 0.5 * (a[0] + b[1] + c[2])
        size = math.sqrt(dot(a, a) + dot(b, b) + dot(c, c))
        one = half - 0.5 * a[0], -0.5 * a[1], -0.5 * a[2]
        two = -0.5 * b[0], half - 0.5 * b[1], -0.5 * b[2]
        return one, two, (-0.5 * c[0], -0.5 * c[1], half - 0.5 * c[2]), size
    xx = yy = zz = xy = xz = yz = 0.0
    for i in range(points.shape[1]):
        x, y, z = combined(_at(points, k, i), centre, -1.0)
        xx, yy, zz = xx + x * x, yy + y * y, zz + z * z
        xy, xz, yz = xy - x * y, xz - x * z, yz - y * z
    return (yy + zz, xy, xz), (xy, xx + zz, yz), (xz, yz, xx + yy), xx + yy + zz


@lean
def _right(points, vectors, spin, k, robust):
    """Return the right-hand side from velocities, or from accelerations less those of `spin`."""
    centre, drift = _mean(points, k), _mean(vectors, k)
    total = (0.0, 0.0, 0.0)
    for i in range(points.shape[1]):
        p = combined(_at(points, k, i), centre, -1.0)
        v = combined(_at(vectors, k, i), drift, -1.0)
        v = combined(v, cross(spin, cross(spin, p)), -1.0)
        if robust:
            total = combined(total, cross(p, v), 1.0)
        elif i == 0:
            # Half of the axial vector of the matrix with columns v.
            total = combined(total, (0.0, -0.5 * v[2], 0.5 * v[1]), 1.0)
        elif i == 1:
            total = combined(total, (0.5 * v[2], 0.0, -0.5 * v[0]), 1.0)
        else:
            total = combined(total, (-0.5 * v[1], 0.5 * v[0], 0.0), 1.0)
    return total


@kernel(i8(IN3, IN3, i8, OUT2))
def velocities_of_points(points, velocities, robust, out):
    """Write angular velocities (k, 3) of points (k, m, 3) from their velocities."""
    for k in range(points.shape[0]):
        one, two, three, size = _columns(points, k, robust != 0)
        right = _right(points, velocities, (0.0, 0.0, 0.0), k, robust != 0)
        status, omega = _solved(one, two, three, size, right)
        if status != 0:
            return k * STATUSES + status
        out[k, 0], out[k, 1], out[k, 2] = omega
    return 0


@kernel(i8(IN3, IN3, IN3, i8, OUT2))
def accelerations_of_points(points, velocities, accelerations, robust, out):
    """Write angular accelerations (k, 3) of points (k, m, 3) from velocities and accelerations."""
    for k in range(points.shape[0]):
        one, two, three, size = _columns(points, k, robust != 0)
        right = _right(points, velocities, (0.0, 0.0, 0.0), k, robust != 0)
        status, omega = _solved(one, two, three, size, right)
        if status != 0:
            return k * STATUSES + status
        right = _right(points, accelerations, omega, k, robust != 0)
        _, change = _solved(one, two, three, size, right)
        out[k, 0], out[k, 1], out[k, 2] = change
    return 0


@lean
def _weights(times, start, window, degree, at, out):
    """Write the weights (3, window) of a polynomial fit for value and two derivatives at a time.

    Polynomials orthonormal over the samples keep all digits at any degree.
    """
    scale = 0.5 * (times[start + window - 1] - times[start])
    u0 = (times[at] - times[start]) / scale - 1.0
    for i in range(window):
        for d in range(3):
            out[d, i] = 0.0
        # The current and the previous polynomial at each sample.
        out[3, i], out[4, i] = 1.0 / math.sqrt(window), 0.0
    now, now1, now2 = 1.0 / math.sqrt(window), 0.0, 0.0
    before, before1, before2 = 0.0, 0.0, 0.0
    last = 0.0
    for _ in range(degree + 1):
        for i in range(window):
            out[0, i] += now * out[3, i]
            out[1, i] += now1 * out[3, i] / scale
            out[2, i] += now2 * out[3, i] / (scale * scale)
        mean = 0.0
        for i in range(window):
            u = (times[start + i] - times[start]) / scale - 1.0
            mean += u * out[3, i] * out[3, i]
        square = 0.0
        for i in range(window):
            u = (times[start + i] - times[start]) / scale - 1.0
            following = (u - mean) * out[3, i] - last * out[4, i]
            out[4, i] = out[3, i]
            out[3, i] = following
            square += following * following
        norm = math.sqrt(square) if square > 0.0 else 1.0
        for i in range(window):
            out[3, i] /= norm
        after = ((u0 - mean) * now - last * before) / norm
        after1 = (now + (u0 - mean) * now1 - last * before1) / norm
        after2 = (2.0 * now1 + (u0 - mean) * now2 - last * before2) / norm
        before, before1, before2 = now, now1, now2
        now, now1, now2 = after, after1, after2
        last = norm


@kernel(i8(IN1, IN2, i8, i8, OUT2, OUT3, OUT2, OUT1))
def fit_tracks(times, rows, window, degree, room, out, gains, squares):
    """Fit polynomials to the nearest samples of each time.

    ``out`` (3, n, width) receives values and two derivatives of rows (n, width), ``gains`` (n, 3)
    the sums of their squared weights, and ``squares`` (n,) the squared residuals.  ``room``
    (5, window) is working space.
    """
    count, width = rows.shape
    for k in range(count):
        start = min(max(k - window // 2, 0), count - window)
        _weights(times, start, window, degree, k, room)
        for d in range(3):
            gains[k, d] = 0.0
            for j in range(width):
                out[d, k, j] = 0.0
            for i in range(window):
                weight = room[d, i]
                gains[k, d] += weight * weight
                for j in range(width):
                    out[d, k, j] += weight * rows[start + i, j]
        squares[k] = 0.0
        for j in range(width):
            off = rows[k, j] - out[0, k, j]
            squares[k] += off * off
    return 0
