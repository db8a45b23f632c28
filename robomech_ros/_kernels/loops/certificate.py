"""Proof that a step of closed loops passes no singularity, and so stays in its assembly mode.

The unknowns are the passive joints and a twist tau, the same for all limbs.  The conditions of limb
i are ``f_i = P(T_i(q_i)) - tau = 0`` with ``P(T) = [vect(R R_0'); p]``: the poses T_i of the ends
of all limbs are equal.  The step starts along a straight line.  At its end, M is the Jacobian of f,
R_0 the rotation of the first limb, and M+ a left inverse of M.  The rates of the passive joints of
limb i for twists d_i are ``H_i (t - d_i)`` with ``t = sum of G_i d_i``.

From any point of the line ``x -> x - M+ f(x)`` contracts within r, in the maximum norm, if
``|M+ f| <= (1 - k - b r) r``, with bounds k of ``|M+ (f' - M)|`` along the line and b of
``|M+ f''|``.  Such an r exists if ``k + sqrt(4 b e) <= 1`` with a bound e of ``|M+ f|``.  Then one
solution follows the drives from the start of the step to its end, and f' is regular throughout.

Derivatives of P(T_i) of any order for joints of limb i are at most 1 in the angular part, and at
most the reach of the limb in the linear part; lengths are scaled.
"""

import math
from collections import namedtuple

import numpy as np

from robomech_ros._kernels.compiling.jit import inline, lean, scratch
from robomech_ros._kernels.loops.factors import REGULAR, left_inverse, passive_count, widest

# G (limbs, 6, 6) and H (limbs, w, 6); S is working space; for each limb the sums of |t| over the
# changes of its columns of M (limbs, 6), the sums of its rows (limbs, w), and bounds (limbs, 5).
Inverse = namedtuple("Inverse", ("G", "H", "S", "sums", "rows", "bounds"))
# Bounds of d_i for f' - M and for f between the points where these are known, for second
# derivatives by norms, and for the changes of second derivatives along the line and with r.
_CHORD, _BEND, _TWICE, _THRICE, _WIDE = 0, 1, 2, 3, 4


@inline
def room_for_inverse(starts):
    """Return working space for the inverse of a posture."""
    limbs, n = starts.size - 1, widest(starts)
    return Inverse(
        np.empty((limbs, 6, 6)),
        np.empty((limbs, n, 6)),
        np.empty((6 * limbs, 6 * limbs)),
        np.empty((limbs, 6)),
        np.empty((limbs, n)),
        np.empty((limbs, 5)),
    )


@lean
def invert(chains, found, inverse):
    """Write G and H from the factors of a posture; return a status."""
    limbs, S = chains.starts.size - 1, inverse.S
    status = left_inverse(chains, found, S)
    if status != REGULAR:
        return status
    row = 0
    for i in range(limbs):
        k = passive_count(chains.drives, chains.starts[i], chains.starts[i + 1])
        Q, R = found.Q[i], found.R[i]
        G, H = inverse.G[i], inverse.H[i]
        for j in range(6):
            for r in range(6):
                total = 0.0
                for m in range(k, 6):
                    total += S[r, row + m - k] * Q[m, j]
                G[r, j] = total
            for r in range(k - 1, -1, -1):
                value = Q[r, j]
                for m in range(r + 1, k):
                    value -= R[r, m] * H[m, j]
                H[r, j] = value / R[r, r]
        row += 6 - k
    return REGULAR


@lean
def passive_moves(chains, inverse, D, qd):
    """Write the passive moves that close loop errors D (limbs, 6, 1) with fixed drives."""
    t = scratch(6)
    limbs = chains.starts.size - 1
    for r in range(6):
        t[r] = 0.0
        for i in range(limbs):
            for j in range(6):
                t[r] += inverse.G[i, r, j] * D[i, j, 0] * (chains.scale if j > 2 else 1.0)
    for i in range(limbs):
        k = 0
        for j in range(chains.starts[i], chains.starts[i + 1]):
            qd[j, 0] = 0.0
            if chains.drives[j] >= 0:
                continue
            for r in range(6):
                d = D[i, r, 0] * (chains.scale if r > 2 else 1.0)
                qd[j, 0] += inverse.H[i, k, r] * (t[r] - d)
            k += 1


@lean
def _change(first, second, i, j, weight, d):
    """Write the change (6,) of column j of f' of limb i, from the end of the line to its start."""
    half = 0.0
    for r in range(3):
        w = 0.0
        for c in range(3):
            # tr(Z) w - Z w with Z = R R_0'.
            half += first.T[i, r, c] * second.T[0, r, c]
            w += first.T[i, r, c] * (
                second.T[0, 0, c] * first.J[i, 0, j]
                + second.T[0, 1, c] * first.J[i, 1, j]
                + second.T[0, 2, c] * first.J[i, 2, j]
            )
        d[r] = -0.5 * w
    for r in range(3):
        d[r] += 0.5 * half * first.J[i, r, j] - second.J[i, r, j]
        d[3 + r] = first.J[i, 3 + r, j] - second.J[i, 3 + r, j]
    for r in range(6):
        d[r] /= weight


@lean
def _clear_sums(inverse, i):
    """Clear the sums of one limb."""
    for r in range(6):
        inverse.sums[i, r] = 0.0
    for k in range(inverse.rows.shape[1]):
        inverse.rows[i, k] = 0.0


@lean
def _add_twist(chains, weights, inverse, i, d):
    """Add M+ times a twist d (6,) of one limb to its sums, for itself and for other limbs."""
    t = scratch(6)
    G, H, sums, rows = inverse.G[i], inverse.H[i], inverse.sums[i], inverse.rows[i]
    for r in range(6):
        t[r] = 0.0
        for m in range(6):
            t[r] += G[r, m] * d[m]
        sums[r] += abs(t[r])
    k = 0
    for j in range(chains.starts[i], chains.starts[i + 1]):
        if chains.drives[j] >= 0:
            continue
        total = 0.0
        for r in range(6):
            total += H[k, r] * (t[r] - d[r])
        rows[k] += abs(total) * weights[j]
        k += 1


@lean
def _change_of_limb(chains, weights, first, second, inverse, i):
    """Sum M+ times the changes of all columns of one limb."""
    d = scratch(6)
    _clear_sums(inverse, i)
    s = chains.starts[i]
    for j in range(s, chains.starts[i + 1]):
        if chains.drives[j] < 0:
            _change(first, second, i, j - s, weights[j], d)
            _add_twist(chains, weights, inverse, i, d)


@lean
def _bend_of_limb(chains, weights, second, inverse, i):
    """Sum M+ times all second derivatives of f of one limb."""
    d, J = scratch(6), second.J[i]
    _clear_sums(inverse, i)
    s, e = chains.starts[i], chains.starts[i + 1]
    for j in range(s, e):
        for m in range(j, e):
            if chains.drives[j] >= 0 or chains.drives[m] >= 0:
                continue
            unit = (1.0 if j == m else 2.0) / (weights[j] * weights[m])
            for r in range(3):
                x, y = (r + 1) % 3, (r + 2) % 3
                d[r] = J[x, j - s] * J[y, m - s] - J[y, j - s] * J[x, m - s]
                d[r] *= 0.5 * unit
                d[3 + r] = J[x, j - s] * J[3 + y, m - s] - J[y, j - s] * J[3 + x, m - s]
                d[3 + r] *= unit
            _add_twist(chains, weights, inverse, i, d)


@lean
def _write_bounds(chains, weights, v, D, inverse, i):
    """Write the five bounds of limb i, _CHORD to _WIDE."""
    path, count = 0.0, 0.0
    for j in range(chains.starts[i], chains.starts[i + 1]):
        path += abs(v[j, 0]) * weights[j]
        if chains.drives[j] < 0:
            count += 1.0
    open_end = 0.0
    for r in range(6):
        open_end += abs(D[i, r, 0]) * (chains.scale if r > 2 else 1.0)
    bounds = inverse.bounds[i]
    bounds[_CHORD] = count * (path * path / 8.0 + open_end)
    # f and its slope along the line are known at the start, and f at the end: t^2 (1 - t) / 6.
    bounds[_BEND] = path * path * path / 40.0
    bounds[_TWICE] = count * count
    bounds[_THRICE] = count * count * (path + open_end)
    bounds[_WIDE] = count * count * count


@lean
def _bound_moves(chains, weights, reach, inverse, which):
    """Return a bound of the joint moves that M+ gives for twists d_i within a bound."""
    t = scratch(6)
    limbs = chains.starts.size - 1
    for r in range(6):
        t[r] = 0.0
        for i in range(limbs):
            G = inverse.G[i]
            turn = math.sqrt(G[r, 0] ** 2 + G[r, 1] ** 2 + G[r, 2] ** 2)
            move = math.sqrt(G[r, 3] ** 2 + G[r, 4] ** 2 + G[r, 5] ** 2)
            t[r] += (turn + move * reach[i]) * inverse.bounds[i, which]
    largest = 0.0
    for i in range(limbs):
        k = 0
        for j in range(chains.starts[i], chains.starts[i + 1]):
            if chains.drives[j] >= 0:
                continue
            H = inverse.H[i, k]
            turn = math.sqrt(H[0] ** 2 + H[1] ** 2 + H[2] ** 2)
            move = math.sqrt(H[3] ** 2 + H[4] ** 2 + H[5] ** 2)
            total = (turn + move * reach[i]) * inverse.bounds[i, which]
            for r in range(6):
                total += abs(H[r]) * t[r]
            largest = max(largest, total * weights[j])
            k += 1
    return largest


@lean
def _largest_sum(chains, weights, inverse):
    """Return a bound of the norm of M+ times the changes summed for all limbs."""
    limbs, largest = chains.starts.size - 1, 0.0
    for i in range(limbs):
        k = 0
        for j in range(chains.starts[i], chains.starts[i + 1]):
            if chains.drives[j] >= 0:
                continue
            total = 0.0
            for r in range(6):
                others = 0.0
                for m in range(limbs):
                    if m != i:
                        others += inverse.sums[m, r]
                total += abs(inverse.H[i, k, r]) * others
            largest = max(largest, inverse.rows[i, k] + total * weights[j])
            k += 1
    return largest


@lean
def part_of_proof(chains, weights, reach, room, size):
    """Return ``k + sqrt(4 b e)`` of a step: at most 1 if it is proved, about linear in its length.

    ``room`` has the factors at both ends of the line v (n, 1), the inverse at its end, and the loop
    errors D (limbs, 6, 1) there; ``size`` is the largest move that M+ gives for loop errors at
    both ends.
    """
    limbs, inverse, v, D = chains.starts.size - 1, room.inverse, room.v, room.D
    first, second = room.first, room.second
    for i in range(limbs):
        _change_of_limb(chains, weights, first, second, inverse, i)
        _write_bounds(chains, weights, v, D, inverse, i)
    k = _largest_sum(chains, weights, inverse)
    k += _bound_moves(chains, weights, reach, inverse, _CHORD)
    e = size + _bound_moves(chains, weights, reach, inverse, _BEND)
    b = _bound_moves(chains, weights, reach, inverse, _TWICE)
    part = k + math.sqrt(4.0 * b * e)
    if part <= 1.0 or not k < 1.0:
        return part
    # Second derivatives at the end of the line give a smaller bound, but take longer.
    for i in range(limbs):
        _bend_of_limb(chains, weights, second, inverse, i)
    b = _largest_sum(chains, weights, inverse)
    b += _bound_moves(chains, weights, reach, inverse, _THRICE)
    b += _bound_moves(chains, weights, reach, inverse, _WIDE) * 2.0 * e / (1.0 - k)
    return min(part, k + math.sqrt(4.0 * b * e))
