"""The place of the joints, kept in case the process of the simulated robot is killed."""

from collections.abc import Sequence

import numpy as np
from rclpy.node import Node

from robomech_ros.nodes.joint_trajectory_controller.commanded_joints import CommandedJoints
from robomech_ros.nodes.joint_trajectory_controller.settings import ControllerSettings
from robomech_ros.nodes.process.crash_record import LeftBehind, open_crash_record
from robomech_ros.typing import Array

_NAME = "place_of_the_joints"
# A joint may be off its limits by this much (rad, m) where it was stopped by force.
_BEYOND = 0.1


class KeptPlace:
    """Keeps where the joints are, and puts them back there if the process before was killed.

    A real robot stays where it is when the process of its controller dies.

    Parameters
    ----------
    node : Node
        Whose robot it is.
    robot : str
        Its name.
    commanded : sequence of CommandedJoints
        What moves; they share a lock.
    settings : ControllerSettings
        Where the joints are at start, and how long a place counts.
    """

    def __init__(
        self,
        node: Node,
        robot: str,
        commanded: Sequence[CommandedJoints],
        settings: ControllerSettings,
    ) -> None:
        self._logger = node.get_logger()
        self._commanded = commanded
        bounds = [joints.bounds for joints in commanded]
        self._lower = np.concatenate([lower for lower, _ in bounds])
        self._upper = np.concatenate([upper for _, upper in bounds])
        names = [name for joints in commanded for name in joints.shown_names]
        limits = (repr(self._lower.tolist()), repr(self._upper.tolist()))
        self._record = (
            open_crash_record(node, _NAME, (robot, *names, *limits))
            if settings.resume_within
            else None
        )
        left = None if self._record is None else self._record.left
        if left is not None and left.age <= settings.resume_within:
            if settings.initial_positions:
                self._logger.warning("begins at initial_positions, though its process was killed")
            else:
                self._resume(left)

    def keep(self) -> None:
        """Note where the joints are; their lock is to be held."""
        if self._record is None:
            return
        now = [joints.kept() for joints in self._commanded]
        try:
            self._record.write(np.concatenate(now).tobytes())
        except OSError as error:
            self._logger.warning(f"where the joints are is kept no longer: {error.strerror}")
            self.forget()

    def forget(self) -> None:
        """Let the next process begin at its initial positions: this one ends in good order."""
        record, self._record = self._record, None
        if record is not None:
            record.close()

    def _resume(self, left: LeftBehind) -> None:
        position = np.frombuffer(left.data) if len(left.data) == self._lower.nbytes else None
        if position is None or not self._possible(position):
            self._logger.warning("the place of the joints that was kept is not one of this robot")
            return
        start = 0
        for joints in self._commanded:
            end = start + len(joints.shown_names)
            joints.resume(position[start:end])
            start = end
        self._logger.warning(
            f"this robot's process was killed {left.age:.1f} s ago: the joints stand where they "
            "were then; the service reset puts them to their initial positions"
        )

    def _possible(self, position: Array) -> bool:
        low, high = self._lower - _BEYOND, self._upper + _BEYOND
        return bool(np.all((low <= position) & (position <= high) & np.isfinite(position)))
