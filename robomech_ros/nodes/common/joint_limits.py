"""Joint limits from a file of their own, for robots whose description lacks them.

Two forms are read.  MoveIt's ``joint_limits.yaml``::

    joint_limits:
      elbow: {has_velocity_limits: true, max_velocity: 2.0, has_acceleration_limits: true,
              max_acceleration: 5.0, has_jerk_limits: true, max_jerk: 50.0}

and that of a file beside a URDF, with ``source`` and ``joints``.
"""

import dataclasses
import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from robomech_ros.errors import MissingLimitsError, RobomechError, RobotDescriptionError
from robomech_ros.nodes.common.parameters import ParameterError
from robomech_ros.regular_files import read_regular
from robomech_ros.robots.description import RobotDescription
from robomech_ros.robots.documents.guarded_yaml import LARGEST_YAML, check_keys, parse_yaml
from robomech_ros.robots.joint import Joint
from robomech_ros.robots.robot_yaml import with_yaml_limits

__all__ = ["JointLimitsFile", "NoLimitsForPlanError", "read_joint_limits"]

_SECTION = "joint_limits"
_SCALES = ("default_velocity_scaling_factor", "default_acceleration_scaling_factor")
# Of each kind whether there is a limit, and the numbers.
_NUMBERS = {
    "has_position_limits": ("min_position", "max_position"),
    "has_velocity_limits": ("max_velocity",),
    "has_acceleration_limits": ("max_acceleration",),
    "has_deceleration_limits": ("max_deceleration",),
    "has_jerk_limits": ("max_jerk",),
}
# What a plan has no use for.
_UNUSED = (
    *("has_effort_limits", "max_effort", "min_velocity", "angle_wraparound", "has_soft_limits"),
    *("k_position", "k_velocity", "soft_lower_limit", "soft_upper_limit"),
)
_KEYS = (*_NUMBERS, *(key for keys in _NUMBERS.values() for key in keys), *_UNUSED)


class NoLimitsForPlanError(MissingLimitsError):
    """A limit is missing that a plan needs; says where the planner takes it from."""

    def __init__(self, error: MissingLimitsError) -> None:
        self.kind, self.joints = error.kind, error.joints
        RobomechError.__init__(
            self, f"{error}; the planner's parameter joint_limits may name a file that gives it"
        )


@dataclass(frozen=True)
class JointLimitsFile:
    """A file with joint limits.

    Attributes
    ----------
    where : str
        Its path.
    text : bytes
        What is in it.
    document : mapping
        The same, parsed.
    """

    where: str
    text: bytes
    document: Mapping[str, Any]

    def on(self, description: RobotDescription) -> RobotDescription:
        """Give a robot these limits.

        Accelerations and jerks of the file replace those of the robot; its ranges of positions
        and its velocities only narrow them.

        Raises
        ------
        RobotDescriptionError
            The file names what the robot does not have, or a number that is no limit.
        """
        if _SECTION not in self.document:
            return with_yaml_limits(description, self.text, self.where)
        check_keys(self.document, self.where, (_SECTION,), _SCALES)
        section = self.document[_SECTION]
        place = f"{self.where}: {_SECTION}"
        moving = {joint.name: joint for joint in description.joints if joint.moves}
        if not isinstance(section, dict):
            raise RobotDescriptionError(place, "expected joint names, each with its limits")
        for name in section:
            if name not in moving:
                why = f"no joint '{str(name)[:80]}' in {description.where}, which has: "
                raise RobotDescriptionError(place, why + ", ".join([*moving][:40]))
        joints = tuple(
            _limited(joint, section[joint.name], f"{place}: joint '{joint.name}'")
            if joint.name in section
            else joint
            for joint in description.joints
        )
        return dataclasses.replace(description, joints=joints)


def read_joint_limits(path: str) -> JointLimitsFile:
    """Read a file with joint limits.

    Raises
    ------
    ParameterError
        It cannot be read.
    RobotDescriptionError
        It is not YAML.
    """
    file = Path(path).expanduser()
    try:
        text = read_regular(file, LARGEST_YAML)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        allowed = f"the path of a YAML file with joint limits ({reason})"
        raise ParameterError("joint_limits", path, allowed) from None
    return JointLimitsFile(str(file), text, parse_yaml(text, str(file)))


def _limited(joint: Joint, entry: object, place: str) -> Joint:
    values = _values(check_keys(entry, place, (), _KEYS), place)
    acceleration = values.get("max_acceleration", joint.acceleration)
    changes: dict[str, Any] = {
        "lower": max(joint.lower, values.get("min_position", -math.inf)),
        "upper": min(joint.upper, values.get("max_position", math.inf)),
        "velocity": _least(joint.velocity, values.get("max_velocity")),
        # One limit serves both ways; what has no acceleration limit keeps none.
        "acceleration": min(acceleration, values.get("max_deceleration", math.inf)),
        "jerk": values.get("max_jerk", joint.jerk),
    }
    if changes["lower"] > changes["upper"]:
        why = (
            f"no position from {changes['lower']:g} to {changes['upper']:g} {joint.unit}, what "
            "this file and the robot have in common"
        )
        raise RobotDescriptionError(place, why)
    return dataclasses.replace(joint, **changes)


def _least(own: float, given: float | None) -> float:
    """Take the lower of two limits, the first of which is NaN where there is none."""
    if given is None:
        return own
    return given if math.isnan(own) else min(own, given)


def _values(entry: Mapping[str, Any], place: str) -> dict[str, float]:
    """List the numbers that count: those whose ``has_`` is not false."""
    values: dict[str, float] = {}
    for has, keys in _NUMBERS.items():
        present = entry.get(has, any(key in entry for key in keys))
        if not isinstance(present, bool):
            raise RobotDescriptionError(place, f"{has} is {str(present)[:80]!r}, expected a bool")
        if not present:
            continue
        for key in keys:
            values[key] = _number(entry.get(key), key, place)
    return values


def _number(value: object, key: str, place: str) -> float:
    number = not isinstance(value, bool) and isinstance(value, int | float)
    if not number or not math.isfinite(value):  # type: ignore[arg-type]
        raise RobotDescriptionError(place, f"{key} is {str(value)[:80]!r}, expected a number")
    if not key.endswith("_position") and value <= 0.0:  # type: ignore[operator]
        raise RobotDescriptionError(place, f"{key} is {value}, expected a positive number")
    return float(value)  # type: ignore[arg-type]
