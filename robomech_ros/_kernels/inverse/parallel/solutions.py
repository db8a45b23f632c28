"""All solutions of a six-joint arm with three parallel axes next to each other."""

from robomech_ros._kernels.algebra.angles import wrapped
from robomech_ros._kernels.compiling.jit import lean, lean_part, scratch
from robomech_ros._kernels.compiling.types import IN1, IN2, IOUT1, OUT2, ZERO, i8
from robomech_ros._kernels.inverse.branch_bits import BOUNDARY, DOUBT, SHOULDER_SINGULAR
from robomech_ros._kernels.inverse.general.multiplicity import FOLD_LEAST, all_simple
from robomech_ros._kernels.inverse.parallel import layout as at
from robomech_ros._kernels.inverse.parallel.arm import MAX_SOLUTIONS, finish_pair
from robomech_ros._kernels.inverse.parallel.continuum import free_pairs
from robomech_ros._kernels.inverse.parallel.pairs import FREE, MAX_PAIRS, PAIR_WIDTH, separate_pairs
from robomech_ros._kernels.inverse.parallel.skew_pairs import skew_pairs
from robomech_ros._kernels.inverse.parallel.slides import sliding_pairs
from robomech_ros._kernels.inverse.polishing import call_polish
from robomech_ros._kernels.tolerances import ACCEPTED, GENERAL_SINGULAR, POLISH_ABOVE, SAME_POSTURE


@lean
def _demanded(data, T):
    """Return the pose of frame 6 that the target asks for: rotation row by row, then origin."""
    r00, r01, r02, x = T[0, 0], T[0, 1], T[0, 2], T[0, 3]
    r10, r11, r12, y = T[1, 0], T[1, 1], T[1, 2], T[1, 3]
    r20, r21, r22, z = T[2, 0], T[2, 1], T[2, 2], T[2, 3]
    if data[at.FROM_TIP] != 0.0:
        x, y, z = (
            -(r00 * x + r10 * y + r20 * z),
            -(r01 * x + r11 * y + r21 * z),
            -(r02 * x + r12 * y + r22 * z),
        )
        r01, r10 = r10, r01
        r02, r20 = r20, r02
        r12, r21 = r21, r12
    k = at.RIGHT
    a0, a1, a2, a3 = data[k], data[k + 1], data[k + 2], data[k + 3]
    b0, b1, b2, b3 = data[k + 4], data[k + 5], data[k + 6], data[k + 7]
    c0, c1, c2, c3 = data[k + 8], data[k + 9], data[k + 10], data[k + 11]
    r00, r01, r02, x = (
        r00 * a0 + r01 * b0 + r02 * c0,
        r00 * a1 + r01 * b1 + r02 * c1,
        r00 * a2 + r01 * b2 + r02 * c2,
        r00 * a3 + r01 * b3 + r02 * c3 + x,
    )
    r10, r11, r12, y = (
        r10 * a0 + r11 * b0 + r12 * c0,
        r10 * a1 + r11 * b1 + r12 * c1,
        r10 * a2 + r11 * b2 + r12 * c2,
        r10 * a3 + r11 * b3 + r12 * c3 + y,
    )
    r20, r21, r22, z = (
        r20 * a0 + r21 * b0 + r22 * c0,
        r20 * a1 + r21 * b1 + r22 * c1,
        r20 * a2 + r21 * b2 + r22 * c2,
        r20 * a3 + r21 * b3 + r22 * c3 + z,
    )
    k = at.LEFT
    a0, a1, a2, a3 = data[k], data[k + 1], data[k + 2], data[k + 3]
    b0, b1, b2, b3 = data[k + 4], data[k + 5], data[k + 6], data[k + 7]
    c0, c1, c2, c3 = data[k + 8], data[k + 9], data[k + 10], data[k + 11]
    return (
        a0 * r00 + a1 * r10 + a2 * r20,
        a0 * r01 + a1 * r11 + a2 * r21,
        a0 * r02 + a1 * r12 + a2 * r22,
        b0 * r00 + b1 * r10 + b2 * r20,
        b0 * r01 + b1 * r11 + b2 * r21,
        b0 * r02 + b1 * r12 + b2 * r22,
        c0 * r00 + c1 * r10 + c2 * r20,
        c0 * r01 + c1 * r11 + c2 * r21,
        c0 * r02 + c1 * r12 + c2 * r22,
        a0 * x + a1 * y + a2 * z + a3,
        b0 * x + b1 * y + b2 * z + b3,
        c0 * x + c1 * y + c2 * z + c3,
    )


@lean
def _refined(data, T, q, branch, errors, count):
    """Polish where the algebra left more than rounding, and drop what is no solution."""
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
    """Keep one of several postures that are the same up to what a double root can lose."""
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
    """Tell whether at every boundary two solutions become one and no more."""
    boundary = 0
    for k in range(count):
        boundary |= branch[k] & BOUNDARY
    if boundary == 0:
        return True
    packed = data[at.PACKED : at.LENGTH].reshape(7, 13)
    size = data[at.SIZE]
    return all_simple(packed, size, q, branch, BOUNDARY, count, GENERAL_SINGULAR, FOLD_LEAST)


@lean_part(i8(IN1, IN2, IN1, OUT2, IOUT1))
def solve_parallel(data, T, seed, q, branch):
    """Write all solutions for the pose T (4, 4) to q (16, 6) and branch (16,).

    Returns how many, plus DOUBT where the list may lack one: where more than two solutions are or
    nearly are one at a boundary, as all along a continuum.
    """
    G = _demanded(data, T)
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
