"""Linear initial guess of X and Z, and errors and rotation moments of the samples."""

import math

import numpy as np

from robomech_ros._kernels.algebra.dense import cholesky_solve
from robomech_ros._kernels.algebra.singular_values import make_rows_orthogonal, row_lengths
from robomech_ros._kernels.calibration.residuals import residual
from robomech_ros._kernels.compiling.jit import inline, kernel, scratch
from robomech_ros._kernels.compiling.types import IN1, IN2, OUT1, OUT2, i8
from robomech_ros._kernels.spatial.vectors import cross, dot


@inline
def _reweigh(A, S, at, weight):
    """Set the weights of samples to the inverses of their position errors."""
    P = scratch(3, 3)
    total = 0.0
    for i in range(A.shape[0]):
        if weight[i] > 0.0:
            _, shift, _, _ = residual(A[i], S[i], at, 0, P)
            weight[i] = math.sqrt(shift[0] ** 2 + shift[1] ** 2 + shift[2] ** 2)
            total += weight[i]
    for i in range(A.shape[0]):
        if weight[i] > 0.0:
            weight[i] = 1.0 / (weight[i] + 1e-3 * total / A.shape[0] + 1e-15)


@kernel(i8(IN2, IN2, OUT1, i8, OUT1))
def linear_positions(A, S, weight, rounds, at):
    """Find the positions of X and Z, given their rotations, with the least sum of distances.

    Each round solves a weighted least-squares problem; the next weights are inverse distances.
    """
    M, b, right = scratch(6, 6), scratch(6), scratch(3)
    for k in range(rounds):
        M[:], b[:] = 0.0, 0.0
        for i in range(A.shape[0]):
            w = weight[i]
            for r in range(3):
                inner = 0.0
                for c in range(3):
                    x = at[3 * c] * S[i, 9] + at[3 * c + 1] * S[i, 10] + at[3 * c + 2] * S[i, 11]
                    inner += A[i, 3 * r + c] * x
                right[r] = -(A[i, 9 + r] + inner)
            for r in range(3):
                M[r, r] += w
                M[3 + r, 3 + r] += w
                b[3 + r] -= w * right[r]
                for c in range(3):
                    M[3 + r, c] -= w * A[i, 3 * r + c]
                    b[c] += w * A[i, 3 * r + c] * right[r]
        for r in range(6):
            M[r, r] *= 1.0 + 1e-12
        if not cholesky_solve(M, b, 6):
            return 1
        for r in range(3):
            at[9 + r], at[21 + r] = b[r], b[3 + r]
        if k + 1 < rounds:
            _reweigh(A, S, at, weight)
    return 0


@inline
def _make_rotation(W, at, first, either):
    """Replace a matrix in nine entries by the nearest rotation; if `either`, of either sign."""
    W[:] = 0.0
    for j in range(3):
        W[j, 3 + j] = 1.0
        for k in range(3):
            W[j, k] = at[first + 3 * j + k]
    a, b = (W[0, 0], W[0, 1], W[0, 2]), (W[1, 0], W[1, 1], W[1, 2])
    opposite = either and dot(cross(a, b), (W[2, 0], W[2, 1], W[2, 2])) < 0.0
    sign = -1.0 if opposite else 1.0
    # Rows of R, in the last columns, make the rows of the matrix orthogonal.
    make_rows_orthogonal(W, 3)
    lengths = scratch(3)
    row_lengths(W, 3, lengths)
    least = int(np.argmin(lengths))
    i, j = (least + 1) % 3, (least + 2) % 3
    if not min(lengths[i], lengths[j]) > 0.0:
        return False
    for k in range(3):
        W[i, k] *= sign / lengths[i]
        W[j, k] *= sign / lengths[j]
    third = cross((W[i, 0], W[i, 1], W[i, 2]), (W[j, 0], W[j, 1], W[j, 2]))
    W[least, 0], W[least, 1], W[least, 2] = third
    for j in range(3):
        for k in range(3):
            at[first + 3 * j + k] = (
                W[0, 3 + j] * W[0, k] + W[1, 3 + j] * W[1, k] + W[2, 3 + j] * W[2, k]
            )
    return True


@kernel(i8(IN2, IN2, OUT1, OUT2))
def squared_errors(A, S, at, out):
    """Write the squared errors of rotation (rad^2) and position (m^2), as rows (n,)."""
    P = scratch(3, 3)
    for i in range(A.shape[0]):
        turn, shift, _, _ = residual(A[i], S[i], at, 0, P)
        out[0, i], out[1, i] = dot(turn, turn), dot(shift, shift)
    return 0


@kernel(i8(IN2, OUT1))
def make_rotations(square, at):
    """Replace the matrix of X by the nearest rotation, and write Z's rotation from it.

    The product of square (9, 9) and the entries of X's rotation is close to Z's rotation.
    """
    W = scratch(3, 6)
    if not _make_rotation(W, at, 0, True):
        return 1
    for j in range(9):
        at[12 + j] = 0.0
        for k in range(9):
            at[12 + j] += square[j, k] * at[k]
    return 0 if _make_rotation(W, at, 12, False) else 1


@kernel(i8(IN2, IN2, IN1, OUT1, OUT2))
def common_turns(A, S, use, at, out):
    """Write the moments (3, 3) of the rotations of the samples, in the axes of X's parent.

    For a vector v, v . out v is the mean of p_i . q_i: the displacements of the point v by the
    rotations of the robot, and by those of the sensor, from their means.
    """
    P, mean, seen = scratch(3, 3), scratch(3, 3), scratch(3, 3)
    mean[:], seen[:], out[:] = 0.0, 0.0, 0.0
    count = 0.0
    for i in range(A.shape[0]):
        if not use[i] > 0.0:
            continue
        count += 1.0
        # Rows of the robot's rotation from the sensor's, R_Z R_S^T R_X^T.
        for j in range(3):
            for k in range(3):
                P[j, k] = 0.0
                for m in range(3):
                    turned = (
                        at[3 * k] * S[i, m]
                        + at[3 * k + 1] * S[i, 3 + m]
                        + at[3 * k + 2] * S[i, 6 + m]
                    )
                    P[j, k] += at[12 + 3 * j + m] * turned
        for j in range(3):
            for k in range(3):
                mean[j, k] += A[i, 3 * j + k]
                seen[j, k] += P[j, k]
                for m in range(3):
                    out[j, k] += A[i, 3 * m + j] * P[m, k]
    for j in range(3):
        for k in range(3):
            for m in range(3):
                out[j, k] -= mean[m, j] * seen[m, k] / count
            out[j, k] /= count
    for j in range(3):
        for k in range(j):
            out[j, k] = out[k, j] = 0.5 * (out[j, k] + out[k, j])
    return 0
