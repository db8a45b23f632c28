"""SRDF documents, checked against the robot that they speak of.

Groups are made as MoveIt makes them: of chains, joints, links (each stands for the joint above
it) and other groups.  Of names that the robot does not have, those in pairs of links without
collisions are passed over.  Entries with other such names are left out and noted, as in MoveIt.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import islice
from pathlib import Path

from robomech_ros.errors import BadValueError
from robomech_ros.robots.description import RobotDescription
from robomech_ros.robots.documents.guarded_xml import (
    LARGEST_XML,
    XmlElement,
    is_xml,
    parse_xml,
    refuse_xacro,
    text_of_xml,
)
from robomech_ros.robots.documents.numbers_in_text import finite_number
from robomech_ros.robots.documents.source_files import read_source
from robomech_ros.robots.entry_checks import bare_link
from robomech_ros.robots.joint import Joint
from robomech_ros.robots.semantic import (
    DisabledCollision,
    EndEffector,
    Group,
    SemanticDescription,
    VirtualJoint,
)
from robomech_ros.robots.srdf.groups import read_groups
from robomech_ros.robots.srdf.names import SrdfNames

_MOST_NAMES = 20
# Files give few digits: a position this little outside its limits (rad or m) means the limit.
_ROUNDING = 1e-4


def load_srdf(
    text_or_path: str | os.PathLike[str], description: RobotDescription
) -> SemanticDescription:
    """Read the semantic description of a robot.

    What is no error and yet not what its author may believe is in the ``notes`` of the result:
    entries with names that there are not, chains that run up the tree, states that leave out
    joints of their group or name joints of others.  A state outside the limits of a joint is
    named there, too, and cannot be used.

    Parameters
    ----------
    text_or_path : str or path
        The text of an SRDF, xacro expanded, or the path of a file.
    description : RobotDescription
        The robot.

    Raises
    ------
    RobotDescriptionError
        The document as a whole is broken, hostile or no SRDF, or the robot has none of its
        groups: the line and the fault are named.

    See Also
    --------
    load_description : the robot.
    group_chain : the chain of a group.

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
    if isinstance(given, str) and is_xml(given):
        data, where = given, "SRDF string"
    elif isinstance(given, str | os.PathLike) and str(given).strip():
        where = str(given)
        data = read_source(Path(given).expanduser(), LARGEST_XML)
    else:
        raise BadValueError("SRDF", given, "the text of an SRDF, or a path")
    root = parse_xml(data, where)
    names = SrdfNames(root, where, description)
    if root.tag != "robot":
        names.refuse(root, f"the root element is <{root.tag[:80]}>, expected <robot>")
    refuse_xacro(root, where)
    groups, left_out = read_groups(root, names)
    if left_out and not groups:
        names.refuse(root, f"none of its groups is one of '{description.name}'; {names.notes[0]}")
    states = read_states(root, names, groups)
    tools = _end_effectors(root, names, groups)
    virtual = tuple(_virtual_joints(root, names))
    return SemanticDescription(
        name=root.attributes.get("name", ""),
        groups=groups,
        end_effectors=tools,
        states=states.positions,
        disabled_collisions=tuple(_disabled(root, names)),
        unusable=states.unusable,
        notes=tuple(names.notes),
        document=text_of_xml(data),
        left_out=left_out,
        virtual_joints=virtual,
    )


def _end_effectors(
    root: XmlElement, names: SrdfNames, groups: dict[str, Group]
) -> dict[str, EndEffector]:
    found: dict[str, EndEffector] = {}
    for element in root.all("end_effector"):
        with names.leaving_out("the end effector"):
            name = names.own(element, found)
            group = names.known(element, "group", groups, "group")
            link = names.known(element, "parent_link", names.links, "link")
            above = ""
            if element.attributes.get("parent_group"):
                above = names.known(element, "parent_group", groups, "group")
            found[name] = EndEffector(name, group, link, above)
    return found


def _virtual_joints(root: XmlElement, names: SrdfNames) -> Iterator[VirtualJoint]:
    for element in root.all("virtual_joint"):
        with names.leaving_out("the virtual joint"):
            parent = bare_link(element.attributes.get("parent_frame", ""))
            child = names.known(element, "child_link", names.links, "link")
            name, kind = names.own(element, ()), element.attributes.get("type", "")
            # A frame that is a link of the robot is known anyway.
            if parent and parent not in names.links:
                yield VirtualJoint(name, kind, parent, child)


def _disabled(root: XmlElement, names: SrdfNames) -> Iterator[DisabledCollision]:
    for element in root.all("disable_collisions"):
        first, second = (bare_link(element.attributes.get(key, "")) for key in ("link1", "link2"))
        if first in names.links and second in names.links:
            yield DisabledCollision(first, second, element.attributes.get("reason", ""))


@dataclass
class States:
    """The named states of all groups.

    Attributes
    ----------
    positions : dict
        For each group by name of the state the positions (rad or m) by joint.
    unusable : dict
        By group and state why the robot cannot go there.
    """

    positions: dict[str, dict[str, dict[str, float]]]
    unusable: dict[tuple[str, str], str] = field(default_factory=dict)


def read_states(root: XmlElement, names: SrdfNames, groups: dict[str, Group]) -> States:
    """Read all states; those without a name or of no group are noted and left out.

    - ``root``: root element of the document.
    - ``names``: receives the notes.
    """
    states = States({name: {} for name in groups})
    mobile_robots = {
        name: frozenset(names.to_parent[link].name for link in group.links)
        for name, group in groups.items()
    }
    for element in root.all("group_state"):
        name = group = ""
        with names.leaving_out("the state"):
            name = names.own(element, ())
            group = names.known(element, "group", groups, "group")
        if not group:
            continue
        state = _State(element, names, mobile_robots[group])
        positions = dict(state.positions())
        of_group = states.positions[group]
        why = state.why
        if name in of_group:
            why = "" if of_group[name] == positions else "given twice, with different positions"
            state.notes.append("given twice")
        if why:
            states.unusable[group, name] = why
            state.notes.append(f"{why}; it cannot be used")
        of_group.setdefault(name, positions)
        lacking = (joint for joint in groups[group].joints if joint not in positions)
        if first := list(islice(lacking, _MOST_NAMES + 1)):
            state.notes.append(f"it gives no position of {_listed(first)}")
        place = f"{names.place(element)} of group '{group}'"
        names.notes += [f"{place}: {note}" for note in state.notes]
    return states


class _State:
    """Reads one state."""

    def __init__(
        self, element: XmlElement, names: SrdfNames, mobile_robots: frozenset[str]
    ) -> None:
        self.why = ""  #: Why the robot cannot go there; empty if it can.
        self.notes: list[str] = []  #: What else a user should know.
        self._element = element
        self._names = names
        self._movers = mobile_robots

    def positions(self) -> Iterator[tuple[str, float]]:
        """Read the positions, but for joints of several degrees of freedom or none.

        Joints of other groups are passed over, as in MoveIt.
        """
        found: dict[str, float] = {}
        foreign: list[str] = []
        for element in self._element.all("joint"):
            name = ""
            with self._names.leaving_out("it"):
                name = self._names.known(element, "name", self._names.all_joints, "joint")
            joint = self._names.joints.get(name)
            if joint is None or not joint.moves:
                continue
            text = element.attributes.get("value", "")
            try:
                value = finite_number(text)
            except ValueError:
                self.why = f"joint '{name}' is at '{text[:80]}', expected a finite number, rad or m"
                continue
            if name not in self._movers:
                foreign.append(name)
            elif found.setdefault(name, value) != value:
                self.why = f"joint '{name}' is given twice, with different positions"
            else:
                yield name, self._inside(joint, value)
        if foreign:
            self.notes.append(f"{_listed(foreign)} not of this group, and left out")

    def _inside(self, joint: Joint, value: float) -> float:
        inside = min(max(value, joint.lower), joint.upper)
        if abs(inside - value) <= _ROUNDING:
            return inside
        self.why = (
            f"joint '{joint.name}' is at {value:.6g} {joint.unit}, outside its limits "
            f"{joint.lower:.6g} to {joint.upper:.6g} {joint.unit}"
        )
        return value


def _listed(joints: list[str]) -> str:
    quoted = ", ".join(f"'{name}'" for name in joints[:_MOST_NAMES])
    more = " and more" if len(joints) > _MOST_NAMES else ""
    return f"joint{'s' if len(joints) > 1 else ''} {quoted}{more}"
