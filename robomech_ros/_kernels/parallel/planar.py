"""All poses of a planar platform for three distances between points of base and platform.

With both origins at the first points, p . u_i = r_i for i = 2, 3 with u_i = R c_i - d_i; so
|r_2 u_3 - r_3 u_2|^2 = rho_1^2 (u_2 x u_3)^2, a trigonometric polynomial of order three.
"""

import math

from robomech_ros._kernels.compiling.jit import inline, kernel, lean, scratch
from robomech_ros._kernels.compiling.types import IN1, IN2, IOUT1, OUT1, OUT2, i8
from robomech_ros._kernels.parallel.circle import circle_zeros
from robomech_ros._kernels.parallel.newton_3x3 import REGULAR, gather, solve_three

_SAMPLES = 7
_STEPS = 40
# Largest distance error (of the size) of a pose, and largest difference of equal poses.
_CLOSED, _SAME = 1e-10, 1e-5
# Below this, the lines of p are nearly parallel: both points of one line are tried.
_PARALLEL = 1e-3


@lean
def _lines(A, B, rho, cosine, sine):
    """Return u_2, r_2, u_3, r_3."""
    b, c = B[1, 0] - B[0, 0], B[1, 1] - B[0, 1]
    d, e = B[2, 0] - B[0, 0], B[2, 1] - B[0, 1]
    u = cosine * b - sine * c - A[1, 0] + A[0, 0]
    v = sine * b + cosine * c - A[1, 1] + A[0, 1]
    w = cosine * d - sine * e - A[2, 0] + A[0, 0]
    x = sine * d + cosine * e - A[2, 1] + A[0, 1]
    first = rho[0] * rho[0]
    r = 0.5 * (rho[1] * rho[1] - first - u * u - v * v)
    s = 0.5 * (rho[2] * rho[2] - first - w * w - x * x)
    return u, v, r, w, x, s


@lean
def _closure(A, B, rho, pose, J, f):
    """Write residuals f and Jacobian J for x, y and phi; return the largest distance error."""
    cosine, sine = math.cos(pose[2]), math.sin(pose[2])
    error = 0.0
    for i in range(3):
        b, c = cosine * B[i, 0] - sine * B[i, 1], sine * B[i, 0] + cosine * B[i, 1]
        d, e = pose[0] + b - A[i, 0], pose[1] + c - A[i, 1]
        J[i, 0], J[i, 1], J[i, 2] = d, e, e * b - d * c
        f[i] = 0.5 * (rho[i] * rho[i] - d * d - e * e)
        error = max(error, abs(math.sqrt(d * d + e * e) - rho[i]))
    return error


@inline
def _polish(A, B, rho, pose):
    """Improve (x, y, phi) in place; return the remaining error and the determinant."""
    J, f, step = scratch(3, 3), scratch(3), scratch(3)
    determinant = 0.0
    for _ in range(_STEPS):
        _closure(A, B, rho, pose, J, f)
        determinant = solve_three(J, f, step)
        if determinant == 0.0 or not abs(step[2]) < 1.0:
            break
        for i in range(3):
            pose[i] += step[i]
        if max(max(abs(step[0]), abs(step[1])), abs(step[2])) < 1e-15:
            break
    pose[2] = math.atan2(math.sin(pose[2]), math.cos(pose[2]))
    return _closure(A, B, rho, pose, J, f), determinant


@lean
def _slides(A, B, rho):
    """Return whether the platform can translate: equal triangles and equal distances."""
    angle = math.atan2(A[1, 1] - A[0, 1], A[1, 0] - A[0, 0]) - math.atan2(
        B[1, 1] - B[0, 1], B[1, 0] - B[0, 0]
    )
    u, v, r, w, x, s = _lines(A, B, rho, math.cos(angle), math.sin(angle))
    return max(max(abs(u), abs(v)), max(abs(w), abs(x)), max(abs(r), abs(s))) <= _CLOSED


@kernel(i8(IN2, IN2, IN1, OUT2, OUT1, IOUT1))
def planar_modes(A, B, rho, poses, errors, multiplicity):
    """Write all poses (x, y, phi), up to six, for distances rho (3,) of B from A (3, 2).

    Lengths are of order one; ``poses`` has thirteen rows.  Returns the number of poses, or -1 if
    the platform can move with constant distances.
    """
    samples, sizes, zeros = scratch(_SAMPLES), scratch(_SAMPLES), scratch(_SAMPLES)
    for k in range(_SAMPLES):
        angle = 2.0 * math.pi * k / _SAMPLES
        u, v, r, w, x, s = _lines(A, B, rho, math.cos(angle), math.sin(angle))
        across = rho[0] * (u * x - v * w)
        y, z = r * w - s * u, r * x - s * v
        samples[k] = y * y + z * z - across * across
        sizes[k] = (u * u + v * v + w * w + x * x) * (r * r + s * s) + across * across
    found = circle_zeros(samples, sizes, _SAMPLES, zeros)
    if found < 0:
        return -1
    if _slides(A, B, rho):
        return -1
    count = 0
    for k in range(found):
        u, v, r, w, x, s = _lines(A, B, rho, math.cos(zeros[k]), math.sin(zeros[k]))
        across, size = u * x - v * w, u * u + v * v + w * w + x * x
        for branch in range(3):
            pose = poses[count]
            pose[2] = zeros[k]
            if branch == 0:
                if not abs(across) > 1e-12 * size:
                    continue
                pose[0], pose[1] = (r * x - s * v) / across, (s * u - r * w) / across
            else:
                if abs(across) > _PARALLEL * size:
                    break
                if u * u + v * v < w * w + x * x:
                    u, v, r = w, x, s
                square = u * u + v * v
                if not square > 0.0:
                    break
                root = math.sqrt(max(0.0, rho[0] * rho[0] * square - r * r))
                root = root if branch == 1 else -root
                pose[0], pose[1] = (r * u - root * v) / square, (r * v + root * u) / square
            pose[0] += A[0, 0] - math.cos(zeros[k]) * B[0, 0] + math.sin(zeros[k]) * B[0, 1]
            pose[1] += A[0, 1] - math.sin(zeros[k]) * B[0, 0] - math.cos(zeros[k]) * B[0, 1]
            error, determinant = _polish(A, B, rho, pose)
            if error <= _CLOSED:
                errors[count] = error
                regular = abs(determinant) > REGULAR
                count = gather(poses, multiplicity, count, _SAME, regular)
    return count
