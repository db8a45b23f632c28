"""All solutions of any six-joint arm.

The forms of the arm are tried, the best first, until one is clean: its elimination is regular,
its determinant is well above rounding, has simple zeros only, and each of them has led to one
posture of its own.  Then the list is complete.

At a singular posture, where axes line up, or where two postures share the hidden angle, that may
fail for every form.  Then the pose is nudged, back and forth, to neighbours that are solved
cleanly, and their solutions are followed back.  Where the Jacobian is regular a solution has one
beside it for every pose nearby, so that none of these can be lost; a fold keeps its two on one
side.  The list counts as complete where a nudge and its opposite were clean, none of their
solutions was lost on the way, and both led to all solutions that are far from singular; but not
where the determinant of every form vanishes all round, as it does where a joint is free.
"""

import math

import numpy as np
from numba import types

from robomech_ros._kernels import general_layout as at
from robomech_ros._kernels._jit import (
    IN1,
    IN2,
    IOUT1,
    OUT1,
    OUT2,
    b1,
    i8,
    inline,
    kernel,
    linked,
    part,
)
from robomech_ros._kernels.angles import wrapped
from robomech_ros._kernels.branch_bits import ARM_SHIFT, BOUNDARY, POSTURE_NUMBERED, SELF_MOTION
from robomech_ros._kernels.general_determinant import core, null_vector
from robomech_ros._kernels.general_equations import (
    complete_form,
    demanded,
    free_equations,
    right_side,
)
from robomech_ros._kernels.general_posture import half_angles, remaining_joints
from robomech_ros._kernels.general_roots import MAX_ROOTS, isolate, sample
from robomech_ros._kernels.general_slides import MAX_TRIALS, slide_postures
from robomech_ros._kernels.polishing import call_polish
from robomech_ros._kernels.serial import jacobian_body
from robomech_ros._kernels.tolerances import (
    ACCEPTED,
    CONTINUUM_KEPT,
    CONTINUUM_STEP,
    GENERAL_FREE_VALUES,
    GENERAL_MARGIN,
    GENERAL_MULTIPLE,
    GENERAL_REGULAR,
    GENERAL_SAMPLINGS,
    GENERAL_SINGULAR,
    GENERAL_STEPS,
    GENERAL_STEPS_SINGULAR,
    GENERAL_VOID,
    NUDGE_PARTS,
    SAME_MULTIPLE,
    SAME_POSTURE,
    SAME_SINGULAR,
)

__all__ = ["DOUBT", "MAX_SOLUTIONS", "solve_general"]

# Added to the number of solutions where the list may lack one.
DOUBT = 1 << 8

MAX_SOLUTIONS = 16
# Nudges: rotation (rad), translation over the size, and their norm.  Each is used both ways; the
# largest is sure to leave the degenerate pose, the smallest stays near all regular solutions.
_NUDGES = (
    (1.1e-3, -0.7e-3, 0.8e-3, 0.9e-3, 0.5e-3, -1.2e-3, 2.2e-3),
    (-0.5e-4, 0.8e-4, 0.4e-4, 0.3e-4, -0.9e-4, 0.6e-4, 1.5e-4),
    (1.5e-2, 0.9e-2, -1.2e-2, 0.7e-2, -1.6e-2, 1.0e-2, 2.9e-2),
)
_EIGHTH = 0.25 * math.pi
_NUDGED = 1 + 2 * len(_NUDGES)
# Beside the rows reached, as bits.
_IS_CLEAN = 1 << 16


@inline
def _distance(data, packed, a, b):
    """Give the largest difference of a joint (rad, of a slide over the size)."""
    apart = 0.0
    for j in range(6):
        if packed[j, 0] == 0.0:
            apart = max(apart, abs(wrapped(a[j] - b[j])))
        else:
            apart = max(apart, abs(a[j] - b[j]) / data[at.SIZE])
    return apart


@inline
def _regularity(data, packed, q, direction):
    """Give the last pivot of the Jacobian (lengths over the size) over the first.

    ``direction`` (6,) is working space.
    """
    J = np.empty((6, 6))
    pose = np.empty((4, 4))
    jacobian_body(packed, q, J, pose)
    inverse = 1.0 / data[at.SIZE]
    for i in range(3, 6):
        for j in range(6):
            if packed[j, 0] == 0.0:
                J[i, j] *= inverse
    order = np.empty(6, np.int64)
    _, last = null_vector(J, direction, order)
    return last


@part(types.UniTuple(i8, 2)(IN1, IN2, IN2, OUT1, b1, OUT2, i8))
def _admit(data, packed, T, trial, singular, q, count):
    """Polish a posture and enter it if it is a new solution; return its row (-1: none), count.

    Near ``singular`` solutions Newton steps are slow and end at some distance, the farther the
    more solutions have become one.
    """
    error = call_polish(packed, T, trial, GENERAL_STEPS_SINGULAR if singular else GENERAL_STEPS)
    if not error <= ACCEPTED:
        return -1, count
    same = SAME_POSTURE
    ratio = 1.0
    direction = np.empty(6)
    if singular:
        ratio = _regularity(data, packed, trial, direction)
        same = SAME_MULTIPLE if ratio < GENERAL_MULTIPLE else SAME_SINGULAR
    for j in range(6):
        if packed[j, 0] == 0.0:
            trial[j] = wrapped(trial[j])
    for k in range(count):
        if _distance(data, packed, q[k], trial) < same:
            if same == SAME_MULTIPLE and _regularity(data, packed, q[k], direction) > ratio:
                # The more singular of the two is the nearer to where they have become one.
                for j in range(6):
                    q[k, j] = trial[j]
            return k, count
    if count >= MAX_SOLUTIONS:
        return -1, count
    for j in range(6):
        q[count, j] = trial[j]
    return count, count + 1


@inline
def _solve_form(data, start, packed, T, pose, back, seed, q, count):
    """Enter the solutions that a form finds; return whether it is clean, void, and count.

    Void is a form whose determinant vanishes all round: the hidden joint may be free.  It is then
    given the seed's value, or the next of some others with which there is a posture.
    """
    form = np.empty(at.FORM)
    complete_form(data, start, pose, back, form)
    before = form[at.BEFORE : at.BEFORE + 12]
    behind = form[at.BEHIND : at.BEHIND + 12]
    X = np.empty((14, 3))
    V = np.empty((3, 14))
    slide = int(form[at.SLIDE])
    right_side(before, behind, slide == at.FIRST, X, V)
    E = np.empty((6, at.N_COLUMNS))
    K = form[at.EQUATIONS :].reshape(at.N_EQUATIONS, at.N_COLUMNS)
    clean = free_equations(K, X, slide, E) > GENERAL_MARGIN
    A = np.empty((6, 9))
    B = np.empty((6, 9))
    S = np.empty((6, 6))
    shape = np.empty((2, 9))
    largest, noise = sample(E, shape, A, B, S)
    roots = np.empty((MAX_ROOTS, 2))
    void = not largest > GENERAL_VOID * noise
    if void:
        clean = False
        zeros = GENERAL_FREE_VALUES
        given = form[at.SENSE] * seed[int(form[at.JOINTS + at.HIDDEN])]
        for k in range(zeros):
            away = 2.0 * math.pi * ((k + 1) // 2) / zeros
            roots[k, 0] = given + (away if k % 2 == 1 else -away)
            roots[k, 1] = roots[k, 0]
    else:
        zeros, whole = isolate(E, shape, noise, GENERAL_SAMPLINGS, A, B, S, roots)
        clean = clean and whole
    x = np.empty(6)
    order = np.empty(6, np.int64)
    left = np.empty(14)
    trial = np.empty(6)
    rows = 0
    for k in range(zeros):
        clean = clean and roots[k, 0] == roots[k, 1]
        hidden = 0.5 * (roots[k, 0] + roots[k, 1])
        core(E, math.cos(hidden), math.sin(hidden), A, B, S)
        null_vector(S, x, order)
        third, fourth = half_angles(x, slide)
        remaining_joints(form, data[at.SIZE], X, hidden, third, fourth, left, trial)
        row, count = _admit(data, packed, T, trial, False, q, count)
        clean = clean and row >= 0 and not rows >> row & 1
        if row >= 0:
            rows |= 1 << row
            if void:
                break
    return clean, void, count


@inline
def _solve_slides(data, form, packed, T, back, seed, q, count):
    """Do for a form of an arm with two or three slides what :func:`_solve_form` does."""
    trials = np.empty((MAX_TRIALS, 6))
    found, clean, void = slide_postures(data, form, back, seed, trials)
    rows = 0
    for k in range(found):
        row, count = _admit(data, packed, T, trials[k], False, q, count)
        clean = clean and row >= 0 and not rows >> row & 1
        if row >= 0:
            rows |= 1 << row
            if void:
                break
    return clean, void, count


@inline
def _nudged(data, T, number, part, near):
    """Write the pose T, moved by a part of a nudge (number 0: not moved), to near (4, 4)."""
    u = _NUDGES[(number - 1) // 2]
    scale = part * (0.0 if number == 0 else 1.0 if number % 2 == 1 else -1.0)
    x, y, z = scale * u[0], scale * u[1], scale * u[2]
    square = x * x + y * y + z * z
    # Cayley's rotation, which needs no case for small angles.
    w = 1.0 / (1.0 + square)
    a, b = 2.0 * w, (1.0 - square) * w
    for j in range(3):
        p, q, r = T[0, j], T[1, j], T[2, j]
        along = a * (x * p + y * q + z * r)
        near[0, j] = b * p + along * x + a * (y * r - z * q)
        near[1, j] = b * q + along * y + a * (z * p - x * r)
        near[2, j] = b * r + along * z + a * (x * q - y * p)
        near[3, j] = 0.0
    scale *= data[at.SIZE]
    for i in range(3):
        near[i, 3] = T[i, 3] + scale * u[3 + i]
    near[3, 3] = 1.0


@inline
def _follow_back(data, packed, T, number, trial, q, count):
    """Follow a solution of a nudged pose, in ``trial``, to the pose T; return its row, count."""
    near = np.empty((4, 4))
    for fraction in NUDGE_PARTS:
        _nudged(data, T, number, fraction, near)
        call_polish(packed, near, trial, GENERAL_STEPS)
    row, count = _admit(data, packed, T, trial, True, q, count)
    if row < 0:
        # Where many solutions become one, Newton steps stop short of it.  Such postures are those
        # at which links line up or stand square.
        for j in range(6):
            if packed[j, 0] == 0.0:
                trial[j] = _EIGHTH * math.floor(trial[j] / _EIGHTH + 0.5)
        row, count = _admit(data, packed, T, trial, True, q, count)
    return row, count


@inline
def _classify(data, packed, T, q, branch, count):
    """Mark continua and folds; return which solutions are far from singular, as bits."""
    direction = np.empty(6)
    trial = np.empty(6)
    regular = 0
    for k in range(count):
        ratio = _regularity(data, packed, q[k], direction)
        if ratio > GENERAL_REGULAR:
            regular |= 1 << k
        if ratio > GENERAL_SINGULAR:
            continue
        bit = BOUNDARY
        for number in range(4):
            # Steps in several directions come back, each as near as it can.
            u = _NUDGES[number // 2]
            for j in range(6):
                move = u[j] if number % 2 == 0 else u[5 - j]
                if packed[j, 0] != 0.0:
                    move *= data[at.SIZE]
                trial[j] = q[k, j] + CONTINUUM_STEP * move / u[6]
            error = call_polish(packed, T, trial, GENERAL_STEPS_SINGULAR)
            if error <= ACCEPTED and _distance(data, packed, trial, q[k]) > CONTINUUM_KEPT:
                bit = SELF_MOTION
        branch[k] |= bit
    return regular


@inline
def _solve_at(data, packed, T, seed, q):
    """Write the solutions of the first clean form, or of all, to q.

    Returns whether one is clean, whether all are void, and how many solutions there are.
    """
    pose = np.empty(12)
    back = np.empty(12)
    demanded(data, T, pose, back)
    count = 0
    square = pose[3] * pose[3] + pose[7] * pose[7] + pose[11] * pose[11]
    if data[at.SLIDES] == 0.0 and not square <= 1.0 + ACCEPTED:
        # Farther away than the stretched arm reaches.
        return True, False, 0
    all_void = True
    for k in range(int(data[at.FORMS])):
        form = at.HEAD + k * at.FORM
        if data[at.SLIDES] <= 1.0:
            clean, void, count = _solve_form(data, form, packed, T, pose, back, seed, q, count)
        else:
            clean, void, count = _solve_slides(data, form, packed, T, back, seed, q, count)
        all_void = all_void and void
        if clean:
            return True, False, count
    return False, all_void, count


@kernel(i8(IN1, IN2, IN1, OUT2, IOUT1))
def solve_general(data, T, seed, q, branch):
    """Write all solutions for the pose T (4, 4) to q (16, 6) and branch (16,).

    Returns how many, plus DOUBT where the list may lack one.
    """
    packed = data[at.PACKED : at.HEAD].reshape(7, 13)
    near = np.empty((4, 4))
    others = np.empty((MAX_SOLUTIONS, 6))
    trial = np.empty(6)
    reached = np.zeros(_NUDGED, np.int64)
    count = 0
    untold = False
    # Number 0 is the pose itself.
    for number in range(_NUDGED):
        _nudged(data, T, number, 1.0, near)
        clean, void, found = _solve_at(data, packed, near, seed, others)
        untold = untold or (number == 0 and void)
        rows = 0
        for k in range(found):
            for j in range(6):
                trial[j] = others[k, j]
            if number == 0 and clean:
                row, count = k, found
                for j in range(6):
                    q[k, j] = trial[j]
            else:
                row, count = _follow_back(data, packed, T, number, trial, q, count)
            if row >= 0:
                rows |= 1 << row
            else:
                # It has met another one on the way: there is more at this pose than folds.
                clean = False
        reached[number] = _IS_CLEAN | rows if clean else 0
        if number == 0 and clean:
            break
        if number % 2 == 0 and number > 0 and clean and reached[number] == reached[number - 1]:
            if reached[number] == _IS_CLEAN | ((1 << count) - 1):
                # Both ways led to all that is known.
                break
    for k in range(count):
        branch[k] = POSTURE_NUMBERED | (k << ARM_SHIFT)
    if reached[0] & _IS_CLEAN:
        return count
    wanted = _IS_CLEAN | _classify(data, packed, T, q, branch, count)
    for pair in range(1, _NUDGED, 2):
        if not untold and count > 0 and reached[pair] & reached[pair + 1] & wanted == wanted:
            return count
    return count | DOUBT


call_general = linked(solve_general)
