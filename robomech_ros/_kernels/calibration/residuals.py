"""Residuals of A_i X S_i = Z, with noise on both sides, and their normal equations.

A pose is a row of twelve numbers: rotation matrix row by row, then origin.  The unknowns (24,) are
X, then Z.  The noise (3,) is the variances of rotation (rad^2) and position (m^2) of both sides
together, and the robot's share of the rotation variance.
"""

import math

from robomech_ros._kernels.compiling.jit import lean
from robomech_ros._kernels.spatial.representations import (
    canonical,
    quaternion_of_matrix,
    quaternion_of_vector,
    vector_of_quaternion,
)
from robomech_ros._kernels.spatial.vectors import combined, cross, dot, scaled, times

UNKNOWNS = 12


@lean
def _times(a, i, v):
    """Return the product of the matrix in entries i to i + 8 and a vector."""
    return (
        a[i] * v[0] + a[i + 1] * v[1] + a[i + 2] * v[2],
        a[i + 3] * v[0] + a[i + 4] * v[1] + a[i + 5] * v[2],
        a[i + 6] * v[0] + a[i + 7] * v[1] + a[i + 8] * v[2],
    )


@lean
def _back(a, i, v):
    """Return the product of the transposed matrix in entries i to i + 8 and a vector."""
    return (
        a[i] * v[0] + a[i + 3] * v[1] + a[i + 6] * v[2],
        a[i + 1] * v[0] + a[i + 4] * v[1] + a[i + 7] * v[2],
        a[i + 2] * v[0] + a[i + 5] * v[1] + a[i + 8] * v[2],
    )


@lean
def _predicted(A, at, P):
    """Write the predicted sensor rotation P; return its position, and the lever to the target."""
    for j in range(3):
        column = _back(at, 0, _back(A, 0, (at[12 + j], at[15 + j], at[18 + j])))
        P[0, j], P[1, j], P[2, j] = column
    d = _back(A, 0, (at[21] - A[9], at[22] - A[10], at[23] - A[11]))
    from_hand = _back(at, 0, d)
    offset = _back(at, 0, (at[9], at[10], at[11]))
    t = from_hand[0] - offset[0], from_hand[1] - offset[1], from_hand[2] - offset[2]
    return t, from_hand


@lean
def residual(A, S, at, inverted, P):
    """Return rotation error, position error, predicted position and lever of a sample; write P.

    The lever goes from the hand's origin to the target, in the sensor's frame: an error of the
    robot's rotation moves the target about that origin.
    """
    t, lever = _predicted(A, at, P)
    if inverted:
        lever = times(P, _back(at, 12, (at[21], at[22], at[23])))
    # Rows of R_S P^T are R_S's rows times P's rows.
    rows = (P[0, 0], P[0, 1], P[0, 2]), (P[1, 0], P[1, 1], P[1, 2]), (P[2, 0], P[2, 1], P[2, 2])
    a, d, g = _times(S, 0, rows[0])
    b, e, h = _times(S, 0, rows[1])
    c, f, i = _times(S, 0, rows[2])
    _, x, y, z, w = quaternion_of_matrix(a, b, c, d, e, f, g, h, i)
    x, y, z, w = canonical(x, y, z, w)
    turn = vector_of_quaternion(x, y, z, w)
    return turn, (S[9] - t[0], S[10] - t[1], S[11] - t[2]), t, lever


@lean
def _whiten(v, lever, square, along, across):
    """Scale a vector by one factor along the lever and by another across it."""
    if square > 0.0:
        k = (along - across) * dot(lever, v) / square
    else:
        k = 0.0
    return combined(scaled(v, across), lever, k)


@lean
def whitened(turn, shift, lever, noise):
    """Return the position error, given the rotation error, in standard deviations.

    Returns also the lever's square, the variance across it, and the weights along and across it.
    """
    square = dot(lever, lever)
    share = noise[2]
    variance = noise[1] + share * (1.0 - share) * noise[0] * square
    along, across = 1.0 / math.sqrt(noise[1]), 1.0 / math.sqrt(variance)
    d = combined(shift, cross(lever, turn), share)
    return _whiten(d, lever, square, along, across), square, variance, along, across


@lean
def _position_rows(P, t, lever, share, square, along, across, J):
    """Write the whitened derivatives of the position error, given the rotation error."""
    for j in range(3):
        unit = 1.0 * (j == 0), 1.0 * (j == 1), 1.0 * (j == 2)
        p = P[0, j], P[1, j], P[2, j]
        one, two, three = cross(lever, unit), cross(t, unit), cross(lever, p)
        w = share * one[0] - two[0], share * one[1] - two[1], share * one[2] - two[2]
        J[j, 0], J[j, 1], J[j, 2] = _whiten(w, lever, square, along, across)
        J[3 + j, 0], J[3 + j, 1], J[3 + j, 2] = _whiten(unit, lever, square, along, across)
        w = -share * three[0], -share * three[1], -share * three[2]
        J[6 + j, 0], J[6 + j, 1], J[6 + j, 2] = _whiten(w, lever, square, along, across)
        J[9 + j, 0], J[9 + j, 1], J[9 + j, 2] = _whiten(
            (-p[0], -p[1], -p[2]), lever, square, along, across
        )


@lean
def accumulate(samples, at, noise, inverted, P, J, equations):
    """Write the normal equations M d = -g of the samples (A, S, use), and their sums.

    The equations are (M, g, sums).  The sums are: squared whitened errors of rotation and of
    position, the logarithm of the determinant of the noise, the number of samples, and the sum of
    all P.
    """
    A, S, use = samples
    M, g, sums = equations
    M[:], g[:], sums[:] = 0.0, 0.0, 0.0
    turn_weight = 1.0 / noise[0]
    share = noise[2]
    for i in range(A.shape[0]):
        if not use[i] > 0.0:
            continue
        turn, shift, t, lever = residual(A[i], S[i], at, inverted, P)
        d, square, variance, along, across = whitened(turn, shift, lever, noise)
        _position_rows(P, t, lever, share, square, along, across, J)
        for j in range(12):
            row = J[j, 0], J[j, 1], J[j, 2]
            g[j] += dot(row, d)
            for k in range(j + 1):
                M[j, k] += row[0] * J[k, 0] + row[1] * J[k, 1] + row[2] * J[k, 2]
        for j in range(3):
            g[j] += turn_weight * turn[j]
            g[6 + j] -= turn_weight * (P[0, j] * turn[0] + P[1, j] * turn[1] + P[2, j] * turn[2])
            for k in range(3):
                sums[4 + 3 * j + k] += P[j, k]
        sums[0] += turn_weight * dot(turn, turn)
        sums[1] += dot(d, d)
        sums[2] += 3.0 * math.log(noise[0]) + math.log(noise[1]) + 2.0 * math.log(variance)
        sums[3] += 1.0
    for j in range(3):
        M[j, j] += turn_weight * sums[3]
        M[6 + j, 6 + j] += turn_weight * sums[3]
        for k in range(3):
            M[6 + j, k] -= turn_weight * sums[4 + 3 * k + j]


@lean
def _moved_pose(at, i, d, k, out):
    """Write the pose at entry i, moved in its own axes by entries k to k + 5 of a step."""
    x, y, z, w = quaternion_of_vector(d[k], d[k + 1], d[k + 2])
    norm = 1.0 / math.sqrt(x * x + y * y + z * z + w * w)
    x, y, z, w = x * norm, y * norm, z * norm, w * norm
    step = _times(at, i, (d[k + 3], d[k + 4], d[k + 5]))
    for j in range(3):
        row = at[i + 3 * j], at[i + 3 * j + 1], at[i + 3 * j + 2]
        one = cross((x, y, z), row)
        two = cross((x, y, z), one)
        # A row times Q is Q^T times the row.
        for c in range(3):
            out[i + 3 * j + c] = row[c] - 2.0 * w * one[c] + 2.0 * two[c]
        out[i + 9 + j] = at[i + 9 + j] + step[j]


@lean
def moved(at, d, out):
    """Write the unknowns after a step (12,): rotation and translation of X, then of Z."""
    _moved_pose(at, 0, d, 0, out)
    _moved_pose(at, 12, d, 6, out)
