"""The first three joints of a decoupled arm: all postures with the wrist centre at c.

The closed forms give candidates.  Newton's method improves those that idealised geometry or a
double root makes inaccurate, and the residual decides whether they are solutions.
"""

import math

import numpy as np

from robomech_ros._kernels.algebra.angles import wrapped
from robomech_ros._kernels.algebra.dense import cholesky_solve
from robomech_ros._kernels.compiling.jit import lean, lean_part, scratch
from robomech_ros._kernels.compiling.types import F3, IN1, IOUT1, OUT2, ZERO, f8, i8
from robomech_ros._kernels.inverse import branch_bits as bit
from robomech_ros._kernels.inverse.decoupled import layout as at
from robomech_ros._kernels.inverse.decoupled.arm_prismatic import prismatic_arm, through
from robomech_ros._kernels.inverse.decoupled.arm_revolute import revolute_arm
from robomech_ros._kernels.inverse.decoupled.arm_rows import (
    DETERMINANT,
    FREE,
    FREE_1,
    FREE_2,
    FREE_3,
    WIDTH,
    add_angles,
    copy_row,
    cosine_of,
    enter_turn,
    sine_of,
    update_cosines,
)
from robomech_ros._kernels.spatial.vectors import rotated
from robomech_ros._kernels.tolerances import ACCEPTED, NEAR_DOUBLE, POLISH_ABOVE, SAME_POSTURE

# Below this determinant, relative to REGULAR, an improved candidate may represent two solutions:
# an error of IDEALISED_SLACK becomes its square root at a double root.
NEAR_SINGULAR = 3e-2
# Accepted error of a second solution near a fold (rad, and lengths over the size).
SHARP = 1e-12
# Least distance (rad) of two solutions near a fold, about ten times the effect of such an error.
FOLD_APART = 1e-5

# Largest number of postures of the arm: twice the number that exist without a continuum.
MAX_ARMS = 8
# Rows for these postures and one more as working space.
ARM_ROWS = MAX_ARMS + 1
# Starts from each inaccurate candidate.
_STARTS = 8
# Typed, since numba recompiles a function for each literal argument.
_THREE = np.int64(3)


@lean
def _reverse(arm):
    """Convert a posture solved from the tip to one of the arm itself."""
    arm[0], arm[1], arm[2] = -arm[2], -arm[1], -arm[0]
    cos1, sin1, cos3, sin3 = cosine_of(arm, 0), sine_of(arm, 0), cosine_of(arm, 2), sine_of(arm, 2)
    enter_turn(arm, 0, cos3, -sin3)
    enter_turn(arm, 1, cosine_of(arm, 1), -sine_of(arm, 1))
    enter_turn(arm, 2, cos1, -sin1)
    flags = int(arm[FREE])
    arm[FREE] = (flags & FREE_1) << 2 | (flags & FREE_2) | flags >> 2


@lean
def _candidates(data, c, seed, shift, arms):
    """Write candidates of joints 1 to 3 to ``arms`` (16, WIDTH); return their number.

    Free joints take their value from ``seed`` plus ``shift``.
    """
    unit = 1.0 / data[at.SIZE]
    q1 = seed[0] + shift if data[at.TYPES] == 0.0 else seed[0] * unit
    q2 = seed[1] + shift if data[at.TYPES + 1] == 0.0 else seed[1] * unit
    q3 = seed[2] + shift if data[at.TYPES + 2] == 0.0 else seed[2] * unit
    w = (data[at.WRIST], data[at.WRIST + 1], data[at.WRIST + 2])
    backwards = data[at.FROM_TIP] == 1.0
    values = free = (q1, q2, q3)
    if backwards:
        c, w = w, c
        free = (-q3, -q2, -q1)
    if data[at.KIND] <= at.REVOLUTE_QUARTIC:
        count = revolute_arm(data, c, w, free, arms)
    else:
        count = prismatic_arm(data, c, w, free, arms)
    if backwards:
        for i in range(count):
            _reverse(arms[i])
    for i in range(count):
        add_angles(data, arms[i], values)
    return count


@lean
def arm_error(data, arm, c, J, e):
    """Write the error e of the wrist centre at c and its Jacobian J, in the frame behind joint 1.

    Returns the determinant of J and two numbers whose signs name shoulder and elbow.
    """
    x, y, z = data[at.WRIST], data[at.WRIST + 1], data[at.WRIST + 2]
    if data[at.TYPES + 2] == 0.0:
        a, b = cosine_of(arm, 2), sine_of(arm, 2)
        x, y = a * x - b * y, b * x + a * y
        d3x, d3y, d3z = -y, x, 0.0
    else:
        z += arm[2]
        d3x, d3y, d3z = 0.0, 0.0, 1.0
    k = at.C2
    x, y, z = through(data, k, x, y, z)
    d3x, d3y, d3z = rotated(data, k, (d3x, d3y, d3z))
    elbow = data[k + 3] * y - data[k + 7] * x
    if data[at.TYPES + 1] == 0.0:
        a, b = cosine_of(arm, 1), sine_of(arm, 1)
        x, y = a * x - b * y, b * x + a * y
        d3x, d3y = a * d3x - b * d3y, b * d3x + a * d3y
        d2x, d2y, d2z = -y, x, 0.0
    else:
        z += arm[1]
        d2x, d2y, d2z = 0.0, 0.0, 1.0
    k = at.C1
    x, y, z = through(data, k, x, y, z)
    J[0, 1], J[1, 1], J[2, 1] = rotated(data, k, (d2x, d2y, d2z))
    J[0, 2], J[1, 2], J[2, 2] = rotated(data, k, (d3x, d3y, d3z))
    shoulder = data[k + 2] * y - data[k + 6] * x
    if data[at.TYPES] == 0.0:
        a, b = cosine_of(arm, 0), sine_of(arm, 0)
        J[0, 0], J[1, 0], J[2, 0] = -y, x, 0.0
        e[0], e[1], e[2] = a * c[0] + b * c[1] - x, a * c[1] - b * c[0] - y, c[2] - z
    else:
        J[0, 0], J[1, 0], J[2, 0] = 0.0, 0.0, 1.0
        e[0], e[1], e[2] = c[0] - x, c[1] - y, c[2] - z - arm[0]
    determinant = J[0, 0] * (J[1, 1] * J[2, 2] - J[2, 1] * J[1, 2])
    determinant += J[1, 0] * (J[2, 1] * J[0, 2] - J[0, 1] * J[2, 2])
    determinant += J[2, 0] * (J[0, 1] * J[1, 2] - J[1, 1] * J[0, 2])
    return determinant, shoulder, elbow


@lean
def _improve_arm(data, arm, c, J, e, error):
    """Improve the arm by damped Newton steps; return the remaining error (units of SIZE)."""
    A = scratch(3, 3)
    step = scratch(3)
    trial = scratch(WIDTH)
    damping = 1e-16
    for _ in range(40):
        for i in range(3):
            step[i] = J[0, i] * e[0] + J[1, i] * e[1] + J[2, i] * e[2]
            for j in range(3):
                A[i, j] = J[0, i] * J[0, j] + J[1, i] * J[1, j] + J[2, i] * J[2, j]
            A[i, i] += damping + error * error
        if not cholesky_solve(A, step, _THREE):
            break
        for i in range(3):
            trial[i] = arm[i] + step[i]
        update_cosines(data, trial)
        arm_error(data, trial, c, J, e)
        found = math.sqrt(e[0] * e[0] + e[1] * e[1] + e[2] * e[2])
        better = found < error
        if better:
            slow = found > 0.9 * error
            for i in range(3):
                arm[i] = trial[i]
            update_cosines(data, arm)
            error = found
            if slow or error <= POLISH_ABOVE:
                break
        else:
            if damping > 1e-4:
                break
            damping *= 1e4
            arm_error(data, arm, c, J, e)
    return error


@lean
def is_among(data, posture, others, apart):
    """Return whether a posture, of all or the first three joints, is among the rows ``others``."""
    for i in range(others.shape[0]):
        same = True
        for j in range(posture.shape[0]):
            d = posture[j] - others[i, j]
            if j > 2 or data[at.TYPES + j] == 0.0:
                d = wrapped(d)
            same = same and abs(d) <= apart
        if same:
            return True
    return False


@lean
def _arm_bits(data, k, arm, shoulder, elbow):
    """Return the bits of the arm's branch and singularity."""
    free = int(arm[FREE])
    branch = 0
    if data[at.NAMED] != 0.0:
        if shoulder * data[at.NAMED] > 0.0:
            branch |= bit.SHOULDER_RIGHT
        if elbow * shoulder > 0.0:
            branch |= bit.ELBOW_DOWN
    else:
        branch |= (k << bit.ARM_SHIFT) | bit.ARM_NUMBERED
    if free & FREE_1:
        branch |= bit.SHOULDER_SINGULAR
    if free & (FREE_2 | FREE_3):
        branch |= bit.ELBOW_SINGULAR
    if not free and arm[DETERMINANT] <= NEAR_DOUBLE:
        branch |= bit.BOUNDARY
    return branch


@lean
def step_off_fold(data, arm, J, amount):
    """Move the arm by ``amount`` in the direction that changes the wrist centre least.

    At a double root this changes the error in second order only; starts on both sides lead to the
    two solutions.
    """
    best = -1.0
    x = y = z = 0.0
    for i in range(3):
        j = (i + 1) % 3
        u = J[i, 1] * J[j, 2] - J[i, 2] * J[j, 1]
        v = J[i, 2] * J[j, 0] - J[i, 0] * J[j, 2]
        w = J[i, 0] * J[j, 1] - J[i, 1] * J[j, 0]
        norm = math.sqrt(u * u + v * v + w * w)
        if norm > best:
            best, x, y, z = norm, u, v, w
    if best > 0.0:
        arm[0] += amount * x / best
        arm[1] += amount * y / best
        arm[2] += amount * z / best
        update_cosines(data, arm)


@lean
def _fold_offset(start, error):
    """Return the signed distance of start 1 and later ones from a fold whose error is ``error``.

    From outside the two solutions Newton steps lead to the nearer one, so the first starts are
    there; near a continuum a joint may need a full turn.
    """
    if start < 5:
        away = (10.0 if start < 3 else 100.0) * math.sqrt(error)
        return min(away, 0.3) * (1.0 - 2.0 * (start & 1))
    return math.pi if start == 5 else math.pi * (start - 6.5)


@lean
def _length(e):
    return math.sqrt(e[0] * e[0] + e[1] * e[1] + e[2] * e[2])


@lean
def _add_postures(data, c, k, candidate, J, e, arms, bits, count):
    """Enter the postures of candidate k, both near a fold; return the number of postures."""
    limit = data[at.SLACK]
    if data[at.EXACT] == 1.0:
        limit = ACCEPTED / max(1.0, data[at.SIZE])
    first_error = 0.0
    for start in range(_STARTS):
        arm = arms[count]
        copy_row(candidate, arm)
        determinant, shoulder, elbow = arm_error(data, arm, c, J, e)
        if start == 0:
            first_error = _length(e)
        else:
            step_off_fold(data, arm, J, _fold_offset(start, first_error))
            arm_error(data, arm, c, J, e)
        error = _length(e)
        if not error <= POLISH_ABOVE:
            error = _improve_arm(data, arm, c, J, e, error)
            determinant, shoulder, elbow = arm_error(data, arm, c, J, e)
        arm[DETERMINANT] = abs(determinant) / data[at.REGULAR]
        good = error <= (limit if start == 0 else SHARP)
        regular = arm[DETERMINANT] > NEAR_SINGULAR and error <= limit
        apart = SAME_POSTURE if first_error <= POLISH_ABOVE else FOLD_APART
        if good and not is_among(data, arm[:3], arms[:count], apart):
            bits[count] = _arm_bits(data, k, arm, shoulder, elbow)
            count += 1
        # Next to a good posture of a continuum the next start would find the continuum again.
        settled = good and candidate[FREE] > 0.0
        if first_error <= POLISH_ABOVE or regular or settled or count == MAX_ARMS:
            break
        if data[at.HAS_FALLBACK] == 1.0:
            break
    return count


@lean_part(i8(IN1, F3, IN1, f8, OUT2, IOUT1))
def arm_postures(data, c, seed, shift, arms, bits):
    """Write the arm's solutions to ``arms`` and their branches to ``bits``; return their number.

    Rows of ``arms`` (ARM_ROWS, WIDTH) are those of :mod:`arm_rows`.
    """
    J = scratch(3, 3)
    e = scratch(3)
    candidates = scratch(16, WIDTH)
    found = _candidates(data, c, seed, shift, candidates)
    count = ZERO
    for k in range(found):
        if count < MAX_ARMS:
            count = _add_postures(data, c, k, candidates[k], J, e, arms, bits, count)
    return count
