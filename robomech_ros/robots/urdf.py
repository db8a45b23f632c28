"""Robots described in URDF.

The document is checked element by element first, so that every fault is named with its line, its
joint and what is allowed; what remains, without geometry and extensions, goes to the ecosystem's
parser, ``urdf_parser_py``.
"""

import math
from collections import Counter
from collections.abc import Callable
from typing import Any
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from robomech_ros.errors import RobotDescriptionError
from robomech_ros.robots.description import RobotDescription
from robomech_ros.robots.drives import Drive
from robomech_ros.robots.guarded_xml import XmlElement, parse_xml
from robomech_ros.robots.joint import Joint
from robomech_ros.robots.limit_arrays import position_limits
from robomech_ros.robots.urdf_inertial import link_bodies
from robomech_ros.robots.urdf_reader import ElementReader

__all__ = ["description_from_urdf"]

# A joint axis must be given with at least this length before it is normalised.
AXIS_LENGTH = 1e-9

Array = NDArray[np.float64]

JOINT_TYPES = ("revolute", "continuous", "prismatic", "fixed", "floating", "planar")
LONGEST_NAME = 256


def description_from_urdf(text: str | bytes, where: str = "URDF") -> RobotDescription:
    """Read a robot from a URDF document.

    A velocity or effort limit of 0 counts as missing, and so does a position limit of 1e5 and
    more: that is what exporters write when they do not know it, or when there is none.

    Parameters
    ----------
    text : str or bytes
        The document, xacro expanded.
    where : str, optional
        What it is called in messages.

    Raises
    ------
    RobotDescriptionError
        The document is broken, hostile or breaks a rule of URDF: line, element and reason are
        named.
    """
    root = parse_xml(text, where)
    _check_root(root, where)
    joints, links = root.all("joint"), root.all("link")
    link_names = _names(links, "link", where)
    _names(joints, "joint", where)
    if not links:
        raise RobotDescriptionError(where, "no link")
    stripped = ElementTree.Element("robot", {"name": root.attributes["name"]})
    for name in link_names:
        ElementTree.SubElement(stripped, "link", {"name": name})
    for joint in joints:
        stripped.append(_checked_joint(joint, where))
    parsed = _parsed(stripped, where)
    made = tuple(_joint(joint) for joint in parsed.joints)
    _check_tree(link_names, made, where)
    return RobotDescription(
        root.attributes["name"], tuple(link_names), made, where, bodies=link_bodies(links, where)
    )


def _check_root(root: XmlElement, where: str) -> None:
    if root.tag != "robot":
        raise RobotDescriptionError(
            where, f"the root element is <{root.tag[:80]}>, expected <robot>"
        )
    if not root.attributes.get("name"):
        raise RobotDescriptionError(where, "<robot> has no name")
    for child in root.children:
        if child.tag.startswith("xacro:"):
            place = f"{where}: line {child.line}"
            why = f"<{child.tag[:80]}>: expand it first, with `xacro model.xacro > model.urdf`"
            raise RobotDescriptionError(place, why)


def _names(elements: list[XmlElement], kind: str, where: str) -> list[str]:
    names = []
    for element in elements:
        name = element.attributes.get("name", "")
        place = f"{where}: line {element.line}"
        if not name:
            raise RobotDescriptionError(place, f"a {kind} without a name")
        if len(name) > LONGEST_NAME:
            raise RobotDescriptionError(place, f"a {kind}'s name longer than {LONGEST_NAME}")
        names.append(name)
    name, count = Counter(names).most_common(1)[0] if names else ("", 0)
    if count > 1:
        lines = [str(e.line) for e in elements if e.attributes["name"] == name]
        raise RobotDescriptionError(
            f"{where}: {kind} '{name}'", f"defined {count} times, in lines {', '.join(lines[:10])}"
        )
    return names


def _checked_joint(element: XmlElement, where: str) -> ElementTree.Element:
    """Check a joint and copy what a chain needs of it."""
    reader = ElementReader(element, where)
    kind = element.attributes.get("type", "")
    if kind not in JOINT_TYPES:
        reader.refuse(f"type is '{kind[:80]}', expected one of {', '.join(JOINT_TYPES)}")
    copy = ElementTree.Element("joint", {"name": element.attributes["name"], "type": kind})
    for tag in ("parent", "child"):
        ElementTree.SubElement(copy, tag, {"link": reader.link(tag)})
    origin = reader.child("origin")
    if origin is not None:
        _copy(reader, origin, copy, {"xyz": 3, "rpy": 3})
    axis = reader.child("axis")
    if axis is not None:
        values = reader.numbers(axis, "xyz", 3)
        if values is not None and math.hypot(*values) < AXIS_LENGTH:
            reader.refuse(f"axis is '{axis.attributes['xyz'][:80]}', of zero length")
        if values is not None:
            _copy(reader, axis, copy, {"xyz": 3})
    _check_limit(reader, kind, copy)
    dynamics = reader.child("dynamics")
    if dynamics is not None:
        _check_friction(reader, dynamics, copy)
    mimic = reader.child("mimic")
    if mimic is not None:
        if not mimic.attributes.get("joint"):
            reader.refuse("<mimic> names no joint")
        ElementTree.SubElement(copy, "mimic", {"joint": mimic.attributes["joint"]})
    return copy


def _copy(
    reader: ElementReader, element: XmlElement, parent: ElementTree.Element, counts: dict[str, int]
) -> None:
    attributes = {}
    for attribute, count in counts.items():
        if reader.numbers(element, attribute, count) is not None:
            attributes[attribute] = element.attributes[attribute]
    ElementTree.SubElement(parent, element.tag, attributes)


def _check_limit(reader: ElementReader, kind: str, copy: ElementTree.Element) -> None:
    limit = reader.child("limit", required=kind in ("revolute", "prismatic"))
    if limit is None or kind not in ("revolute", "prismatic", "continuous"):
        return
    values = {}
    for key in ("lower", "upper", "velocity", "effort"):
        numbers = reader.numbers(limit, key, 1)
        values[key] = None if numbers is None else numbers[0]
    for key in ("velocity", "effort"):
        value = values[key]
        if value is None:
            reader.refuse(f"<limit> has no {key}; URDF requires effort and velocity")
        elif value < 0.0:
            reader.refuse(f"{key} limit is {value:g}, expected no negative number")
    lower, upper = values["lower"] or 0.0, values["upper"] or 0.0
    if kind != "continuous" and lower > upper:
        reader.refuse(f"lower limit {lower:g} is above upper limit {upper:g}")
    _copy(reader, limit, copy, {"lower": 1, "upper": 1, "velocity": 1, "effort": 1})


def _check_friction(
    reader: ElementReader, dynamics: XmlElement, parent: ElementTree.Element
) -> None:
    for key in ("damping", "friction"):
        numbers = reader.numbers(dynamics, key, 1)
        if numbers is not None and numbers[0] < 0.0:
            reader.refuse(f"{key} is {numbers[0]:g}, expected no negative number")
    _copy(reader, dynamics, parent, {"damping": 1, "friction": 1})


def _parsed(stripped: ElementTree.Element, where: str) -> Any:
    from urdf_parser_py.urdf import URDF

    try:
        return URDF.from_xml_string(ElementTree.tostring(stripped))
    except Exception as error:
        # The parser raises plain exceptions and assertions of every kind.
        raise RobotDescriptionError(where, f"not accepted by urdf_parser_py: {error}") from None


def _joint(parsed: Any) -> Joint:
    """Convert a joint as the ecosystem's parser gives it."""
    xyz = parsed.origin.xyz if parsed.origin is not None else None
    rpy = parsed.origin.rpy if parsed.origin is not None else None
    axis = np.array(parsed.axis if parsed.axis is not None else (1.0, 0.0, 0.0), dtype=float)
    # By the largest entry first, so that no square overflows.
    axis = axis / np.abs(axis).max()
    rest: dict[str, Any] = {}
    if parsed.limit is not None:
        rest["velocity"] = parsed.limit.velocity or math.nan
        rest["effort"] = parsed.limit.effort or math.nan
        if parsed.type != "continuous":
            rest["lower"], rest["upper"] = position_limits(
                parsed.limit.lower or 0.0, parsed.limit.upper or 0.0
            )
    dynamics = parsed.dynamics
    if dynamics is not None:
        rest["drive"] = Drive(dynamics.damping or 0.0, dynamics.friction or 0.0)
    return Joint(
        name=parsed.name,
        type=parsed.type,
        parent=parsed.parent,
        child=parsed.child,
        origin=_pose(xyz or (0.0, 0.0, 0.0), rpy or (0.0, 0.0, 0.0)),
        axis=axis / np.linalg.norm(axis),
        mimic=parsed.mimic.joint if parsed.mimic is not None else None,
        **rest,
    )


def _pose(xyz: Any, rpy: Any) -> Array:
    from robomech_ros.spatial import matrix_from_roll_pitch_yaw

    T = np.eye(4)
    T[:3, :3] = matrix_from_roll_pitch_yaw([float(angle) for angle in rpy])
    T[:3, 3] = xyz
    return T


def _check_tree(links: list[str], joints: tuple[Joint, ...], where: str) -> None:
    """Check that the joints make one tree of all links."""
    known = set(links)
    parents: dict[str, Joint] = {}
    children: dict[str, list[str]] = {}
    for joint in joints:
        place = f"{where}: joint '{joint.name}'"
        for role, link in (("parent", joint.parent), ("child", joint.child)):
            if link not in known:
                raise RobotDescriptionError(place, f"its {role} link '{link[:80]}' does not exist")
        if joint.child in parents:
            other = parents[joint.child].name
            why = f"link '{joint.child}' is already the child of joint '{other}'"
            raise RobotDescriptionError(place, why)
        parents[joint.child] = joint
        children.setdefault(joint.parent, []).append(joint.child)
    roots = [link for link in links if link not in parents]
    if len(roots) > 1:
        names = ", ".join(f"'{link}'" for link in roots[:10])
        raise RobotDescriptionError(where, f"several root links, expected one: {names}")
    reached = _reached(roots, children.get)
    if len(reached) < len(links):
        loop = next(link for link in links if link not in reached)
        raise RobotDescriptionError(where, f"link '{loop}' is on or below a loop of joints")


def _reached(roots: list[str], children: Callable[[str, list[str]], list[str]]) -> set[str]:
    reached = set(roots)
    waiting = list(roots)
    while waiting:
        for child in children(waiting.pop(), []):
            reached.add(child)
            waiting.append(child)
    return reached
