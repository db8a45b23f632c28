"""Batches of inverse kinematics in short turns, between which the node serves others."""

import math
import time
from array import array
from typing import Any

import numpy as np

from robomech_ros.kinematics import forward_kinematics, inverse_kinematics_batch
from robomech_ros.kinematics.inverse.families.selection import family_of
from robomech_ros.nodes.common.cooperative_wait import TimeSlices
from robomech_ros.nodes.common.message_fields import append_numbers
from robomech_ros.outcomes import Code
from robomech_ros.robots import SerialChain
from robomech_ros.typing import Array, IntArray

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
    chain : SerialChain
        Of n joints.
    """

    def __init__(self, chain: SerialChain) -> None:
        self._chain = chain
        self.counts, self.codes = array("I"), array("H")
        self.solutions = array("d")
        self.position_errors, self.orientation_errors = array("d"), array("d")

    def add(self, T: Array, q: Array, count: IntArray, status: IntArray) -> None:
        """Add what `inverse_kinematics_batch` found for some poses.

        Parameters
        ----------
        T : ndarray, shape (m, 4, 4)
            The poses asked for (m).
        q : ndarray, shape (m, c, n)
            Solutions (rad or m).
        count, status : ndarray of int, shape (m,)
            How many each pose has, and its code.
        """
        rows = q[np.arange(q.shape[1]) < count[:, None]]
        apart = np.repeat(T, count, axis=0)
        apart -= forward_kinematics(self._chain, rows)
        # The difference of two rotations that are apart by an angle is 2 sqrt(2) sin(angle / 2)
        # long.
        turned = _lengths(apart[:, :3, :3].reshape(-1, 9))
        chord = np.minimum(turned / (2.0 * math.sqrt(2.0)), 1.0)
        append_numbers(self.counts, count)
        append_numbers(self.codes, status)
        append_numbers(self.solutions, rows)
        append_numbers(self.position_errors, _lengths(apart[:, :3, 3]))
        append_numbers(self.orientation_errors, 2.0 * np.arcsin(chord))

    def add_left(self, poses: int) -> None:
        """Add poses that were not worked on."""
        append_numbers(self.counts, np.zeros(poses))
        append_numbers(self.codes, np.full(poses, Code.TIMED_OUT))

    def fill(self, response: Any) -> None:
        """Hand the lists over to a response."""
        response.joint_names = list(self._chain.joint_names)
        for name in ("counts", "codes", "solutions", "position_errors", "orientation_errors"):
            setattr(response, name, getattr(self, name))


async def solve_in_turns(
    chain: SerialChain, T: Array, allowed: float, turns: TimeSlices, **options: Any
) -> tuple[BatchLists, int]:
    """Solve many poses and let others work in between.

    Parameters
    ----------
    chain : SerialChain
        Of n joints.
    T : ndarray, shape (m, 4, 4)
        Wanted poses of the tip in the base (m).
    allowed : float
        Time (s) after which the poses that are left get the code TIMED_OUT.
    turns : TimeSlices
        Those of the node that does it.
    **options
        Of `inverse_kinematics_batch`.

    Returns
    -------
    lists : BatchLists
        What was found for all poses.
    done : int
        How many poses were worked on.
    """
    size = _FIRST if family_of(chain).closed_form else _FIRST_ITERATIVE
    lists = BatchLists(chain)
    start = began = time.monotonic()
    done = 0
    while done < len(T):
        portion = T[done : done + size]
        lists.add(portion, *inverse_kinematics_batch(chain, portion, **options))
        done += len(portion)
        now = time.monotonic()
        if now - start > allowed:
            break
        size = _next_size(size, now - began)
        await turns.end_if_over()
        began = time.monotonic()
    lists.add_left(len(T) - done)
    return lists, done


def _next_size(size: int, seconds: float) -> int:
    """Choose how many poses to solve next, from how long the last ones took (s)."""
    if seconds < _SHORT:
        return min(2 * size, _LARGEST)
    return max(size // 2, 1) if seconds > _LONG else size


def _lengths(rows: Array) -> Array:
    """Lengths of the rows of a matrix, without the copies that a norm makes."""
    lengths: Array = np.sqrt(np.einsum("ij,ij->i", rows, rows))
    return lengths
