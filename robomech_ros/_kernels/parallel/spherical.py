"""All rotations of a platform for three angles between its axes and fixed axes.

R = Rot(w_1, x) R_0 Rot(v_1, y), where R_0 v_1 is at the required angle to w_1: the first condition
holds for all x and y.  The others are linear in cos y and sin y, and cos^2 y + sin^2 y = 1 gives a
trigonometric polynomial of order four in x.
"""

import math

from robomech_ros._kernels.compiling.jit import inline, kernel, lean, scratch
from robomech_ros._kernels.compiling.types import IN1, IN2, IOUT1, OUT1, OUT2, i8
from robomech_ros._kernels.parallel.circle import circle_zeros
from robomech_ros._kernels.parallel.newton_3x3 import REGULAR, gather, solve_three

_SAMPLES = 9
_STEPS = 40
# Largest error of a cosine, and largest difference (of an entry) of equal rotations.
_CLOSED, _SAME = 1e-11, 1e-5
# Below this determinant of the two linear equations, both solutions of one of them are tried.
_PARALLEL = 1e-3


@lean
def _turn(axis, angle, M, out):
    """Write Rot(axis, angle) M."""
    c, s = math.cos(angle), math.sin(angle)
    x, y, z = axis[0], axis[1], axis[2]
    for j in range(3):
        u, v, w = M[0, j], M[1, j], M[2, j]
        inner = (1.0 - c) * (x * u + y * v + z * w)
        out[0, j] = c * u + s * (y * w - z * v) + inner * x
        out[1, j] = c * v + s * (z * u - x * w) + inner * y
        out[2, j] = c * w + s * (x * v - y * u) + inner * z


@lean
def _orthogonal(v, out):
    """Write a unit vector orthogonal to v, and the cross product of v and this."""
    k = 0
    for i in range(3):
        if abs(v[i]) < abs(v[k]):
            k = i
    size = 0.0
    for i in range(3):
        out[0, i] = (1.0 if i == k else 0.0) - v[k] * v[i]
        size += out[0, i] * out[0, i]
    size = 1.0 / math.sqrt(size)
    for i in range(3):
        out[0, i] *= size
    for i in range(3):
        j, m = (i + 1) % 3, (i + 2) % 3
        out[1, i] = v[j] * out[0, m] - v[m] * out[0, j]


@lean
def _first(W, V, cosine, one, two, R):
    """Write R_0, which rotates v_1 to the required angle with w_1."""
    _orthogonal(V[0], one)
    _orthogonal(W[0], two)
    sine = math.sqrt(max(0.0, 1.0 - cosine * cosine))
    for i in range(3):
        for j in range(3):
            x = cosine * W[0, i] + sine * two[0, i]
            y = -sine * W[0, i] + cosine * two[0, i]
            R[i, j] = x * V[0, j] + y * one[0, j] + two[1, i] * one[1, j]


@lean
def _linear(W, V, cosines, M, i):
    """Return a, b and d of a cos y + b sin y = d for axis i with M = Rot(w_1, x) R_0."""
    a, b, d = 0.0, 0.0, cosines[i]
    inner = V[0, 0] * V[i, 0] + V[0, 1] * V[i, 1] + V[0, 2] * V[i, 2]
    for j in range(3):
        k, m = (j + 1) % 3, (j + 2) % 3
        w = M[0, j] * W[i, 0] + M[1, j] * W[i, 1] + M[2, j] * W[i, 2]
        a += w * (V[i, j] - inner * V[0, j])
        b += w * (V[0, k] * V[i, m] - V[0, m] * V[i, k])
        d -= w * V[0, j] * inner
    return a, b, d


@lean
def _closure(W, V, cosines, pose, J, f):
    error = 0.0
    for i in range(3):
        x = pose[0] * V[i, 0] + pose[1] * V[i, 1] + pose[2] * V[i, 2]
        y = pose[3] * V[i, 0] + pose[4] * V[i, 1] + pose[5] * V[i, 2]
        z = pose[6] * V[i, 0] + pose[7] * V[i, 1] + pose[8] * V[i, 2]
        u, v, w = W[i, 0], W[i, 1], W[i, 2]
        J[i, 0], J[i, 1], J[i, 2] = y * w - z * v, z * u - x * w, x * v - y * u
        f[i] = cosines[i] - (x * u + y * v + z * w)
        error = max(error, abs(f[i]))
    return error


@inline
def _polish(W, V, cosines, pose):
    """Improve a rotation (9,) in place; return the remaining error and the determinant."""
    J, f, step, M, axis = scratch(3, 3), scratch(3), scratch(3), scratch(3, 3), scratch(3)
    determinant = 0.0
    for _ in range(_STEPS):
        _closure(W, V, cosines, pose, J, f)
        determinant = solve_three(J, f, step)
        if determinant == 0.0:
            break
        angle = math.sqrt(step[0] ** 2 + step[1] ** 2 + step[2] ** 2)
        if not 0.0 < angle < 1.0:
            break
        for i in range(3):
            axis[i] = step[i] / angle
        _turn(axis, angle, pose.reshape(3, 3), M)
        for i in range(9):
            pose[i] = M[i // 3, i % 3]
        if angle < 1e-15:
            break
    return _closure(W, V, cosines, pose, J, f), determinant


@lean
def _complete(M, axis, angle, pose):
    """Write M Rot(axis, angle) row by row."""
    c, s = math.cos(angle), math.sin(angle)
    for i in range(3):
        inner = (1.0 - c) * (M[i, 0] * axis[0] + M[i, 1] * axis[1] + M[i, 2] * axis[2])
        for j in range(3):
            k, m = (j + 1) % 3, (j + 2) % 3
            # A row times [axis]x is the cross product of the row and the axis.
            across = M[i, k] * axis[m] - M[i, m] * axis[k]
            pose[3 * i + j] = c * M[i, j] + s * across + inner * axis[j]


@kernel(i8(IN2, IN2, IN1, OUT2, OUT1, IOUT1))
def spherical_modes(W, V, cosines, poses, errors, multiplicity):
    """Write all rotations (9,), up to eight, for unit axes W and V (3, 3): w_i . R v_i = cosine.

    ``poses`` has seventeen rows.  Returns the number of rotations, or -1 if the platform can move
    with constant angles.
    """
    samples, sizes, zeros = scratch(_SAMPLES), scratch(_SAMPLES), scratch(_SAMPLES)
    one, two, start, M = scratch(2, 3), scratch(2, 3), scratch(3, 3), scratch(3, 3)
    _first(W, V, cosines[0], one, two, start)
    for k in range(_SAMPLES):
        _turn(W[0], 2.0 * math.pi * k / _SAMPLES, start, M)
        a, b, d = _linear(W, V, cosines, M, 1)
        e, g, h = _linear(W, V, cosines, M, 2)
        x, y, across = d * g - h * b, a * h - e * d, a * g - e * b
        samples[k] = x * x + y * y - across * across
        sizes[k] = (a * a + b * b + d * d) * (e * e + g * g + h * h)
    found = circle_zeros(samples, sizes, _SAMPLES, zeros)
    if found < 0:
        return -1
    count = 0
    for k in range(found):
        _turn(W[0], zeros[k], start, M)
        a, b, d = _linear(W, V, cosines, M, 1)
        e, g, h = _linear(W, V, cosines, M, 2)
        across, size = a * g - e * b, math.sqrt((a * a + b * b) * (e * e + g * g))
        for branch in range(3):
            if branch == 0:
                if not abs(across) > 1e-12 * size:
                    continue
                y = math.atan2((a * h - e * d) / across, (d * g - h * b) / across)
            else:
                if abs(across) > _PARALLEL * size:
                    break
                if a * a + b * b < e * e + g * g:
                    a, b, d = e, g, h
                square = a * a + b * b
                root = math.sqrt(max(0.0, square - d * d))
                y = math.atan2(b, a) + math.atan2(root if branch == 1 else -root, d)
            _complete(M, V[0], y, poses[count])
            error, determinant = _polish(W, V, cosines, poses[count])
            if error <= _CLOSED:
                errors[count] = error
                regular = abs(determinant) > REGULAR
                count = gather(poses, multiplicity, count, _SAME, regular)
    return count
