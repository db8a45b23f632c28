"""The choice of a solution and its windings for every pose of a path, with the fewest jumps."""

from itertools import pairwise

import numpy as np

from robomech_ros._kernels.inverse.cheapest_moves import cheapest_moves
from robomech_ros._kernels.tolerances import AT_LIMIT
from robomech_ros.kinematics.joint_jumps import find_jumps, shortest_moves
from robomech_ros.robots.chain import SerialChain
from robomech_ros.typing import Array, IntArray


def fewest_jumps(
    chain: SerialChain, solutions: list[Array], origin: Array | None, largest: Array
) -> Array:
    """Choose a solution for every pose: fewest jumps first, then least squares of the moves.

    Solutions stand for all their windings at first.  Of the best path to each solution of the last
    pose the windings are chosen, and then the best of these paths.  It ends before the first pose
    without a solution.
    """
    reached = next((k for k, found in enumerate(solutions) if not len(found)), len(solutions))
    if not reached:
        return np.empty((0, chain.n))
    cost = np.zeros(len(solutions[0]))
    if origin is not None:
        cost, _ = _continued(chain, np.zeros(1), origin[None], solutions[0], largest)
    came: list[IntArray] = []
    for before, after in pairwise(solutions[:reached]):
        cost, predecessors = _continued(chain, cost, before, after, largest)
        came.append(predecessors)
    paths = []
    for last in range(len(cost)):
        chosen = [last]
        for back in reversed(came):
            chosen.append(int(back[chosen[-1]]))
        path = np.array([solutions[k][i] for k, i in enumerate(reversed(chosen))])
        path = _wound(chain, path, origin)
        paths.append((len(find_jumps(chain, path, origin, largest)), float(cost[last]), path))
    return min(paths, key=lambda one: one[:2])[2]


def _continued(
    chain: SerialChain, cost: Array, before: Array, after: Array, largest: Array
) -> tuple[Array, IntArray]:
    """Go on to the solutions of the next pose: what the best ways cost, and their predecessors."""
    total = np.empty(len(after))
    came = np.empty(len(after), dtype=np.int64)
    cheapest_moves(chain.packed, cost, before, after, largest, total, came)
    return total, came


def _wound(chain: SerialChain, path: Array, origin: Array | None) -> Array:
    """Choose windings: each joint goes on continuously as far as its limits allow."""
    result = path.copy()
    steps = shortest_moves(chain, np.diff(path, axis=0))
    for i in np.flatnonzero(chain.turns).tolist():
        k = 0
        here = path[0, i] if origin is None else origin[i]
        free = origin is None
        while k < len(path):
            run = np.concatenate(([0.0], np.cumsum(steps[k:, i])))
            value, length = _longest(chain, i, path[k, i], run, None if free else here)
            result[k : k + length, i] = np.clip(
                value + run[:length], chain.lower[i], chain.upper[i]
            )
            here, free = result[k + length - 1, i], True
            k += length
    return result


def _longest(
    chain: SerialChain, i: int, value: float, run: Array, near: float | None
) -> tuple[float, int]:
    """Find the winding of joint i from which a run stays inside the limits longest.

    Of equals it is the one nearest to the middle of the limits; where there is a place to start
    from, only the winding nearest to that is looked at, if it is inside.
    """
    lower, upper = chain.lower[i] - AT_LIMIT, chain.upper[i] + AT_LIMIT
    turn = 2.0 * np.pi
    middle = float(chain.midrange()[i]) if near is None else near
    centre = value + turn * np.round((middle - value) / turn)
    best = (0, -np.inf, value)
    for k in (0,) if near is not None and lower <= centre <= upper else range(-8, 9):
        wound = centre + turn * k
        outside = (wound + run < lower) | (wound + run > upper)
        length = int(outside.argmax()) if outside.any() else len(run)
        best = max(best, (length, -abs(wound - middle), wound))
    # The solver gave the value inside the limits, so that at least the first one stays.
    return best[2], max(best[0], 1)
