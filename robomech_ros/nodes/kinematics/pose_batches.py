"""Many poses at once, in short turns between which the node serves others."""

import time
from array import array
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from rclpy.node import Node

from robomech_ros.nodes.common.cooperative_wait import TimeSlices
from robomech_ros.nodes.common.messages.message_fields import append_numbers, floats
from robomech_ros.outcomes import Code
from robomech_ros.typing import Array

if TYPE_CHECKING:
    from robomech_ros.nodes.kinematics.chain_manipulator import ChainManipulator
    from robomech_ros.nodes.kinematics.platform_manipulator import PlatformManipulator

# Kinematics of one robot: both classes have the same methods.
Manipulator: TypeAlias = "ChainManipulator | PlatformManipulator"

# Poses of the first portion. One pose takes 10 us where the solution is in closed form, up to some
# ms where it is to be explained why there is none, and up to 30 ms where there is no closed form.
_FIRST, _FIRST_ITERATIVE = 64, 1
# The next portion is twice as large after one shorter than this, s, and half after one longer.
_SHORT, _LONG = 0.001, 0.003
# The arrays of so many poses stay in the processor's cache.
_LARGEST = 512
# Poses of a workspace query between two looks whether others wait: of a closed form, of a search.
_PORTION, _PORTION_SEARCHED = 32, 1


class BatchLists:
    """Lists of a SolveIKBatch response, in types that rclpy takes without checks of entries."""

    def __init__(self, robot: Manipulator) -> None:
        self._robot = robot
        real = ("solutions", "position_errors", "orientation_errors")
        self._lists = {"counts": array("I"), "codes": array("H")} | {k: array("d") for k in real}

    def __len__(self) -> int:
        return len(self._lists["counts"])

    def solve(self, T: Array, **options: Any) -> None:
        """Solve some poses (m, 4, 4) and add what was found."""
        count, status, q = self._robot.solve_many(T, **options)
        errors = self._robot.pose_errors(np.repeat(T, count, axis=0), q)
        for numbers, new in zip(self._lists.values(), (count, status, q, *errors), strict=True):
            append_numbers(numbers, new)

    def fill(self, response: Any, poses: int) -> None:
        """Write the lists to a response; the poses that are left get the code TIMED_OUT."""
        left = poses - len(self)
        append_numbers(self._lists["counts"], np.zeros(left))
        append_numbers(self._lists["codes"], np.full(left, Code.TIMED_OUT))
        for name, numbers in self._lists.items():
            setattr(response, name, numbers)


async def solve_in_turns(
    robot: Manipulator, T: Array, allowed: float, turns: TimeSlices, **options: Any
) -> BatchLists:
    """Solve many poses and let others work in between.

    - ``T``: wanted poses of the tip in the base (m), shape (m, 4, 4).
    - ``allowed``: time (s) after which no further poses are solved.
    - ``turns``: time slices of the node.
    - ``**options``: options of ``Manipulator.solve_many``.
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


class WorkspaceQuery:
    """Reachability of many poses, filled portion by portion.

    - ``robot``: after ``Manipulator.prepare``.
    - ``T``: in the base (m), shape (m, 4, 4).
    - ``task_mask``: None stands for the full pose.
    """

    def __init__(self, robot: Manipulator, T: Array, task_mask: tuple[bool, ...] | None) -> None:
        self._robot, self._T, self._mask = robot, T, task_mask
        self.count = np.zeros(len(T), np.int64)
        self.reason = np.full(len(T), Code.TIMED_OUT, np.int64)
        self.condition = np.full(len(T), np.inf)
        self.distance = np.full(len(T), np.nan)

    async def work(self, node: Node, allowed: float) -> int:
        """Judge the poses in turns with others; give how many were, in the time allowed (s)."""
        turns, began, done = TimeSlices(node), time.monotonic(), 0
        fast = self._mask is None and self._robot.closed_form
        size = _PORTION if fast else _PORTION_SEARCHED
        while done < len(self._T) and time.monotonic() - began < allowed:
            end = min(done + size, len(self._T))
            count, status, q = self._robot.solve_many(self._T[done:end], task_mask=self._mask)
            self.count[done:end] = count
            self.reason[done:end] = np.where(count > 0, Code.NONE, status)
            owner = np.repeat(np.arange(done, end), count)
            np.minimum.at(self.condition, owner, self._robot.condition_numbers(q))
            done = end
            await turns.end_if_over()
        self.distance = await self._robot.boundary_distances(
            self._T, self.count > 0, began + allowed
        )
        return done

    def fill(self, response: Any) -> None:
        """Write the lists of a QueryWorkspace response."""
        response.reachable = (self.count > 0).tolist()
        response.reason = array("H", self.reason.astype(np.uint16).tobytes())
        response.solution_count = array("I", self.count.astype(np.uint32).tobytes())
        response.condition_numbers = floats(self.condition)
        response.boundary_distances = floats(self.distance)
