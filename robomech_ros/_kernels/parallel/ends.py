"""Selection of distinct, conjugate and real end points of homotopy paths."""

import math

import numpy as np

from robomech_ros._kernels.compiling.jit import inline, kernel, scratch
from robomech_ros._kernels.compiling.types import IIN1, IN2, IOUT1, OUT1, OUT2, i8
from robomech_ros._kernels.parallel.newton import newton, pose_of_parameters
from robomech_ros._kernels.parallel.projective import REGULAR
from robomech_ros._kernels.parallel.quadrics import COUT2

# Ends nearer to each other than this (of unit length) are equal: a path tracker has jumped.
_ONE = 1e-9
# Largest distance of an end from the conjugate of its partner, and its largest ratio to the next.
_CONJUGATE, _NEARER = 1e-6, 0.1
# Above this, a squared distance is accurate as the difference 1 - |x . y|^2.
_FAR = 1e-4
# Ends whose |x_0|^2 differ by more are farther apart than _CONJUGATE.
_APART = 1e-4


@inline
def _square(z):
    return z.real * z.real + z.imag * z.imag


@inline
def _distance(x, y, conjugate):
    """Return the distance of unit points x and y, or the conjugate of y, in P^7."""
    inner = 0.0j
    for i in range(8):
        z = y[i].conjugate() if conjugate else y[i]
        inner += z.conjugate() * x[i]
    square = 1.0 - inner.real * inner.real - inner.imag * inner.imag
    if square > _FAR:
        return math.sqrt(square)
    total = 0.0
    for i in range(8):
        z = y[i].conjugate() if conjugate else y[i]
        difference = x[i] - inner * z
        total += difference.real * difference.real + difference.imag * difference.imag
    return math.sqrt(total)


@kernel(i8(COUT2, IIN1, IOUT1))
def pair(X, ends, partner):
    """Normalise the ends X (n, 8), and write the index of the conjugate of each to partner (n,).

    A real end is its own partner; the partner is -1 if none is found, or if two ends are equal.
    Returns the number of ends without a partner.
    """
    n = X.shape[0]
    for i in range(n):
        partner[i] = -1
        total = 0.0
        for j in range(8):
            total += X[i, j].real * X[i, j].real + X[i, j].imag * X[i, j].imag
        size = 1.0 / math.sqrt(total)
        for j in range(8):
            X[i, j] *= size
    for i in range(n):
        if ends[i] != REGULAR:
            continue
        least, second, found = 2.0, 2.0, -1
        first = _square(X[i, 0])
        for j in range(n):
            if ends[j] != REGULAR or abs(_square(X[j, 0]) - first) > _APART:
                continue
            distance = _distance(X[i], X[j], True)
            if distance < least:
                least, second, found = distance, least, j
            else:
                second = min(second, distance)
        if least <= _CONJUGATE and least <= _NEARER * second and second > _ONE:
            partner[i] = found
    alone = 0
    for i in range(n):
        if partner[i] >= 0 and partner[partner[i]] != i:
            partner[i] = -1
        alone += partner[i] < 0
    return alone


@kernel(i8(IN2, IN2, OUT1, COUT2, IIN1, OUT2, OUT1))
def real_poses(A, B, lengths, X, partner, poses, errors):
    """Write the poses (n, 12) of real ends, R row by row and p, and their length errors.

    Returns their number, or -1 if Newton's method does not converge for one.
    """
    x = scratch(8)
    count = 0
    for i in range(X.shape[0]):
        if partner[i] != i:
            continue
        norm = 0.0j
        for j in range(4):
            norm += X[i, j] * X[i, j]
        root = 1.0 / np.sqrt(norm)
        for j in range(8):
            x[j] = (X[i, j] * root).real
        pose_of_parameters(x, poses[count])
        error = newton(A, B, lengths, poses[count])
        if not error >= 0.0:
            return -1
        errors[count] = error
        count += 1
    return count
