"""Singular postures of a six-joint arm: how to get there, and whether joints can move on.

Where m solutions have become one, a Newton step covers only 1/m of the way.  Steps are therefore
lengthened as long as that helps, which makes convergence quick at a fold and bearable at worse.
"""

import math

import numpy as np

from robomech_ros._kernels import general_layout as at
from robomech_ros._kernels._dense import cholesky_solve
from robomech_ros._kernels._jit import IN1, IN2, OUT1, b1, f8, i8, inline, part
from robomech_ros._kernels.angles import wrapped
from robomech_ros._kernels.general_determinant import null_space
from robomech_ros._kernels.polishing import largest_error, pose_difference
from robomech_ros._kernels.serial import forward_body, jacobian_body
from robomech_ros._kernels.tolerances import (
    CONTINUUM_ERROR,
    CONTINUUM_KEPT,
    CONTINUUM_STEP,
    GENERAL_CORANK,
    SETTLED,
    SETTLING_DAMPING,
    SETTLING_FAILED,
    SETTLING_LEAST_DAMPING,
    SETTLING_STALLED,
    SETTLING_STEP,
    SETTLING_STEPS,
)

__all__ = ["distance", "is_in_continuum", "regularity", "settle"]

_LENGTHENINGS = 5


@inline
def distance(a, b):
    """Largest difference (rad) of two postures of six revolute joints."""
    apart = 0.0
    for j in range(6):
        apart = max(apart, abs(wrapped(a[j] - b[j])))
    return apart


@inline
def _square(e, weight):
    angular = e[0] * e[0] + e[1] * e[1] + e[2] * e[2]
    return angular + weight * (e[3] * e[3] + e[4] * e[4] + e[5] * e[5])


@inline
def _newton_step(J, e, weight, damping, A, step):
    """Write the damped step of least squares to step (6,); False where that fails."""
    for i in range(6):
        value = 0.0
        for k in range(3):
            value += J[k, i] * e[k] + weight * J[3 + k, i] * e[3 + k]
        step[i] = value
        for j in range(i + 1):
            value = 0.0
            for k in range(3):
                value += J[k, i] * J[k, j] + weight * J[3 + k, i] * J[3 + k, j]
            A[i, j] = value
        A[i, i] += damping
    return cholesky_solve(A, step, 6)


@part(f8(IN1, IN2, OUT1))
def settle(data, T, q):
    """Improve q (6,) in place towards the pose T, also where the Jacobian is singular.

    Damping goes with the squared error (lengths over the size), so that steps along a continuum
    stay short.  Returns the remaining error, the larger of rad and m.
    """
    packed = data[at.PACKED : at.HEAD].reshape(7, 13)
    weight = 1.0 / (data[at.SIZE] * data[at.SIZE])
    J = np.empty((6, 6))
    current = np.empty((4, 4))
    A = np.empty((6, 6))
    step = np.empty(6)
    trial = np.empty(6)
    e = np.empty(6)
    factor = SETTLING_DAMPING
    jacobian_body(packed, q, J, current)
    pose_difference(T, current, e)
    error = _square(e, weight)
    checkpoint = error
    for number in range(SETTLING_STEPS):
        if error <= SETTLED or not error <= 1e3:
            break
        if number % 8 == 7:
            if error > SETTLING_STALLED * checkpoint:
                break
            checkpoint = error
        taken = 0.0
        best = error
        if _newton_step(J, e, weight, factor * error + 1e-18, A, step):
            longest = 0.0
            for i in range(6):
                longest = max(longest, abs(step[i]))
            scale = min(1.0, SETTLING_STEP / longest) if longest > 0.0 else 1.0
            for _ in range(_LENGTHENINGS):
                for i in range(6):
                    trial[i] = q[i] + scale * step[i]
                forward_body(packed, trial, current)
                pose_difference(T, current, e)
                found = _square(e, weight)
                if not found < best:
                    break
                best = found
                taken = scale
                if found < 1e-4 * error:
                    break
                scale *= 2.0
        if taken == 0.0:
            factor *= 10.0
            if factor * error > SETTLING_FAILED:
                break
        else:
            factor = max(0.1 * factor, SETTLING_LEAST_DAMPING)
            for i in range(6):
                q[i] += taken * step[i]
            error = best
        jacobian_body(packed, q, J, current)
        pose_difference(T, current, e)
    return largest_error(e)


@inline
def regularity(data, packed, q, u, v):
    """Give the last two pivots of the Jacobian (lengths over the size) over the first.

    u (6,) and v (6,) become the directions that it takes nearest to zero: one of them where the
    last pivot alone is small, their pencil where both are.
    """
    J = np.empty((6, 6))
    pose = np.empty((4, 4))
    jacobian_body(packed, q, J, pose)
    inverse = 1.0 / data[at.SIZE]
    for i in range(3, 6):
        for j in range(6):
            J[i, j] *= inverse
    order = np.empty(6, np.int64)
    along = np.empty(6)
    _, fifth, last = null_space(J, along, u, v, order)
    if fifth > GENERAL_CORANK:
        for j in range(6):
            u[j] = along[j]
    return fifth, last


@inline
def _moved_on(data, T, q, direction, length, trial):
    """Move on by ``length`` (rad) and settle; tell how far from q that ends, 0 for nowhere."""
    largest = 0.0
    for j in range(6):
        largest = max(largest, abs(direction[j]))
    for j in range(6):
        trial[j] = q[j] + length / largest * direction[j]
    if not settle(data, T, trial) <= CONTINUUM_ERROR:
        return 0.0
    return distance(trial, q)


@part(b1(IN1, IN2, IN1, OUT1, OUT1, f8))
def is_in_continuum(data, T, q, u, v, fifth):
    """Tell whether the joints can move on from a singular posture q (6,) while the tip stays.

    u, v and ``fifth`` are those of :func:`regularity`.  From a place beside an isolated posture,
    of whatever multiplicity, one settles back to it; on a continuum one stays, at half the step
    half as far away.
    """
    trial = np.empty(6)
    direction = np.empty(6)
    for k in range(2 if fifth > GENERAL_CORANK else 8):
        sign = 1.0 if k % 2 == 0 else -1.0
        a = sign * (0.0 if k // 2 == 1 else 1.0)
        b = sign * (0.0 if k // 2 == 0 else -1.0 if k // 2 == 3 else 1.0)
        for j in range(6):
            direction[j] = a * u[j] + b * v[j]
        far = _moved_on(data, T, q, direction, CONTINUUM_STEP, trial)
        if far < CONTINUUM_KEPT:
            continue
        near = _moved_on(data, T, q, direction, 0.5 * CONTINUUM_STEP, trial)
        if 0.3 * far < near < 0.8 * far:
            return True
    return False
