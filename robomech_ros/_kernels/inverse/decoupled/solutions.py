"""All solutions of an arm whose last three revolute axes intersect in one point.

The wrist centre gives the first three joints, the remaining rotation the last three.

Axes that only nearly intersect are idealised, and Newton steps move every solution to the true
chain.  Near a singular posture two true solutions may correspond to one or none of the idealised
arm: the list is then in doubt.
"""

import math

import numpy as np

from robomech_ros._kernels.algebra.angles import angle_of, wrapped
from robomech_ros._kernels.algebra.polynomials import order_one_roots
from robomech_ros._kernels.compiling.jit import lean, lean_part, scratch, scratch_integers
from robomech_ros._kernels.compiling.types import IN1, IN2, IOUT1, OUT2, ZERO, i8
from robomech_ros._kernels.inverse import branch_bits as bit
from robomech_ros._kernels.inverse.decoupled import layout as at
from robomech_ros._kernels.inverse.decoupled.arm import (
    ARM_ROWS,
    FOLD_APART,
    MAX_ARMS,
    NEAR_SINGULAR,
    SHARP,
    arm_error,
    arm_postures,
    is_among,
    step_off_fold,
)
from robomech_ros._kernels.inverse.decoupled.arm_rows import (
    DETERMINANT,
    FREE,
    WIDTH,
    copy_row,
    cosine_of,
    sine_of,
    update_cosines,
)
from robomech_ros._kernels.inverse.decoupled.wrist import (
    WRIST_BOUNDARY,
    WRIST_FREE,
    WRIST_OPPOSED,
    spherical_wrist,
)
from robomech_ros._kernels.inverse.polishing import call_polish
from robomech_ros._kernels.spatial.vectors import (
    combined,
    mixed,
    product,
    rotated,
    rotated_back,
    scaled,
    times,
)
from robomech_ros._kernels.tolerances import ACCEPTED, IDEALISED_SLACK, PARALLEL_AXES

# Near a singularity of the arm its joints are uncertain by ARM_ROUNDING over the determinant of its
# Jacobian (relative to REGULAR), at a double root by PARALLEL_AT_FOLD, the square root of a
# rounding.  Parallel wrist axes may differ by as much.
ARM_ROUNDING = 1e-14
PARALLEL_AT_FOLD = 3e-5

# Number of values of a free joint tried if the seed's value leads to no reachable orientation.
_TRIES = 24
# Distance (rad) of the starts from a fold of the whole chain.
_FOLD = 5e-3
# Typed, since numba recompiles a function for each literal argument.
_STEPS = np.int64(30)
_DOUBT = np.int64(bit.DOUBT)


@lean
def _turn_back(arm, j, Q):
    """Return the rotation Q turned back by joint j."""
    c, s = cosine_of(arm, j), sine_of(arm, j)
    a, b = Q[:3], Q[3:6]
    return combined(scaled(a, c), b, s) + combined(scaled(b, c), a, -s) + Q[6:]


@lean
def _rotated_back(data, k, Q):
    """Return R^T Q with R the rotation of the 3x4 transform at k."""
    a, b, c = Q[:3], Q[3:6], Q[6:]
    x = mixed((data[k], data[k + 4], data[k + 8]), a, b, c)
    y = mixed((data[k + 1], data[k + 5], data[k + 9]), a, b, c)
    return x + y + mixed((data[k + 2], data[k + 6], data[k + 10]), a, b, c)


@lean
def _reduced_target(data, T):
    """Return the wrist centre in frame 1 (in SIZE) and the rotation between joints 1 and 6."""
    k = at.BASE
    x, y, z = times(T, (data[at.CENTRE], data[at.CENTRE + 1], data[at.CENTRE + 2]))
    p = x + T[0, 3] - data[k + 3], y + T[1, 3] - data[k + 7], z + T[2, 3] - data[k + 11]
    c = scaled(rotated_back(data, k, p), 1.0 / data[at.SIZE])
    j = at.TIP
    rows = data[j : j + 3], data[j + 3 : j + 6], data[j + 6 : j + 9]
    first, second, third = product((T[0], T[1], T[2]), rows)
    Q = first + second + third
    return c, _rotated_back(data, k, Q)


@lean
def _wrist_rotation(data, arm, Q):
    """Return the rotation of the wrist: Q turned back by the first three joints and their links."""
    Q = _rotated_back(data, at.C1, _turn_back(arm, 0, Q))
    Q = _rotated_back(data, at.C2, _turn_back(arm, 1, Q))
    return _rotated_back(data, at.C3, _turn_back(arm, 2, Q))


@lean
def _reachable_angle(data, arm, Q, j):
    """Turn free joint j to the nearest value with an orientation in reach of the wrist.

    The cosine of the angle between axes 4 and 6 is of first order in the joint, and must be in the
    wrist's range.  Returns False if it never is.
    """
    before = Q
    if j > 0:
        before = _rotated_back(data, at.C1, _turn_back(arm, 0, before))
    if j > 1:
        before = _rotated_back(data, at.C2, _turn_back(arm, 1, before))
    x, y, z = before[2], before[5], before[8]
    ax, ay, az = data[at.C3 + 2], data[at.C3 + 6], data[at.C3 + 10]
    for i in range(2, j, -1):
        c, s = cosine_of(arm, i), sine_of(arm, i)
        ax, ay = c * ax - s * ay, s * ax + c * ay
        k = at.C2 if i == 2 else at.C1
        ax, ay, az = rotated(data, k, (ax, ay, az))
    constant, c, s = z * az, x * ax + y * ay, y * ax - x * ay
    best = math.inf
    value = arm[j]
    for side in range(2):
        bound = math.cos(data[at.NEAREST + side])
        found, c1, s1, c2, s2 = order_one_roots(constant - bound, c, s, 0.0)
        for i in range(found):
            angle = angle_of(s1 if i == 0 else s2, c1 if i == 0 else c2)
            turn = wrapped(angle - arm[j])
            if abs(turn) < best:
                best = abs(turn)
                value = arm[j] + turn
    arm[j] = value
    update_cosines(data, arm)
    return best < math.inf


@lean
def _wrist_of(data, arm, Q, free_angle, slack, parallel, angles):
    """Solve the wrist for an arm's posture; a free joint of the arm moves if necessary."""
    left = _wrist_rotation(data, arm, Q)
    count, flags = spherical_wrist(data, left, free_angle, slack, parallel, angles)
    free = int(arm[FREE])
    if count > 0 or free == 0:
        return count, flags
    for j in range(3):
        if free & (1 << j) and data[at.TYPES + j] == 0.0:
            before = arm[j]
            if _reachable_angle(data, arm, Q, j):
                left = _wrist_rotation(data, arm, Q)
                count, flags = spherical_wrist(data, left, free_angle, ACCEPTED, parallel, angles)
            if count > 0:
                break
            arm[j] = before
            update_cosines(data, arm)
    return count, flags


@lean
def _enter(data, arm, angles, q):
    """Write the joint values of a solution, angles in (-pi, pi]."""
    for j in range(3):
        q[j] = wrapped(arm[j]) if data[at.TYPES + j] == 0.0 else arm[j] * data[at.SIZE]
        q[3 + j] = wrapped(angles[j] - data[at.ANGLES + j])


@lean
def _polished(data, T, posture, others, limit):
    """Move an idealised solution to the true chain; return False if it fails or is listed."""
    packed = data[at.PACKED : at.PACKED + 91].reshape((7, 13))
    if not call_polish(packed, T, posture, _STEPS) <= limit:
        return False
    for j in range(6):
        if j > 2 or data[at.TYPES + j] == 0.0:
            posture[j] = wrapped(posture[j])
    return not is_among(data, posture, others, FOLD_APART)


@lean
def _add_singular(data, T, arm, angles, q, count):
    """Enter a solution with a singular wrist near a fold of the arm; return the number.

    Half of the digits of the arm are known there, and the wrist is singular to as many.
    """
    if count < q.shape[0]:
        _enter(data, arm, angles[0], q[count])
        if _polished(data, T, q[count], q[:count], ACCEPTED):
            count += 1
    return count


@lean
def _name(data, bits, flags, angle5):
    """Return the bits of an arm's branch with those of the wrist added."""
    if wrapped(angle5) * data[at.UNFLIPPED] < 0.0:
        bits |= bit.WRIST_FLIP
    if flags & WRIST_FREE:
        bits |= bit.WRIST_SINGULAR
    if flags & WRIST_OPPOSED:
        bits |= bit.WRIST_OPPOSED
    if flags & WRIST_BOUNDARY:
        bits |= bit.BOUNDARY
    return bits


@lean
def _add_near_fold(data, T, arm, Q, free_angle, slack, angles, near_fold, q, count):
    """Enter the solutions for an arm's posture that is not accurate enough for the wrist.

    Either the wrist axes only nearly intersect, and the true chain has its folds elsewhere, or the
    arm is at a fold, where half of its digits are lost.  The pose decides; near a fold the search
    starts on both sides.  Returns the number of solutions, and whether each idealised one leads to
    a different solution far from folds.
    """
    sure = not near_fold
    J = scratch(3, 3)
    e = scratch(3)
    trial = scratch(WIDTH)
    starts = 1
    start = 0
    while start < starts:
        copy_row(arm, trial)
        side = 0.0 if start == 0 else _FOLD * (1.0 - 2.0 * (start & 1))
        if start == 1 or start == 2:
            arm_error(data, trial, (0.0, 0.0, 0.0), J, e)
            step_off_fold(data, trial, J, side)
        n, _ = _wrist_of(data, trial, Q, free_angle, slack, PARALLEL_AXES, angles)
        for k in range(n):
            if count == q.shape[0]:
                return count, False
            if start > 2:
                angles[k, 1] += side
            _enter(data, trial, angles[k], q[count])
            if _polished(data, T, q[count], q[:count], ACCEPTED if start == 0 else SHARP):
                count += 1
            elif start == 0:
                sure = False
            if near_fold or n == 1 or abs(math.sin(angles[k, 1])) < max(_FOLD, slack):
                starts = 5
                sure = False
            if not sure and data[at.HAS_FALLBACK] == 1.0:
                return count, False
        start += 1
    return count, sure


@lean_part(i8(IN1, IN2, IN1, OUT2, IOUT1))
def solve_decoupled(data, T, seed, q, branch):
    """Write all solutions for the pose T (4, 4) to q (16, 6), branches to ``branch``.

    Angles are in (-pi, pi], limits are ignored.  Free joints of a continuum take the value of
    ``seed`` (6,), or the nearest with a solution.  Returns the number of solutions, plus DOUBT if
    the wrist axes only nearly intersect and the list may be incomplete; with a fallback it is.
    """
    c, Q = _reduced_target(data, T)
    arms = scratch(ARM_ROWS, WIDTH)
    bits = scratch_integers(MAX_ARMS)
    angles = scratch(2, 3)
    exact = data[at.EXACT] == 1.0
    slack = 0.5 * ACCEPTED if exact else data[at.SLACK]
    bound = NEAR_SINGULAR if exact else max(NEAR_SINGULAR, math.sqrt(slack))
    has_fallback = data[at.HAS_FALLBACK] == 1.0
    doubt = ZERO
    free_angle = seed[3] + data[at.ANGLES]
    count = ZERO
    for attempt in range(_TRIES):
        shift = 2.0 * math.pi / _TRIES * ((attempt + 1) // 2) * (1 - 2 * (attempt % 2))
        found = arm_postures(data, c, seed, shift, arms, bits)
        any_free = False
        for i in range(found):
            if has_fallback and (doubt > 0 or arms[i, DETERMINANT] <= bound):
                return _DOUBT
            any_free = any_free or arms[i, FREE] > 0.0
            before = count
            rounding = ARM_ROUNDING / arms[i, DETERMINANT]
            parallel = min(max(PARALLEL_AXES, rounding), PARALLEL_AT_FOLD)
            n, flags = _wrist_of(data, arms[i], Q, free_angle, slack, parallel, angles)
            if parallel > PARALLEL_AXES and flags & WRIST_FREE:
                count = _add_singular(data, T, arms[i], angles, q, count)
                if count > before:
                    doubt = ZERO if exact else _DOUBT
                    angle5 = q[before, 4] + data[at.ANGLES + 1]
                    branch[before] = _name(data, bits[i], flags, angle5)
                    continue
                n, flags = _wrist_of(data, arms[i], Q, free_angle, slack, PARALLEL_AXES, angles)
            fold = arms[i, DETERMINANT] <= bound
            if exact and (n > 0 or not fold):
                for k in range(n):
                    _enter(data, arms[i], angles[k], q[count])
                    count += 1
            else:
                beyond = max(slack, IDEALISED_SLACK)
                count, sure = _add_near_fold(
                    data, T, arms[i], Q, free_angle, beyond, angles, fold, q, count
                )
                if not (exact or sure):
                    doubt = _DOUBT
            for k in range(before, count):
                branch[k] = _name(data, bits[i], flags, q[k, 4] + data[at.ANGLES + 1])
        if count > 0 or not any_free:
            break
    return count | doubt
