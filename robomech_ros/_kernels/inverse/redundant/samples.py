"""Samples of a redundant arm's self-motion: all postures at a value of its parameter."""

import math

import numpy as np

from robomech_ros._kernels.algebra.angles import wrapped
from robomech_ros._kernels.chain.serial import forward_body
from robomech_ros._kernels.compiling.jit import kernel, lean, scratch
from robomech_ros._kernels.compiling.types import IN1, IN2, IOUT1, OUT2, i8
from robomech_ros._kernels.inverse import branch_bits as bit
from robomech_ros._kernels.inverse.continuum import free_value
from robomech_ros._kernels.inverse.redundant import layout as at
from robomech_ros._kernels.inverse.redundant.arm_angle import call_arm_angle_postures
from robomech_ros._kernels.inverse.redundant.vectors import rotated_back_by, turned
from robomech_ros._kernels.inverse.six_joints import DOUBT, GENERAL, MAX_SOLUTIONS, call_six_joints
from robomech_ros._kernels.spatial.vectors import times

# Typed, since numba recompiles a function for a literal.
_FORWARDS = np.bool_(False)


@lean
def _between(front, T, rear, out):
    """Write front^-1 T rear^-1 to out (4, 4)."""
    for i in range(3):
        a, b, c = front[0, i], front[1, i], front[2, i]
        x = a * T[0, 0] + b * T[1, 0] + c * T[2, 0]
        y = a * T[0, 1] + b * T[1, 1] + c * T[2, 1]
        z = a * T[0, 2] + b * T[1, 2] + c * T[2, 2]
        p = a * (T[0, 3] - front[0, 3]) + b * (T[1, 3] - front[1, 3]) + c * (T[2, 3] - front[2, 3])
        for j in range(3):
            out[i, j] = x * rear[j, 0] + y * rear[j, 1] + z * rear[j, 2]
        out[i, 3] = p - out[i, 0] * rear[0, 3] - out[i, 1] * rear[1, 3] - out[i, 2] * rear[2, 3]
        out[3, i] = 0.0
    out[3, 3] = 1.0


@lean
def _locked_body(data, T, seed, locked, q, branch):
    """Write the postures for the pose T (4, 4) with fixed values of the joints outside the six.

    ``locked`` (n,) holds the values; those of the six joints are not read.  q is (16, n).  Returns
    the number of postures.
    """
    n = int(data[at.JOINTS])
    first = int(data[at.FIRST])
    own = at.PARTS + 13 * (n + 1)
    packed = data[at.PARTS : own].reshape((n + 1, 13))
    front, rear, target = scratch(4, 4), scratch(4, 4), scratch(4, 4)
    found = scratch(MAX_SOLUTIONS, 6)
    forward_body(packed[: first + 1], locked[:first], front)
    forward_body(packed[first + 6 :], locked[first + 6 :], rear)
    _between(front, T, rear, target)
    start = seed[first : first + 6]
    six = int(data[at.SIX])
    total = call_six_joints(
        six, data[at.BACKWARDS] != 0.0, data[own:], target, start, found, branch
    )
    exact = int(data[at.GENERAL])
    if total >= DOUBT and exact > 0:
        total = call_six_joints(GENERAL, _FORWARDS, data[exact:], target, start, found, branch)
    # The list of a continuum is never complete, so a remaining doubt does not matter.
    count = total % DOUBT
    for k in range(count):
        for i in range(n):
            if i < first or i >= first + 6:
                q[k, i] = locked[i]
            else:
                value = found[k, i - first]
                q[k, i] = wrapped(value) if packed[i, 0] == 0.0 else value
        branch[k] = bit.SELF_MOTION | bit.UNNAMED
    return count


@kernel(i8(IN1, IN2, IN1, IN1, OUT2, IOUT1))
def locked_postures(data, T, seed, locked, q, branch):
    """Write the postures with some joints locked, as :func:`_locked_body`, for Python."""
    return _locked_body(data, T, seed, locked, q, branch)


@lean
def choose_locked(data, lower, upper, seed, k, steps, locked):
    """Write the k-th values of the locked joints; return their distance from the seed.

    The first are the seed's.  A single joint takes further values in order of their distance from
    the seed; several follow a low-discrepancy sequence in the box of their limits.
    """
    n = int(data[at.JOINTS])
    first = int(data[at.FIRST])
    largest = 0.0
    root = 1.0
    for _ in range(32 if n > 7 and k > 0 else 0):
        root = (1.0 + root) ** (1.0 / (n - 5))
    stride = 1.0
    for i in range(n):
        locked[i] = seed[i]
        if first <= i < first + 6 or k == 0:
            continue
        if n == 7:
            locked[i] = free_value(lower[i], upper[i], seed[i], k, steps)
        else:
            stride /= root
            part = 0.5 + k * stride
            low, high = lower[i], upper[i]
            if not high - low < 2.0 * math.pi and data[at.PARTS + 13 * i] == 0.0:
                low, high = seed[i] - math.pi, seed[i] + math.pi
            elif not high - low < math.inf:
                low, high = seed[i] - data[at.SIZE], seed[i] + data[at.SIZE]
                low, high = max(low, lower[i]), min(high, upper[i])
            locked[i] = low + (high - low) * (part - math.floor(part))
        largest = max(largest, abs(locked[i] - seed[i]))
    return largest


@lean
def stretched(data, T):
    """Return the value of the locked joint with shoulder and wrist nearest, NaN if unknown.

    Half a turn from it they are farthest from each other.
    """
    if data[at.STRETCHED] == 0.0:
        return math.nan
    packed = data[at.PARTS : at.PARTS + 8 * 13].reshape((8, 13))
    x, y, z = data[at.CENTRE], data[at.CENTRE + 1], data[at.CENTRE + 2]
    towards = math.atan2(data[at.TOWARDS + 1], data[at.TOWARDS])
    if data[at.FIRST] == 0.0:
        x, y, z = x - T[0, 3], y - T[1, 3], z - T[2, 3]
        column = (
            T[0, 0] * x + T[1, 0] * y + T[2, 0] * z,
            T[0, 1] * x + T[1, 1] * y + T[2, 1] * z,
            T[0, 2] * x + T[1, 2] * y + T[2, 2] * z,
        )
        x, y, _ = turned(packed, 7, column)
        return towards - math.atan2(y + packed[7, 11], x + packed[7, 10])
    x, y, z = times(T, (x, y, z))
    point = x + T[0, 3] - packed[0, 10], y + T[1, 3] - packed[0, 11], z + T[2, 3] - packed[0, 12]
    x, y, _ = rotated_back_by(packed, 0, point)
    return math.atan2(y, x) - towards


@lean
def sample(data, T, seed, angle, locked, turn, postures):
    """Write the postures of one sample and their names; return their number.

    ``angle`` is the arm angle of the seed, and ``turn`` (rad) that of the sample from it.
    """
    q, branch = postures
    if data[at.KIND] == at.ARM_ANGLE:
        return call_arm_angle_postures(data, T, seed, angle + turn, q, branch)
    return _locked_body(data, T, seed, locked, q, branch)
