"""Joint limits from a file of their own, for robots whose description lacks them.

Two forms are read.  MoveIt's ``joint_limits.yaml``::

    joint_limits:
      elbow: {has_velocity_limits: true, max_velocity: 2.0, has_acceleration_limits: true,
              max_acceleration: 5.0, has_jerk_limits: true, max_jerk: 50.0}

and that of a file beside a URDF, with ``joints``.  MoveIt's may be in a file of parameters, below
the name of a node, ``ros__parameters`` and ``robot_description_planning``.
"""

import dataclasses
import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from rclpy.node import Node

from robomech_ros.errors import MissingLimitsError, RobomechError, RobotDescriptionError
from robomech_ros.execution.joints import TIME_TO_ACCELERATION, TIME_TO_SPEED
from robomech_ros.nodes.common.joints.plan_settings import PlanSettings
from robomech_ros.nodes.common.parameters import ParameterError
from robomech_ros.regular_files import read_regular
from robomech_ros.robots.description import RobotDescription
from robomech_ros.robots.documents.guarded_yaml import (
    LARGEST_YAML,
    check_keys,
    describe_value,
    parse_yaml,
    read_flag,
)
from robomech_ros.robots.documents.yaml_rows import read_number, read_positive
from robomech_ros.robots.joint import Joint
from robomech_ros.robots.robot_yaml import with_yaml_limits

_SECTION = "joint_limits"
_WRAPPERS = ("ros__parameters", "robot_description_planning")
# Namespace, node and the wrappers.
_DEEPEST = 5
_OTHER_SECTIONS = ("cartesian_limits",)
_SCALES = ("default_velocity_scaling_factor", "default_acceleration_scaling_factor")
_TOP_KEYS = {_SECTION, "source", "joints"}
# For each kind: whether there is a limit, and the numbers.
_NUMBERS = {
    "has_position_limits": ("min_position", "max_position"),
    "has_velocity_limits": ("max_velocity",),
    "has_acceleration_limits": ("max_acceleration",),
    "has_deceleration_limits": ("max_deceleration",),
    "has_jerk_limits": ("max_jerk",),
}
# Limits that plans do not use.
_UNUSED = (
    *("has_effort_limits", "max_effort", "min_velocity", "angle_wraparound", "has_soft_limits"),
    *("k_position", "k_velocity", "soft_lower_limit", "soft_upper_limit"),
)
_POSITIONS = _NUMBERS["has_position_limits"]
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
    """A file with joint limits."""

    where: str  #: Path of the file.
    text: bytes  #: The bytes of the file.
    document: Mapping[str, Any]  #: The parsed content.

    def on(self, description: RobotDescription) -> RobotDescription:
        """Return the robot with these limits.

        Accelerations and jerks of the file replace those of the robot; its ranges of positions
        and its velocities only narrow them.

        Raises RobotDescriptionError: a number is no limit; or the file beside a URDF names a joint
        that there is not. In MoveIt's form such joints, of a gripper perhaps, are noted and passed
        over.
        """
        document = _planning_section(self.document)
        if _SECTION not in document:
            return with_yaml_limits(description, self.text, self.where)
        check_keys(document, self.where, (_SECTION,), (*_SCALES, *_OTHER_SECTIONS))
        section = document[_SECTION]
        place = f"{self.where}: {_SECTION}"
        moving = {joint.name: joint for joint in description.joints if joint.moves}
        if not isinstance(section, dict):
            raise RobotDescriptionError(place, "expected joint names, each with its limits")
        notes = [
            f"{place}: no joint {describe_value(name)} in {description.where}, which has: "
            f"{', '.join([*moving][:40])}; it is left out"
            for name in section
            if name not in moving
        ]
        joints = tuple(
            _limited(joint, section[joint.name], f"{place}: joint '{joint.name}'")
            if joint.name in section
            else joint
            for joint in description.joints
        )
        notes = [*description.notes, *notes]
        return dataclasses.replace(description, joints=joints, notes=tuple(notes))


def _planning_section(document: Mapping[str, Any]) -> Mapping[str, Any]:
    """Unpack a file of parameters: node, its namespaces, ``ros__parameters`` and their prefix."""
    for _ in range(_DEEPEST):
        within = [document[key] for key in _WRAPPERS if isinstance(document.get(key), dict)]
        if not within and len(document) == 1 and not _TOP_KEYS & document.keys():
            within = [value for value in document.values() if isinstance(value, dict)]
        if not within:
            break
        document = within[0]
    return document


def robot_limits(node: Node, settings: PlanSettings) -> dict[str, Any]:
    """Return functions that complete the limits of a robot, as keywords of `when_robot_known`.

    The file of the parameter ``joint_limits`` gives what the description lacks.  The parameter
    ``assume_limits`` lets the rest be assumed, which the log says.
    """

    def completed(robot: RobotDescription) -> RobotDescription:
        if not settings.assume_limits:
            return robot
        completed, notice, file = with_assumed_rates(robot)
        if notice:
            more = "to set your own, edit this file and pass it with --joint-limits FILE"
            node.get_logger().warning(f"{notice}; {more}:\n{file}")
        return completed

    limits = read_joint_limits(settings.joint_limits) if settings.joint_limits else None
    return {"supplemented": limits.on if limits else None, "completed": completed}


def with_assumed_rates(description: RobotDescription) -> tuple[RobotDescription, str, str]:
    """Assume missing limits of acceleration and jerk from the limits of velocity.

    Returns the description, a notice of assumed limits (empty if none), and the text of a
    file with the same limits in MoveIt's form, to copy.
    """
    limits: dict[str, dict[str, Any]] = {}
    for joint in description.joints:
        acceleration = _or(joint.acceleration, joint.velocity / TIME_TO_SPEED)
        jerk = _or(joint.jerk, acceleration / TIME_TO_ACCELERATION)
        lacks = math.isnan(joint.acceleration) or math.isnan(joint.jerk)
        own = joint.moves and joint.mimic is None and joint.fault is None
        if own and lacks and math.isfinite(acceleration):
            limits[joint.name] = {"acceleration": acceleration, "jerk": jerk}
    if not limits:
        return description, "", ""
    joints = tuple(
        dataclasses.replace(joint, **limits.get(joint.name, {})) for joint in description.joints
    )
    notice = (
        "acceleration or jerk limits of some joints are missing (URDF has none); assumed: "
        f"full speed in {TIME_TO_SPEED:g} s, full acceleration in {TIME_TO_ACCELERATION:g} s"
    )
    return dataclasses.replace(description, joints=joints), notice, _as_file(limits)


def _or(given: float, assumed: float) -> float:
    return assumed if math.isnan(given) else given


def _as_file(limits: Mapping[str, Mapping[str, float]]) -> str:
    rows = {
        name: {
            "has_acceleration_limits": True,
            "max_acceleration": float(f"{one['acceleration']:.6g}"),
            "has_jerk_limits": True,
            "max_jerk": float(f"{one['jerk']:.6g}"),
        }
        for name, one in limits.items()
    }
    return yaml.safe_dump({_SECTION: rows}, default_flow_style=None, sort_keys=False, width=120)


def read_joint_limits(path: str) -> JointLimitsFile:
    """Read joint limits; ParameterError: unreadable file, RobotDescriptionError: not YAML."""
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
        "velocity": float(np.fmin(joint.velocity, values.get("max_velocity", math.nan))),
        # One limit serves both directions; without an acceleration limit there is none.
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


def _values(entry: Mapping[str, Any], place: str) -> dict[str, float]:
    """List the numbers that count: those whose ``has_`` is not false."""
    values: dict[str, float] = {}
    for has, keys in _NUMBERS.items():
        if not read_flag(entry.get(has, any(key in entry for key in keys)), has, place):
            continue
        for key in keys:
            number = read_number(entry.get(key), key, place)
            # Pilz has decelerations below zero.
            number = abs(number) if key == "max_deceleration" else number
            values[key] = number if key in _POSITIONS else read_positive(number, key, place)
    return values
