"""A running mobile robot, shown at its reported pose."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from robomech_ros.rolling.library import RollingRobot
from robomech_ros.rolling.tree import BASE_JOINTS
from robomech_ros.rvs.model.kinds.mobile_robot import MobileRobotView, Trail
from robomech_ros.rvs.model.kinds.rolling import BaseView
from robomech_ros.rvs.model.kinds.tree_view import TreeView
from robomech_ros.typing import Array

if TYPE_CHECKING:
    from robomech_ros.walking import LeggedRobot


class JogDirection(NamedTuple):
    """A jog direction of a mobile robot."""

    #: Label on the page.
    name: str
    #: One of "linear", "angular".
    kind: str
    #: Index of the axis of the twist, from 0.
    axis: int


class Shift(NamedTuple):
    """A motion of the trunk over standing feet."""

    #: Label on the page.
    name: str
    #: One of "m", "rad".
    unit: str
    #: Largest distance or angle to either side (m or rad).
    most: float


JOG_DIRECTIONS = (
    JogDirection("forward", "linear", 0),
    JogDirection("sideways", "linear", 1),
    JogDirection("turn", "angular", 2),
)


class ObservedRobot(TreeView):
    """A robot that is not moved on the page.

    - ``view``: the same robot at rest, which is drawn.
    - ``joints``: names of the joints whose positions are received.
    - ``placed``: returns the joints that place it at a pose (4, 4) over the ground (m).
    - ``directions``: its jog directions.
    - ``gaits``: names of its gaits.
    - ``shifts``: motions of the trunk: x, y, z, roll, pitch, yaw.
    - ``trail``: past positions.
    """

    def __init__(
        self,
        view: MobileRobotView,
        joints: Sequence[str],
        placed: Callable[[Array], Mapping[str, float]],
        directions: Sequence[JogDirection] = JOG_DIRECTIONS,
        gaits: Sequence[str] = (),
        shifts: Sequence[Shift] = (),
    ) -> None:
        super().__init__(view.description, {}, view.end)
        self.verb, self.room, self.joints, self.placed = view.verb, view.room, joints, placed
        self.directions, self.gaits, self.shifts = directions, gaits, shifts
        self.trail = Trail()

    def update(self, positions: Mapping[str, float], position: ArrayLike) -> None:
        """Update joints (rad or m, by name), and x, y (m) and heading (rad), shape (3,)."""
        self.place(positions)
        self.trail.add(position)


def observed_base(robot: RollingRobot) -> ObservedRobot:
    """Return a rolling robot that runs."""
    base = robot.base
    directions = JOG_DIRECTIONS if base.axle is None else JOG_DIRECTIONS[::2]
    turned = [f"{name}_steering" for name in base.steered]
    joints = (*base.names, *turned, *(f"{name}_bracket" for name in base.casters))

    def placed(T: Array) -> Mapping[str, float]:
        return dict(zip(BASE_JOINTS, on_plane(T).tolist(), strict=True))

    return ObservedRobot(BaseView(robot), joints, placed, directions)


def observed_walker(robot: LeggedRobot) -> ObservedRobot:
    """Return a walking machine that runs; errors are those of ``WalkerView``."""
    # Compiled code for legs is loaded only if there are some.
    from robomech_ros.rvs.model.walking.placed_tree import placing
    from robomech_ros.rvs.model.walking.walker_view import WalkerView

    view = WalkerView(robot)

    def placed(T: Array) -> Mapping[str, float]:
        return placing(on_plane(T), T, view.height)

    shifts = [
        Shift(name.replace("_", " "), unit, view.travel(k).high)
        for k, (name, unit) in enumerate(zip(view.joint_names, view.units, strict=True))
    ]
    return ObservedRobot(view, robot.joint_names, placed, gaits=view.gaits, shifts=shifts)


def on_plane(T: Array) -> Array:
    """Return x, y (m) and heading (rad) of a pose (4, 4) over the ground."""
    return np.array([T[0, 3], T[1, 3], math.atan2(T[1, 0], T[0, 0])])
