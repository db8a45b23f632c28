"""Cheapest move to each solution of a pose from the solutions of the previous pose."""

import math

from numba import types

from robomech_ros._kernels.algebra.angles import wrapped
from robomech_ros._kernels.chain.coupling import drive_kind
from robomech_ros._kernels.chain.layout import TURN
from robomech_ros._kernels.compiling.jit import kernel, lean
from robomech_ros._kernels.compiling.types import IN1, IN2, IOUT1, OUT1

# Cost of a jump: more than any sum of moves without a jump.
_JUMP = 1e6


@lean
def _move_cost(packed, before, after, largest, least):
    """Return the cost of a move, angles modulo a turn, or any cost above ``least``.

    It is the sum of squares, plus the cost of a jump if a joint moves more than ``largest``.
    """
    squares = 0.0
    jump = 0.0
    for i in range(before.shape[0]):
        move = after[i] - before[i]
        if drive_kind(packed, i) == TURN:
            move = wrapped(move)
        squares += move * move
        if abs(move) > largest[i]:
            jump = _JUMP
        if jump + squares > least:
            break
    return jump + squares


@kernel(types.void(IN2, IN1, IN2, IN2, IN1, OUT1, IOUT1))
def cheapest_moves(packed, costs, before, after, largest, totals, predecessors):
    """Find the best predecessor of every solution.

    ``costs`` (k,) are those of the paths to the solutions ``before`` (k, n).  ``totals`` (l,)
    receives the costs of the paths to ``after`` (l, n), and ``predecessors`` (l,) the first best
    predecessor.  ``largest`` (n,) are the largest moves (rad, m) that are not jumps.
    """
    for k in range(after.shape[0]):
        least = math.inf
        predecessors[k] = 0
        for i in range(before.shape[0]):
            total = costs[i] + _move_cost(packed, before[i], after[k], largest, least - costs[i])
            if total < least:
                least = total
                predecessors[k] = i
        totals[k] = least
