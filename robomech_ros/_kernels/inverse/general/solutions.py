"""All solutions of any six-joint arm.

The forms of the arm are tried, the best first, until one is clean: its elimination is regular,
its determinant is well above rounding, and all postures of each zero or cluster of zeros have been
found.  Then the list is complete.

With parallel or perpendicular links that may fail for every form.  Then the pose is nudged in both
senses to neighbouring poses that are solved cleanly, and their solutions settle back.  A solution
with a regular Jacobian has a neighbour at every nearby pose, so it cannot be missed.  A fold has
two neighbours on one side; if more solutions have merged, the determinant of the neighbouring pose
at least comes near zero, and postures are sought there, too.  The list counts as complete if a
nudge and its opposite were clean, none of their solutions was lost, and both led to all solutions
far from singular; but not if the determinant of every form vanishes at all angles, as with a free
joint.
"""

import math

import numpy as np
from numba import types

from robomech_ros._kernels.algebra.angles import wrapped
from robomech_ros._kernels.compiling.jit import inline, kernel, linked, part
from robomech_ros._kernels.compiling.types import IN1, IN2, IOUT1, OUT2, b1, i8
from robomech_ros._kernels.inverse import branch_bits as bit
from robomech_ros._kernels.inverse.general import layout as at
from robomech_ros._kernels.inverse.general.equations import required_pose
from robomech_ros._kernels.inverse.general.forms import (
    COUNT,
    CROWDED,
    EFFORT,
    GENERAL_STEPS,
    LOOSE,
    MAX_LOOSE,
    MAX_SOLUTIONS as MAX_SOLUTIONS,
    STATE,
    admit,
    solve_form,
    solve_slides,
)
from robomech_ros._kernels.inverse.general.multiplicity import MIN_FOLD_SLOPE, all_simple
from robomech_ros._kernels.inverse.general.singular_postures import (
    distance,
    is_in_continuum,
    regularity,
)
from robomech_ros._kernels.inverse.polishing import call_polish
from robomech_ros._kernels.tolerances import ACCEPTED, GENERAL_SINGULAR

# Ratio of pivots of a Jacobian (lengths over the size) above which a posture counts as far from
# singular.
GENERAL_REGULAR = 2e-2
# The same ratio below which rounding moves a posture by SAME_POSTURE or more; with slides hundreds
# of sizes out it is about 1e-8.
GENERAL_LOST = 1e-10
# Least slope (as MIN_FOLD_SLOPE) at settled solutions without a third one nearby.
FOLD_SHARP = 1e-2
# Number of starts of a search if no solution was found.
GENERAL_STARTS = 32
# Largest distance (rad) of a regular solution from that of a nudged pose.
NUDGED_AWAY = 0.2
# Fractions of the nudge at which a posture is followed back if it does not settle at once.
NUDGE_PARTS = (0.5, 0.25, 0.125, 0.06, 2e-2, 4e-3, 4e-4, 4e-5, 4e-6)

# Strides of an additive low-discrepancy sequence in six joints: powers of the root of x^7 = x + 1.
_STRIDES = tuple(1.1127756842787055 ** -(j + 1) for j in range(6))
# Added to the bits of the rows reached.
_IS_CLEAN = 1 << 16
# Nudges of a pose: rotation (rad), and translation over the size, used in both senses.  The first
# is small enough for all solutions to be near, the others large enough to leave a degenerate pose.
_NUDGES = (
    (-0.5e-4, 0.8e-4, 0.4e-4, 0.3e-4, -0.9e-4, 0.6e-4),
    (1.1e-3, -0.7e-3, 0.8e-3, 0.9e-3, 0.5e-3, -1.2e-3),
    (1.5e-2, 0.9e-2, -1.2e-2, 0.7e-2, -1.6e-2, 1.0e-2),
)
# Number of poses; the pose itself has index 0.
_NUDGED = 1 + 2 * len(_NUDGES)


@inline
def _nudged(data, T, number, part, near):
    """Write the pose T, moved by ``part`` of nudge ``number`` (0: not moved), to near (4, 4)."""
    u = _NUDGES[(number - 1) // 2]
    scale = part * (0.0 if number == 0 else 1.0 if number % 2 == 1 else -1.0)
    x, y, z = scale * u[0], scale * u[1], scale * u[2]
    square = x * x + y * y + z * z
    # Cayley's rotation needs no case for small angles.
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
def _follow_back(data, T, number, start, trial, q, marks, state):
    """Follow a solution of a nudged pose, ``start``, to the pose T; return its row, -1 for none.

    A regular solution takes a few Newton steps and is near; any other one settles.
    """
    packed = data[at.PACKED : at.HEAD].reshape(7, 13)
    for j in range(6):
        trial[j] = start[j]
    if call_polish(packed, T, trial, GENERAL_STEPS) <= ACCEPTED:
        if distance(data, trial, start) < NUDGED_AWAY:
            _, ratio = regularity(data, packed, trial, np.empty(6), np.empty(6))
            if ratio > GENERAL_REGULAR:
                return admit(data, T, trial, False, q, marks, state)
    for j in range(6):
        trial[j] = start[j]
    row = admit(data, T, trial, True, q, marks, state)
    if row >= 0:
        return row
    near = np.empty((4, 4))
    for j in range(6):
        trial[j] = start[j]
    for fraction in NUDGE_PARTS:
        _nudged(data, T, number, fraction, near)
        call_polish(packed, near, trial, GENERAL_STEPS)
    return admit(data, T, trial, True, q, marks, state)


@part(i8(IN1, IN2, OUT2, IOUT1, IOUT1))
def _classify(data, T, q, marks, state):
    """Mark continua and folds; return the bits of the solutions that are far from singular."""
    packed = data[at.PACKED : at.HEAD].reshape(7, 13)
    u, v = np.empty(6), np.empty(6)
    regular = 0
    for k in range(state[COUNT]):
        fifth, ratio = regularity(data, packed, q[k], u, v)
        if ratio > GENERAL_REGULAR:
            regular |= 1 << k
        if ratio < GENERAL_SINGULAR and marks[k] == 0:
            free = is_in_continuum(data, T, q[k], u, v, fifth)
            marks[k] = bit.SELF_MOTION if free else bit.BOUNDARY
    return regular


@part(types.UniTuple(b1, 2)(IN1, IN2, IN1, OUT2, IOUT1, IOUT1, OUT2))
def _solve_at(data, T, seed, q, marks, state, loose):
    """Enter the solutions of the forms in q, up to the first clean one.

    Returns whether a form is clean, and whether all are void.
    """
    pose = np.empty(12)
    back = np.empty(12)
    required_pose(data, T, pose, back)
    square = pose[3] * pose[3] + pose[7] * pose[7] + pose[11] * pose[11]
    if data[at.SLIDES] == 0.0 and not square <= 1.0 + ACCEPTED:
        # The target is out of reach of the stretched arm.
        return True, False
    all_void = True
    for k in range(int(data[at.FORMS])):
        form = at.HEAD + k * at.FORM
        if data[at.SLIDES] <= 1.0:
            clean, void = solve_form(data, form, T, pose, back, seed, q, marks, state, loose)
        else:
            clean, void = solve_slides(data, form, T, back, seed, q, marks, state)
        all_void = all_void and void
        if clean:
            return True, False
    return False, all_void


@part(b1(IN1, IN2, IN1, b1, OUT2, IOUT1, IOUT1))
def _solve_nudged(data, T, seed, void, q, marks, state):
    """Enter the solutions reached from neighbouring poses; return whether they are all.

    If every form is ``void`` at T itself, nothing is proved, and more neighbours are solved.
    """
    near = np.empty((4, 4))
    trial = np.empty(6)
    others = np.empty((MAX_SOLUTIONS, 6))
    other_marks = np.empty(MAX_SOLUTIONS, np.int64)
    loose = np.empty((MAX_LOOSE, 6))
    nudged_state = np.zeros(STATE, np.int64)
    reached = np.zeros(_NUDGED, np.int64)
    for number in range(1, _NUDGED):
        _nudged(data, T, number, 1.0, near)
        for k in range(STATE):
            nudged_state[k] = 0
        if number > 4:
            # The determinant at a pose so far away is not conclusive for this one.
            nudged_state[LOOSE] = -1
        clean, _ = _solve_at(data, near, seed, others, other_marks, nudged_state, loose)
        rows = 0
        for k in range(nudged_state[COUNT]):
            row = _follow_back(data, T, number, others[k], trial, q, marks, state)
            if row >= 0:
                rows |= 1 << row
            else:
                # This pose has merged solutions other than folds.
                clean = False
        for k in range(nudged_state[LOOSE]):
            admit(data, T, loose[k], True, q, marks, state)
        reached[number] = _IS_CLEAN | rows if clean else 0
        if number % 2 == 1 or not clean:
            continue
        wanted = _IS_CLEAN | _classify(data, T, q, marks, state)
        if reached[number] & reached[number - 1] & wanted == wanted:
            # Both senses led to all known regular solutions.
            if not void:
                return True
            if number > 2:
                return False
    return False


@part(types.void(IN1, IN2, IN1, OUT2, IOUT1, IOUT1))
def _search(data, T, seed, q, marks, state):
    """Settle from the seed and from a low-discrepancy sequence until a posture is found."""
    trial = np.empty(6)
    for k in range(GENERAL_STARTS):
        for j in range(6):
            turn = wrapped(2.0 * math.pi * k * _STRIDES[j])
            if data[at.PACKED + 13 * j] == 0.0:
                trial[j] = wrapped(seed[j] + turn)
            else:
                trial[j] = seed[j] + turn / math.pi * data[at.SIZE]
        if admit(data, T, trial, True, q, marks, state) >= 0:
            break


@inline
def _reset(state):
    """Reset ``state`` for a new pose, without loose postures; return it."""
    for k in range(STATE):
        state[k] = 0
    state[LOOSE] = -1
    return state


@kernel(types.Tuple((b1, i8))(IN1, IN2, IN1))
def try_forms(data, T, seed):
    """Solve for the pose T (4, 4) without neighbours; return whether a form is clean, and effort.

    The effort is ``forms.EFFORT``, a count that does not depend on the machine.
    """
    state = _reset(np.empty(STATE, np.int64))
    marks = np.empty(MAX_SOLUTIONS, np.int64)
    q = np.empty((MAX_SOLUTIONS, 6))
    clean, _ = _solve_at(data, T, seed, q, marks, state, q)
    return clean, state[EFFORT]


@kernel(i8(IN1, IN2, IN1, OUT2, IOUT1))
def solve_general(data, T, seed, q, branch):
    """Write all solutions for the pose T (4, 4) to q (16, 6) and branch (16,).

    Returns their number, plus DOUBT if the list may be incomplete.
    """
    state = _reset(np.empty(STATE, np.int64))
    marks = np.empty(MAX_SOLUTIONS, np.int64)
    packed = data[at.PACKED : at.HEAD].reshape(7, 13)
    size = data[at.SIZE]
    slides = data[at.SLIDES] > 0.0
    clean, void = _solve_at(data, T, seed, q, marks, state, q)
    if slides and clean:
        # A simple zero has a simple posture.
        clean = all_simple(packed, size, q, marks, 0, state[COUNT], GENERAL_LOST, MIN_FOLD_SLOPE)
    if not clean:
        clean = _solve_nudged(data, T, seed, void, q, marks, state)
        if slides and clean:
            # Far along a continuum of slides it may not be detected as one.
            clean = all_simple(packed, size, q, marks, 0, state[COUNT], GENERAL_REGULAR, FOLD_SHARP)
        if state[COUNT] == 0:
            clean = False
            _search(data, T, seed, q, marks, state)
        _classify(data, T, q, marks, state)
    elif state[CROWDED]:
        _classify(data, T, q, marks, state)
    count = state[COUNT]
    for k in range(count):
        branch[k] = bit.POSTURE_NUMBERED | (k << bit.ARM_SHIFT) | marks[k]
    return count if clean else count | bit.DOUBT


call_general = linked(solve_general)
