"""SRDF documents, checked against the robot that they speak of.

Groups are made as MoveIt makes them: of chains, joints, links (each stands for the joint above
it) and other groups.  Of names that the robot does not have, those in pairs of links without
collisions are passed over, as MoveIt does; all others are refused.
"""

import math
import os
from collections.abc import Collection, Iterator
from difflib import get_close_matches
from pathlib import Path
from typing import NoReturn

from robomech_ros.errors import BadValueError, RobotDescriptionError
from robomech_ros.robots.description import RobotDescription
from robomech_ros.robots.guarded_xml import LARGEST_XML, XmlElement, parse_xml, refuse_xacro
from robomech_ros.robots.joint import Joint
from robomech_ros.robots.semantic import (
    DisabledCollision,
    EndEffector,
    Group,
    SemanticDescription,
)
from robomech_ros.robots.source_files import read_source

__all__ = ["load_srdf"]

_MOST_NAMES = 20


def load_srdf(
    text_or_path: str | os.PathLike[str], description: RobotDescription
) -> SemanticDescription:
    """Read the semantic description of a robot.

    Parameters
    ----------
    text_or_path : str or path
        The text of an SRDF, xacro expanded, or the path of a file.
    description : RobotDescription
        The robot.

    Returns
    -------
    SemanticDescription

    Raises
    ------
    RobotDescriptionError
        The document is broken or hostile, or names a group, link or joint that there is not:
        the line, the name and those there are are given.
    BadValueError
        Neither text nor a path.

    See Also
    --------
    load_description : the robot.

    Examples
    --------
    >>> from robomech_ros.robots import load_description, load_srdf
    >>> text = '''<robot name="ur5e">
    ...   <group name="arm"><chain base_link="base_link" tip_link="tool0"/></group>
    ...   <group_state name="up" group="arm">
    ...     <joint name="shoulder_lift_joint" value="-1.57"/>
    ...   </group_state>
    ... </robot>'''
    >>> semantic = load_srdf(text, load_description("ur5e"))
    >>> semantic.groups["arm"].ends, semantic.states["arm"]["up"]
    (('base_link', 'tool0'), {'shoulder_lift_joint': -1.57})
    """
    given: object = text_or_path
    data: str | bytes
    if isinstance(given, str) and given.lstrip("\ufeff \t\r\n").startswith("<"):
        data, where = given, "SRDF string"
    elif isinstance(given, str | os.PathLike) and str(given).strip():
        where = str(given)
        data = read_source(Path(given).expanduser(), LARGEST_XML)
    else:
        raise BadValueError("SRDF", given, "the text of an SRDF, or a path")
    return _Reader(parse_xml(data, where), where, description).read()


class _Reader:
    """Reads one document."""

    def __init__(self, root: XmlElement, where: str, description: RobotDescription) -> None:
        self._root = root
        self._where = where
        self._robot = description
        self._joints = {joint.name: joint for joint in description.joints}
        self._to_parent = {joint.child: joint for joint in description.joints}
        virtual = [one.attributes.get("name", "") for one in root.all("virtual_joint")]
        # In the order in which messages list them.
        self._all_joints = dict.fromkeys([*self._joints, *virtual])
        self._links = dict.fromkeys(description.links)

    def read(self) -> SemanticDescription:
        """Read all of it."""
        tag = self._root.tag
        if tag != "robot":
            self._refuse(self._root, f"the root element is <{tag[:80]}>, expected <robot>")
        refuse_xacro(self._root, self._where)
        groups = self._groups()
        return SemanticDescription(
            name=self._root.attributes.get("name", ""),
            groups=groups,
            end_effectors=dict(self._end_effectors(groups)),
            states=self._states(groups),
            disabled_collisions=tuple(self._disabled()),
        )

    def _refuse(self, element: XmlElement, why: str) -> NoReturn:
        name = element.attributes.get("name", "")
        what = f" '{name[:80]}'" if name else ""
        place = f"{self._where}: line {element.line}: {element.tag}{what}"
        raise RobotDescriptionError(place, why)

    def _named(self, element: XmlElement, key: str, known: Collection[str], kind: str) -> str:
        """Read an attribute that names something known."""
        name = element.attributes.get(key, "")
        if name not in known:
            names = list(known)
            close = get_close_matches(name[:80], names[:1000], n=1)
            hint = f" (did you mean '{close[0]}'?)" if close else ""
            listed = ", ".join(names[:_MOST_NAMES]) or "none"
            self._refuse(element, f"{key} is '{name[:80]}'{hint}, expected a {kind}: {listed}")
        return name

    def _groups(self) -> dict[str, Group]:
        elements: dict[str, XmlElement] = {}
        for element in self._root.all("group"):
            name = element.attributes.get("name", "")
            if not name or name in elements:
                why = "given twice" if name else "a group without a name"
                self._refuse(element, why)
            elements[name] = element
        made: dict[str, set[str]] = {}
        for name in elements:
            self._fill(name, elements, made)
        return {name: self._group(elements[name], made[name]) for name in elements}

    def _fill(self, start: str, elements: dict[str, XmlElement], made: dict[str, set[str]]) -> None:
        """Collect the joints of a group, those of the groups in it first."""
        path = [start]
        while path:
            element = elements[path[-1]]
            inner = [self._named(one, "name", elements, "group") for one in element.all("group")]
            missing = next((name for name in inner if name not in made), None)
            if missing is None:
                joints = set(self._joints_of(element))
                made[path.pop()] = joints.union(*(made[name] for name in inner))
            elif missing in path:
                self._refuse(element, f"contains itself: {' -> '.join([*path, missing])}")
            else:
                path.append(missing)

    def _joints_of(self, element: XmlElement) -> Iterator[str]:
        for chain in element.all("chain"):
            base, tip = self._chain_ends(chain)
            yield from (joint.name for joint in self._between(chain, base, tip))
        for one in element.all("joint"):
            name = self._named(one, "name", self._all_joints, "joint")
            if name in self._joints:
                yield name
        for one in element.all("link"):
            link = self._named(one, "name", self._links, "link")
            if link in self._to_parent:
                yield self._to_parent[link].name

    def _chain_ends(self, chain: XmlElement) -> tuple[str, str]:
        base = self._named(chain, "base_link", self._links, "link")
        return base, self._named(chain, "tip_link", self._links, "link")

    def _between(self, chain: XmlElement, base: str, tip: str) -> list[Joint]:
        """List the joints from one link to the other, by way of the link above both."""
        above_base, above_tip = self._above(base), self._above(tip)
        if base == tip:
            self._refuse(chain, f"base_link and tip_link are both '{base}', expected two links")
        while above_base and above_tip and above_base[-1] is above_tip[-1]:
            above_base.pop()
            above_tip.pop()
        return [*above_base, *reversed(above_tip)]

    def _above(self, link: str) -> list[Joint]:
        found = []
        while link in self._to_parent:
            found.append(self._to_parent[link])
            link = found[-1].parent
        return found

    def _group(self, element: XmlElement, names: set[str]) -> Group:
        joints = [joint for joint in self._robot.joints if joint.name in names]
        chains = element.all("chain")
        ends = self._chain_ends(chains[0]) if len(chains) == 1 else _ends_of(joints)
        return Group(
            name=element.attributes["name"],
            joints=tuple(one.name for one in joints if one.moves and one.mimic is None),
            links=tuple(joint.child for joint in joints),
            ends=ends if len(element.children) == len(chains) else _ends_of(joints),
        )

    def _end_effectors(self, groups: dict[str, Group]) -> Iterator[tuple[str, EndEffector]]:
        for element in self._root.all("end_effector"):
            name = element.attributes.get("name", "")
            group = self._named(element, "group", groups, "group")
            link = self._named(element, "parent_link", self._links, "link")
            above = ""
            if element.attributes.get("parent_group"):
                above = self._named(element, "parent_group", groups, "group")
            yield name, EndEffector(name, group, link, above)

    def _states(self, groups: dict[str, Group]) -> dict[str, dict[str, dict[str, float]]]:
        states: dict[str, dict[str, dict[str, float]]] = {name: {} for name in groups}
        for element in self._root.all("group_state"):
            name = element.attributes.get("name", "")
            if not name:
                self._refuse(element, "a state without a name")
            group = self._named(element, "group", groups, "group")
            states[group][name] = dict(self._positions(element))
        return states

    def _positions(self, state: XmlElement) -> Iterator[tuple[str, float]]:
        """Read the positions of a state, but for joints of several degrees of freedom or none."""
        for element in state.all("joint"):
            name = self._named(element, "name", self._all_joints, "joint")
            if name not in self._joints or not self._joints[name].moves:
                continue
            text = element.attributes.get("value", "")
            try:
                value = float(text)
            except ValueError:
                value = math.nan
            if not math.isfinite(value):
                self._refuse(element, f"value is '{text[:80]}', expected a finite number, rad or m")
            yield name, value

    def _disabled(self) -> Iterator[DisabledCollision]:
        for element in self._root.all("disable_collisions"):
            first, second = (element.attributes.get(key, "") for key in ("link1", "link2"))
            if first in self._links and second in self._links:
                yield DisabledCollision(first, second, element.attributes.get("reason", ""))


def _ends_of(joints: list[Joint]) -> tuple[str, str] | None:
    """Find base and tip of joints that follow each other, whatever order they are in."""
    by_parent = {joint.parent: joint for joint in joints}
    children = {joint.child for joint in joints}
    first = [joint for joint in joints if joint.parent not in children]
    if len(first) != 1 or len(by_parent) < len(joints):
        return None
    tip = first[0].parent
    while tip in by_parent:
        tip = by_parent[tip].child
    return first[0].parent, tip
