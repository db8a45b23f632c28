"""Rolling robots by name, by path or from a YAML document.

A document says where its numbers come from, and lists the wheels with the arguments of
:class:`Wheel`::

    kind: rolling
    name: cart
    source: where the numbers come from
    drive: diff
    wheels:
      - {name: left, kind: fixed, position: [0.0, 0.2], radius: 0.1}
      - {name: right, kind: fixed, position: [0.0, -0.2], radius: 0.1}
    limits:
      velocity: [2.0, 1.0, 0.0]

Names are those of files in the folder ``rolling`` of the folders of robots.
"""

from __future__ import annotations

import os
from dataclasses import dataclass, fields
from typing import Any

from robomech_ros.errors import RobomechError, RobotDescriptionError
from robomech_ros.robots.documents.guarded_yaml import check_choices, check_keys
from robomech_ros.robots.robot_kinds import checked_document, names_of, source_of
from robomech_ros.rolling.base import RollingBase
from robomech_ros.rolling.bodies import PlatformBody, WheelBody
from robomech_ros.rolling.dynamics import RollingDynamics
from robomech_ros.rolling.limits import MotionLimits
from robomech_ros.rolling.wheels import Wheel

# Kinds of drive, by the names of the controllers of ros2_control, and swerve.
DRIVES = ("diff", "omni", "mecanum", "bicycle", "tricycle", "ackermann", "swerve")
_WHEEL = tuple(field.name for field in fields(Wheel))
_LIMITS = tuple(field.name for field in fields(MotionLimits))
_PLATFORM = tuple(field.name for field in fields(PlatformBody))
_BODY = tuple(field.name for field in fields(WheelBody))
_MOST_WHEELS = 100


@dataclass(frozen=True, eq=False)
class RollingRobot:
    """Rolling robot, as its document describes it.

    Attributes
    ----------
    base : RollingBase
    drive : str
        One of diff, omni, mecanum, bicycle, tricycle, ackermann and swerve.
    limits : MotionLimits
        Infinite where the document has none.
    dynamics : RollingDynamics or None
        Where the document has bodies.
    source : str
        Where the numbers come from.
    """

    base: RollingBase
    drive: str
    limits: MotionLimits
    dynamics: RollingDynamics | None
    source: str


def load_rolling(name_or_path: str | os.PathLike[str]) -> RollingBase:
    """Load the base of a rolling robot.

    Parameters
    ----------
    name_or_path : str or path
        A name (see :func:`list_rolling`), the path of a YAML file, or the text of one.

    Raises
    ------
    UnknownRobotError
        No robot of this name; the error lists those there are.
    RobotDescriptionError
        The document cannot be used: the message says where and why.

    Examples
    --------
    >>> from robomech_ros.rolling import load_rolling
    >>> load_rolling("swerve").mobility.type
    '(1,2)'
    """
    return rolling_robot(name_or_path).base


def rolling_robot(name_or_path: str | os.PathLike[str]) -> RollingRobot:
    """Load a rolling robot: its base, kind of drive and limits.

    Parameters
    ----------
    name_or_path : str or path
        As for :func:`load_rolling`.

    Raises
    ------
    UnknownRobotError, RobotDescriptionError
        As :func:`load_rolling`.

    Examples
    --------
    >>> from robomech_ros.rolling import rolling_robot
    >>> robot = rolling_robot("mecanum")
    >>> robot.drive, robot.limits.velocity.tolist()
    ('mecanum', [1.23, 0.8, 0.8])
    """
    return _from_text(*source_of("rolling", name_or_path))


def list_rolling() -> tuple[str, ...]:
    """List the names of the rolling robots in all folders, sorted.

    Examples
    --------
    >>> from robomech_ros.rolling import list_rolling
    >>> "mecanum" in list_rolling()
    True
    """
    return names_of("rolling")


def _from_text(text: str | bytes, where: str) -> RollingRobot:
    optional = ("limits", "bodies")
    document = checked_document("rolling", text, where, ("drive", "wheels"), optional)
    check_choices(document, where, drive=DRIVES)
    wheels, limits = document["wheels"], document.get("limits", {})
    if not isinstance(wheels, list) or not 0 < len(wheels) <= _MOST_WHEELS:
        why = f"expected a list of up to {_MOST_WHEELS} wheels"
        raise RobotDescriptionError(f"{where}: wheels", why)
    made = [_wheel(one, f"{where}: wheels: {i}") for i, one in enumerate(wheels)]
    check_keys(limits, f"{where}: limits", (), _LIMITS)
    try:
        base = RollingBase(made, name=document["name"])
        bodies = document.get("bodies")
        dynamics = None if bodies is None else _dynamics(base, bodies, f"{where}: bodies")
        bounds = MotionLimits(**limits)
        return RollingRobot(base, document["drive"], bounds, dynamics, document["source"])
    except RobotDescriptionError:
        raise
    except RobomechError as error:
        raise RobotDescriptionError(where, str(error)) from None


def _dynamics(base: RollingBase, entry: Any, where: str) -> RollingDynamics:
    check_keys(entry, where, ("platform", "wheels"), ())
    check_keys(entry["platform"], f"{where}: platform", ("mass", "inertia"), _PLATFORM)
    wheels = entry["wheels"]
    if not isinstance(wheels, dict):
        raise RobotDescriptionError(f"{where}: wheels", "expected the names of wheels, or 'all'")
    check_keys(wheels, f"{where}: wheels", (), ("all", *base.names))
    made = []
    for name in base.names:
        given: Any = wheels.get(name, wheels.get("all", {}))
        check_keys(given, f"{where}: wheels: {name}", (), _BODY)
        made.append(WheelBody(**given))
    return RollingDynamics(base, PlatformBody(**entry["platform"]), made)


def _wheel(entry: Any, where: str) -> Wheel:
    needed = ("name", "kind", "position", "radius")
    check_keys(entry, where, needed, [key for key in _WHEEL if key not in needed])
    try:
        return Wheel(**entry)
    except RobomechError as error:
        raise RobotDescriptionError(where, str(error)) from None
