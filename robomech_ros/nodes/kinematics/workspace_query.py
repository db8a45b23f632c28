"""Which of many poses a robot reaches, computed in turns with other work of the node."""

import math
import time
from array import array
from typing import Any

import numpy as np
from rclpy.node import Node

from robomech_ros.kinematics import inverse_kinematics, inverse_kinematics_batch
from robomech_ros.kinematics.inverse.families.selection import family_of
from robomech_ros.kinetostatics import condition_number
from robomech_ros.nodes.common.cooperative_wait import TimeSlices, Worker
from robomech_ros.nodes.common.message_fields import append_numbers
from robomech_ros.nodes.kinematics.workspace_cache import ReachableSpace
from robomech_ros.outcomes import Code
from robomech_ros.robots import SerialChain
from robomech_ros.typing import Array

# Poses between two looks whether others wait: of a closed form, and of a search.
_PORTION, _PORTION_SEARCHED = 32, 1


class WorkspaceQuery:
    """Which of many poses can be reached, filled portion by portion.

    Parameters
    ----------
    chain : SerialChain
    T : ndarray, shape (m, 4, 4)
        In the base (m).
    mask : tuple of six bool
        Task mask; all of it false stands for the full pose.
    space : ReachableSpace
    """

    def __init__(
        self, chain: SerialChain, T: Array, mask: tuple[bool, ...], space: ReachableSpace
    ) -> None:
        self._chain, self._T, self._space = chain, T, space
        self._mask = mask if any(mask) and not all(mask) else None
        self.count = np.zeros(len(T), np.int64)
        self.reason = np.full(len(T), Code.TIMED_OUT, np.int64)
        self.condition = np.full(len(T), np.inf)
        self.distance = np.full(len(T), np.nan)

    async def work(self, node: Node, worker: Worker, allowed: float) -> int:
        """Judge the poses in turns with others; give how many were, in the time allowed (s)."""
        if self._space.boundary is not None and len(self._T):
            await worker.do(self._measure)
        turns, began, done = TimeSlices(node), time.monotonic(), 0
        fast = self._mask is None and family_of(self._chain).closed_form
        size = _PORTION if fast else _PORTION_SEARCHED
        while done < len(self._T) and time.monotonic() - began < allowed:
            part = slice(done, min(done + size, len(self._T)))
            self._judge(part)
            done = part.stop
            await turns.end_if_over()
        return done

    def _measure(self) -> None:
        boundary = self._space.boundary
        if boundary is not None:
            centres = self._T[:, :3, :3] @ self._space.centre + self._T[:, :3, 3]
            self.distance = boundary.distance(centres)

    def _judge(self, part: slice) -> None:
        if self._mask is None:
            q, count, status = inverse_kinematics_batch(self._chain, self._T[part])
            rows = q[np.arange(q.shape[1]) < count[:, None]]
        else:
            found = [
                inverse_kinematics(self._chain, T, task_mask=self._mask) for T in self._T[part]
            ]
            count = np.array([len(result) for result in found])
            status = np.array([int(result.status) for result in found])
            rows = np.concatenate([result.q for result in found])
        self.count[part] = count
        self.reason[part] = np.where(count > 0, Code.NONE, status)
        if len(rows) and not math.isnan(self._space.length):
            values = condition_number(self._chain, rows, length=self._space.length)
            owner = np.repeat(np.arange(part.start, part.stop), count)
            np.minimum.at(self.condition, owner, values)

    def fill(self, response: Any) -> None:
        """Write the lists of a QueryWorkspace response."""
        response.reachable = (self.count > 0).tolist()
        for name, kind, values in (
            ("reason", "H", self.reason),
            ("solution_count", "I", self.count),
            ("condition_numbers", "d", self.condition),
            ("boundary_distances", "d", self.distance),
        ):
            numbers = array(kind)
            append_numbers(numbers, values)
            setattr(response, name, numbers)
        response.least_reach = self._space.least
        response.greatest_reach = self._space.greatest
