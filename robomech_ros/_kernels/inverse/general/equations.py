"""Closure equations of a general six-joint arm, and six of them without its first two joints.

Cut in two, the loop reads ``L_2 J_3 L_3 J_4 L_4 J_5 L_5 = J_2^-1 L_1^-1 J_1^-1 L_6^-1 J_6^-1``.
The third and fourth columns of both sides, the direction l of the last axis and a point p on it,
do not depend on J_6.  With ``p x l``, ``m = (p.p) l - 2 (p.l) p``, ``p.p`` and ``p.l`` they give
fourteen equations, linear in the products of one cosine, sine or 1 of every joint.

In the frame of axis 2, joint 2 only rotates x and y of the four vectors, so the complex numbers
x + i y satisfy four linear equations in three unknowns.  Their z and the two products do not
depend on joint 2 and give six equations in cosine and sine of joint 1.  One complex and four real
equations for the other three joints are orthogonal to these unknowns.

References
----------
Raghavan and Roth, Inverse kinematics of the general 6R manipulator and related linkages, ASME
J. Mechanical Design 115 (1993), pp. 502-508.
Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., chapter 9.
"""

import math

import numpy as np

from robomech_ros._kernels.compiling.jit import inline, kernel, linked, part
from robomech_ros._kernels.compiling.types import IN1, IN2, OUT1, OUT2, f8, i8
from robomech_ros._kernels.inverse.general import layout as at
from robomech_ros._kernels.spatial.vectors import rotated

# A pivot below this (of the first) is zero: the elimination is complete.
GENERAL_RANK = 1e-13

_HALF_ROOT = math.sqrt(0.75)
# Three values of a rotation and of a slide.
_COSINES = np.array([1.0, -0.5, -0.5])
_SINES = np.array([0.0, _HALF_ROOT, -_HALF_ROOT])
_SLIDE_VALUES = np.array([0.0, 1.0, -1.0])
# Maps from values there to coefficients of cosine, sine and 1; of s s, s c, c c of the half angle;
# of a slide's square, the slide and 1.
_TURN_PARTS = np.array([2.0 * _COSINES, 2.0 * _SINES, np.ones(3)]) / 3.0
_HALF_PARTS = np.array([_TURN_PARTS[2] - _TURN_PARTS[0], 2.0 * _TURN_PARTS[1],
                        _TURN_PARTS[2] + _TURN_PARTS[0]])  # fmt: skip
_SLIDE_PARTS = np.array([[-1.0, 0.5, 0.5], [0.0, 0.5, -0.5], [1.0, 0.0, 0.0]])
# The same with sqrt(2) in the middle.
_EVEN = np.array([[1.0], [math.sqrt(2.0)], [1.0]])
_EVEN_HALF_PARTS = _HALF_PARTS / _EVEN
_EVEN_SLIDE_PARTS = _SLIDE_PARTS / _EVEN


@inline
def closure_quantities(lx, ly, lz, px, py, pz, out):
    """Write the fourteen quantities: x of l, p, p x l and m, their y, their z, p.p and p.l."""
    pp = px * px + py * py + pz * pz
    pl = px * lx + py * ly + pz * lz
    out[0], out[4], out[8] = lx, ly, lz
    out[1], out[5], out[9] = px, py, pz
    out[2], out[6], out[10] = py * lz - pz * ly, pz * lx - px * lz, px * ly - py * lx
    twice = 2.0 * pl
    out[3], out[7], out[11] = pp * lx - twice * px, pp * ly - twice * py, pp * lz - twice * pz
    out[12], out[13] = pp, pl


@inline
def _chained(pose, number, slides, links, k, out):
    """Write the product of a pose (12,), a joint at one of its three values and a link to out."""
    c, s, d = 1.0, 0.0, 0.0
    if slides:
        d = _SLIDE_VALUES[number]
    else:
        c, s = _COSINES[number], _SINES[number]
    for j in range(4):
        x = c * links[k + j] - s * links[k + 4 + j]
        y = s * links[k + j] + c * links[k + 4 + j]
        z = links[k + 8 + j]
        if j == 3:
            z += d
        for i in range(3):
            out[4 * i + j] = pose[4 * i] * x + pose[4 * i + 1] * y + pose[4 * i + 2] * z
    for i in range(3):
        out[4 * i + 3] += pose[4 * i + 3]


@kernel(i8(IN1, i8, OUT1))
def left_side(links, slide, K):
    """Write the coefficients of the fourteen quantities behind joint 2 to K (14 x 3 x 9,).

    They are linear in cosine, sine and 1 of three joints and quadratic in a slide, so three values
    of each joint determine them.  ``links`` (48,) are those of a form.
    """
    V = np.empty((27, 14))
    first, second, third = np.empty(12), np.empty(12), np.empty(12)
    n = 0
    for i in range(3):
        _chained(links[:12], i, False, links, 12, first)
        for j in range(3):
            _chained(first, j, slide == at.THIRD, links, 24, second)
            for k in range(3):
                _chained(second, k, slide == at.FOURTH, links, 36, third)
                closure_quantities(
                    third[2], third[6], third[10], third[3], third[7], third[11], V[n]
                )
                n += 1
    to_third = _SLIDE_PARTS if slide == at.THIRD else _HALF_PARTS
    to_fourth = _EVEN_SLIDE_PARTS if slide == at.FOURTH else _EVEN_HALF_PARTS
    W = np.empty((27, 14))
    for step in range(3):
        matrix = to_fourth if step == 0 else to_third if step == 1 else _TURN_PARTS
        stride = 1 if step == 0 else 3 if step == 1 else 9
        for n in range(27):
            a = n // stride % 3
            start = n - a * stride
            for r in range(14):
                W[n, r] = (
                    matrix[a, 0] * V[start, r]
                    + matrix[a, 1] * V[start + stride, r]
                    + matrix[a, 2] * V[start + 2 * stride, r]
                )
        V, W = W, V
    for r in range(14):
        for n in range(27):
            K[27 * r + n] = V[n, r]
    return 0


call_left_side = linked(left_side)


@inline
def complete_form(data, start, pose, back, form):
    """Write the form at ``start`` of the data, completed with the target, to form (FORM,)."""
    for i in range(at.FORM):
        form[i] = data[start + i]
    forwards = form[at.SENSE] > 0.0
    target = int(form[at.TARGET])
    if target == 0 or target == 5:
        k = at.BEHIND if target == 0 else at.BEFORE
        for i in range(12):
            form[k + i] = pose[i] if forwards else back[i]
        return
    k = at.LINKS + 12 * (target - 1)
    angle = form[at.OFFSETS + target - 2] if 2 <= target <= 3 else 0.0
    c, s = math.cos(angle), math.sin(angle)
    for i in range(0, 12, 4):
        for j in range(4):
            form[k + i + j] = back[i + j] if forwards else pose[i + j]
        x, y = form[k + i], form[k + i + 1]
        form[k + i], form[k + i + 1] = c * x + s * y, c * y - s * x
    call_left_side(form[at.LINKS : at.LINKS + 48], int(form[at.SLIDE]), form[at.EQUATIONS :])


@inline
def write_inverse(pose, out):
    """Write the inverse of a pose, both as 3x4 in twelve numbers."""
    for i in range(3):
        shift = 0.0
        for j in range(3):
            out[4 * i + j] = pose[4 * j + i]
            shift -= pose[4 * j + i] * pose[4 * j + 3]
        out[4 * i + 3] = shift


@inline
def required_pose(data, T, pose, back):
    """Write ``C_0^-1 T C_6^-1``, lengths over the size, to pose (12,) and its inverse to back."""
    b = at.BASE
    t = at.TIP
    length = 1.0 / data[at.SIZE]
    for i in range(3):
        u0, u1, u2 = data[b + 4 * i], data[b + 4 * i + 1], data[b + 4 * i + 2]
        v0 = u0 * T[0, 0] + u1 * T[1, 0] + u2 * T[2, 0]
        v1 = u0 * T[0, 1] + u1 * T[1, 1] + u2 * T[2, 1]
        v2 = u0 * T[0, 2] + u1 * T[1, 2] + u2 * T[2, 2]
        v3 = (u0 * T[0, 3] + u1 * T[1, 3] + u2 * T[2, 3]) * length + data[b + 4 * i + 3]
        for j in range(4):
            value = v0 * data[t + j] + v1 * data[t + 4 + j] + v2 * data[t + 8 + j]
            pose[4 * i + j] = value if j < 3 else value + v3
    write_inverse(pose, back)


@inline
def right_side(before, behind, slides, X, V):
    """Write the fourteen quantities in front of joint 2: cosine, sine and constant part in joint 1.

    If joint 1 ``slides``, the coefficients in X (14, 3) are those of its square, the slide and 1.
    ``before`` (12,) is the inverse of the link before joint 1, ``behind`` of the link behind it.
    V (3, 14) is working space.  Three values of joint 1 determine the coefficients.
    """
    for k in range(3):
        c = 1.0 if k == 0 else -0.5
        s = 0.0 if k == 0 else (-_HALF_ROOT if k == 1 else _HALF_ROOT)
        d = 0.0
        if slides:
            c, s, d = 1.0, 0.0, (0.0 if k == 0 else 1.0 if k == 1 else -1.0)
        axis = c * before[2] - s * before[6], s * before[2] + c * before[6], before[10]
        point = c * before[3] - s * before[7], s * before[3] + c * before[7], before[11] - d
        lx, ly, lz = rotated(behind, 0, axis)
        px, py, pz = rotated(behind, 0, point)
        closure_quantities(lx, ly, lz, px + behind[3], py + behind[7], pz + behind[11], V[k])
    for r in range(14):
        if slides:
            X[r, 0] = 0.5 * (V[1, r] + V[2, r]) - V[0, r]
            X[r, 1] = 0.5 * (V[1, r] - V[2, r])
            X[r, 2] = V[0, r]
            continue
        X[r, 0] = (2.0 * V[0, r] - V[1, r] - V[2, r]) / 3.0
        X[r, 1] = (V[1, r] - V[2, r]) / (2.0 * _HALF_ROOT)
        X[r, 2] = (V[0, r] + V[1, r] + V[2, r]) / 3.0


@inline
def _left_null_vector(X, n):
    """Write the complex vector n (4,) orthogonal to the three unknowns of x + i y.

    Returns the last of the three pivots of an elimination with complete pivoting, over the first.
    """
    N = np.empty((3, 4), np.complex128)
    order = np.empty(4, np.int64)
    for k in range(4):
        order[k] = k
        for j in range(3):
            N[j, k] = complex(X[k, j], X[4 + k, j])
    first, last = 1.0, 0.0
    for k in range(3):
        r, c, best = k, k, -1.0
        for i in range(k, 3):
            for j in range(k, 4):
                size = abs(N[i, j].real) + abs(N[i, j].imag)
                if size > best:
                    r, c, best = i, j, size
        if k == 0:
            first = max(best, 1e-300)
        last = best / first
        for j in range(4):
            N[k, j], N[r, j] = N[r, j], N[k, j]
        for i in range(3):
            N[i, k], N[i, c] = N[i, c], N[i, k]
        order[k], order[c] = order[c], order[k]
        if last < GENERAL_RANK:
            N[k, k] = 0.0
            continue
        inverse = 1.0 / N[k, k]
        for i in range(k + 1, 3):
            factor = N[i, k] * inverse
            for j in range(k + 1, 4):
                N[i, j] -= factor * N[k, j]
    n[order[3]] = 1.0
    for i in range(2, -1, -1):
        value = complex(0.0, 0.0)
        for j in range(i + 1, 4):
            value -= N[i, j] * n[order[j]]
        n[order[i]] = value / N[i, i] if N[i, i] != 0.0 else complex(0.0, 0.0)
    return last


@inline
def _complex_equation(K, X, E):
    """Write real and imaginary part of the equation without joint 2 to rows 0 and 1 of E.

    Returns how independent the eliminated unknowns are, 1 at best.
    """
    n = np.empty(4, np.complex128)
    margin = _left_null_vector(X, n)
    square = 0.0
    for k in range(4):
        square += n[k].real * n[k].real + n[k].imag * n[k].imag
    inverse = 1.0 / math.sqrt(square)
    for k in range(4):
        a = n[k].real * inverse
        b = n[k].imag * inverse
        for j in range(at.N_COLUMNS):
            x = a * K[k, j] - b * K[4 + k, j]
            y = b * K[k, j] + a * K[4 + k, j]
            if k == 0:
                E[0, j] = x
                E[1, j] = y
            else:
                E[0, j] += x
                E[1, j] += y
    return margin


@inline
def _without_constants(K, X, slide, W):
    """Write the equations without joint 2 to W (6, 27), the constant written as monomials.

    1 is the sum of the first and the last monomial of a joint, for a slide the last one.
    """
    for i in range(6):
        for j in range(at.N_COLUMNS):
            W[i, j] = K[8 + i, j]
        constant = X[8 + i, 2]
        if slide != at.THIRD:
            W[i, 20] -= constant
            if slide != at.FOURTH:
                W[i, 18] -= constant
        if slide != at.FOURTH:
            W[i, 24] -= constant
        W[i, 26] -= constant


@inline
def _real_equations(K, X, slide, E, W, Z):
    """Write the four equations without joints 1 and 2 to rows 2 .. 5 of E.

    Two Householder reflections reduce the columns of joint 1, in Z (6, 2), to their first rows.
    Returns how independent the eliminated unknowns are, 1 at best.
    """
    norms = 1.0
    for j in range(2):
        square = 0.0
        for i in range(6):
            Z[i, j] = X[8 + i, j]
            square += Z[i, j] * Z[i, j]
        norms *= math.sqrt(square)
    squares = 0.0
    for i in range(6):
        squares += Z[i, 0] * Z[i, 0] - Z[i, 1] * Z[i, 1]
    if squares < 0.0:
        for i in range(6):
            Z[i, 0], Z[i, 1] = Z[i, 1], Z[i, 0]
    _without_constants(K, X, slide, W)
    pivots = 1.0
    for c in range(2):
        square = 0.0
        for i in range(c, 6):
            square += Z[i, c] * Z[i, c]
        length = math.sqrt(square)
        pivots *= length
        if not length > GENERAL_RANK:
            # Nothing is left to eliminate, and the equations are valid as they are.
            break
        if Z[c, c] > 0.0:
            length = -length
        Z[c, c] -= length
        factor = -1.0 / (length * Z[c, c])
        if c == 0:
            value = 0.0
            for i in range(6):
                value += Z[i, 0] * Z[i, 1]
            value *= factor
            for i in range(6):
                Z[i, 1] -= value * Z[i, 0]
        for j in range(at.N_COLUMNS):
            value = 0.0
            for i in range(c, 6):
                value += Z[i, c] * W[i, j]
            value *= factor
            for i in range(c, 6):
                W[i, j] -= value * Z[i, c]
    for i in range(4):
        for j in range(at.N_COLUMNS):
            E[2 + i, j] = W[2 + i, j]
    return pivots / norms if norms > 0.0 else 0.0


@part(f8(IN2, IN2, i8, OUT2))
def free_equations(K, X, slide, E):
    """Write six equations E (6, 27) in the last three joints only.

    ``slide`` is the role of the prismatic joint, -1 without one.  Returns how independent the
    eliminated unknowns are, 1 at best.  If they are dependent, the equations are valid, but
    further ones exist.
    """
    W = np.empty((6, at.N_COLUMNS))
    Z = np.empty((6, 2))
    return min(_complex_equation(K, X, E), _real_equations(K, X, slide, E, W, Z))
