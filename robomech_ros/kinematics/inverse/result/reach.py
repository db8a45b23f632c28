"""Distance of an unreachable pose from reach, in position and orientation."""

import math
import time
from typing import NamedTuple

import numpy as np

from robomech_ros._kernels.chain.reach import REACHED, least_distance
from robomech_ros.kinematics.inverse.families.iterative import SearchGoal, packed_chain, task_data
from robomech_ros.kinematics.inverse.families.iterative_search import least_orientation_error
from robomech_ros.kinematics.inverse.request.task import FULL_TASK, Task
from robomech_ros.kinematics.posture_samples import low_discrepancy_strides
from robomech_ros.robots.chain import SerialChain
from robomech_ros.typing import Array

# Starts and Newton steps of each in the search for the least distance: every local minimum of
# the arms in the tests has a basin found within a dozen starts.
REACH_STARTS = 64
REACH_ITERATIONS = 60


class ReachGap(NamedTuple):
    """By how much a pose is missed, position limits of the joints ignored.

    The distance is the least one (m) of the tip from the target position in any orientation, 0
    where the position is reached or the task asks for none, NaN where the time ran out. The
    orientation error is the least angle (rad) to the target among the postures that reach the
    position; NaN where none does or the time ran out, 0 where the task asks for no orientation.
    """

    distance: float
    orientation_error: float


# Result after the time has run out.
NO_TIME = ReachGap(math.nan, math.nan)
# A distance inside the limits that is greater by no more than this (relative) is the same.
_SAME = 1e-7
# Starts of the search for the least distance between two looks at the clock, times joints.
_CHUNK = 64


def reach_gap(
    chain: SerialChain, T: Array, task: Task = FULL_TASK, deadline: float = math.inf
) -> ReachGap:
    """Find how far the target position is out of reach, else the least orientation error there.

    Position limits are ignored, those of prismatic joints, too. The task says which of x, y, z, rx,
    ry, rz, along and about the axes of the target, count; the deadline is by ``time.monotonic``
    (s). The distance is known to about 1e-7 m; the orientation error is the least of many local
    minima, attained at the position to about 1e-6 of the arm's length.
    """
    data, target = task_data(chain, T, SearchGoal(False, task, wanted=1))
    distance, best = _nearest_posture(packed_chain(data), chain.n, target, task, deadline)
    if distance != 0.0 or not chain.n:
        return ReachGap(distance, math.nan)
    if not any(task[3:]):
        return ReachGap(0.0, 0.0)
    angle = least_orientation_error(data, target, best, deadline)
    return NO_TIME if math.isnan(angle) else ReachGap(0.0, angle)


def distance_inside_limits(
    chain: SerialChain, T: Array, task: Task, least: float, deadline: float = math.inf
) -> float:
    """Find the least distance (m) of the tip from the target position inside the position limits.

    The search ends where the ``least`` one with the limits ignored (m) is attained; NaN where the
    time ran out. The others are as for :func:`reach_gap`.
    """
    bounds = np.stack((chain.lower, chain.upper))
    if not np.isfinite(bounds).any():
        return least
    data, target = task_data(chain, T, SearchGoal(True, task, wanted=1))
    enough = least * (1.0 + _SAME)
    packed = packed_chain(data)
    return _nearest_posture(packed, chain.n, target, task, deadline, bounds=bounds, enough=enough)[
        0
    ]


def out_of_reach(chain: SerialChain, T: Array) -> float:
    """Return the distance of :func:`reach_gap` alone."""
    return _nearest_posture(chain.packed, chain.n, T, FULL_TASK)[0]


def _nearest_posture(
    packed: Array,
    n: int,
    T: Array,
    task: Task,
    deadline: float = math.inf,
    *,
    bounds: Array | None = None,
    enough: float = REACHED,
) -> tuple[float, Array]:
    """Find the least distance (m) of the tip from T's position, and its posture.

    It is 0 for rounding, and NaN where the time ran out.  The search ends where it is enough.
    """
    if bounds is None:
        bounds = np.full((2, n), np.inf)
        bounds[0] = -np.inf
    best = np.zeros(n)
    weights = np.array(task[:3], dtype=float)
    if n == 0:
        return float(np.linalg.norm(weights * (T[:3, 3] - packed[0, 10:13]))), best
    if not weights.any():
        return 0.0, best
    wanted = np.array((T[:3, 3], weights))
    strides = low_discrepancy_strides(n)
    count = REACH_STARTS if deadline == math.inf else max(1, _CHUNK // n)
    distance = math.inf
    for first in range(0, REACH_STARTS, count):
        if first and time.monotonic() >= deadline:
            return math.nan, best
        starts = min(count, REACH_STARTS - first)
        counts = first, starts, REACH_ITERATIONS
        distance = least_distance(packed, wanted, bounds, strides, counts, enough, distance, best)
        if distance <= enough:
            break
    return (0.0 if distance <= REACHED else distance), best
