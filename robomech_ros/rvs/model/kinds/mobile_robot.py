"""A mobile robot that follows commands."""

from abc import abstractmethod
from collections import deque
from collections.abc import Mapping, Sequence
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from robomech_ros.robots import RobotDescription
from robomech_ros.rolling.arcs import moved
from robomech_ros.rvs.model.draggable import SliderRange
from robomech_ros.rvs.model.kinds.tree_view import TreeView
from robomech_ros.typing import Array

# Duration of the drawn path ahead (s), and number of its pieces.
AHEAD, PIECES = 3.0, 60
# Most positions of a trail, and their least distance (m, rad).
MOST_POSITIONS, APART = 2000, 0.01
# Height of a line over the ground (m): on it, it would be hidden.
LIFT = 0.004

# Components of a twist: name, unit, and index in [w, vx, vy].
AXES = (("turn", "rad/s", 0), ("forward", "m/s", 1), ("sideways", "m/s", 2))


class Trail:
    """Past positions of a robot; the oldest ones are dropped."""

    def __init__(self) -> None:
        self._positions: deque[Array] = deque(maxlen=MOST_POSITIONS)

    def add(self, pose: ArrayLike) -> None:
        """Add x, y (m) and heading (rad), unless they are near the last ones."""
        position = np.array(pose, dtype=np.float64)
        if not self._positions or np.abs(self._positions[-1] - position).max() > APART:
            self._positions.append(position)

    def clear(self) -> None:
        """Clear all positions."""
        self._positions.clear()

    @property
    def points(self) -> Array:
        """The positions, on the ground, shape (m, 3) (m)."""
        return on_ground(np.array(self._positions).reshape(-1, 3))


def on_ground(positions: Array) -> Array:
    """Return points on the ground, just above it, for positions (m, 2 or more) (m)."""
    return np.column_stack([positions[:, :2], np.full(len(positions), LIFT)])


class MobileRobotView(TreeView):
    """A mobile robot that moves in time steps; not for several threads at a time.

    - ``trail``: past positions.
    - ``command``: commanded twist [w, vx, vy] (rad/s, m/s), shape (3,).
    """

    #: What the robot does: "drive" or "walk".
    verb: ClassVar[str]
    #: Length of a time step (s).
    period: float
    #: Greatest twist of the sliders (rad/s, m/s), shape (3,); 0 for a component without a slider.
    most: Array
    #: Index of the slider that moved the robot last; the page does not write to that slider.
    moved_joint: int | None = None

    def __init__(
        self, description: RobotDescription, travels: Mapping[str, SliderRange], end: str
    ) -> None:
        super().__init__(description, travels, end)
        self.command = np.zeros(3)
        self.trail = Trail()

    @property
    @abstractmethod
    def pose(self) -> Array:
        """Present x, y (m) and heading (rad), shape (3,)."""

    @property
    @abstractmethod
    def allowed_twist(self) -> Array:
        """The part of the command within limits, shape (3,) (rad/s, m/s)."""

    @property
    @abstractmethod
    def stands(self) -> bool:
        """True if it stands still, without a path."""

    @abstractmethod
    def drive(self, steps: int, *, brake: bool = False) -> None:
        """Follow the command for some periods within all limits, or stop within them."""

    @abstractmethod
    def preview(self) -> None:
        """Describe the effect of the command, and mark the parts that limit it."""

    @abstractmethod
    def facts(self) -> list[tuple[str, str]]:
        """Describe the motion."""

    def path_ahead(self) -> Array:
        """Return the path of the command from here, within limits, shape (m, 3) (m)."""
        twist, pose = self.allowed_twist, self.pose
        if not twist.any():
            return np.empty((0, 3))
        times = np.linspace(0.0, AHEAD, PIECES + 1)
        return on_ground(np.array([moved(pose, twist * time) for time in times]))


def twist_facts(twist: Array, most: Sequence[float] | Array) -> list[tuple[str, str]]:
    """Describe the possible velocities [w, vx, vy]."""
    # Adding 0 makes -0 a plain 0.
    return [(name, f"{twist[k] + 0.0:.3f} {unit}") for name, unit, k in AXES if most[k] or twist[k]]
