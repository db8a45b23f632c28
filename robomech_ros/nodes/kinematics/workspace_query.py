"""Which of many poses a robot reaches, computed in turns with other work of the node."""

import time
from array import array
from typing import Any

import numpy as np
from rclpy.node import Node

from robomech_ros.nodes.common.cooperative_wait import TimeSlices
from robomech_ros.nodes.common.message_fields import append_numbers
from robomech_ros.nodes.kinematics.manipulator import Manipulator
from robomech_ros.outcomes import Code
from robomech_ros.typing import Array

# Poses between two looks whether others wait: of a closed form, and of a search.
_PORTION, _PORTION_SEARCHED = 32, 1


class WorkspaceQuery:
    """Which of many poses can be reached, filled portion by portion.

    Parameters
    ----------
    robot : Manipulator
        After :meth:`Manipulator.prepare`.
    T : ndarray, shape (m, 4, 4)
        In the base (m).
    task_mask : tuple of six bool, or None
        None stands for the full pose.
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
            part = slice(done, min(done + size, len(self._T)))
            self._judge(part)
            done = part.stop
            await turns.end_if_over()
        self.distance = await self._robot.boundary_distances(
            self._T, self.count > 0, began + allowed
        )
        return done

    def _judge(self, part: slice) -> None:
        count, status, q = self._robot.solve_many(self._T[part], task_mask=self._mask)
        self.count[part] = count
        self.reason[part] = np.where(count > 0, Code.NONE, status)
        owner = np.repeat(np.arange(part.start, part.stop), count)
        np.minimum.at(self.condition, owner, self._robot.condition_numbers(q))

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
