"""Newton's method for a real pose of a platform on six legs, leg lengths and Jacobian."""

import math

from robomech_ros._kernels.algebra.dense import factored, solve_factored
from robomech_ros._kernels.compiling.jit import kernel, lean, scratch, scratch_integers
from robomech_ros._kernels.compiling.types import IN2, IN3, OUT1, OUT2, OUT3, i8

_STEPS = 12
# After a correction this small (rad, and of the size), one more suffices: errors are squared.
_SMALL = 1e-7
# Least pivot, relative to the largest entry, of a pose that is regular to working precision.
_PIVOT = 1e-13


@lean
def pose_of_parameters(x, pose):
    """Write the pose (12,) of real parameters (e, g) of any length."""
    a, b, c, d = x[0], x[1], x[2], x[3]
    size = 1.0 / (a * a + b * b + c * c + d * d)
    pose[0] = (a * a + b * b - c * c - d * d) * size
    pose[1] = 2.0 * (b * c - a * d) * size
    pose[2] = 2.0 * (b * d + a * c) * size
    pose[3] = 2.0 * (b * c + a * d) * size
    pose[4] = (a * a - b * b + c * c - d * d) * size
    pose[5] = 2.0 * (c * d - a * b) * size
    pose[6] = 2.0 * (b * d - a * c) * size
    pose[7] = 2.0 * (c * d + a * b) * size
    pose[8] = (a * a - b * b - c * c + d * d) * size
    e, f, g, h = x[4], x[5], x[6], x[7]
    pose[9] = 2.0 * (a * f - e * b + c * h - d * g) * size
    pose[10] = 2.0 * (a * g - e * c + d * f - b * h) * size
    pose[11] = 2.0 * (a * h - e * d + b * g - c * f) * size


@lean
def rows(A, B, pose, J, r):
    """Write the rows [d, b x d] of all legs in the platform's frame to J, and d . d to r."""
    for k in range(6):
        x, y, z = A[k, 0] - pose[9], A[k, 1] - pose[10], A[k, 2] - pose[11]
        u, v, w = B[k, 0], B[k, 1], B[k, 2]
        e = u - (pose[0] * x + pose[3] * y + pose[6] * z)
        f = v - (pose[1] * x + pose[4] * y + pose[7] * z)
        g = w - (pose[2] * x + pose[5] * y + pose[8] * z)
        J[k, 0], J[k, 1], J[k, 2] = e, f, g
        J[k, 3], J[k, 4], J[k, 5] = v * g - w * f, w * e - u * g, u * f - v * e
        r[k] = e * e + f * f + g * g


@lean
def eliminate(J, b, order):
    """Overwrite J (6, 6) with its factors, and b with the solution; return False if singular."""
    largest = 0.0
    for k in range(6):
        for i in range(6):
            largest = max(largest, abs(J[k, i]))
    if not factored(J, order, _PIVOT * largest):
        return False
    solve_factored(J, order, b)
    return True


@lean
def moved(pose, x):
    """Move a pose in place by a step x = (tau, w) in its own frame."""
    a, b, c, u, v, w = x[0], x[1], x[2], x[3], x[4], x[5]
    size = 2.0 / (1.0 + u * u + v * v + w * w)
    g = -(a * u + b * v + c * w)
    p = size * (a - g * u + v * c - w * b)
    q = size * (b - g * v + w * a - u * c)
    r = size * (c - g * w + u * b - v * a)
    for i in range(3):
        x0, y0, z0 = pose[3 * i], pose[3 * i + 1], pose[3 * i + 2]
        pose[9 + i] += x0 * p + y0 * q + z0 * r
        # A row of R times R_delta is row + size (row x w + (row x w) x w).
        d, e, f = y0 * w - z0 * v, z0 * u - x0 * w, x0 * v - y0 * u
        k, m, n = e * w - f * v, f * u - d * w, d * v - e * u
        pose[3 * i] = x0 + size * (d + k)
        pose[3 * i + 1] = y0 + size * (e + m)
        pose[3 * i + 2] = z0 + size * (f + n)


@lean
def newton(A, B, lengths, pose):
    """Improve a pose (12,) in place; return the largest length error, or -1 if not converged."""
    J, b, r, order = scratch(6, 6), scratch(6), scratch(6), scratch_integers(6)
    for _ in range(_STEPS):
        rows(A, B, pose, J, r)
        for k in range(6):
            b[k] = 0.25 * (lengths[k] * lengths[k] - r[k])
        if not eliminate(J, b, order):
            return -1.0
        size = 0.0
        for k in range(6):
            size = max(size, abs(b[k]))
        if not size < 1.0:
            return -1.0
        moved(pose, b)
        if size < _SMALL:
            rows(A, B, pose, J, r)
            error = 0.0
            for k in range(6):
                error = max(error, abs(math.sqrt(r[k]) - lengths[k]))
            return error
    return -1.0


@kernel(i8(IN2, IN2, OUT1, OUT2, OUT1))
def rows_at(A, B, pose, J, squares):
    """Write the rows [d, b x d] (6, 6) of a pose (12,) in its own frame, and d . d (6,)."""
    rows(A, B, pose, J, squares)
    return 0


@kernel(i8(OUT1, OUT1))
def move(pose, step):
    """Move a pose (12,) in place by a step (tau, w) in its own frame."""
    moved(pose, step)
    return 0


@kernel(i8(OUT1, OUT1))
def read_parameters(x, pose):
    """Write the pose (12,) of real parameters (8,)."""
    pose_of_parameters(x, pose)
    return 0


@kernel(i8(IN2, IN2, IN3, OUT2))
def leg_lengths(A, B, T, out):
    """Write the leg lengths (m, 6) of poses (m, 4, 4)."""
    for i in range(T.shape[0]):
        for k in range(A.shape[0]):
            total = 0.0
            for j in range(3):
                d = T[i, j, 3] - A[k, j]
                d += T[i, j, 0] * B[k, 0] + T[i, j, 1] * B[k, 1] + T[i, j, 2] * B[k, 2]
                total += d * d
            out[i, k] = math.sqrt(total)
    return 0


@kernel(i8(IN2, IN2, IN3, OUT3))
def jacobians(A, B, T, out):
    """Write rows [(R b) x n, n] of legs with directions n (m, 6, 6); return -1 for zero length."""
    for i in range(T.shape[0]):
        for k in range(A.shape[0]):
            u, v, w = B[k, 0], B[k, 1], B[k, 2]
            x = T[i, 0, 0] * u + T[i, 0, 1] * v + T[i, 0, 2] * w
            y = T[i, 1, 0] * u + T[i, 1, 1] * v + T[i, 1, 2] * w
            z = T[i, 2, 0] * u + T[i, 2, 1] * v + T[i, 2, 2] * w
            d = x + T[i, 0, 3] - A[k, 0]
            e = y + T[i, 1, 3] - A[k, 1]
            f = z + T[i, 2, 3] - A[k, 2]
            length = math.sqrt(d * d + e * e + f * f)
            if not length > 0.0:
                return -1
            d, e, f = d / length, e / length, f / length
            out[i, k, 0], out[i, k, 1], out[i, k, 2] = y * f - z * e, z * d - x * f, x * e - y * d
            out[i, k, 3], out[i, k, 4], out[i, k, 5] = d, e, f
    return 0
