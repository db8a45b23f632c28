"""Batches of inverse kinematics in short turns, between which the node serves others."""

import time
from array import array
from typing import Any

import numpy as np

from robomech_ros.nodes.common.cooperative_wait import TimeSlices
from robomech_ros.nodes.common.message_fields import append_numbers
from robomech_ros.nodes.kinematics.manipulator import Manipulator
from robomech_ros.outcomes import Code
from robomech_ros.typing import Array

# Poses of the first portion. One pose takes 10 us where the solution is in closed form, up to some
# ms where it is to be explained why there is none, and up to 30 ms where there is no closed form.
_FIRST, _FIRST_ITERATIVE = 64, 1
# The next portion is twice as large after one shorter than this, s, and half after one longer.
_SHORT, _LONG = 0.001, 0.003
# What is computed on a portion stays in the processor's cache.
_LARGEST = 512


class BatchLists:
    """The lists of a SolveIKBatch response, filled portion by portion.

    They are what rclpy takes without looking at each entry.

    Parameters
    ----------
    robot : Manipulator
    """

    def __init__(self, robot: Manipulator) -> None:
        self._robot = robot
        self.counts, self.codes = array("I"), array("H")
        self.solutions = array("d")
        self.position_errors, self.orientation_errors = array("d"), array("d")

    def solve(self, T: Array, **options: Any) -> None:
        """Solve some poses (m, 4, 4) and add what was found."""
        count, status, q = self._robot.solve_many(T, **options)
        position, orientation = self._robot.pose_errors(np.repeat(T, count, axis=0), q)
        append_numbers(self.counts, count)
        append_numbers(self.codes, status)
        append_numbers(self.solutions, q)
        append_numbers(self.position_errors, position)
        append_numbers(self.orientation_errors, orientation)

    def fill(self, response: Any, poses: int) -> None:
        """Write the lists to a response; the poses that are left get the code TIMED_OUT."""
        left = poses - len(self.counts)
        append_numbers(self.counts, np.zeros(left))
        append_numbers(self.codes, np.full(left, Code.TIMED_OUT))
        for name in ("counts", "codes", "solutions", "position_errors", "orientation_errors"):
            setattr(response, name, getattr(self, name))


async def solve_in_turns(
    robot: Manipulator, T: Array, allowed: float, turns: TimeSlices, **options: Any
) -> BatchLists:
    """Solve many poses and let others work in between.

    Parameters
    ----------
    robot : Manipulator
    T : ndarray, shape (m, 4, 4)
        Wanted poses of the tip in the base (m).
    allowed : float
        Time (s) after which no further poses are solved.
    turns : TimeSlices
        Those of the node that does it.
    **options
        Of :meth:`Manipulator.solve_many`.
    """
    size, done = _FIRST if robot.closed_form else _FIRST_ITERATIVE, 0
    lists = BatchLists(robot)
    start = began = time.monotonic()
    while done < len(T):
        lists.solve(T[done : done + size], **options)
        done += size
        now = time.monotonic()
        if now - start > allowed:
            break
        size = _next_size(size, now - began)
        await turns.end_if_over()
        began = time.monotonic()
    return lists


def _next_size(size: int, seconds: float) -> int:
    """Choose how many poses to solve next, from how long the last ones took (s)."""
    if seconds < _SHORT:
        return min(2 * size, _LARGEST)
    return max(size // 2, 1) if seconds > _LONG else size
