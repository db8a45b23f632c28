"""Robots described in URDF.

The document is read element by element, so that every fault is named with its line, its joint and
what is allowed.
"""

from collections import Counter
from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from robomech_ros.errors import RobomechError, RobotDescriptionError
from robomech_ros.robots.bodies import Body
from robomech_ros.robots.description import RobotDescription
from robomech_ros.robots.documents.guarded_xml import XmlElement, refuse_xacro, text_of_xml
from robomech_ros.robots.joint import Joint
from robomech_ros.robots.link_tree import LinkTree
from robomech_ros.robots.mimic import mimic_faults
from robomech_ros.robots.urdf.element_reader import ElementReader, parse_urdf
from robomech_ros.robots.urdf.joints import read_joint

_MOMENTS = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
_ORDER = ((0, 1, 2), (1, 3, 4), (2, 4, 5))
LONGEST_NAME = 256
_MOST_NAMES = 20


def link_bodies(links: Iterable[XmlElement], where: str, notes: list[str]) -> dict[str, Body]:
    """Read the bodies of those links that have any, in their own frames.

    Whether a body can have these numbers is asked where they are used (:meth:`Body.fault`), so
    that kinematics goes on without.

    - ``links``: elements of the links, which have names.
    - ``where``: name of the document in messages.
    - ``notes``: receives a note for each value that is given more than once.
    """
    bodies = {}
    for link in links:
        body = _body(ElementReader(link, where), notes)
        if body is not None:
            bodies[link.attributes["name"]] = body
    return bodies


def _body(reader: ElementReader, notes: list[str]) -> Body | None:
    inertial = reader.first("inertial", notes)
    if inertial is None:
        return None
    mass = reader.first("mass", notes, inertial)
    moments = reader.first("inertia", notes, inertial)
    if mass is None or moments is None:
        reader.refuse("<inertial> needs <mass> and <inertia>")
    six = np.array([_required(reader, moments, key) for key in _MOMENTS])
    T = reader.origin(inertial)
    # Our own attribute; other readers pass over it.
    measured = moments.attributes.get("as_measured") == "true"
    try:
        value = _required(reader, mass, "value")
        return Body(value, np.zeros(3), six[_ORDER,], measured).expressed_in(T)
    except RobomechError as error:
        reader.refuse(f"<inertial>: {error}")


def _required(reader: ElementReader, element: XmlElement, attribute: str) -> float:
    numbers = reader.numbers(element, attribute, 1)
    if numbers is None:
        reader.refuse(f"<{element.tag}> has no {attribute}")
    return numbers[0]


def description_from_urdf(text: str | bytes, where: str = "URDF") -> RobotDescription:
    """Read a robot from a URDF document.

    A velocity or effort limit of 0 counts as missing, and so does a position limit of 1e5 and
    more: that is what exporters write when they do not know it, or when there is none.  The soft
    limits of ``<safety_controller>`` narrow the position limits, as MoveIt does.

    A joint with a wrong axis, limit, drive or leader is kept, as others read the rest of the
    document, too: only chains with this joint are refused.  The ``notes`` of the result name it.

    - ``text``: the document, xacro expanded.
    - ``where``: name of the document in messages.

    Raises RobotDescriptionError: the document is broken, hostile or breaks a rule of URDF: line,
    element and reason are named.
    """
    root = parse_urdf(text, where)
    _check_root(root, where)
    joints, links = root.all("joint"), root.all("link")
    link_names = _names(links, "link", where)
    _names(joints, "joint", where)
    if not links:
        raise RobotDescriptionError(where, "no link")
    notes: list[str] = []
    made = tuple(read_joint(joint, where, notes) for joint in joints)
    _check_tree(link_names, made, where)
    faults = mimic_faults(made)
    made = tuple(_without_leader(one, faults.get(one.name, ""), where) for one in made)
    notes += ["{}: {}; no chain takes this joint".format(*one.fault) for one in made if one.fault]
    bodies = link_bodies(links, where, notes)
    return RobotDescription(
        name=root.attributes["name"],
        links=tuple(link_names),
        joints=made,
        where=where,
        bodies=bodies,
        document=text_of_xml(text),
        notes=tuple(notes),
    )


def _without_leader(joint: Joint, fault: str, where: str) -> Joint:
    """Make a joint independent if it mimics a joint that cannot lead."""
    if not fault:
        return joint
    place = f"{where}: joint '{joint.name}'"
    return replace(joint, mimic=None, multiplier=1.0, offset=0.0, fault=(place, fault))


def _check_root(root: XmlElement, where: str) -> None:
    if root.tag != "robot":
        raise RobotDescriptionError(
            where, f"the root element is <{root.tag[:80]}>, expected <robot>"
        )
    if not root.attributes.get("name"):
        raise RobotDescriptionError(where, "<robot> has no name")
    refuse_xacro(root, where)


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


def _check_tree(links: list[str], joints: tuple[Joint, ...], where: str) -> None:
    """Check that the joints make one tree of all links."""
    known = set(links)
    parents: dict[str, Joint] = {}
    for joint in joints:
        place = f"{where}: joint '{joint.name}'"
        for role, link in (("parent", joint.parent), ("child", joint.child)):
            if link not in known:
                names = ", ".join(f"'{name}'" for name in links[:_MOST_NAMES])
                why = f"its {role} link '{link[:80]}' does not exist; the first links are {names}"
                raise RobotDescriptionError(place, why)
        if joint.child in parents:
            other = parents[joint.child].name
            why = f"link '{joint.child}' is already the child of joint '{other}'"
            raise RobotDescriptionError(place, why)
        parents[joint.child] = joint
    roots = [link for link in links if link not in parents]
    if len(roots) > 1:
        names = ", ".join(f"'{link}'" for link in roots[:10])
        raise RobotDescriptionError(where, f"several root links, expected one: {names}")
    tree = LinkTree(tuple(links), joints, where)
    reached = set(roots).union(*map(tree.below, roots))
    if len(reached) < len(links):
        loop = next(link for link in links if link not in reached)
        raise RobotDescriptionError(where, f"link '{loop}' is on or below a loop of joints")
