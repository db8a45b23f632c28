"""Joints of a URDF.

What other readers (urdfdom, and with it robot_state_publisher and MoveIt) ignore is ignored here,
too: axis, limits, dynamics, mimic and safety of a joint that does not move, whatever stands there.
"""

import math
from dataclasses import replace
from typing import Any

import numpy as np

from robomech_ros.errors import RobomechError, RobotDescriptionError
from robomech_ros.robots.documents.guarded_xml import XmlElement
from robomech_ros.robots.drives import DRIVE_KEYS, Drive
from robomech_ros.robots.joint import MOVING, Joint
from robomech_ros.robots.limit_arrays import position_limits
from robomech_ros.robots.urdf.element_reader import ElementReader
from robomech_ros.typing import Array

# A joint axis must be given with at least this length before it is normalised.
AXIS_LENGTH = 1e-9
JOINT_TYPES = ("revolute", "continuous", "prismatic", "fixed", "floating", "planar")
# Our own element, for what <dynamics> has no attribute for; other readers pass over it.
DRIVE_TAG = "robomech_drive"
_LIMIT_KEYS = ("lower", "upper", "velocity", "effort", "acceleration", "jerk")


def read_joint(element: XmlElement, where: str, notes: list[str]) -> Joint:
    """Read a joint; one that cannot move as it is described gets its fault.

    - ``element``: element of the joint, which has a name.
    - ``where``: name of the document in messages.
    - ``notes``: receives a note for each given value that is not a valid limit.
    """
    reader = ElementReader(element, where)
    kind = element.attributes.get("type", "")
    if kind not in JOINT_TYPES:
        reader.refuse(f"type is '{kind[:80]}', expected one of {', '.join(JOINT_TYPES)}")
    parent, child = reader.link("parent"), reader.link("child")
    # urdfdom takes the first of several origins.
    origins = element.all("origin")[:1]
    if any("quat_xyzw" in origin.attributes for origin in origins):
        reader.refuse("<origin> has quat_xyzw, of URDF 1.1; expected rpy, which all readers know")
    joint = Joint(element.attributes["name"], kind, parent, child, reader.pose(origins))
    if kind not in MOVING:
        return joint
    try:
        joint = replace(joint, axis=_read_axis(reader, notes))
        motion = _read_limits(reader, kind, notes) | _read_drive(reader) | _read_mimic(reader)
    except RobotDescriptionError as error:
        return replace(joint, fault=(error.where, error.why))
    return replace(joint, **motion)


def _read_axis(reader: ElementReader, notes: list[str]) -> Array:
    given = reader.first("axis", notes)
    values = None if given is None else reader.numbers(given, "xyz", 3)
    axis = np.array(values or (1.0, 0.0, 0.0))
    if given is not None and math.hypot(*axis) < AXIS_LENGTH:
        shown = given.attributes["xyz"][:80]
        reader.refuse(f"axis is '{shown}', of zero length; expected a direction, such as '0 0 1'")
    # By the largest entry first, so that no square overflows.
    axis = axis / np.abs(axis).max()
    return axis / np.linalg.norm(axis)


def _read_limits(reader: ElementReader, kind: str, notes: list[str]) -> dict[str, Any]:
    limit = reader.child("limit", required=kind != "continuous")
    if limit is None:
        return {}
    values = {}
    for key in _LIMIT_KEYS:
        numbers = reader.numbers(limit, key, 1)
        values[key] = None if numbers is None else numbers[0]
    for key in ("velocity", "effort"):
        if values[key] is None:
            reader.refuse(f"<limit> has no {key}; URDF requires effort and velocity")
    for key in _LIMIT_KEYS[2:]:
        value = values[key]
        if value is not None and value < 0.0:
            notes.append(f"{reader.where}: {key} limit is {value:g}, which counts as missing")
            values[key] = None
    rest = {key: values[key] or math.nan for key in _LIMIT_KEYS[2:]}
    if kind == "continuous":
        return rest
    lower, upper = values["lower"] or 0.0, values["upper"] or 0.0
    if lower > upper:
        reader.refuse(f"lower limit {lower:g} is above upper limit {upper:g}")
    lower, upper = _within_soft_limits(reader, lower, upper)
    rest["lower"], rest["upper"] = position_limits(lower, upper)
    return rest


def _within_soft_limits(reader: ElementReader, lower: float, upper: float) -> tuple[float, float]:
    """Narrow limits (rad or m) to those of the safety controller, as MoveIt does.

    One soft limit that is missing is 0, as URDF says; where both are, there are none.
    """
    safety = reader.child("safety_controller")
    if safety is None:
        return lower, upper
    soft = [reader.numbers(safety, f"soft_{key}_limit", 1) for key in ("lower", "upper")]
    if soft == [None, None]:
        return lower, upper
    low, high = (numbers[0] if numbers else 0.0 for numbers in soft)
    if max(lower, low) > min(upper, high):
        reader.refuse(
            f"soft limits {low:g} and {high:g} of <safety_controller> leave nothing of the limits "
            f"{lower:g} and {upper:g}; expected a range that overlaps"
        )
    return max(lower, low), min(upper, high)


def _read_drive(reader: ElementReader) -> dict[str, Drive]:
    """Read the drive: our own element, else that of the friction in <dynamics>."""
    dynamics, friction = reader.child("dynamics"), list[float]()
    for key in ("damping", "friction"):
        numbers = None if dynamics is None else reader.numbers(dynamics, key, 1)
        friction.append(numbers[0] if numbers else 0.0)
        if friction[-1] < 0.0:
            reader.refuse(f"{key} is {friction[-1]:g}, expected no negative number")
    given = reader.child(DRIVE_TAG)
    if given is None:
        return {"drive": Drive(*friction)}
    own = {key: reader.numbers(given, key, 1) for key in DRIVE_KEYS}
    try:
        return {"drive": Drive(**{key: value[0] for key, value in own.items() if value})}
    except RobomechError as error:
        reader.refuse(f"<{DRIVE_TAG}>: {error}")


def _read_mimic(reader: ElementReader) -> dict[str, Any]:
    mimic = reader.child("mimic")
    if mimic is None:
        return {}
    if not mimic.attributes.get("joint"):
        reader.refuse("<mimic> names no joint")
    multiplier = reader.numbers(mimic, "multiplier", 1) or [1.0]
    offset = reader.numbers(mimic, "offset", 1) or [0.0]
    return {"mimic": mimic.attributes["joint"], "multiplier": multiplier[0], "offset": offset[0]}
