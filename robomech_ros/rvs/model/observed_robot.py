"""A running mobile robot, shown at its reported pose."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from robomech_ros.robots import RobotDescription
from robomech_ros.rolling.library import RollingRobot
from robomech_ros.rolling.tree import BASE_JOINTS
from robomech_ros.rvs.model.kinds.rolling import BaseView
from robomech_ros.rvs.model.kinds.trail import Trail
from robomech_ros.rvs.model.kinds.tree_view import TreeView
from robomech_ros.typing import Array

if TYPE_CHECKING:
    from robomech_ros.walking import LeggedRobot


class JogDirection(NamedTuple):
    """A direction in which it is jogged.

    Parameters
    ----------
    name : str
        For people.
    kind : {"linear", "angular"}
    axis : int
        Of its twist.
    """

    name: str
    kind: str
    axis: int


class Shift(NamedTuple):
    """How the trunk can be moved over feet that stay.

    Parameters
    ----------
    name : str
        For people.
    unit : {"m", "rad"}
    most : float
        How far either way (m or rad).
    """

    name: str
    unit: str
    most: float


JOG_DIRECTIONS = (
    JogDirection("forward", "linear", 0),
    JogDirection("sideways", "linear", 1),
    JogDirection("turn", "angular", 2),
)


class ObservedRobot(TreeView):
    """A robot that is not moved on the page.

    Parameters
    ----------
    description : RobotDescription
        With the joints that place it.
    end : str
        The link that says where it is.
    verb : str
        What it does: drive, or walk.
    joints : sequence of str
        Those that are heard of.
    placed : callable
        Gives the joints that place it, for its pose over the ground (4, 4).
    ways : sequence of JogDirection
        In which it can be jogged.
    gaits : sequence of str, optional
        In which it can walk.
    shifts : sequence of Shift, optional
        Of the trunk: x, y, z, roll, pitch, yaw.
    room : float, optional
        Side of the square that is seen (m).

    Attributes
    ----------
    trail : Trail
        Where it was.
    """

    def __init__(
        self,
        description: RobotDescription,
        end: str,
        verb: str,
        joints: Sequence[str],
        placed: Callable[[Array], Mapping[str, float]],
        ways: Sequence[JogDirection],
        gaits: Sequence[str] = (),
        shifts: Sequence[Shift] = (),
        room: float = 0.0,
    ) -> None:
        super().__init__(description, {}, end)
        self.verb, self.ways, self.gaits = verb, tuple(ways), tuple(gaits)
        self.shifts = tuple(shifts)
        self.joints, self.placed = tuple(joints), placed
        self.room = room
        self.trail = Trail()

    def hear(self, positions: Mapping[str, float], place: ArrayLike) -> None:
        """Be where the robot is.

        Parameters
        ----------
        positions : mapping of str to float
            rad or m, by joint.
        place : array_like, shape (3,)
            x, y (m) and heading (rad).
        """
        self.place(positions)
        self.trail.add(place)


def observed_base(robot: RollingRobot) -> ObservedRobot:
    """Return a rolling robot that runs."""
    base = robot.base
    ways = JOG_DIRECTIONS if base.axle is None else (JOG_DIRECTIONS[0], JOG_DIRECTIONS[2])
    seen = BaseView(robot)
    turned = [f"{name}_steering" for name in base.steered]
    joints = (*base.names, *turned, *(f"{name}_bracket" for name in base.casters))

    def placed(T: Array) -> Mapping[str, float]:
        return dict(zip(BASE_JOINTS, on_plane(T).tolist(), strict=True))

    what = seen.description, seen.end, seen.verb, joints, placed, ways
    return ObservedRobot(*what, room=seen.room)


def observed_walker(robot: LeggedRobot) -> ObservedRobot:
    """Return a walking machine that runs; errors are those of ``WalkerView``."""
    # What is compiled for legs is loaded only where there are some.
    from robomech_ros.rvs.model.walking.placed_tree import placing
    from robomech_ros.rvs.model.walking.walker_view import WalkerView

    seen = WalkerView(robot)

    def placed(T: Array) -> Mapping[str, float]:
        return placing(on_plane(T), T, seen.height)

    shifts = [
        Shift(name.replace("_", " "), unit, seen.travel(k).high)
        for k, (name, unit) in enumerate(zip(seen.joint_names, seen.units, strict=True))
    ]
    what = seen.description, seen.end, seen.verb, robot.joint_names, placed, JOG_DIRECTIONS
    return ObservedRobot(*what, seen.gaits, shifts, seen.room)


def on_plane(T: Array) -> Array:
    """Return x, y (m) and heading (rad) of a pose (4, 4) over the ground."""
    return np.array([T[0, 3], T[1, 3], math.atan2(T[1, 0], T[0, 0])])
