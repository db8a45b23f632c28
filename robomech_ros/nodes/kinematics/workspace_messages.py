"""Judging and encoding which poses a robot reaches."""

import math
import time
from array import array
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rclpy.node import Node
from sensor_msgs.msg import PointCloud2, PointField

from robomech_interfaces.msg import ErrorCode
from robomech_ros.errors import RobomechError
from robomech_ros.kinematics import inverse_kinematics, inverse_kinematics_batch
from robomech_ros.kinematics.inverse.families.selection import family_of
from robomech_ros.kinetostatics import (
    Workspace,
    characteristic_length,
    condition_number,
    extreme_reach,
    workspace_boundary,
)
from robomech_ros.kinetostatics.workspace.positioning_part import positioning_part
from robomech_ros.nodes.common.message_fields import append_numbers
from robomech_ros.nodes.common.pauses import Turns, beside
from robomech_ros.nodes.common.pose_messages import matrix_from_pose
from robomech_ros.nodes.common.robot_description import RobotModel
from robomech_ros.robots import SerialChain

__all__ = ["Judgement", "ReachOfRobot", "poses_in_base", "reach_of", "workspace_cloud"]

Array = NDArray[np.float64]

# Poses between two looks whether others wait: of a closed form, and of a search.
_PORTION, _PORTION_SEARCHED = 32, 1


@dataclass(frozen=True, eq=False)
class ReachOfRobot:
    """What is the same for all poses of a robot.

    Parameters
    ----------
    least, greatest : float
        Distance of the tip from the first joint (m).
    length : float
        Characteristic length (m); NaN for an arm that has none.
    space : Workspace or None
        None for an arm without a positioning part.
    centre : ndarray, shape (3,)
        The point that this part places, in the frame of the tip (m).
    """

    least: float
    greatest: float
    length: float
    space: Workspace | None
    centre: Array


def reach_of(chain: SerialChain) -> ReachOfRobot:
    """Find what holds for all poses of a robot; this takes some seconds."""
    try:
        length = float(characteristic_length(chain))
    except RobomechError:
        length = math.nan
    space, centre = None, np.zeros(3)
    try:
        space, centre = workspace_boundary(chain), positioning_part(chain).in_tip
        space.distance(np.zeros(3))  # what is the same for all points is found now
    except RobomechError:
        space = None
    return ReachOfRobot(*extreme_reach(chain), length, space, centre)


def poses_in_base(model: RobotModel, poses: list[Any]) -> Array:
    """Convert the poses of a request to transforms in the base, shape (m, 4, 4) (m).

    Raises
    ------
    NonFiniteError, BadQuaternionError, FrameUnavailableError
        The message names the pose by its index.
    """
    T = np.empty((len(poses), 4, 4))
    for k, stamped in enumerate(poses):
        frame = model.frame_in_base(stamped.header.frame_id)
        pose = matrix_from_pose(stamped.pose, f"poses[{k}].pose")
        T[k] = pose if frame is None else frame @ pose
    return T


class Judgement:
    """Which of many poses can be reached, filled portion by portion.

    Parameters
    ----------
    chain : SerialChain
    T : ndarray, shape (m, 4, 4)
        In the base (m).
    mask : tuple of six bool
        Task mask; all of it false stands for the full pose.
    reach : ReachOfRobot
    """

    def __init__(
        self, chain: SerialChain, T: Array, mask: tuple[bool, ...], reach: ReachOfRobot
    ) -> None:
        self._chain, self._T, self._reach = chain, T, reach
        self._mask = mask if any(mask) and not all(mask) else None
        self.count = np.zeros(len(T), np.int64)
        self.reason = np.full(len(T), ErrorCode.TIMED_OUT, np.int64)
        self.condition = np.full(len(T), np.inf)
        self.distance = np.full(len(T), np.nan)

    async def work(self, node: Node, allowed: float) -> int:
        """Judge the poses in turns with others; give how many were, in the time allowed (s)."""
        if self._reach.space is not None and len(self._T):
            await beside(node, self._measure)
        turns, began, done = Turns(node), time.monotonic(), 0
        fast = self._mask is None and family_of(self._chain).closed_form
        size = _PORTION if fast else _PORTION_SEARCHED
        while done < len(self._T) and time.monotonic() - began < allowed:
            part = slice(done, min(done + size, len(self._T)))
            self._judge(part)
            done = part.stop
            await turns.end_if_over()
        return done

    def _measure(self) -> None:
        space = self._reach.space
        if space is not None:
            centres = self._T[:, :3, :3] @ self._reach.centre + self._T[:, :3, 3]
            self.distance = space.distance(centres)

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
        self.reason[part] = np.where(count > 0, ErrorCode.NONE, status)
        if len(rows) and not math.isnan(self._reach.length):
            values = condition_number(self._chain, rows, length=self._reach.length)
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
        response.least_reach = self._reach.least
        response.greatest_reach = self._reach.greatest


def workspace_cloud(frame: str, T: Array, count: NDArray[np.int64], distance: Array) -> PointCloud2:
    """Make a cloud of judged poses: x, y, z, how many solutions, distance from the boundary.

    Parameters
    ----------
    frame : str
        Base of the chain.
    T : ndarray, shape (m, 4, 4)
        m.
    count : ndarray of int, shape (m,)
    distance : ndarray, shape (m,)
        m, NaN where it is not known.
    """
    rows = np.column_stack((T[:, :3, 3], count, distance)).astype("<f4")
    names = ("x", "y", "z", "solutions", "boundary_distance")
    fields = [
        PointField(name=name, offset=4 * k, datatype=PointField.FLOAT32, count=1)
        for k, name in enumerate(names)
    ]
    message = PointCloud2(height=1, width=len(rows), fields=fields, is_dense=False)
    message.header.frame_id = frame
    message.point_step = rows.itemsize * len(names)
    message.row_step = message.point_step * len(rows)
    message.data = array("B", rows.tobytes())
    return message
