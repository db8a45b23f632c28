"""Groups of an SRDF: made of chains, joints, links (each the joint above it) and other groups."""

from collections.abc import Iterable, Iterator

from robomech_ros.robots.documents.guarded_xml import XmlElement
from robomech_ros.robots.joint import Joint
from robomech_ros.robots.semantic import Group
from robomech_ros.robots.srdf.names import SrdfNames

# Ten times what a hundred arms of a hundred joints need; more is made to fill the memory.
_MOST_MEMBERS = 1_000_000


def read_groups(root: XmlElement, names: SrdfNames) -> tuple[dict[str, Group], dict[str, str]]:
    """Read all groups; unknown members are noted and left out, as in MoveIt.

    - ``root``: root element of the document.
    - ``names``: receives the notes.

    Returns the groups, and by name why a group is left out: it has no known member.
    """
    elements: dict[str, XmlElement] = {}
    for element in root.all("group"):
        with names.leaving_out("the group"):
            elements[names.own(element, elements)] = element
    members: dict[str, set[str]] = {}
    left_out: dict[str, str] = {}
    count = 0
    for name in _inner_first(elements, names):
        noted = len(names.notes)
        inner = [one.attributes.get("name", "") for one in elements[name].all("group")]
        joints = _joints_of(elements[name], names)
        members[name] = set(joints).union(*(members.get(one, ()) for one in inner))
        count += len(members[name])
        if count > _MOST_MEMBERS:
            names.refuse(elements[name], f"all groups together have more than {_MOST_MEMBERS}")
        lacks = any(one in left_out or one not in elements for one in inner)
        if not members[name] and (lacks or names.notes[noted:]):
            why = f"{names.place(elements[name])}: no group in it has a joint of the robot"
            left_out[name] = names.notes[noted] if names.notes[noted:] else why
    place = {joint.name: i for i, joint in enumerate(names.robot.joints)}
    groups = {}
    for name in (one for one in elements if one not in left_out):
        joints_of = [names.joints[one] for one in sorted(members[name], key=place.__getitem__)]
        groups[name] = Group(
            name=name,
            joints=tuple(one.name for one in joints_of if one.moves and one.mimic is None),
            links=tuple(joint.child for joint in joints_of),
            ends=_ends(elements[name], joints_of, names),
        )
    return groups, left_out


def _inner_first(elements: dict[str, XmlElement], names: SrdfNames) -> Iterator[str]:
    """List the groups, those that are in others first."""
    done: set[str] = set()
    for start in elements:
        path = [] if start in done else [start]
        waiting = [_inner(elements[start], elements, names)]
        while path:
            name = next(waiting[-1], None)
            if name is None:
                waiting.pop()
                done.add(path[-1])
                yield path.pop()
            elif name in path:
                with names.leaving_out(f"group '{name}' in it"):
                    circle = " -> ".join([*path, name])
                    names.refuse(elements[path[-1]], f"contains itself: {circle}")
            elif name not in done:
                path.append(name)
                waiting.append(_inner(elements[name], elements, names))


def _inner(element: XmlElement, elements: dict[str, XmlElement], names: SrdfNames) -> Iterator[str]:
    for one in element.all("group"):
        with names.leaving_out("it"):
            yield names.known(one, "name", elements, "group")


def _joints_of(element: XmlElement, names: SrdfNames) -> Iterator[str]:
    """Name the joints that a group has besides those of the groups in it."""
    walked = _Walked(names)
    for one in (child for child in element.children if child.tag in ("chain", "joint", "link")):
        with names.leaving_out("it"):
            if one.tag == "chain":
                base, tip = _chain_ends(one, names)
                if base == tip:
                    names.refuse(
                        one, f"base_link and tip_link are both '{base}', expected two links"
                    )
                yield from walked.between(base, tip)
            elif one.tag == "joint":
                name = names.known(one, "name", names.all_joints, "joint")
                if name in names.joints:
                    yield name
            else:
                link = names.known(one, "name", names.links, "link")
                if link in names.to_parent:
                    yield names.to_parent[link].name


def _chain_ends(chain: XmlElement, names: SrdfNames) -> tuple[str, str]:
    base = names.known(chain, "base_link", names.links, "link")
    return base, names.known(chain, "tip_link", names.links, "link")


class _Walked:
    """Joints on the ways between links, each of which is looked at once.

    What chains have covered already is skipped: the first link above it is kept.
    """

    def __init__(self, names: SrdfNames) -> None:
        self._to_parent = names.to_parent
        self._depth = names.robot.link_depths
        self._top: dict[str, str] = {}

    def between(self, first: str, second: str) -> Iterator[str]:
        """Name the joints between two links that no chain before has covered."""
        first, second = self._above_covered(first), self._above_covered(second)
        while first != second:
            if self._depth[first] < self._depth[second]:
                first, second = second, first
            joint = self._to_parent[first]
            yield joint.name
            self._top[first] = joint.parent
            first = self._above_covered(joint.parent)

    def _above_covered(self, link: str) -> str:
        passed = []
        while link in self._top:
            passed.append(link)
            link = self._top[link]
        self._top.update(dict.fromkeys(passed, link))
        return link


def _ends(element: XmlElement, joints: list[Joint], names: SrdfNames) -> tuple[str, str] | None:
    """Find base and tip of a group that is one chain down the tree."""
    chains = element.all("chain")
    if len(chains) != 1 or any(element.all(kind) for kind in ("joint", "link", "group")):
        return _ends_of(joints)
    base, tip = _chain_ends(chains[0], names)
    up, down = names.robot.joints_between(base, tip)
    if not up:
        return base, tip
    if down:
        return None
    names.notes.append(
        f"{names.place(element)}: its chain runs up, from '{base}' to '{tip}'; its base is taken "
        f"to be '{tip}' and its tip '{base}'"
    )
    return tip, base


def _ends_of(joints: Iterable[Joint]) -> tuple[str, str] | None:
    """Find base and tip of joints that follow each other, whatever order they are in."""
    by_parent = {joint.parent: joint for joint in joints}
    children = {joint.child for joint in joints}
    first = [joint for joint in joints if joint.parent not in children]
    if len(first) != 1 or len(by_parent) < len(children):
        return None
    tip = first[0].parent
    while tip in by_parent:
        tip = by_parent[tip].child
    return first[0].parent, tip
