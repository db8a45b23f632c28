"""Homotopy paths of all poses of a platform on six legs, in the squared leg lengths.

A batch of eight paths is tracked at a time, each with its own t; the next path replaces one that
has ended.
"""

import math

from numba import types

from robomech_ros._kernels.compiling.jit import fused, inline, kernel, scratch, scratch_integers
from robomech_ros._kernels.compiling.types import IN2, IOUT1, OUT1, i8
from robomech_ros._kernels.parallel.projective import FAILED, REGULAR, SINGULAR
from robomech_ros._kernels.parallel.quadrics import COUT2
from robomech_ros._kernels.parallel.series import ORDER, coefficients, series
from robomech_ros._kernels.parallel.simd_batch import LANES, factor, frame, moved, solve

CIN1 = types.Array(types.complex128, 1, "C", readonly=True)

# Largest last term of the series, and largest part of its radius of convergence for a step.
_TERM = 1e-3
_RADIUS = 0.75
# Largest first and second correction of an accepted step.
_FIRST, _SECOND = 0.1, 1e-5
# Paths to a double root approach it as the root of 1 - t: this near to t = 1, step to the end only.
_LAST = 1e-8
_STEPS = 400
_LEAST_STEP = 1e-11
# Rows of the state of the batch.
_T, _H, _CAP, _STEP, _SIZE = range(5)


@fused
def _lengths(s0, s1, state, rr, ri):
    """Add a quarter of the squared lengths at t + h to the residuals."""
    for k in range(6):
        x, y = 0.25 * s0[k].real, 0.25 * s0[k].imag
        u, v = 0.25 * s1[k].real - x, 0.25 * s1[k].imag - y
        for n in range(LANES):
            t = state[_T, n] + state[_H, n]
            rr[k, n] += x + t * u
            ri[k, n] += y + t * v


@fused
def _steps(Sr, Si, state):
    """Write the step of each path."""
    for n in range(LANES):
        last, before = 0.0, 0.0
        for i in range(6):
            last += Sr[ORDER, i, n] ** 2 + Si[ORDER, i, n] ** 2
            before += Sr[ORDER - 1, i, n] ** 2 + Si[ORDER - 1, i, n] ** 2
        last, before = math.sqrt(last), math.sqrt(before)
        h = 1.0
        if last > 0.0:
            h = min(math.sqrt(math.sqrt(math.sqrt(_TERM / last))), _RADIUS * before / last)
        h = min(h, state[_CAP, n])
        left = 1.0 - state[_T, n]
        if h >= left:
            h = left
        elif left <= 1.5 * _LAST:
            h = 0.0
        elif left - h < _LAST:
            h = left - _LAST
        state[_H, n] = h


@fused
def _predict(Sr, Si, state, xr, xi):
    """Evaluate the series, continued by a geometric series from its last term on."""
    for n in range(LANES):
        h = state[_H, n]
        u, v, size = 0.0, 0.0, 1e-300
        for i in range(6):
            a, b = Sr[ORDER - 1, i, n], Si[ORDER - 1, i, n]
            c, d = Sr[ORDER, i, n], Si[ORDER, i, n]
            u += a * c + b * d
            v += a * d - b * c
            size += a * a + b * b
        u, v = 1.0 - h * u / size, -h * v / size
        size = h / (u * u + v * v)
        u, v = u * size, -v * size
        for i in range(6):
            a, b = Sr[ORDER, i, n], Si[ORDER, i, n]
            x, y = a * u - b * v, a * v + b * u
            for k in range(1, ORDER):
                x = (x + Sr[ORDER - k, i, n]) * h
                y = (y + Si[ORDER - k, i, n]) * h
            xr[i, n], xi[i, n] = x, y


@fused
def _accept(xr, xi, state, turn, good):
    """Write the sizes of corrections, and flags of paths whose steps are good."""
    for n in range(LANES):
        size = 0.0
        for i in range(6):
            size += xr[i, n] * xr[i, n] + xi[i, n] * xi[i, n]
        state[_SIZE, n] = math.sqrt(size)
    for n in range(LANES):
        if turn == 0:
            good[n] = 1.0 if state[_SIZE, n] < _FIRST else 0.0
        elif not state[_SIZE, n] < _SECOND:
            good[n] = 0.0


@inline
def _fill(X, path, pr, pi, state, n):
    for i in range(8):
        pr[i, n], pi[i, n] = X[path, i].real, X[path, i].imag
    state[_T, n], state[_CAP, n], state[_STEP, n] = 0.0, 1.0, 0.0


@fused
def _advance(pr, pi, qr, qi, state, good, n):
    """Take step n of the batch if it is good; return the end of the path, or -1 if it continues."""
    state[_STEP, n] += 1.0
    if state[_H, n] == 0.0:
        return SINGULAR
    if good[n] > 0.0:
        t = state[_T, n] + state[_H, n]
        if state[_H, n] == 1.0 - state[_T, n]:
            t = 1.0
        state[_T, n], state[_CAP, n] = t, 1.0
        for i in range(8):
            pr[i, n], pi[i, n] = qr[i, n], qi[i, n]
        if t == 1.0:
            return REGULAR
    else:
        state[_CAP, n] = 0.25 * state[_H, n]
        if not state[_CAP, n] > _LEAST_STEP:
            return FAILED
    return FAILED if state[_STEP, n] >= _STEPS else -1


@kernel(i8(IN2, IN2, CIN1, CIN1, COUT2, IOUT1, OUT1))
def track_lengths(A, B, s0, s1, X, ends, times):
    """Track poses X (n, 8) in place from squared lengths s0 to s1.

    Base points A and platform points B (6, 3) are of order one.  ``ends`` (n,) receives the result
    of each path, and ``times`` (n,) its last t.  Returns the number of steps of the batch.
    """
    pr, pi = scratch(8, LANES), scratch(8, LANES)
    qr, qi = scratch(8, LANES), scratch(8, LANES)
    sr, si = scratch(8, LANES), scratch(8, LANES)
    mr, mi = scratch(12, LANES), scratch(12, LANES)
    ar, ai = scratch(6, 3, LANES), scratch(6, 3, LANES)
    Jr, Ji = scratch(6, 6, LANES), scratch(6, 6, LANES)
    Mr, Mi = scratch(6, 12, LANES), scratch(6, 12, LANES)
    Sr, Si = scratch(9, 7, LANES), scratch(9, 7, LANES)
    Pr, Pi = scratch(21, LANES), scratch(21, LANES)
    xr, xi = scratch(6, LANES), scratch(6, LANES)
    rr, ri, state, good = scratch(6), scratch(6), scratch(5, LANES), scratch(LANES)
    for i in range(6):
        rate = 0.25 * (s1[i] - s0[i])
        rr[i], ri[i] = rate.real, rate.imag
    total = X.shape[0]
    at = scratch_integers(LANES)
    following, open_paths, rounds = 0, total, 0
    for n in range(LANES):
        _fill(X, min(n, total - 1), pr, pi, state, n)
        at[n] = n if n < total else -1
        following = min(n + 1, total)
    while open_paths > 0:
        rounds += 1
        frame(pr, pi, A, B, mr, mi, ar, ai, Jr, Ji, xr, xi)
        coefficients(ar, ai, B, Mr, Mi)
        factor(Jr, Ji)
        series(Jr, Ji, Mr, Mi, rr, ri, Sr, Si, Pr, Pi)
        _steps(Sr, Si, state)
        _predict(Sr, Si, state, xr, xi)
        moved(pr, pi, xr, xi, sr, si, qr, qi)
        for turn in range(2):
            frame(qr, qi, A, B, mr, mi, ar, ai, Jr, Ji, xr, xi)
            _lengths(s0, s1, state, xr, xi)
            factor(Jr, Ji)
            solve(Jr, Ji, xr, xi)
            moved(qr, qi, xr, xi, sr, si, qr, qi)
            _accept(xr, xi, state, turn, good)
        for n in range(LANES):
            if at[n] < 0:
                continue
            end = _advance(pr, pi, qr, qi, state, good, n)
            if end < 0:
                continue
            path = at[n]
            for i in range(8):
                X[path, i] = complex(pr[i, n], pi[i, n])
            ends[path], times[path] = end, state[_T, n]
            open_paths -= 1
            at[n] = -1
            if following < total:
                _fill(X, following, pr, pi, state, n)
                at[n] = following
                following += 1
    return rounds
