"""Poses of the links behind many joints, all at once."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from robomech_ros.robots import Joint
from robomech_ros.spatial.plain_poses import plain_pose
from robomech_ros.typing import Array


class JointPoses:
    r"""Poses of the child links of k joints in their parents, all of them at once.

    By Rodrigues' formula the place is :math:`p_0 + p_1 \cos\theta + p_2 \sin\theta + p_3 d` for a
    joint turned by :math:`\theta` or moved by d, and the quaternion :math:`q_0 \cos(\theta/2) + q_1
    \sin(\theta/2)`; what is constant is made once. Joints are fixed or of one degree of freedom.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., ch. 2 and app. A.
    """

    def __init__(self, joints: Sequence[Joint]) -> None:
        self._turns = np.array([j.moves and j.type != "prismatic" for j in joints], dtype=bool)
        (here, there, aside), (start, quarter) = self._samples(joints)
        self._place = np.stack(
            (0.5 * (here + there), 0.5 * (here - there), aside - 0.5 * (here + there))
        )
        self._place[:, ~self._turns] = 0.0
        self._place[0, ~self._turns] = here[~self._turns]
        self._way = np.where(self._turns[:, None], 0.0, there - here) / np.pi
        # The quaternion of the quarter turn nearer to that of the start.
        near = np.where(np.sum(start * quarter, axis=1, keepdims=True) < 0.0, -1.0, 1.0)
        self._quaternion = np.stack((start, np.sqrt(2.0) * near * quarter - start))

    @staticmethod
    def _samples(joints: Sequence[Joint]) -> tuple[list[Any], list[Any]]:
        """Return places at 0, pi and pi / 2, and quaternions at 0 and pi / 2, each (k, 3 or 4)."""
        split = [
            [plain_pose(joint.pose(at)) for joint in joints] for at in (0.0, np.pi, 0.5 * np.pi)
        ]
        places = [np.array([place for place, _ in one]).reshape(-1, 3) for one in split]
        turns = [np.array([turn for _, turn in one]).reshape(-1, 4) for one in split]
        return places, [turns[0], turns[2]]

    def at(self, positions: Array) -> tuple[Array, Array]:
        """Return places (k, 3) in m and quaternions xyzw (k, 4), at positions (k,) in rad or m."""
        angle = np.where(self._turns, positions, 0.0)[:, None]
        first, second, third = self._place
        place = first + second * np.cos(angle) + third * np.sin(angle)
        half = 0.5 * angle
        turn = self._quaternion[0] * np.cos(half) + self._quaternion[1] * np.sin(half)
        return place + self._way * positions[:, None], turn
