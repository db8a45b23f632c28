"""Closure of loops for new positions of the drives, from a near posture in the same mode.

The drives move in steps, each proved to pass no singularity (see :mod:`.certificate`); towards a
singularity, they become shorter without limit.  A step first follows the tangent; then Newton steps
close the loops with the inverse at the end of the tangent.
"""

import math
from collections import namedtuple

import numpy as np

from robomech_ros._kernels.chain.serial import forward_body
from robomech_ros._kernels.compiling.jit import inline, kernel, lean
from robomech_ros._kernels.compiling.types import IIN1, IN1, IN2, OUT1, f8, i8
from robomech_ros._kernels.loops.certificate import (
    invert,
    part_of_proof,
    passive_moves,
    room_for_inverse,
)
from robomech_ros._kernels.loops.factors import (
    REGULAR,
    SINGULAR,
    Chains,
    factors,
    loop_errors,
    room_for_factors,
    solve,
)

# Status of a path that is too long.
LONG = 6
# Longest tangent step of a joint (rad; of the size): longer ones are never proved.
_LONGEST = 0.25
# A negligible move, and loop errors of a closed posture (rad; of the size).
_SETTLED, _CLOSED = 1e-13, 1e-12
_ITERATIONS, _STEPS = 20, 3000
# Least step relative to a path of 1 rad: a shorter one means a singularity.  At first, the least
# step is this part of the travelled path, or an absolute one: steps away from a singularity grow.
_LEAST, _LEAST_OF_GONE, _LEAST_AT_START = 1e-5, 1e-3, 1e-8
# Part of the longest provable step, and its smallest and largest ratio to the last step.
_PART, _SHORTER, _LONGER = 0.8, 0.1, 4.0

# Factors at both ends of a tangent, the inverse at its end, errors D (limbs, 6, 1) and those at
# its start, rates of drives, and moves of joints along the tangent and after it.
Room = namedtuple("Room", ("first", "second", "inverse", "D", "start", "rates", "v", "qd", "t"))


@inline
def _room(starts, dof):
    limbs, n = starts.size - 1, starts[starts.size - 1]
    return Room(
        room_for_factors(starts, 1),
        room_for_factors(starts, 1),
        room_for_inverse(starts),
        np.empty((limbs, 6, 1)),
        np.empty((limbs, 6, 1)),
        np.empty((dof, 1)),
        np.empty((n, 1)),
        np.empty((n, 1)),
        np.empty((6, 1)),
    )


@lean
def _reaches(chains, q, v, out):
    """Write the reach of each limb from its revolute joints to its end, scaled; at least 1."""
    for i in range(chains.starts.size - 1):
        s, e = chains.starts[i], chains.starts[i + 1]
        total, reach = 0.0, 0.0
        for j in range(e - 1, s - 1, -1):
            after = chains.packed[j + i + 1]
            total += math.sqrt(after[10] ** 2 + after[11] ** 2 + after[12] ** 2)
            if chains.packed[j + i, 0] == 0.0:
                reach = total
            else:
                total += abs(q[j]) + abs(v[j, 0])
                if chains.drives[j] < 0:
                    # Half of the size exceeds any r of the proof.
                    total += 0.5 / chains.scale
        out[i] = max(1.0, reach * chains.scale)


@lean
def _largest(qd, weights):
    """Return the largest move of a joint."""
    size = 0.0
    for j in range(weights.size):
        size = max(size, abs(qd[j, 0]) * weights[j])
    return size


@lean
def _moved(trial, qd, weights):
    """Move joints in place; return the largest move."""
    for j in range(trial.size):
        trial[j] += qd[j, 0]
    return _largest(qd, weights)


@lean
def _poses(chains, q, T):
    for i in range(chains.starts.size - 1):
        s, e = chains.starts[i], chains.starts[i + 1]
        forward_body(chains.packed[s + i : e + i + 1], q[s:e], T[i])


@lean
def _step(chains, weights, trial, reach, room):
    """Move all joints in place by the rates of the drives in the room.

    Returns the result of :func:`part_of_proof`, or infinity without one.  Above 1, the step is not
    proved, and the joints are invalid.
    """
    first, second, inverse, v, qd = room.first, room.second, room.inverse, room.v, room.qd
    if factors(chains, trial, first) != REGULAR:
        return math.inf
    loop_errors(first.T, chains.scale, room.start)
    loop_errors(first.T, chains.scale, room.D)
    if solve(chains, first, room.rates, room.D, v, room.t) != REGULAR:
        return math.inf
    _reaches(chains, trial, v, reach)
    size = _moved(trial, v, weights)
    if not size <= _LONGEST:
        return size / _LONGEST if size < math.inf else math.inf
    part, before = 0.0, size
    if size > _SETTLED:
        if factors(chains, trial, second) != REGULAR:
            return math.inf
        loop_errors(second.T, chains.scale, room.D)
        if invert(chains, second, inverse) != REGULAR:
            return math.inf
        passive_moves(chains, inverse, room.start, qd)
        most = _largest(qd, weights)
        passive_moves(chains, inverse, room.D, qd)
        size = _moved(trial, qd, weights)
        most = max(most, size)
        part = part_of_proof(chains, weights, reach, room, most)
        if not part <= 1.0:
            return part if part > 1.0 else math.inf
        for _ in range(_ITERATIONS):
            if size * size <= 0.01 * _SETTLED * before:
                break
            _poses(chains, trial, second.T)
            loop_errors(second.T, chains.scale, room.D)
            passive_moves(chains, inverse, room.D, qd)
            before, size = size, _moved(trial, qd, weights)
    _poses(chains, trial, second.T)
    return part if loop_errors(second.T, chains.scale, room.D) <= _CLOSED else math.inf


@kernel(i8(IN2, IIN1, IIN1, f8, IN1, IN1, OUT1, OUT1))
def close(packed, starts, drives, scale, weights, target, q, report):
    """Move all joints q (n,) in place until the drives are at their target (m,).

    ``weights`` are 1 for revolute and ``scale`` for prismatic joints.  ``report`` (2,) receives the
    travelled part of the path, and the largest loop error (rad; of the size).  Returns a status; if
    it is not regular, q is the last posture with closed loops.
    """
    chains, room = Chains(packed, starts, drives, scale), _room(starts, target.size)
    trial, reach = np.empty(q.size), np.empty(starts.size - 1)
    length = 1.0
    for j in range(q.size):
        if drives[j] >= 0:
            length = max(length, abs(target[drives[j]] - q[j]) * weights[j])
    left, step, status = 1.0, 1.0, LONG
    for _ in range(_STEPS):
        last = step >= left
        share = 1.0 if last else step / left
        for j in range(q.size):
            trial[j] = q[j]
            if drives[j] >= 0:
                room.rates[drives[j], 0] = share * (target[drives[j]] - q[j])
        part = _step(chains, weights, trial, reach, room)
        if part <= 1.0:
            for j in range(q.size):
                q[j] = target[drives[j]] if last and drives[j] >= 0 else trial[j]
            if last:
                left, status = 0.0, REGULAR
                break
            left -= step
            step *= min(_LONGER, _PART / max(part, 1e-3))
        else:
            step = min(step, left) * max(_SHORTER, min(_PART, _PART / part))
        gone = _LEAST_OF_GONE * (1.0 - left) * length
        if step * length < min(_LEAST, max(_LEAST_AT_START, gone)):
            status = SINGULAR
            break
    report[0] = 1.0 - left
    _poses(chains, q, room.first.T)
    report[1] = loop_errors(room.first.T, scale, room.D)
    return status
