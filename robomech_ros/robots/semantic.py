"""What an SRDF says of a robot: groups of joints, end effectors, named postures."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from robomech_ros.errors import BadValueError

__all__ = ["DisabledCollision", "EndEffector", "Group", "SemanticDescription"]


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
class SemanticDescription:
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
    """

    name: str
    groups: Mapping[str, Group] = field(default_factory=dict)
    end_effectors: Mapping[str, EndEffector] = field(default_factory=dict)
    states: Mapping[str, Mapping[str, Mapping[str, float]]] = field(default_factory=dict)
    disabled_collisions: tuple[DisabledCollision, ...] = ()

    def group(self, name: str) -> Group:
        """Find a group.

        Raises
        ------
        BadValueError
            There is none of this name; the error lists those there are.
        """
        if name not in self.groups:
            raise BadValueError("group", name, _one_of(self.groups))
        return self.groups[name]

    def state(self, group: str, name: str) -> dict[str, float]:
        """Find a named posture of a group: positions (rad or m) by joint.

        Raises
        ------
        BadValueError
            There is no such group, or no such posture of it; the error lists those there are.
        """
        states = self.states.get(self.group(group).name, {})
        if name not in states:
            raise BadValueError(f"state of group '{group}'", name, _one_of(states))
        return dict(states[name])


def _one_of(names: Mapping[str, object]) -> str:
    return f"one of {', '.join(names)}" if names else "none, since there are none"
