"""All solutions of a six-joint arm with three parallel axes next to each other."""

from robomech_ros._kernels.algebra.angles import wrapped
from robomech_ros._kernels.compiling.jit import lean, lean_part, scratch
from robomech_ros._kernels.compiling.types import IN1, IN2, IOUT1, OUT2, ZERO, i8
from robomech_ros._kernels.inverse.branch_bits import BOUNDARY, DOUBT, SHOULDER_SINGULAR
from robomech_ros._kernels.inverse.general.multiplicity import MIN_FOLD_SLOPE, all_simple
from robomech_ros._kernels.inverse.parallel import layout as at
from robomech_ros._kernels.inverse.parallel.arm import MAX_SOLUTIONS, finish_pair
from robomech_ros._kernels.inverse.parallel.continuum import free_pairs
from robomech_ros._kernels.inverse.parallel.pairs import FREE, MAX_PAIRS, PAIR_WIDTH, separate_pairs
from robomech_ros._kernels.inverse.parallel.skew_pairs import skew_pairs
from robomech_ros._kernels.inverse.parallel.slides import sliding_pairs
from robomech_ros._kernels.inverse.polishing import call_polish
from robomech_ros._kernels.spatial.vectors import dot, mixed, product, scaled
from robomech_ros._kernels.tolerances import ACCEPTED, GENERAL_SINGULAR, POLISH_ABOVE, SAME_POSTURE


@lean
def _transform(data, k):
    """Return the rows of the rotation and the origin of a 3x4 transform."""
    a, b = (data[k], data[k + 1], data[k + 2]), (data[k + 4], data[k + 5], data[k + 6])
    c = data[k + 8], data[k + 9], data[k + 10]
    return (a, b, c), (data[k + 3], data[k + 7], data[k + 11])


@lean
def _required_pose(data, T):
    """Return the pose of frame 6 at the target: rotation row by row, then origin."""
    a, b, c = (T[0, 0], T[0, 1], T[0, 2]), (T[1, 0], T[1, 1], T[1, 2]), (T[2, 0], T[2, 1], T[2, 2])
    p = T[0, 3], T[1, 3], T[2, 3]
    if data[at.FROM_TIP] != 0.0:
        p = scaled(mixed(p, a, b, c), -1.0)
        a, b, c = (a[0], b[0], c[0]), (a[1], b[1], c[1]), (a[2], b[2], c[2])
    right, origin = _transform(data, at.RIGHT)
    p = dot(a, origin) + p[0], dot(b, origin) + p[1], dot(c, origin) + p[2]
    left, origin = _transform(data, at.LEFT)
    a, b, c = product(left, product((a, b, c), right))
    x, y, z = dot(left[0], p), dot(left[1], p), dot(left[2], p)
    return a + b + c + (x + origin[0], y + origin[1], z + origin[2])


@lean
def _refined(data, T, q, branch, errors, count):
    """Improve inaccurate candidates and drop those that are not solutions.

    Returns the number of solutions, and whether some may be equal.
    """
    packed = data[at.PACKED : at.LENGTH].reshape(7, 13)
    kept = 0
    doubtful = data[at.EXACT] == 0.0
    for k in range(count):
        if data[at.EXACT] == 0.0 or errors[k] > POLISH_ABOVE:
            errors[k] = call_polish(packed, T, q[k], 60)
            for j in range(6):
                if packed[j, 0] == 0.0:
                    q[k, j] = wrapped(q[k, j])
        if not errors[k] <= ACCEPTED:
            continue
        doubtful = doubtful or branch[k] >= SHOULDER_SINGULAR
        branch[kept] = branch[k]
        for j in range(6):
            q[kept, j] = q[k, j]
        kept += 1
    return kept, doubtful


@lean
def _without_repetitions(data, q, branch, count):
    """Drop repeated postures, equal within the accuracy of a double root; return their number."""
    kept = 0
    for k in range(count):
        repeated = False
        for m in range(kept):
            apart = 0.0
            for j in range(6):
                difference = q[k, j] - q[m, j]
                if data[at.PACKED + 13 * j] == 0.0:
                    difference = wrapped(difference)
                apart = max(apart, abs(difference))
            repeated = repeated or apart < SAME_POSTURE
        if not repeated:
            branch[kept] = branch[k]
            for j in range(6):
                q[kept, j] = q[k, j]
            kept += 1
    return kept


@lean
def _are_simple(data, q, branch, count):
    """Return whether exactly two solutions become one at every boundary."""
    boundary = 0
    for k in range(count):
        boundary |= branch[k] & BOUNDARY
    if boundary == 0:
        return True
    packed = data[at.PACKED : at.LENGTH].reshape(7, 13)
    size = data[at.SIZE]
    return all_simple(packed, size, q, branch, BOUNDARY, count, GENERAL_SINGULAR, MIN_FOLD_SLOPE)


@lean_part(i8(IN1, IN2, IN1, OUT2, IOUT1))
def solve_parallel(data, T, seed, q, branch):
    """Write all solutions for the pose T (4, 4) to q (16, 6) and branch (16,).

    Returns their number, plus DOUBT if the list may be incomplete: more than two solutions nearly
    coincide at a boundary, as all along a continuum.
    """
    G = _required_pose(data, T)
    pairs = scratch(MAX_PAIRS, PAIR_WIDTH)
    errors = scratch(MAX_SOLUTIONS)
    if data[at.SLIDING] != at.SLIDE_NONE:
        found = sliding_pairs(data, G, seed, pairs)
    elif data[at.KIND] == at.SKEW:
        found = skew_pairs(data, G, pairs)
    else:
        found = separate_pairs(data, G, pairs)
    if found == FREE:
        found = free_pairs(data, G, seed, pairs)
    named = data[at.NAMED] != 0.0
    count = ZERO
    for k in range(found):
        count = finish_pair(data, G, seed, pairs[k], named, q, branch, errors, count)
    count, doubtful = _refined(data, T, q, branch, errors, count)
    if doubtful:
        count = _without_repetitions(data, q, branch, count)
    return count if _are_simple(data, q, branch, count) else count | DOUBT
