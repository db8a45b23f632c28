"""Solutions of one form of elimination for a pose, and a test of their completeness.

A simple zero of the determinant has one posture.  For a cluster of zeros the rank of the matrix
decides.  If it is clearly five, all zeros belong to one posture or to several merged ones, as at a
fold; if it is four, to at most two postures, which :mod:`.pencil` finds.
"""

import math

import numpy as np
from numba import types

from robomech_ros._kernels.algebra.angles import wrapped
from robomech_ros._kernels.compiling.jit import inline, part
from robomech_ros._kernels.compiling.types import IN1, IN2, IOUT1, OUT1, OUT2, b1, i8
from robomech_ros._kernels.inverse.branch_bits import BOUNDARY, SELF_MOTION
from robomech_ros._kernels.inverse.general import layout as at
from robomech_ros._kernels.inverse.general.determinant import null_space, reduced_matrix
from robomech_ros._kernels.inverse.general.equations import (
    complete_form,
    free_equations,
    right_side,
)
from robomech_ros._kernels.inverse.general.pencil import MAX_VECTORS, pencil_vectors
from robomech_ros._kernels.inverse.general.posture import half_angles, remaining_joints
from robomech_ros._kernels.inverse.general.roots import MAX_ROOTS, isolate, near_zeros, sample
from robomech_ros._kernels.inverse.general.singular_postures import (
    distance,
    is_between,
    is_in_continuum,
    regularity,
    settle,
)
from robomech_ros._kernels.inverse.general.slides import (
    GENERAL_FREE_VALUES,
    GENERAL_VOID,
    MAX_TRIALS,
    slide_postures,
)
from robomech_ros._kernels.inverse.polishing import call_polish
from robomech_ros._kernels.tolerances import ACCEPTED, GENERAL_SINGULAR, SAME_POSTURE

# Least independence of the unknowns that a form eliminates.
GENERAL_MARGIN = 1e-6
# Largest number of samplings of one determinant: ten times the need of any regular pose of the
# tested arms.
GENERAL_SAMPLINGS = 16
# All postures of a cluster of zeros are one, or indistinguishable, if the next pivot of the matrix
# (of the first) exceeds this times the width of the cluster (rad).
CLUSTER_GAP = 100.0
# Least pivot for that test if the cluster is narrower than the rounding of a pivot.
CLUSTER_MIN_GAP = 1e-6
# Widest cluster (rad) for that test; at a fold it is about 1e-5 wide.
CLUSTER_WIDTH = 5e-5
# Below this pivot (of the first) two postures are sought.
CLUSTER_PENCIL = 5e-2
# Newton steps for a posture from a simple zero.
GENERAL_STEPS = 12
# Accepted error (rad, and lengths over a size beyond a metre): far less than ACCEPTED, since its
# m-th root is the error of a posture in which m solutions have merged.
GENERAL_ERROR = 1e-11
# Singular postures nearer to each other than this (rad) are one: some square roots of the pose's
# rounding; with another one halfway between them, up to a higher root of it.
SAME_SINGULAR = 1e-5
SAME_MULTIPLE = 5e-2
# Largest number of solutions of one pose that represent continua, so that others fit in the list.
MAX_CONTINUA = 6

MAX_SOLUTIONS = 16
# Largest number of loose postures, at which the determinant only comes near zero.
MAX_LOOSE = 16

# Entries of ``state``: numbers of solutions, of solutions in a continuum and of loose postures (-1
# if not collected); 1 after a cluster of zeros; and the sum of samplings of a determinant, left
# sides and settlings, which take equal times and nearly all of the time.
COUNT = 0
CONTINUA = 1
LOOSE = 2
CROWDED = 3
EFFORT = 4
STATE = 5


@inline
def _enter(trial, mark, q, marks, state):
    """Enter a solution; return its row, or -1 if the list is full."""
    count = state[COUNT]
    if count >= MAX_SOLUTIONS:
        return -1
    for j in range(6):
        q[count, j] = trial[j]
    marks[count] = mark
    state[COUNT] += 1
    return count


@part(i8(IN1, IN2, OUT1, b1, OUT2, IOUT1, IOUT1))
def admit(data, T, trial, singular, q, marks, state):
    """Improve a posture and enter it if it is a new solution; return its row, -1 for none.

    The more solutions have merged in a ``singular`` posture, the larger its error.  Its entry in
    ``marks`` (16,) is BOUNDARY or SELF_MOTION, else 0.
    """
    packed = data[at.PACKED : at.HEAD].reshape(7, 13)
    if singular:
        state[EFFORT] += 1
        error = settle(data, T, trial, False)
    else:
        error = call_polish(packed, T, trial, GENERAL_STEPS)
    if not error <= min(ACCEPTED, GENERAL_ERROR * max(1.0, data[at.SIZE])):
        return -1
    for j in range(6):
        if packed[j, 0] == 0.0:
            trial[j] = wrapped(trial[j])
    count = state[COUNT]
    if not singular:
        for k in range(count):
            if distance(data, q[k], trial) < SAME_POSTURE:
                return k
        return _enter(trial, 0, q, marks, state)
    u, v = np.empty(6), np.empty(6)
    w, x = np.empty(6), np.empty(6)
    fifth, ratio = regularity(data, packed, trial, u, v)
    for k in range(count):
        apart = distance(data, q[k], trial)
        if apart < SAME_SINGULAR:
            return k
        if apart < SAME_MULTIPLE and is_between(data, T, q[k], trial, w):
            _, other = regularity(data, packed, q[k], w, x)
            if ratio < other:
                # The more singular posture is nearer to the merged solution.
                for j in range(6):
                    q[k, j] = trial[j]
            return k
    if ratio > GENERAL_SINGULAR:
        return _enter(trial, 0, q, marks, state)
    if not is_in_continuum(data, T, trial, u, v, fifth):
        return _enter(trial, BOUNDARY, q, marks, state)
    if state[CONTINUA] >= MAX_CONTINUA:
        return -1
    state[CONTINUA] += 1
    return _enter(trial, SELF_MOTION, q, marks, state)


@inline
def _cluster_vectors(width, S, vectors, order):
    """Write candidate null vectors of a cluster of zeros to ``vectors`` (1 + MAX_VECTORS, 6).

    Returns their number, the range of those that must lead to postures, and whether the cluster is
    then complete.
    """
    u, v = np.empty(6), np.empty(6)
    fourth, fifth, _ = null_space(S, vectors[0], u, v, order)
    gap = CLUSTER_GAP * width + CLUSTER_MIN_GAP
    narrow = width < CLUSTER_WIDTH
    if fifth > max(gap, CLUSTER_PENCIL):
        return 1, 0, 1, narrow
    slack = 10.0 * width / max(fourth, CLUSTER_MIN_GAP) + CLUSTER_MIN_GAP
    found, whole = pencil_vectors(u, v, slack, vectors[1:])
    if fifth > gap:
        return 1 + found, 0, 1, narrow
    return 1 + found, 1, 1 + found, narrow and whole and fourth > gap


@inline
def _write_equations(form, X, E):
    """Write both sides' equations of a complete form to X (14, 3) and E (6, 27).

    Returns whether the eliminated unknowns are independent.
    """
    slide = int(form[at.SLIDE])
    V = np.empty((3, 14))
    before, behind = form[at.BEFORE : at.BEFORE + 12], form[at.BEHIND : at.BEHIND + 12]
    right_side(before, behind, slide == at.FIRST, X, V)
    K = form[at.EQUATIONS :].reshape(at.N_EQUATIONS, at.N_COLUMNS)
    return free_equations(K, X, slide, E) > GENERAL_MARGIN


@inline
def _matrix(matrices, hidden):
    """Write the matrix at a value of the hidden joint, and return it.

    ``matrices`` are the equations, working space for their two halves, and the matrix.
    """
    E, A, B, S = matrices
    reduced_matrix(E, math.cos(hidden), math.sin(hidden), A, B, S)
    return S


@inline
def _posture(closure, hidden, vector, trial):
    """Write the joints for a value of the hidden one and a null vector to trial (6,).

    ``closure`` is the complete form, the arm's size, the right side and working space.
    """
    form, size, X, left = closure
    third, fourth = half_angles(vector, int(form[at.SLIDE]))
    remaining_joints(form, size, X, hidden, third, fourth, left, trial)


@inline
def _only_posture(closure, matrices, hidden, vectors, order, trial):
    """Write the only posture at a value of the hidden joint to trial (6,)."""
    null_space(_matrix(matrices, hidden), vectors[0], vectors[1], vectors[2], order)
    _posture(closure, hidden, vectors[0], trial)


@inline
def _free_values(start, roots):
    """Write values to try for a free hidden joint to roots (MAX_ROOTS, 2); return their number."""
    for k in range(GENERAL_FREE_VALUES):
        away = 2.0 * math.pi * ((k + 1) // 2) / GENERAL_FREE_VALUES
        roots[k, 0] = start + (away if k % 2 == 1 else -away)
        roots[k, 1] = roots[k, 0]
    return GENERAL_FREE_VALUES


@inline
def _enter_cluster(data, T, closure, matrices, low, high, vectors, order, trial, q, marks, state):
    """Enter the postures of a cluster of zeros; return whether these are proved to be all."""
    width = high - low
    hidden = low + 0.5 * width
    S = _matrix(matrices, hidden)
    found, first, end, proven = _cluster_vectors(width, S, vectors, order)
    # With a slide some zeros may be at infinity, which the matrix does not show.
    proven = proven and closure[0][at.SLIDE] < 0.0
    regular = False
    for i in range(found):
        _posture(closure, hidden, vectors[i], trial)
        row = admit(data, T, trial, True, q, marks, state)
        proven = proven and (row >= 0 or not first <= i < end)
        regular = regular or (row >= 0 and marks[row] == 0)
    if found > 1 or regular or width > CLUSTER_WIDTH:
        # Postures that have nearly merged, or have nearly the same hidden angle.
        for end_of_cluster in (low, high):
            _only_posture(closure, matrices, end_of_cluster, vectors, order, trial)
            admit(data, T, trial, True, q, marks, state)
    return proven


@inline
def _enter_zeros(data, T, closure, matrices, roots, zeros, vectors, order, trial, q, marks, state):
    """Enter the postures of all zeros; return whether all postures of each zero were found."""
    clean = True
    rows = 0
    for k in range(zeros):
        if roots[k, 1] > roots[k, 0]:
            state[CROWDED] = 1
            low, high = roots[k, 0], roots[k, 1]
            proven = _enter_cluster(
                data, T, closure, matrices, low, high, vectors, order, trial, q, marks, state
            )
            clean = clean and proven
            continue
        _only_posture(closure, matrices, roots[k, 0], vectors, order, trial)
        row = admit(data, T, trial, False, q, marks, state)
        if row < 0:
            row = admit(data, T, trial, True, q, marks, state)
        clean = clean and row >= 0 and not rows >> row & 1
        if row >= 0:
            rows |= 1 << row
    return clean


@inline
def _enter_free(data, T, closure, matrices, roots, zeros, vectors, order, trial, q, marks, state):
    """Enter postures at values of a free hidden joint until a continuum is found."""
    for k in range(zeros):
        S = _matrix(matrices, roots[k, 0])
        found, _, _, _ = _cluster_vectors(0.0, S, vectors, order)
        for i in range(found):
            _posture(closure, roots[k, 0], vectors[i], trial)
            admit(data, T, trial, True, q, marks, state)
        if state[CONTINUA] > 0:
            break


@inline
def _collect_loose(closure, matrices, places, zeros, vectors, order, state, loose):
    """Write postures at which the determinant only comes near zero to ``loose``."""
    for k in range(zeros):
        S = _matrix(matrices, places[k])
        found, _, _, _ = _cluster_vectors(0.0, S, vectors, order)
        for i in range(found):
            if state[LOOSE] < MAX_LOOSE:
                _posture(closure, places[k], vectors[i], loose[state[LOOSE]])
                state[LOOSE] += 1


@part(types.UniTuple(b1, 2)(IN1, i8, IN2, OUT1, OUT1, IN1, OUT2, IOUT1, IOUT1, OUT2))
def solve_form(data, start, T, pose, back, seed, q, marks, state, loose):
    """Enter the solutions of the form at ``start`` for T (4, 4); return if it is clean, and void.

    ``pose`` (12,) and ``back`` (12,) are the pose of the joints for T, and its inverse.  A form is
    void if its determinant vanishes at all angles: the hidden joint may be free.  The seed's value
    and others are then tried until a continuum is found.  Postures at which the determinant only
    comes near zero go to ``loose`` (MAX_LOOSE, 6) if requested.
    """
    form, X = np.empty(at.FORM), np.empty((14, 3))
    E, A, B = np.empty((6, at.N_COLUMNS)), np.empty((6, 9)), np.empty((6, 9))
    S, shape = np.empty((6, 6)), np.empty((2, 9))
    roots = np.empty((MAX_ROOTS, 2))
    vectors, order = np.empty((1 + MAX_VECTORS, 6)), np.empty(6, np.int64)
    trial = np.empty(6)
    closure, matrices = (form, data[at.SIZE], X, np.empty(14)), (E, A, B, S)
    complete_form(data, start, pose, back, form)
    regular = _write_equations(form, X, E)
    largest, noise = sample(E, shape, A, B, S)
    state[EFFORT] += 1 if form[at.TARGET] == 0.0 or form[at.TARGET] == 5.0 else 2
    if not largest > GENERAL_VOID * noise:
        joint = int(form[at.JOINTS + at.HIDDEN])
        zeros = _free_values(form[at.SENSE] * seed[joint], roots)
        _enter_free(
            data, T, closure, matrices, roots, zeros, vectors, order, trial, q, marks, state
        )
        return False, True
    zeros, whole, samplings = isolate(E, shape, noise, GENERAL_SAMPLINGS, A, B, S, roots)
    state[EFFORT] += samplings
    clean = _enter_zeros(
        data, T, closure, matrices, roots, zeros, vectors, order, trial, q, marks, state
    )
    if state[LOOSE] >= 0:
        zeros = near_zeros(shape, roots[:, 0])
        _collect_loose(closure, matrices, roots[:, 0], zeros, vectors, order, state, loose)
    return regular and whole and clean, False


@part(types.UniTuple(b1, 2)(IN1, i8, IN2, OUT1, IN1, OUT2, IOUT1, IOUT1))
def solve_slides(data, form, T, back, seed, q, marks, state):
    """Enter the solutions of a form with two or three slides; returns as :func:`solve_form`."""
    trials = np.empty((MAX_TRIALS, 6))
    found, clean, void = slide_postures(data, form, back, seed, trials)
    rows = 0
    for k in range(found):
        row = admit(data, T, trials[k], False, q, marks, state)
        if row < 0 and not void:
            row = admit(data, T, trials[k], True, q, marks, state)
        clean = clean and row >= 0 and not rows >> row & 1
        if row >= 0:
            rows |= 1 << row
            if void:
                break
    return clean, void
