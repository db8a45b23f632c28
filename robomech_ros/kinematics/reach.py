"""Why a pose cannot be had: how far its position is out of reach, or its orientation."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from robomech_ros._kernels.reach import least_distance
from robomech_ros._kernels.tolerances import REACH_ITERATIONS, REACH_STARTS, REACHED
from robomech_ros.kinematics.iterative import (
    FULL_TASK,
    Task,
    least_orientation_error,
    low_discrepancy_strides,
    packed_chain,
    task_data,
)
from robomech_ros.robots.chain import SerialChain

__all__ = ["ReachGap", "out_of_reach", "reach_gap"]

Array = NDArray[np.float64]


class ReachGap(NamedTuple):
    """How much of a pose cannot be had, position limits of the joints ignored.

    Parameters
    ----------
    distance : float
        Least distance (m) of the tip from the target position in any orientation, 0 where the
        position is reached or the task asks for none.
    orientation_error : float
        Least angle (rad) to the target orientation among the postures that reach the position;
        NaN where none does, 0 where the task asks for no orientation.
    """

    distance: float
    orientation_error: float


def reach_gap(chain: SerialChain, T: Array, task: Task = FULL_TASK) -> ReachGap:
    """Find how far the target position is out of reach, else the least orientation error there.

    Parameters
    ----------
    chain : SerialChain
        Its position limits are ignored, those of prismatic joints, too.
    T : ndarray, shape (4, 4)
        Target pose of the tip in the base (m).
    task : tuple of six bool
        Which of x, y, z, rx, ry, rz, along and about the axes of the target, count.

    Returns
    -------
    ReachGap
        The distance to about 1e-7 m; the orientation error is the least of many local minima,
        attained at the position to about 1e-6 of the arm's length.
    """
    data, target = task_data(chain, T, task=task, respect_limits=False, wanted=1)
    distance, best = _nearest_posture(packed_chain(data), target, task)
    if distance > 0.0 or not chain.n:
        return ReachGap(distance, math.nan)
    if not any(task[3:]):
        return ReachGap(0.0, 0.0)
    return ReachGap(0.0, least_orientation_error(data, target, best))


def out_of_reach(chain: SerialChain, T: Array) -> float:
    """Give the distance of :func:`reach_gap` alone."""
    return _nearest_posture(chain.packed, T, FULL_TASK)[0]


def _nearest_posture(packed: Array, T: Array, task: Task) -> tuple[float, Array]:
    """Find the least distance (m) of the tip from T's position, 0 for rounding, and its posture."""
    n = len(packed) - 1
    best = np.zeros(n)
    weights = np.array(task[:3], dtype=float)
    if n == 0:
        return float(np.linalg.norm(weights * (T[:3, 3] - packed[0, 10:]))), best
    if not weights.any():
        return 0.0, best
    point = np.ascontiguousarray(T[:3, 3])
    strides = low_discrepancy_strides(n)
    distance = least_distance(packed, point, weights, strides, REACH_STARTS, REACH_ITERATIONS, best)
    return (distance if distance > REACHED else 0.0), best
