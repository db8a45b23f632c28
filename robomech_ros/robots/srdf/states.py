"""Named states of an SRDF: postures of groups, and those that cannot be used."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import islice

from robomech_ros.robots.documents.guarded_xml import XmlElement
from robomech_ros.robots.documents.numbers_in_text import finite_number
from robomech_ros.robots.joint import Joint
from robomech_ros.robots.semantic import Group
from robomech_ros.robots.srdf.names import SrdfNames

_MOST_NAMES = 20
# Files give few digits: a position this little outside its limits (rad or m) means the limit.
_ROUNDING = 1e-4


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

    Parameters
    ----------
    root : XmlElement
        Of the document.
    names : SrdfNames
        Gets the notes.
    groups : dict of str to Group
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
    """Reads one state.

    Attributes
    ----------
    why : str
        Why the robot cannot go there; empty if it can.
    notes : list of str
        What else a user should know.
    """

    def __init__(
        self, element: XmlElement, names: SrdfNames, mobile_robots: frozenset[str]
    ) -> None:
        self.why = ""
        self.notes: list[str] = []
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
