"""A gripper that one value moves: its width, or the position of its joints."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from robomech_ros.errors import BadValueError, UnknownJointError
from robomech_ros.robots.chain import SerialChain
from robomech_ros.robots.description import RobotDescription
from robomech_ros.robots.fingers import FingerOpening, finger_ends, finger_joints
from robomech_ros.robots.joint import Joint


@dataclass(frozen=True, eq=False)
class GripperModel:
    """Finger joints that move together."""

    joints: tuple[Joint, ...]  #: All at the same position.
    #: Width between the fingers; None if it is not known. Then the value that moves the gripper is
    #: the position of its joints.
    opening: FingerOpening | None

    @property
    def unit(self) -> str:
        """Unit of the value."""
        return "m" if self.opening is not None else self.joints[0].unit

    @property
    def limits(self) -> tuple[float, float]:
        """Least and greatest value (m, or rad); those of an open-ended joint are a turn apart."""
        if self.opening is not None:
            return 0.0, self.opening.greatest
        low, high = max(j.lower for j in self.joints), min(j.upper for j in self.joints)
        low = low if math.isfinite(low) else min(-math.pi, high)
        return low, high if math.isfinite(high) else max(math.pi, low)

    def position(self, value: float) -> float:
        """Return the position of the joints (rad or m) at a value."""
        low, high = self.limits
        if not low <= value <= high:
            what = "width" if self.opening is not None else f"joint '{self.joints[0].name}'"
            raise BadValueError(what, value, f"{low:.6g} to {high:.6g} {self.unit}")
        return float(value) if self.opening is None else self.opening.position(value)

    def positions(self, value: float) -> dict[str, float]:
        """Return the joints by name (rad or m) at a value; raises as :meth:`position`."""
        return dict.fromkeys((joint.name for joint in self.joints), self.position(value))

    def value(self, positions: Mapping[str, float]) -> float:
        """Return the value at joints given by name (rad or m); a joint not given is at rest."""
        first = self.joints[0]
        position = float(positions.get(first.name, first.rest))
        value = position if self.opening is None else self.opening.width(position)
        low, high = self.limits
        return min(max(value, low), high)


def commanded_fingers(joints: Sequence[Joint], name: str = "") -> tuple[Joint, ...]:
    """Return the finger joints that a command without the name of a joint moves.

    - ``joints``: all joints of the gripper.
    - ``name``: name of the joint to choose; by default the only joint, or both of two slides.

    Raises UnknownJointError: the gripper has no joint of this name.
    """
    if name:
        chosen = tuple(joint for joint in joints if joint.name == name)
        if not chosen:
            raise UnknownJointError(name, [joint.name for joint in joints])
        return chosen
    slides = len(joints) == 2 and all(joint.type == "prismatic" for joint in joints)
    return tuple(joints) if len(joints) == 1 or slides else ()


def gripper_model(
    description: RobotDescription,
    chain: SerialChain,
    names: Sequence[str] = (),
    name: str = "",
    links: Sequence[str] = (),
) -> GripperModel | None:
    """Find the gripper behind an arm.

    - ``chain``: the arm.
    - ``names``: joints of the gripper; by default as for
      :func:`~robomech_ros.robots.fingers.finger_joints`.
    - ``name``: the joint that moves; by default as for :func:`commanded_fingers`.
    - ``links``: two links between which the width is measured; by default the last ones, if they
      are two.

    Returns None if the robot has no gripper, or one of several joints of which none is chosen.

    Raises UnknownJointError, UnknownLinkError: a name is not that of a joint of the gripper, or of
    a link.
    """
    joints = commanded_fingers(finger_joints(description, chain, names), name)
    if not joints:
        return None
    try:
        ends = tuple(links) or finger_ends(description, joints)
        return GripperModel(joints, FingerOpening(description, joints, ends))
    except BadValueError:
        return GripperModel(joints, None)
