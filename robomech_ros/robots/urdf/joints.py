"""Joints of a URDF: checked, read by the ecosystem's parser, and completed.

What other readers (urdfdom, and with it robot_state_publisher and MoveIt) ignore is ignored here,
too: axis, limits, dynamics, mimic and safety of a joint that does not move, whatever stands there.
"""

import math
from typing import Any
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from robomech_ros.errors import RobomechError, RobotDescriptionError
from robomech_ros.robots.documents.guarded_xml import XmlElement
from robomech_ros.robots.drives import Drive
from robomech_ros.robots.joint import MOVING, Joint
from robomech_ros.robots.limit_arrays import position_limits
from robomech_ros.robots.urdf.element_reader import ElementReader

__all__ = ["DRIVE_KEYS", "DRIVE_TAG", "checked_joint", "joint_from_parsed"]

# A joint axis must be given with at least this length before it is normalised.
AXIS_LENGTH = 1e-9
JOINT_TYPES = ("revolute", "continuous", "prismatic", "fixed", "floating", "planar")
# Our own element, for what <dynamics> has no attribute for; other readers pass over it.
DRIVE_TAG = "robomech_drive"
DRIVE_KEYS = ("viscous", "coulomb", "static", "stribeck_velocity", "rotor_inertia", "gear_ratio")
_LIMIT_KEYS = ("lower", "upper", "velocity", "effort", "acceleration", "jerk")

Array = NDArray[np.float64]


def checked_joint(
    element: XmlElement, where: str, notes: list[str]
) -> tuple[ElementTree.Element, dict[str, Any]]:
    """Check a joint, and copy what the ecosystem's parser is to read of it.

    Parameters
    ----------
    element : XmlElement
        Named.
    where : str
        What the document is called in messages.
    notes : list of str
        Gets what is no limit although it is given.

    Returns
    -------
    copy : Element
        For the parser.
    rest : dict
        Fields of :class:`Joint` that the parser does not know, or not as MoveIt does.  The fault
        of a joint that cannot move as it is described is one of them.

    Raises
    ------
    RobotDescriptionError
        The tree cannot be made without this joint: the line, the joint, the value and what is
        expected are named.
    """
    reader = ElementReader(element, where)
    kind = element.attributes.get("type", "")
    if kind not in JOINT_TYPES:
        reader.refuse(f"type is '{kind[:80]}', expected one of {', '.join(JOINT_TYPES)}")
    copy = ElementTree.Element("joint", {"name": element.attributes["name"], "type": kind})
    for tag in ("parent", "child"):
        ElementTree.SubElement(copy, tag, {"link": reader.link(tag)})
    # Of several origins urdfdom takes the first.
    origin = next(iter(element.all("origin")), None)
    if origin is not None:
        if "quat_xyzw" in origin.attributes:
            reader.refuse(
                "<origin> has quat_xyzw, of URDF 1.1; expected rpy, which all readers know"
            )
        _copy(reader, origin, copy, {"xyz": 3, "rpy": 3})
    if kind not in MOVING:
        return copy, {}
    motion = ElementTree.Element("joint")
    try:
        _copy_axis(reader, motion)
        rest: dict[str, Any] = _read_limits(reader, kind, motion, notes)
        _copy_friction(reader, motion)
        rest |= _read_drive(reader)
        rest |= _read_mimic(reader)
    except RobotDescriptionError as error:
        return copy, {"fault": (error.where, error.why)}
    copy.extend(motion)
    return copy, rest


def _copy(
    reader: ElementReader, element: XmlElement, parent: ElementTree.Element, counts: dict[str, int]
) -> None:
    attributes = {}
    for attribute, count in counts.items():
        if reader.numbers(element, attribute, count) is not None:
            attributes[attribute] = element.attributes[attribute]
    ElementTree.SubElement(parent, element.tag, attributes)


def _copy_axis(reader: ElementReader, copy: ElementTree.Element) -> None:
    axis = reader.child("axis")
    values = reader.numbers(axis, "xyz", 3) if axis is not None else None
    if axis is None or values is None:
        return
    if math.hypot(*values) < AXIS_LENGTH:
        shown = axis.attributes["xyz"][:80]
        reader.refuse(f"axis is '{shown}', of zero length; expected a direction, such as '0 0 1'")
    _copy(reader, axis, copy, {"xyz": 3})


def _read_limits(
    reader: ElementReader, kind: str, copy: ElementTree.Element, notes: list[str]
) -> dict[str, Any]:
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


def _copy_friction(reader: ElementReader, copy: ElementTree.Element) -> None:
    dynamics = reader.child("dynamics")
    if dynamics is None:
        return
    for key in ("damping", "friction"):
        numbers = reader.numbers(dynamics, key, 1)
        if numbers is not None and numbers[0] < 0.0:
            reader.refuse(f"{key} is {numbers[0]:g}, expected no negative number")
    _copy(reader, dynamics, copy, {"damping": 1, "friction": 1})


def _read_drive(reader: ElementReader) -> dict[str, Drive]:
    given = reader.child(DRIVE_TAG)
    if given is None:
        return {}
    numbers = {key: reader.numbers(given, key, 1) for key in DRIVE_KEYS}
    try:
        return {"drive": Drive(**{key: value[0] for key, value in numbers.items() if value})}
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
    return {
        "mimic": mimic.attributes["joint"],
        "multiplier": multiplier[0],
        "offset": offset[0],
    }


def joint_from_parsed(parsed: Any, rest: dict[str, Any]) -> Joint:
    """Convert a joint as the ecosystem's parser gives it.

    Parameters
    ----------
    parsed : urdf_parser_py.urdf.Joint
    rest : dict
        Fields that the parser does not know.
    """
    xyz = parsed.origin.xyz if parsed.origin is not None else None
    rpy = parsed.origin.rpy if parsed.origin is not None else None
    axis = np.array(parsed.axis if parsed.axis is not None else (1.0, 0.0, 0.0), dtype=float)
    # By the largest entry first, so that no square overflows.
    axis = axis / np.abs(axis).max()
    dynamics = parsed.dynamics
    if dynamics is not None and "drive" not in rest:
        rest = {**rest, "drive": Drive(dynamics.damping or 0.0, dynamics.friction or 0.0)}
    return Joint(
        name=parsed.name,
        type=parsed.type,
        parent=parsed.parent,
        child=parsed.child,
        origin=_pose(xyz or (0.0, 0.0, 0.0), rpy or (0.0, 0.0, 0.0)),
        axis=axis / np.linalg.norm(axis),
        **rest,
    )


def _pose(xyz: Any, rpy: Any) -> Array:
    from robomech_ros.spatial import matrix_from_roll_pitch_yaw

    T = np.eye(4)
    T[:3, :3] = matrix_from_roll_pitch_yaw([float(angle) for angle in rpy])
    T[:3, 3] = xyz
    return T
