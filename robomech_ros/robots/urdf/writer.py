"""A URDF of every robot, with something to be seen of each of its parts.

A robot from a Denavit-Hartenberg table is written anew.  A URDF keeps its text, meshes and
extensions included; visual bodies are added where a rigid part has none, and what its YAML file
knows besides: limits of acceleration and jerk, and drives.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from robomech_ros.robots.description import RobotDescription
from robomech_ros.robots.documents.guarded_xml import XmlElement
from robomech_ros.robots.drives import Drive
from robomech_ros.robots.joint import Joint
from robomech_ros.robots.urdf.element_reader import parse_urdf
from robomech_ros.robots.urdf.elements import (
    drive_element,
    element,
    inertial_element,
    joint_element,
    new_name,
    visual_elements,
)
from robomech_ros.robots.urdf.joints import DRIVE_TAG
from robomech_ros.robots.urdf.shapes import Shape, generated_shapes

_DECLARATION = '<?xml version="1.0" encoding="utf-8"?>\n'
# A tag as a whole; its attributes may contain what looks like its end.
_TAG = re.compile(rb"<(?:\"[^\"]*\"|'[^']*'|[^\"'>])*>")
_ADDED_LIMITS = ("acceleration", "jerk")


def urdf_from_description(description: RobotDescription) -> str:
    """Return a URDF in which every part of a robot can be seen.

    Parameters
    ----------
    description : RobotDescription
        From a URDF: its text comes back, with visual bodies for rigid parts that have none, and
        limits of acceleration and jerk and drives that its YAML file gave.  Otherwise a document
        is written, in which a joint whose axis is not in the frame of its link gets a link of its
        own.

    Returns
    -------
    str
        The document; loaded again, it has the same links, chains, limits, bodies and drives.

    See Also
    --------
    load_description : reads one.

    Examples
    --------
    >>> from robomech_ros.robots import load_description, load_robot, urdf_from_description
    >>> text = urdf_from_description(load_description("puma560"))
    >>> load_robot(text, tip="tool0").joint_names == load_robot("puma560").joint_names
    True
    """
    if description.document:
        return _completed(description)
    return written_urdf(description)


def written_urdf(
    description: RobotDescription, given: Mapping[str, Sequence[Shape]] | None = None
) -> str:
    """Write a URDF anew.

    - ``given``: shapes of links in their frames, for parts that are to look otherwise than those
      made for any robot.
    """
    joints = list(_with_axes_in_links(description))
    shapes = {**generated_shapes(description.root, joints, given or ()), **(given or {})}
    seen = {*description.links}
    links = [*description.links, *(one.child for one in joints if one.child not in seen)]
    parts = []
    for link in links:
        children = visual_elements(shapes.get(link, ()))
        if link in description.bodies:
            children.insert(0, inertial_element(description.bodies[link]))
        parts.append(element("link", {"name": link}, children))
    parts += map(joint_element, joints)
    source = description.source.replace("--", "- -")
    comment = f"<!-- Source: {source} -->\n" if source else ""
    return f"{_DECLARATION}{comment}{element('robot', {'name': description.name}, parts)}\n"


def _with_axes_in_links(description: RobotDescription) -> Iterator[Joint]:
    """Yield joints after which nothing follows, as in URDF: fixed ones take what does."""
    taken = {*description.links, *(joint.name for joint in description.joints)}
    for joint in description.joints:
        if joint.type == "fixed":
            yield Joint(joint.name, "fixed", joint.parent, joint.child, joint.origin @ joint.after)
        elif np.array_equal(joint.after, np.eye(4)):
            yield joint
        else:
            between = new_name(f"{joint.name}_frame", taken)
            yield replace(joint, child=between, after=np.eye(4))
            fixed = new_name(f"{between}_fixed_joint", taken)
            yield Joint(fixed, "fixed", between, joint.child, joint.after)


def _completed(description: RobotDescription) -> str:
    """Put what is missing into the text of a URDF."""
    data = description.document.encode()
    root = parse_urdf(description.document, description.where)
    links, joints = root.all("link"), root.all("joint")
    seen = {link.attributes["name"] for link in links if link.all("visual")}
    shapes = generated_shapes(description.root, description.joints, seen)
    added: list[tuple[int, int, str]] = []
    for link in links:
        visuals = visual_elements(shapes.get(link.attributes["name"], ()))
        if visuals:
            added.append(_inside(link, data, visuals))
    for given, joint in zip(joints, description.joints, strict=True):
        added.extend(_added_to_joint(given, joint, data))
    parts, at = list[bytes](), 0
    for start, stop, text in sorted(added):
        parts += data[at:start], text.encode()
        at = stop
    return b"".join([*parts, data[at:]]).decode()


def _inside(given: XmlElement, data: bytes, children: list[str]) -> tuple[int, int, str]:
    """Say what to replace, from byte to byte, to put elements at the end of one."""
    tag = _TAG.match(data, given.first_byte)
    assert tag is not None
    margin = _margin(data, given.first_byte).decode()
    lines = [line for child in children for line in child.split("\n")]
    text = "".join(f"{margin}  {line}\n" for line in lines)
    if tag.group().endswith(b"/>"):
        return tag.end() - 2, tag.end(), f">\n{text}{margin}</{given.tag}>"
    last = given.last_byte
    if data[:last].rstrip(b" \t").endswith(b"\n"):
        last -= len(_margin(data, last))
        return last, last, text
    return last, last, f"\n{text}{margin}"


def _margin(data: bytes, at: int) -> bytes:
    """Return the blanks in front of a place, if nothing else is in front of it on its line."""
    line = data[data.rfind(b"\n", 0, at) + 1 : at]
    return b"" if line.strip() else line


def _added_to_joint(given: XmlElement, joint: Joint, data: bytes) -> Iterator[tuple[int, int, str]]:
    """Say what to add of the limits and the drive that the document does not have."""
    if not joint.moves or joint.fault is not None:
        return
    limits = {
        key: getattr(joint, key) for key in _ADDED_LIMITS if not math.isnan(getattr(joint, key))
    }
    written = given.all("limit")
    if written:
        at = written[0].first_byte + len("<limit")
        missing = {key: x for key, x in limits.items() if key not in written[0].attributes}
        if missing:
            yield at, at, "".join(f' {key}="{value!r}"' for key, value in missing.items())
    children = []
    if limits and not written:
        children.append(element("limit", {"effort": 0.0, "velocity": 0.0, **limits}))
    if joint.drive != _drive_of(given) and not given.all(DRIVE_TAG):
        children.append(drive_element(joint.drive))
    if children:
        yield _inside(given, data, children)


def _drive_of(given: XmlElement) -> Drive:
    """Read the drive that <dynamics> makes; it has been checked."""
    attributes = given.all("dynamics")[0].attributes if given.all("dynamics") else {}
    return Drive(*(float(attributes.get(key, 0.0)) for key in ("damping", "friction")))
