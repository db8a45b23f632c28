"""The joints of a gripper behind a chain, and the width between its fingers."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from robomech_ros.errors import BadValueError, UnknownJointError, UnknownLinkError
from robomech_ros.robots.chain import SerialChain
from robomech_ros.robots.description import RobotDescription
from robomech_ros.robots.joint import Joint

# Halvings of the range of a joint, after which its position is exact.
_HALVINGS = 60
# Of a wider range, rad or m, only a part is used: to where the fingers part again after they met,
# found in steps of so much.
_MAX_RANGE = 2.0 * np.pi
_STEP = 0.01
# Rounding of a width over the greatest, m.
_ROUNDING = 1e-9


def finger_joints(
    description: RobotDescription, chain: SerialChain, names: Sequence[str] = ()
) -> tuple[Joint, ...]:
    """Find the joints of a gripper.

    - ``description``: the robot.
    - ``chain``: its arm.
    - ``names``: the joints; by default those that move behind the last joint of the chain, and
      mimic none.

    Raises UnknownJointError: a name is not that of a joint which moves, mimics none, and is not on
    the chain.
    """
    able = {
        joint.name: joint
        for joint in description.joints
        if joint.moves
        and joint.mimic is None
        and joint.fault is None
        and joint.name not in chain.joint_names
    }
    for name in names:
        if name not in able:
            raise UnknownJointError(name, able)
    if names:
        return tuple(able[name] for name in dict.fromkeys(names))
    last = next(joint for joint in description.joints if joint.name == chain.joint_names[-1])
    below = {last.child, *description.links_below(last.child)}
    return tuple(joint for joint in able.values() if joint.parent in below)


def finger_ends(description: RobotDescription, joints: Sequence[Joint]) -> tuple[str, ...]:
    """List the last links that the joints of a gripper move, those that mimic them included."""
    names = {joint.name for joint in joints}
    leaders = {name: follower.leader for name, follower in description.followers.items()}
    children = [
        joint.child
        for joint in description.joints
        if joint.name in names or leaders.get(joint.name) in names
    ]
    parents = {joint.parent for joint in description.joints}
    moved = set(children).union(*map(description.links_below, children))
    return tuple(sorted(moved - parents))


@dataclass(frozen=True, eq=False)
class FingerOpening:
    """Opening of a gripper of two fingers.

    The width is the distance between the origins of two links less that in the closed gripper,
    which is the end of the joints' range where they are nearer to each other, or, where that range
    is more than a turn, where they meet.  For two slides, of
    which one mimics the other, it is twice the joint's way from there.

    Raises BadValueError: not two links, a joint without limits, or the links do not part from each
    other. UnknownLinkError: the robot does not have a link.
    """

    description: RobotDescription  #: The robot.
    #: Joints that open the gripper; they have limits, and all are at the same position.
    joints: tuple[Joint, ...]
    links: tuple[str, ...]  #: A link of each finger.

    def __post_init__(self) -> None:
        if len(self.links) != 2:
            raise BadValueError("links of the fingers", list(self.links), "two, one of each finger")
        for link in self.links:
            if link not in self.description.links:
                raise UnknownLinkError(link, self.description.links)
        if not np.isfinite(self._range).all():
            names = ", ".join(joint.name for joint in self.joints)
            raise BadValueError(f"range of {names}", self._range, "limits at both ends")
        if self.greatest <= 0.0:
            expected = "two that part from each other as the gripper opens"
            raise BadValueError("links of the fingers", list(self.links), expected)

    @cached_property
    def _range(self) -> tuple[float, float]:
        """The ends of the joints' way (rad or m): limits, or where the fingers part again.

        Kinova's Robotiq 2F-85 has limits of 0 and 100 rad.
        """
        lower, upper = max(j.lower for j in self.joints), min(j.upper for j in self.joints)
        if not np.isfinite([lower, upper]).all() or upper - lower <= _MAX_RANGE:
            return lower, upper
        rest = float(np.clip(0.0, lower, upper))
        return self._turning(rest, lower), self._turning(rest, upper)

    def _turning(self, begin: float, end: float) -> float:
        """Find where, on the way from one position to another, the links turn back (rad or m)."""
        steps = round(min(abs(end - begin), _MAX_RANGE) / _STEP)
        positions = begin + np.sign(end - begin) * _STEP * np.arange(steps + 1)
        change = np.diff([self._distance(position) for position in positions])
        turned = np.flatnonzero(change[1:] * change[:-1] < 0.0)
        return float(positions[turned[0] + 1]) if len(turned) else float(positions[-1])

    @cached_property
    def _distances(self) -> tuple[float, float]:
        lower, upper = self._range
        return self._distance(lower), self._distance(upper)

    @property
    def closing(self) -> float:
        """1 where the gripper closes as the position of its joints grows, -1 where it opens."""
        return 1.0 if self._distances[1] < self._distances[0] else -1.0

    @property
    def greatest(self) -> float:
        """Width of the open gripper, m."""
        return abs(self._distances[1] - self._distances[0])

    def width(self, position: float) -> float:
        """Return the width (m) at a position of the joints (rad or m)."""
        return self._distance(position) - min(self._distances)

    def position(self, width: float) -> float:
        """Return the position of the joints (rad or m) at a width (m)."""
        if not 0.0 <= width <= self.greatest + _ROUNDING:
            raise BadValueError("width", width, f"from 0 to {self.greatest:.6g} m")
        closed, opened = self._range[:: -int(self.closing)]
        for _ in range(_HALVINGS):
            middle = 0.5 * (closed + opened)
            if self.width(middle) < width:
                closed = middle
            else:
                opened = middle
        return 0.5 * (closed + opened)

    def _distance(self, position: float) -> float:
        poses = self.description.link_poses(dict.fromkeys((j.name for j in self.joints), position))
        first, second = (poses[link][:3, 3] for link in self.links)
        return float(np.linalg.norm(first - second))
