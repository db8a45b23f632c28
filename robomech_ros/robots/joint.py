"""A joint of a robot's tree."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from robomech_ros.robots.chain_layout import joint_transform
from robomech_ros.robots.drives import Drive
from robomech_ros.typing import Array

MOVING = ("revolute", "continuous", "prismatic")


@dataclass(frozen=True, eq=False)
class Joint:
    """A joint of a robot's tree.

    The child link's pose in the parent link is ``origin J(q) after``, J a rotation about or a
    translation along the axis.  Limits are in rad, m, s, N m and N; lower and upper are infinite
    and the others NaN where there is none.  A joint that mimics another stands at ``multiplier``
    times its position plus ``offset`` (rad or m).  A joint with a ``fault``, which is a place in
    the document and what is wrong there, is on no chain.
    """

    name: str
    type: str
    parent: str
    child: str
    origin: Array
    axis: Array = field(default_factory=lambda: np.array([0.0, 0.0, 1.0]))
    after: Array = field(default_factory=lambda: np.eye(4))
    lower: float = -np.inf
    upper: float = np.inf
    velocity: float = np.nan
    acceleration: float = np.nan
    jerk: float = np.nan
    effort: float = np.nan
    mimic: str | None = None
    drive: Drive = field(default_factory=Drive)
    multiplier: float = 1.0
    offset: float = 0.0
    fault: tuple[str, str] | None = None

    @property
    def moves(self) -> bool:
        """True if the joint is one that a chain can contain as a variable."""
        return self.type in MOVING

    @property
    def unit(self) -> str:
        """The unit of its positions: rad, or m where it slides."""
        return "m" if self.type == "prismatic" else "rad"

    @cached_property
    def rest(self) -> float:
        """Position 0 or, where that is beyond a limit, the limit (rad or m)."""
        return float(np.clip(0.0, self.lower, self.upper))

    def pose(self, position: float) -> Array:
        """Return the pose of the child link in the parent link, shape (4, 4) (m).

        Parameters
        ----------
        position : float
            rad or m; without meaning for a joint that is not revolute, continuous or prismatic.
        """
        if not self.moves or position == 0.0:
            return self.origin @ self.after
        turn = rotation_from_z(self.axis)
        motion = joint_transform(self.type == "prismatic", position)
        return self.origin @ turn @ motion @ turn.T @ self.after


def rotation_from_z(axis: Array) -> Array:
    """Rotate z onto a unit vector; without rounding where that is a coordinate axis."""
    x, y, z = axis
    T = np.eye(4)
    if z == 1.0:
        return T
    if z < 0.0:
        # Half a turn about x first: the formula below is singular at z = -1.
        T[:3, :3] = np.diag((1.0, -1.0, -1.0))
        return T if z == -1.0 else T @ rotation_from_z(np.array([x, -y, -z]))
    k = 1.0 / (1.0 + z)
    T[:3, :3] = ((1.0 - k * x * x, -k * x * y, x), (-k * x * y, 1.0 - k * y * y, y), (-x, -y, z))
    return T
