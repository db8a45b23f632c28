"""Check poses from outside and make their rotations orthogonal to rounding."""

import math

import numpy as np

from robomech_ros._kernels.compiling.jit import inline, kernel
from robomech_ros._kernels.compiling.types import OUT3, f8, i8
from robomech_ros._kernels.tolerances import LARGEST_LENGTH, ORTHOGONAL

NOT_FINITE = 1
NOT_RIGID = 2
IMPROPER = 3
TOO_FAR = 4


@inline
def _gram(T, G):
    """Write R^T R of the pose T to G and return its largest difference from 1."""
    worst = 0.0
    for i in range(3):
        for j in range(3):
            value = 0.0
            for k in range(3):
                value += T[k, i] * T[k, j]
            G[i, j] = value
            worst = max(worst, abs(value - (1.0 if i == j else 0.0)))
    return worst


@inline
def _determinant(T):
    value = T[0, 0] * (T[1, 1] * T[2, 2] - T[1, 2] * T[2, 1])
    value -= T[0, 1] * (T[1, 0] * T[2, 2] - T[1, 2] * T[2, 0])
    return value + T[0, 2] * (T[1, 0] * T[2, 1] - T[1, 1] * T[2, 0])


@inline
def _orthogonalise(T, G):
    """Replace R by R (3 - R^T R) / 2, one step to the nearest rotation that squares the error."""
    for i in range(3):
        a, b, c = T[i, 0], T[i, 1], T[i, 2]
        for j in range(3):
            T[i, j] = 1.5 * T[i, j] - 0.5 * (a * G[0, j] + b * G[1, j] + c * G[2, j])


@inline
def clean_pose(T, G, tolerance):
    """Check one pose and make its rotation orthogonal; return its fault, or 0.

    G (3, 3) is working space.
    """
    for i in range(4):
        for j in range(4):
            if not math.isfinite(T[i, j]):
                return NOT_FINITE
    row = max(max(abs(T[3, 0]), abs(T[3, 1])), max(abs(T[3, 2]), abs(T[3, 3] - 1.0)))
    if row > tolerance:
        return NOT_RIGID
    if max(max(abs(T[0, 3]), abs(T[1, 3])), abs(T[2, 3])) > LARGEST_LENGTH:
        return TOO_FAR
    T[3, 0], T[3, 1], T[3, 2], T[3, 3] = 0.0, 0.0, 0.0, 1.0
    error = _gram(T, G)
    if not error <= tolerance or not _determinant(T) > 0.0:
        return IMPROPER
    for _ in range(3):
        if error <= ORTHOGONAL:
            break
        _orthogonalise(T, G)
        error = _gram(T, G)
    return 0


@kernel(i8(OUT3, f8))
def clean_poses(T, tolerance):
    """Check the poses T (m, 4, 4) and remove their rounding in place.

    Returns 0 or the fault of the first invalid pose: NOT_FINITE, NOT_RIGID (the last row is not
    0 0 0 1) or IMPROPER (not a proper rotation), both by more than ``tolerance``, or TOO_FAR
    (beyond LARGEST_LENGTH).
    """
    G = np.empty((3, 3))
    for k in range(T.shape[0]):
        fault = clean_pose(T[k], G, tolerance)
        if fault != 0:
            return fault
    return 0
