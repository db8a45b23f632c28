"""Content of an SRDF: groups of joints, end effectors, named postures.

One place for named postures: a robot without an SRDF has ``home`` of its own description.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from robomech_ros.errors import BadValueError, RobotDescriptionError
from robomech_ros.printing import Printed
from robomech_ros.robots.chain import SerialChain
from robomech_ros.typing import Array

# The posture that every robot has, whatever its description says.
HOME = "home"


@dataclass(frozen=True)
class Group:
    """Joints that are planned for together.

    Parameters
    ----------
    name : str
    joints : tuple of str
        Those that have a position of their own, in the order of the description: no fixed ones,
        and none that mimic others.
    links : tuple of str
        Links that all joints of the group move directly, fixed ones included.
    ends : tuple of (str, str), or None
        Base and tip, for :meth:`RobotDescription.chain`; None where the group is no one chain.
    """

    name: str
    joints: tuple[str, ...]
    links: tuple[str, ...]
    ends: tuple[str, str] | None = None


@dataclass(frozen=True)
class EndEffector:
    """A group that is mounted on a link of another."""

    name: str
    group: str
    parent_link: str
    parent_group: str = ""


@dataclass(frozen=True)
class DisabledCollision:
    """Two links whose collisions are not looked for, and why."""

    first: str
    second: str
    reason: str = ""


@dataclass(frozen=True)
class VirtualJoint:
    """A joint that holds a link in a frame outside the robot, such as ``world``.

    Parameters
    ----------
    name : str
    type : str
        ``fixed``: frame and link are one; else tf says where the link is.
    parent_frame, child_link : str
    """

    name: str
    type: str
    parent_frame: str
    child_link: str


@dataclass(frozen=True)
class SemanticDescription(Printed):
    """An SRDF, its names checked against the robot's.

    Parameters
    ----------
    name : str
        The robot, as the document calls it.
    groups : mapping of str to Group
    end_effectors : mapping of str to EndEffector
    states : mapping of str to mapping
        For each group its named postures: by name the positions (rad or m) by joint.
    disabled_collisions : tuple of DisabledCollision
        Pairs of links that the robot has.
    unusable : mapping of (str, str) to str
        By group and state why the robot cannot go to a named posture.
    notes : tuple of str
        What is no error, and yet not what the author of the document may believe.
    document : str
        The text of the document, empty where there is none.
    left_out : mapping of str to str
        Why a group of the document is none: the robot has none of its members.
    virtual_joints : tuple of VirtualJoint
    """

    name: str
    groups: Mapping[str, Group] = field(default_factory=dict)
    end_effectors: Mapping[str, EndEffector] = field(default_factory=dict)
    states: Mapping[str, Mapping[str, Mapping[str, float]]] = field(default_factory=dict)
    disabled_collisions: tuple[DisabledCollision, ...] = ()
    unusable: Mapping[tuple[str, str], str] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    document: str = ""
    left_out: Mapping[str, str] = field(default_factory=dict)
    virtual_joints: tuple[VirtualJoint, ...] = ()

    def group(self, name: str) -> Group:
        """Find a group."""
        if name in self.left_out:
            raise RobotDescriptionError(f"group '{name}'", self.left_out[name])
        if name not in self.groups:
            raise BadValueError("group", name, _one_of(self.groups))
        return self.groups[name]

    def state(self, group: str, name: str) -> dict[str, float]:
        """Find a named posture of a group: positions (rad or m) by joint."""
        states = self.states.get(self.group(group).name, {})
        if name not in states:
            raise BadValueError(f"state of group '{group}'", name, _one_of(states))
        if (group, name) in self.unusable:
            place = f"state '{name}' of group '{group}'"
            raise RobotDescriptionError(place, self.unusable[group, name])
        return dict(states[name])

    def posture(self, chain: SerialChain, name: str) -> Array:
        """Find a named posture of a chain.

        It is a state of the group that has the chain's joints, and where that has none of the
        name, of a group that has more; ``home`` is otherwise :meth:`SerialChain.home`.

        Parameters
        ----------
        chain : SerialChain
            Chain of n joints.

        Returns
        -------
        ndarray, shape (n,)
            rad or m, within the limits of the joints.
        """
        group = next((one for one in self._groups_of(chain) if name in self.states[one]), None)
        if group is None:
            if name == HOME:
                return chain.home()
            raise BadValueError("posture", name, _one_of(self.postures(chain)))
        state = self.state(group, name)
        missing = [joint for joint in chain.joint_names if joint not in state]
        if missing:
            what = f"state '{name}' of group '{group}'"
            raise BadValueError(what, state, f"positions of {', '.join(missing)}, too")
        q = np.array([state[joint] for joint in chain.joint_names])
        return np.clip(q, chain.lower, chain.upper)

    def gives(self, chain: SerialChain, name: str) -> bool:
        """Return whether a state of a group with all joints of a chain has a name."""
        return any(name in self.states[group] for group in self._groups_of(chain))

    def postures(self, chain: SerialChain) -> tuple[str, ...]:
        """List the names of the postures of a chain, of which some may be unusable."""
        found = [name for group in self._groups_of(chain) for name in self.states[group]]
        return tuple(dict.fromkeys([HOME, *found]))

    def postures_of(self, joints: Collection[str]) -> dict[str, str]:
        """List the states of the groups that have no other joints than these, such as a hand's.

        Parameters
        ----------
        joints : collection of str

        Returns
        -------
        dict of str to str
            The group of each state by its name: of two groups the one with more of the joints.
        """
        own = [name for name in self.states if name in self.groups]
        own = [name for name in own if set(self.groups[name].joints) <= set(joints)]
        own.sort(key=lambda name: len(self.groups[name].joints))
        return {state: group for group in own for state in self.states[group]}

    def home(self) -> dict[str, float]:
        """Return where joints stand to begin with: the states ``home`` of all groups together.

        Of two that name a joint the one of the smaller group counts; states that the robot cannot
        go to do not count.

        Returns
        -------
        dict of str to float
            rad or m, by joint.
        """
        found: dict[str, float] = {}
        groups = [name for name in self.states if HOME in self.states[name]]
        for name in sorted(groups, key=lambda name: -len(self.groups[name].joints)):
            if (name, HOME) not in self.unusable:
                found |= self.states[name][HOME]
        return found

    def tool_joints(self, chain: SerialChain) -> tuple[str, ...]:
        """Name the joints of the end effectors that are mounted at the end of a chain."""
        last = {frame.name for frame in chain.frames if frame.joints == chain.n}
        tools = [one for one in self.end_effectors.values() if one.parent_link in last]
        joints = [joint for one in tools for joint in self.groups[one.group].joints]
        return tuple(dict.fromkeys(name for name in joints if name not in chain.joint_names))

    def at_home(self, chain: SerialChain) -> SerialChain:
        """Return the chain with the named posture ``home`` as its own, if that can be used."""
        if not any(HOME in self.states[group] for group in self._groups_of(chain)):
            return chain
        try:
            return replace(chain, home_given=self.posture(chain, HOME))
        except (BadValueError, RobotDescriptionError):
            return chain

    def with_groups(self, groups: Mapping[str, Group]) -> SemanticDescription:
        """Add groups; they go before others of the same name, whose states they get."""
        left_out = {name: why for name, why in self.left_out.items() if name not in groups}
        return replace(self, groups={**self.groups, **groups}, left_out=left_out)

    def _groups_of(self, chain: SerialChain) -> list[str]:
        """Name the groups with states that have all joints of a chain, the smallest first."""
        joints = set(chain.joint_names)
        known = [name for name in self.states if name in self.groups]
        having = [name for name in known if joints <= set(self.groups[name].joints)]
        return sorted(having, key=lambda name: len(self.groups[name].joints))


def _one_of(names: Collection[str]) -> str:
    return f"one of {', '.join(names)}" if names else "none, since there are none"
