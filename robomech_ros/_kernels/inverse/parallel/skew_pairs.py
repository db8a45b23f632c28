"""The angles of axes a and 5 of an arm with three parallel axes and skew axes 5 and 6.

The two equations of :mod:`.pairs` do not separate: q_a is a root of a trigonometric polynomial of
order two, and Newton steps on both equations improve the angles.
"""

import math

from robomech_ros._kernels.algebra.angles import angle_of, wrapped
from robomech_ros._kernels.algebra.polynomials import VANISHING, order_one_roots, order_two_roots
from robomech_ros._kernels.compiling.jit import lean, lean_part, scratch
from robomech_ros._kernels.compiling.types import F12, IN1, OUT2, ZERO, i8
from robomech_ros._kernels.inverse.branch_bits import BOUNDARY
from robomech_ros._kernels.inverse.parallel import layout as at
from robomech_ros._kernels.inverse.parallel.pairs import (
    FREE,
    MAX_PAIRS,
    equations,
    moved_apart,
    z_in_frame_5,
)
from robomech_ros._kernels.tolerances import NEAR_DOUBLE, SAME_POSTURE

# If double roots of both equations for (q_a, q_5) coincide, four solutions have become one.  This
# is more than the fourth root of a rounding by which they differ (sum of components of a pair).
FOURFOLD_APART = 5e-3
# Largest error of the equations halfway between two coincident solutions; between different ones it
# is the square of their distance.
FOURFOLD_ERROR = 1e-13
# Distances (sine) from a double root at which its two solutions are sought, first and last.
FOLD_START = 3e-4
FOLD_MIN_START = 1e-8
# Accepted error of the two equations (of order one) of a pair (q_a, q_5): some roundings.
PAIR_ERROR = 1e-12
# Ratio of the factors of these equations below which the roots of the polynomial are close, and
# the equations without the smaller term give further starts.
NEARLY_SEPARATE = 1e-2
# An extremum of the polynomial for q_a this near to zero (of its largest value) is tried as a
# double root, which has half of the digits.  A wrong one fails the accuracy of the pair.
PARALLEL_TOUCHING = 1e-7


@lean
def _pair_errors(data, d, x, y):
    """Return cosines and sines of (q_a, q_5), v_1, v_2, and the errors of the two equations."""
    k1, c1, s1, k2, c2, s2 = d
    c = math.cos(x)
    s = math.sin(x)
    cy = math.cos(y)
    sy = math.sin(y)
    g1 = data[at.FIRST] + data[at.FIRST + 1] * c + data[at.FIRST + 2] * s
    g2 = data[at.SECOND] + data[at.SECOND + 1] * c + data[at.SECOND + 2] * s
    v1 = g1 * cy + g2 * sy
    v2 = g2 * cy - g1 * sy
    f1 = k1 + c1 * c + s1 * s - data[at.SIN_56] * v1
    f2 = k2 + c2 * c + s2 * s - data[at.NORMAL_56] / data[at.SIZE] * v2
    return c, s, cy, sy, v1, v2, f1, f2


@lean
def _error(data, d, x, y):
    """Return the sum of the errors of the two equations."""
    _, _, _, _, _, _, f1, f2 = _pair_errors(data, d, x, y)
    return abs(f1) + abs(f2)


@lean
def _are_merged(data, d, x, y, pair):
    """Return whether two pairs are one double root: the equations also hold halfway between."""
    other_x = angle_of(pair[1], pair[0])
    v1, v2, g1, g2 = pair[3], pair[4], pair[5], pair[6]
    other_y = angle_of(g2 * v1 - g1 * v2, g1 * v1 + g2 * v2)
    halfway_x = x + 0.5 * wrapped(other_x - x)
    halfway_y = y + 0.5 * wrapped(other_y - y)
    ends = _error(data, d, x, y) + _error(data, d, other_x, other_y)
    return _error(data, d, halfway_x, halfway_y) < FOURFOLD_ERROR + ends


@lean
def _polish_pair(data, d, x, y):
    """Improve (q_a, q_5) by Newton steps, shortened until they help.

    A step helps if it lowers the error of the equations or that of (v_1, v_2): with a small factor
    its equation hardly affects the first, and rounding dominates the second.  Returns the angles,
    the error of the equations and the absolute determinant of their derivatives.
    """
    _, c1, s1, _, c2, s2 = d
    factor1 = data[at.SIN_56]
    factor2 = data[at.NORMAL_56] / data[at.SIZE]
    least = math.inf
    error = math.inf
    best = math.inf
    determinant = 0.0
    best_determinant = 0.0
    best_x = kept_x = x
    best_y = kept_y = y
    dx = dy = 0.0
    for _ in range(60):
        c, s, cy, sy, v1, v2, f1, f2 = _pair_errors(data, d, x, y)
        found = abs(f1) + abs(f2)
        merit = abs(f1 / factor1) + abs(f2 / factor2)
        if found < error or merit < least:
            error = found
            least = merit
            kept_x = x
            kept_y = y
            h1 = data[at.FIRST + 2] * c - data[at.FIRST + 1] * s
            h2 = data[at.SECOND + 2] * c - data[at.SECOND + 1] * s
            a11 = factor1 * (h1 * cy + h2 * sy) - s1 * c + c1 * s
            a12 = factor1 * v2
            a21 = factor2 * (h2 * cy - h1 * sy) - s2 * c + c2 * s
            a22 = -factor2 * v1
            determinant = a11 * a22 - a12 * a21
            if found < best:
                best = found
                best_x = x
                best_y = y
                best_determinant = abs(determinant)
            if determinant == 0.0:
                break
            dx = (f1 * a22 - f2 * a12) / determinant
            dy = (f2 * a11 - f1 * a21) / determinant
            length = max(abs(dx), abs(dy))
            if length > 0.3:
                dx *= 0.3 / length
                dy *= 0.3 / length
        else:
            dx *= 0.3
            dy *= 0.3
        if abs(dx) + abs(dy) < 1e-16:
            break
        x = kept_x + dx
        y = kept_y + dy
    return best_x, best_y, best, best_determinant


@lean
def _keep_pair(data, d, x, y, determinant, pairs, count):
    """Enter a pair unless it is listed; return the number of pairs."""
    c = math.cos(x)
    s = math.sin(x)
    gamma, g1, g2 = z_in_frame_5(data, c, s)
    cy = math.cos(y)
    sy = math.sin(y)
    v1 = g1 * cy + g2 * sy
    v2 = g2 * cy - g1 * sy
    bits = BOUNDARY if determinant < NEAR_DOUBLE else 0
    for k in range(count):
        apart = abs(pairs[k, 0] - c) + abs(pairs[k, 1] - s)
        apart += abs(pairs[k, 3] - v1) + abs(pairs[k, 4] - v2)
        folds = bits == BOUNDARY and pairs[k, 7] == BOUNDARY
        if apart < SAME_POSTURE:
            return count
        if folds and apart < FOURFOLD_APART and _are_merged(data, d, x, y, pairs[k]):
            return count
    pairs[count, 0] = c
    pairs[count, 1] = s
    pairs[count, 2] = gamma
    pairs[count, 3] = v1
    pairs[count, 4] = v2
    pairs[count, 5] = g1
    pairs[count, 6] = g2
    pairs[count, 7] = bits
    return count + 1


@lean
def _improve_pair(data, d, c, s, v1, v2, pairs, count):
    """Improve a candidate pair, given by q_a and z across axis 5, and enter it if it is one."""
    _, g1, g2 = z_in_frame_5(data, c, s)
    x = angle_of(s, c)
    y = angle_of(g2 * v1 - g1 * v2, g1 * v1 + g2 * v2)
    x, y, error, determinant = _polish_pair(data, d, x, y)
    allowed = PAIR_ERROR if data[at.EXACT] == 1.0 else data[at.SLACK]
    if error < allowed and count < MAX_PAIRS:
        return _keep_pair(data, d, x, y, determinant, pairs, count)
    return count


@lean
def _add_pairs(data, d, c, s, pairs, count):
    """Improve candidate pairs for both signs of the open component of z, and enter the pairs.

    The equation with the larger factor gives the other component.  Near a double root the search
    starts on both sides of it and, in case it is one of both equations, closer to it as well.
    """
    k1, c1, s1, k2, c2, s2 = d
    factor1 = data[at.SIN_56]
    factor2 = data[at.NORMAL_56] / data[at.SIZE]
    _, g1, g2 = z_in_frame_5(data, c, s)
    radius = math.sqrt(g1 * g1 + g2 * g2)
    first = (k1 + c1 * c + s1 * s) / factor1
    second = (k2 + c2 * c + s2 * s) / factor2
    by_first = factor1 >= abs(factor2)
    known = first if by_first else second
    guess = second if by_first else first
    known = max(-radius, min(radius, known))
    other = math.sqrt((radius - known) * (radius + known))
    nearly_separate = min(factor1, abs(factor2)) < NEARLY_SEPARATE * max(factor1, abs(factor2))
    sure = other > 1e-3 and not nearly_separate
    starts = 2 if other >= FOLD_START else 4
    for start in range(starts):
        value = max(other, FOLD_START if start < 2 else FOLD_MIN_START)
        if start % 2 == 0:
            value = -value
        if sure and value * guess < 0.0:
            continue
        v1 = known if by_first else value
        v2 = value if by_first else known
        count = _improve_pair(data, d, c, s, v1, v2, pairs, count)
    return count


@lean
def _add_nearly_separate(data, d, pairs, count):
    """Add the pairs near those that the equations would have if they separated.

    There the roots of the polynomial form close pairs, and groups of four at a double root.
    """
    k1, c1, s1, k2, c2, s2 = d
    small = abs(data[at.NORMAL_56]) / data[at.SIZE]
    if data[at.SIN_56] < small:
        k2, c2, s2 = k1, c1, s1
        small = data[at.SIN_56]
    found, x1, y1, x2, y2 = order_one_roots(k2, c2, s2, small + data[at.SLACK])
    if found == 1:
        x2, y2 = x1, y1
    amplitude = math.sqrt(c2 * c2 + s2 * s2)
    if found < 1 or amplitude < small:
        return count
    # Move away from a double root by at least the effect of the neglected term.
    x1, y1, x2, y2 = moved_apart(x1, y1, x2, y2, math.sqrt(small / amplitude))
    count = _add_pairs(data, d, x1, y1, pairs, count)
    return _add_pairs(data, d, x2, y2, pairs, count)


@lean
def _add_successive_pairs(data, d, pairs, count):
    """Add the pairs if the components of z in frame 5 do not depend on q_a.

    That is so for parallel axes a and 5.  The equations are then solved one after the other, and
    double roots of both may coincide.
    """
    k1, _, _, k2, c2, s2 = d
    factor2 = data[at.NORMAL_56] / data[at.SIZE]
    radius = math.sqrt(max(0.0, 1.0 - data[at.GAMMA] * data[at.GAMMA]))
    known = max(-radius, min(radius, k1 / data[at.SIN_56]))
    other = math.sqrt((radius - known) * (radius + known))
    for trial in range(3):
        if trial == 0 and other > NEAR_DOUBLE:
            continue
        value = 0.0 if trial == 0 else other if trial == 1 else -other
        found, x1, y1, x2, y2 = order_one_roots(k2 - factor2 * value, c2, s2, data[at.SLACK])
        for root in range(found):
            c, s = (x1, y1) if root == 0 else (x2, y2)
            count = _improve_pair(data, d, c, s, known, value, pairs, count)
    return count


@lean_part(i8(IN1, F12, OUT2))
def skew_pairs(data, G, pairs):
    """Write all pairs for skew axes 5 and 6; return their number or FREE."""
    d = equations(data, G)
    k1, c1, s1, k2, c2, s2 = d
    g0 = data[at.GAMMA]
    gc = data[at.GAMMA + 1]
    gs = data[at.GAMMA + 2]
    factor1 = data[at.SIN_56]
    factor2 = data[at.NORMAL_56] / data[at.SIZE]
    u = factor2 * factor2
    v = factor1 * factor1
    w = u * v
    total = u * (k1 * k1 + c1 * c1 + s1 * s1) + v * (k2 * k2 + c2 * c2 + s2 * s2) + w
    u /= total
    v /= total
    w /= total
    ones = u * (c1 * c1 + s1 * s1) + v * (c2 * c2 + s2 * s2) + w * (gc * gc + gs * gs)
    a0 = u * k1 * k1 + v * k2 * k2 + w * (g0 * g0 - 1.0) + 0.5 * ones
    a1 = 2.0 * (u * k1 * c1 + v * k2 * c2 + w * g0 * gc)
    b1 = 2.0 * (u * k1 * s1 + v * k2 * s2 + w * g0 * gs)
    a2 = 0.5 * (u * (c1 * c1 - s1 * s1) + v * (c2 * c2 - s2 * s2) + w * (gc * gc - gs * gs))
    b2 = u * c1 * s1 + v * c2 * s2 + w * gc * gs
    roots = scratch(7, 2)
    found = order_two_roots(a0, a1, b1, a2, b2, PARALLEL_TOUCHING, roots)
    if found < 0:
        return FREE
    count = ZERO
    if abs(gc) + abs(gs) + abs(c1) + abs(s1) < VANISHING:
        count = _add_successive_pairs(data, d, pairs, count)
    for k in range(found):
        count = _add_pairs(data, d, roots[k, 0], roots[k, 1], pairs, count)
    if min(factor1, abs(factor2)) < NEARLY_SEPARATE * max(factor1, abs(factor2)):
        count = _add_nearly_separate(data, d, pairs, count)
    return count
