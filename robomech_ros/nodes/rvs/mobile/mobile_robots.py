"""Rolling robots and walking machines: what is shown of them, and on which topics they are."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from robomech_ros.nodes.mobile_base.drives import INTERFACES
from robomech_ros.nodes.rvs.settings import RvsSettings
from robomech_ros.rolling import rolling_robot
from robomech_ros.rvs.model.running.observed_robot import (
    ObservedRobot,
    observed_base,
    observed_walker,
)

if TYPE_CHECKING:
    from robomech_ros.walking import LeggedRobot

# How often twists are sent while a button is held (s).
_BASE_PERIOD, _WALKER_PERIOD = 0.005, 0.02


@dataclass(frozen=True, eq=False)
class MobileRobot:
    """A robot that moves over the ground, its topics and its node.

    - ``followed``: the robot as the page draws it.
    - ``command``, ``odometry``: topics of stamped twists and of odometry.
    """

    name: str  #: Name of the robot.
    followed: ObservedRobot
    node: str  #: Name of its node, which says on /diagnostics which limits act at present.
    command: str
    odometry: str
    #: Period of twists while a button is held (s). Some drives follow each twist for only one of
    #: their own periods.
    period: float
    legged: LeggedRobot | None = None  #: Its legs; None if it rolls.


def _rolling(settings: RvsSettings) -> MobileRobot:
    robot = rolling_robot(settings.robot_description)
    topics, node = INTERFACES[robot.drive], settings.mobile_base
    command, odometry = (name.replace("~", node, 1) for name in (topics.command, topics.odometry))
    return MobileRobot(robot.base.name, observed_base(robot), node, command, odometry, _BASE_PERIOD)


def _walking(settings: RvsSettings) -> MobileRobot:
    # Compiled code for legs is loaded only if there are some.
    from robomech_ros.walking import load_legged

    legs, node = load_legged(settings.robot_description), settings.walker
    followed = observed_walker(legs)
    return MobileRobot(legs.name, followed, node, "cmd_vel", "odom", _WALKER_PERIOD, legs)


# By the kinds of robots; each loads the robot of the parameters, or raises a RobomechError.
MOVERS: dict[str, Callable[[RvsSettings], MobileRobot]] = {"rolling": _rolling, "walking": _walking}
