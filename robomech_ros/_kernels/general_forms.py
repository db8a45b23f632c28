"""The solutions that one form of elimination finds for a pose, and whether they are all.

A simple zero of the determinant has a posture of its own.  Where zeros crowd together the matrix
tells: if it has lost one rank, and no other by a wide margin, all of them belong to one posture,
or to several that have merged into it, as at a fold; if two, to the two at most that
:mod:`general_pencil` finds.
"""

import math

import numpy as np
from numba import types

from robomech_ros._kernels import general_layout as at
from robomech_ros._kernels._jit import IN1, IN2, IOUT1, OUT1, OUT2, b1, i8, inline, part
from robomech_ros._kernels.angles import wrapped
from robomech_ros._kernels.branch_bits import BOUNDARY, SELF_MOTION
from robomech_ros._kernels.general_determinant import core, null_space
from robomech_ros._kernels.general_equations import complete_form, free_equations, right_side
from robomech_ros._kernels.general_pencil import MOST_VECTORS, pencil_vectors
from robomech_ros._kernels.general_posture import half_angles, remaining_joints
from robomech_ros._kernels.general_roots import MAX_ROOTS, isolate, near_zeros, sample
from robomech_ros._kernels.general_settling import (
    distance,
    is_between,
    is_in_continuum,
    regularity,
    settle,
)
from robomech_ros._kernels.general_slides import MAX_TRIALS, slide_postures
from robomech_ros._kernels.polishing import call_polish
from robomech_ros._kernels.tolerances import (
    ACCEPTED,
    CLUSTER_GAP,
    CLUSTER_LEAST_GAP,
    CLUSTER_PENCIL,
    CLUSTER_WIDTH,
    GENERAL_ERROR,
    GENERAL_FREE_VALUES,
    GENERAL_MARGIN,
    GENERAL_SAMPLINGS,
    GENERAL_SINGULAR,
    GENERAL_STEPS,
    GENERAL_VOID,
    MOST_CONTINUA,
    SAME_MULTIPLE,
    SAME_POSTURE,
    SAME_SINGULAR,
)

__all__ = [
    "CONTINUA",
    "COUNT",
    "CROWDED",
    "LOOSE",
    "MAX_SOLUTIONS",
    "MOST_LOOSE",
    "STATE",
    "admit",
    "solve_form",
    "solve_slides",
]

MAX_SOLUTIONS = 16
# Places near which a posture may be where the determinant only comes near zero.
MOST_LOOSE = 16

# Entries of ``state``: solutions; those entered as parts of a continuum; loose postures, -1 where
# none are wanted; 1 where zeros crowded together.
COUNT = 0
CONTINUA = 1
LOOSE = 2
CROWDED = 3
STATE = 4


@inline
def _entered(trial, mark, q, marks, state):
    """Enter a solution; return its row, -1 where there is no room."""
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

    A ``singular`` one settles at some distance, the farther the more solutions have become one;
    its entry in ``marks`` (16,) is then BOUNDARY or SELF_MOTION, else 0.
    """
    packed = data[at.PACKED : at.HEAD].reshape(7, 13)
    if singular:
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
        return _entered(trial, 0, q, marks, state)
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
                # The more singular of the two is the nearer to where they have become one.
                for j in range(6):
                    q[k, j] = trial[j]
            return k
    if ratio > GENERAL_SINGULAR:
        return _entered(trial, 0, q, marks, state)
    if not is_in_continuum(data, T, trial, u, v, fifth):
        return _entered(trial, BOUNDARY, q, marks, state)
    if state[CONTINUA] >= MOST_CONTINUA:
        return -1
    state[CONTINUA] += 1
    return _entered(trial, SELF_MOTION, q, marks, state)


@inline
def _cluster_vectors(width, S, vectors, order):
    """Write null vectors to try for a cluster of zeros to ``vectors`` (1 + MOST_VECTORS, 6).

    Returns how many there are, the range of those that must lead to postures for the cluster to be
    done with, and whether that is then so.
    """
    u, v = np.empty(6), np.empty(6)
    fourth, fifth, _ = null_space(S, vectors[0], u, v, order)
    gap = CLUSTER_GAP * width + CLUSTER_LEAST_GAP
    narrow = width < CLUSTER_WIDTH
    if fifth > max(gap, CLUSTER_PENCIL):
        return 1, 0, 1, narrow
    slack = 10.0 * width / max(fourth, CLUSTER_LEAST_GAP) + CLUSTER_LEAST_GAP
    found, whole = pencil_vectors(u, v, slack, vectors[1:])
    if fifth > gap:
        return 1 + found, 0, 1, narrow
    return 1 + found, 1, 1 + found, narrow and whole and fourth > gap


@inline
def _posture(form, size, X, hidden, vector, left, trial):
    """Write the joints that belong to a value of the hidden one and a null vector to trial (6,)."""
    third, fourth = half_angles(vector, int(form[at.SLIDE]))
    remaining_joints(form, size, X, hidden, third, fourth, left, trial)


@inline
def _free_values(start, roots):
    """Write values for a hidden joint that may be free to roots (MAX_ROOTS, 2); return how many."""
    for k in range(GENERAL_FREE_VALUES):
        away = 2.0 * math.pi * ((k + 1) // 2) / GENERAL_FREE_VALUES
        roots[k, 0] = start + (away if k % 2 == 1 else -away)
        roots[k, 1] = roots[k, 0]
    return GENERAL_FREE_VALUES


@part(types.UniTuple(b1, 2)(IN1, i8, IN2, OUT1, OUT1, IN1, OUT2, IOUT1, IOUT1, OUT2))
def solve_form(data, start, T, pose, back, seed, q, marks, state, loose):
    """Enter the solutions that the form at ``start`` finds for T (4, 4); is it clean, and void.

    ``pose`` (12,) and ``back`` (12,) are what T demands of the joints, and its inverse.  Void is a
    form whose determinant vanishes all round: the hidden joint may be free.  It is then given the
    seed's value, and others, until there is a continuum.  Postures at which the
    determinant only comes near zero go to ``loose`` (MOST_LOOSE, 6) where that is wanted.
    """
    form = np.empty(at.FORM)
    complete_form(data, start, pose, back, form)
    slide, size = int(form[at.SLIDE]), data[at.SIZE]
    X = np.empty((14, 3))
    V = np.empty((3, 14))
    before, behind = form[at.BEFORE : at.BEFORE + 12], form[at.BEHIND : at.BEHIND + 12]
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
        joint = int(form[at.JOINTS + at.HIDDEN])
        zeros = _free_values(form[at.SENSE] * seed[joint], roots)
    else:
        zeros, whole = isolate(E, shape, noise, GENERAL_SAMPLINGS, A, B, S, roots)
        clean = clean and whole
    vectors = np.empty((1 + MOST_VECTORS, 6))
    order = np.empty(6, np.int64)
    left = np.empty(14)
    trial = np.empty(6)
    rows = 0
    for k in range(zeros):
        width = roots[k, 1] - roots[k, 0]
        hidden = roots[k, 0] + 0.5 * width
        core(E, math.cos(hidden), math.sin(hidden), A, B, S)
        if width > 0.0:
            state[CROWDED] = 1
            found, first, end, proven = _cluster_vectors(width, S, vectors, order)
            # With a slide some of the zeros may be at infinity, of which the matrix tells nothing.
            proven = proven and slide < 0
            for i in range(found):
                _posture(form, size, X, hidden, vectors[i], left, trial)
                row = admit(data, T, trial, True, q, marks, state)
                proven = proven and (row >= 0 or not first <= i < end)
            clean = clean and proven
            for i in range(2 if found > 1 or width > CLUSTER_WIDTH else 0):
                # Postures that have nearly merged, or share nearly the same hidden angle.
                hidden = roots[k, i]
                core(E, math.cos(hidden), math.sin(hidden), A, B, S)
                null_space(S, vectors[0], vectors[1], vectors[2], order)
                _posture(form, size, X, hidden, vectors[0], left, trial)
                admit(data, T, trial, True, q, marks, state)
            continue
        if void:
            found, _, _, _ = _cluster_vectors(0.0, S, vectors, order)
            for i in range(found):
                _posture(form, size, X, hidden, vectors[i], left, trial)
                admit(data, T, trial, True, q, marks, state)
            if state[CONTINUA] > 0:
                break
            continue
        null_space(S, vectors[0], vectors[1], vectors[2], order)
        _posture(form, size, X, hidden, vectors[0], left, trial)
        row = admit(data, T, trial, False, q, marks, state)
        if row < 0:
            row = admit(data, T, trial, True, q, marks, state)
        clean = clean and row >= 0 and not rows >> row & 1
        if row >= 0:
            rows |= 1 << row
    if state[LOOSE] >= 0 and not void:
        zeros = near_zeros(shape, roots[:, 0])
        for k in range(zeros):
            hidden = roots[k, 0]
            core(E, math.cos(hidden), math.sin(hidden), A, B, S)
            found, _, _, _ = _cluster_vectors(0.0, S, vectors, order)
            for i in range(found):
                if state[LOOSE] < MOST_LOOSE:
                    place = loose[state[LOOSE]]
                    _posture(form, size, X, hidden, vectors[i], left, place)
                    state[LOOSE] += 1
    return clean, void


@part(types.UniTuple(b1, 2)(IN1, i8, IN2, OUT1, IN1, OUT2, IOUT1, IOUT1))
def solve_slides(data, form, T, back, seed, q, marks, state):
    """Do for a form of an arm with two or three slides what :func:`solve_form` does."""
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
