"""All solutions of an arm of fewer than six joints, by completing it to six joints."""

import math

import numpy as np

from robomech_ros._kernels.algebra.angles import wrapped
from robomech_ros._kernels.compiling.jit import inline, part, scratch
from robomech_ros._kernels.compiling.types import IN1, IN2, IOUT1, OUT2, ZERO, i8
from robomech_ros._kernels.inverse import branch_bits as bit, short_layout as at
from robomech_ros._kernels.inverse.polishing import call_polish, pose_error
from robomech_ros._kernels.inverse.six_joints import DOUBT, GENERAL, MAX_SOLUTIONS, call_six_joints
from robomech_ros._kernels.tolerances import ACCEPTED, CONTINUUM_STEP, SAME_POSTURE

# Virtual joints this near to zero (rad, or of the size) may be zero, since poses are rounded:
# Newton steps of the arm itself decide.
SHORT_SLACK = 3e-2
# Postures that only approximate a pose are one solution below this distance (rad or m).
SHORT_APART = 1e-3
# More solutions than this, found where the completed arm is singular, are a continuum.
SHORT_CONTINUUM = 8

# Number of values tried for a joint that is free in the completed arm only.
_FREE_VALUES = 16
_STEPS = np.int64(30)


@inline
def _virtual_joints_vanish(data, found):
    """Return whether the virtual joints are near enough to zero for Newton steps to decide."""
    for i in range(6):
        if data[at.ARM_JOINTS + i] < 0.0:
            if data[at.SLIDES + i] != 0.0:
                away = abs(found[i]) / data[at.SIZE]
            else:
                away = abs(wrapped(found[i]))
            if away > SHORT_SLACK:
                return False
    return True


@inline
def _enter(data, packed, T, found, q, errors, count):
    """Append the arm's joints to the solutions if they solve the pose and are new.

    Of two neighbouring postures that only approximate the pose, the better one is stored.
    ``errors`` (16,) are the errors of the solutions (rad or m).  Returns the number of solutions.
    """
    n = q.shape[1]
    for i in range(6):
        joint = int(data[at.ARM_JOINTS + i])
        if joint >= 0:
            q[count, joint] = found[i]
    error, e = call_polish(packed, T, q[count], _STEPS), scratch(6)
    if error > ACCEPTED:
        if not error <= at.ORIENTATION_TOLERANCE:
            return count
        pose_error(packed, T, q[count], e)
        if math.sqrt(e[3] * e[3] + e[4] * e[4] + e[5] * e[5]) > at.POSITION_TOLERANCE:
            return count
    errors[count] = error
    for i in range(n):
        if packed[i, 0] == 0.0:
            q[count, i] = wrapped(q[count, i])
    for k in range(count):
        apart = 0.0
        for i in range(n):
            difference = q[k, i] - q[count, i]
            if packed[i, 0] == 0.0:
                difference = wrapped(difference)
            apart = max(apart, abs(difference))
        if apart < (SAME_POSTURE if max(error, errors[k]) <= ACCEPTED else SHORT_APART):
            if error < errors[k] and errors[k] > ACCEPTED:
                errors[k] = error
                for i in range(n):
                    q[k, i] = q[count, i]
            return count
    return count + 1


@inline
def _drop_approximate(q, errors, count):
    """Drop approximate solutions if there are exact ones; return the number of solutions."""
    least = math.inf
    for k in range(count):
        least = min(least, errors[k])
    kept = ZERO
    for k in range(count):
        if errors[k] <= ACCEPTED or least > ACCEPTED:
            for i in range(q.shape[1]):
                q[kept, i] = q[k, i]
            kept += 1
    return kept


@inline
def _displace(data, attempt, found):
    """Move the postures ``found`` (k, 6) a little, in another direction for each attempt."""
    for k in range(found.shape[0]):
        for i in range(6):
            step = CONTINUUM_STEP * math.cos(attempt * (i + 1.0))
            found[k, i] += step if data[at.SLIDES + i] == 0.0 else step * data[at.SIZE]


@part(i8(IN1, IN2, IN1, OUT2, IOUT1))
def solve_short(data, T, seed, q, branch):
    """Write all solutions for the pose T (4, 4) to q (16, n), branches to ``branch`` (16,).

    The completed arm may be singular where the arm itself is not.  Then several values of its free
    joints are tried or, without a closed form, postures nearby; many solutions found this way are
    a continuum.  Returns the number of solutions, plus DOUBT if the list may be incomplete.
    """
    n = int(data[at.JOINTS])
    packed = data[at.PARTS : at.PARTS + 13 * (n + 1)].reshape((n + 1, 13))
    six = data[at.PARTS + 13 * (n + 1) :]
    found = np.empty((MAX_SOLUTIONS, 6))
    marks = np.empty(MAX_SOLUTIONS, np.int64)
    start, errors = np.empty(6), np.empty(MAX_SOLUTIONS)
    count = ZERO
    total = ZERO
    doubt = ZERO
    singular = False
    for attempt in range(_FREE_VALUES):
        turn = 2.0 * math.pi * attempt / _FREE_VALUES
        for i in range(6):
            joint = int(data[at.ARM_JOINTS + i])
            start[i] = seed[joint] if joint >= 0 else 0.0
            start[i] += turn if data[at.SLIDES + i] == 0.0 else data[at.SIZE] * (turn - math.pi)
            if attempt == 0 and data[at.SLIDES + i] != 0.0:
                start[i] = seed[joint] if joint >= 0 else 0.0
        if attempt == 0 or data[at.SIX] != GENERAL:
            total = call_six_joints(
                int(data[at.SIX]), data[at.BACKWARDS] != 0.0, six, T, start, found, marks
            )
            doubt |= total & DOUBT
        else:
            _displace(data, attempt, found[: total % DOUBT])
        for k in range(total % DOUBT):
            free = marks[k] & bit.CONTINUUM != 0
            singular = singular or free
            if count < q.shape[0] and (free or _virtual_joints_vanish(data, found[k])):
                count = _enter(data, packed, T, found[k], q, errors, count)
        if not singular:
            break
    count = _drop_approximate(q, errors, count)
    for k in range(count):
        branch[k] = bit.UNNAMED
        if singular and count > SHORT_CONTINUUM:
            branch[k] |= bit.SHOULDER_SINGULAR
    return count | doubt
