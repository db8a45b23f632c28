"""The maximum-likelihood estimate of X and Z in A_i X S_i = Z, and of the noise."""

import math

from robomech_ros._kernels.algebra.dense import cholesky_again, cholesky_solve
from robomech_ros._kernels.calibration.residuals import (
    UNKNOWNS,
    accumulate,
    moved,
    residual,
    whitened,
)
from robomech_ros._kernels.compiling.jit import inline, kernel, lean, scratch
from robomech_ros._kernels.compiling.types import IN2, OUT1, OUT2, OUT3, b1, i8
from robomech_ros._kernels.spatial.vectors import dot

# Least variance (rad^2, m^2): without noise, weights would be unbounded.
_LEAST = 1e-26
_STEPS = 30
_ROUNDS = 25
_BRIEF = 3  # rounds for each compared share
_SMALL_SHARE = 0.1
_WORTH = 2.0  # twice the logarithm of the likelihood that one more parameter gains
_SETTLED = 1e-3
_LEAST_FREEDOM = 0.5
_LEAST_WEIGHT = 1e-10  # of a free direction, relative to the largest weight


@kernel(i8(IN2, IN2, OUT1, OUT1, i8, OUT1))
def distances(A, S, at, noise, inverted, out):
    """Write the squared Mahalanobis distances (n,) of samples from their predictions."""
    P = scratch(3, 3)
    for i in range(A.shape[0]):
        turn, shift, _, lever = residual(A[i], S[i], at, inverted, P)
        d = whitened(turn, shift, lever, noise)[0]
        out[i] = dot(turn, turn) / noise[0] + dot(d, d)
    return 0


@lean
def _fix_direction(at, free, M, g):
    """Fix the unobservable direction of the normal equations with a prior weight.

    Along the axis free[:3] in X's parent, free[3:6] in Z's, both positions may shift together.
    The weight free[6] of their present values keeps the equations solvable.
    """
    if not free[6] > 0.0:
        return
    n, product = scratch(12), scratch(12)
    n[:] = 0.0
    for j in range(3):
        for k in range(3):
            n[3 + j] += math.sqrt(0.5) * at[3 * k + j] * free[k]
            n[9 + j] += math.sqrt(0.5) * at[12 + 3 * k + j] * free[3 + k]
    slope, curvature, weight = 0.0, 0.0, free[6]
    for j in range(UNKNOWNS):
        product[j] = 0.0
        weight = max(weight, _LEAST_WEIGHT * M[j, j])
        for k in range(UNKNOWNS):
            product[j] += M[max(j, k), min(j, k)] * n[k]
        slope += g[j] * n[j]
        curvature += product[j] * n[j]
    for j in range(UNKNOWNS):
        g[j] -= slope * n[j]
        for k in range(j + 1):
            M[j, k] += (curvature + weight) * n[j] * n[k] - n[j] * product[k] - product[j] * n[k]


@inline
def _settle(samples, at, noise, free, inverted, M, g, sums):
    """Take damped Gauss-Newton steps with constant noise; write M and sums of the last step."""
    P, J, F, d, trial = scratch(3, 3), scratch(12, 3), scratch(12, 12), scratch(12), scratch(24)
    other, slope, found = scratch(12, 12), scratch(12), scratch(13)
    accumulate(samples, at, noise, inverted, P, J, (M, g, sums))
    _fix_direction(at, free, M, g)
    damping = 0.0
    for _ in range(_STEPS):
        F[:] = M
        for j in range(UNKNOWNS):
            F[j, j] *= 1.0 + damping
            d[j] = -g[j]
        if not cholesky_solve(F, d, UNKNOWNS):
            damping = max(10.0 * damping, 1e-9)
            continue
        gain = 0.0
        for j in range(UNKNOWNS):
            gain -= g[j] * d[j]
        moved(at, d, trial)
        accumulate(samples, trial, noise, inverted, P, J, (other, slope, found))
        _fix_direction(trial, free, other, slope)
        cost = sums[0] + sums[1]
        if found[0] + found[1] <= cost * (1.0 + 1e-12):
            at[:], M[:], g[:], sums[:] = trial, other, slope, found
            damping = 0.1 * damping if damping > 1e-9 else 0.0
            if damping == 0.0 and gain <= 1e-6:
                return
        elif gain <= 1e-6:
            return
        else:
            damping = max(10.0 * damping, 1e-4)


@inline
def _inverted(M, C):
    """Write the lower triangle of M's inverse; return the logarithm of M's determinant, or NaN."""
    F, e = scratch(12, 12), scratch(12)
    F[:] = M
    e[:] = 0.0
    e[0] = 1.0
    if not cholesky_solve(F, e, UNKNOWNS):
        return math.nan
    determinant = 0.0
    for j in range(UNKNOWNS):
        determinant -= 2.0 * math.log(F[j, j])
    for j in range(UNKNOWNS):
        if j > 0:
            e[:] = 0.0
            e[j] = 1.0
            cholesky_again(F, e, UNKNOWNS)
        C[j, :] = e
    return determinant


@inline
def _fit(samples, at, noise, free, inverted, known, rounds, M, C):
    """Estimate unknowns and variances in turn; return -2 times the restricted log-likelihood."""
    g, sums = scratch(12), scratch(13)
    determinant = 0.0
    for _ in range(rounds):
        _settle(samples, at, noise, free, inverted, M, g, sums)
        determinant = _inverted(M, C)
        if known or not determinant == determinant:
            break
        taken = 0.0
        for j in range(3):
            taken += sums[3] * (C[j, j] + C[6 + j, 6 + j])
            for k in range(3):
                taken -= 2.0 * C[j, 6 + k] * sums[4 + 3 * j + k]
        taken /= noise[0]
        turns = max(3.0 * sums[3] - taken, _LEAST_FREEDOM)
        unknowns = UNKNOWNS - 1.0 * (free[6] > 0.0)
        shifts = max(3.0 * sums[3] - unknowns + taken, _LEAST_FREEDOM)
        one = max(noise[0] * sums[0] / turns, _LEAST)
        two = max(noise[1] * sums[1] / shifts, _LEAST)
        change = max(abs(math.log(one / noise[0])), abs(math.log(two / noise[1])))
        noise[0], noise[1] = one, two
        if change < _SETTLED:
            break
    return sums[2] + determinant + sums[0] + sums[1]


@inline
def _find_share(samples, at, noise, free, inverted, M, C):
    """Find the most likely share of the robot in the rotation noise by bisection.

    Returns twice the gain of the restricted log-likelihood over a share of 0.  If a small share
    gains nothing, no other is tried.
    """
    noise[2] = 0.0
    plain = _fit(samples, at, noise, free, inverted, False, _BRIEF, M, C)
    best, middle = plain, 0.0
    kept, trial = scratch(24), scratch(3)
    width = 0.25
    for k in range(7):
        if k == 0:
            share = _SMALL_SHARE
        elif k == 1:
            share = 0.5
        elif k % 2 == 0:
            share = middle + width
        else:
            share = middle - width
        if 0.0 < share <= 1.0:
            kept[:], trial[:] = at, noise
            trial[2] = share
            value = _fit(samples, kept, trial, free, inverted, False, _BRIEF, M, C)
            if value < best:
                best = value
                at[:], noise[:] = kept, trial
        if k == 0 and noise[2] == 0.0:
            break
        if k % 2 == 1:
            middle = noise[2]
            width = 0.25 if k == 1 else 0.5 * width
    return plain - best


@kernel(i8(IN2, IN2, OUT1, OUT1, OUT1, OUT1, i8, b1, b1, OUT2))
def refine(A, S, use, at, noise, free, inverted, known, shared, information):
    """Refine X and Z (24) and the noise (3) in place; write the information (12, 12).

    If the robot's share improves the likelihood too little, it is 0.  For free (7) see
    `_fix_direction`.
    """
    M, C = scratch(12, 12), scratch(12, 12)
    if shared and not known:
        gain = _find_share((A, S, use), at, noise, free, inverted, M, C)
        if gain < _WORTH:
            noise[2] = 0.0
    value = _fit((A, S, use), at, noise, free, inverted, known, _ROUNDS, M, C)
    for j in range(UNKNOWNS):
        for k in range(j + 1):
            information[j, k] = information[k, j] = M[j, k]
    return 0 if value == value else 1


@kernel(i8(IN2, OUT1, OUT1, i8, OUT3))
def information_of(A, at, noise, inverted, out):
    """Write the information (m, 12, 12) that a sample at each pose A (m, 12) would add."""
    P, J, M, g, sums = scratch(3, 3), scratch(12, 3), scratch(12, 12), scratch(12), scratch(13)
    seen, use = scratch(1, 12), scratch(1)
    seen[:], use[0] = 0.0, 1.0
    seen[0, 0] = seen[0, 4] = seen[0, 8] = 1.0
    for i in range(A.shape[0]):
        accumulate((A[i : i + 1], seen, use), at, noise, inverted, P, J, (M, g, sums))
        for j in range(UNKNOWNS):
            for k in range(j + 1):
                out[i, j, k] = out[i, k, j] = M[j, k]
    return 0
