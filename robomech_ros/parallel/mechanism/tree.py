"""The tree of links and joints of a mechanism, whose limbs end side by side."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

from robomech_ros.robots import Joint, RobotDescription, SerialChain
from robomech_ros.robots.chain_layout import PRISMATIC, unpack_chain
from robomech_ros.spatial.poses import rigid_inverse

__all__ = ["tree_of_limbs"]

_LIMITS = ("lower", "upper", "velocity", "acceleration", "jerk", "effort")


def tree_of_limbs(name: str, chains: Sequence[SerialChain]) -> RobotDescription:
    """Put chains from one base side by side."""
    joints = tuple(joint for chain in chains for joint in _joints(chain))
    links = (chains[0].base, *(joint.child for joint in joints))
    return RobotDescription(name, links, joints, where=name)


def _joints(chain: SerialChain) -> list[Joint]:
    """Make the joints along a chain, fixed ones included."""
    frames = [chain.link_frame(link) for link in chain.links]
    constants = unpack_chain(chain.packed)
    joints = []
    for parent, child in pairwise(frames):
        back = rigid_inverse(parent.offset)
        if child.joints == parent.joints:
            name = f"{child.name}_fixed_joint"
            joints.append(Joint(name, "fixed", parent.name, child.name, back @ child.offset))
            continue
        i = parent.joints
        limits: dict[str, Any] = {key: float(getattr(chain, key)[i]) for key in _LIMITS}
        kind = "prismatic" if chain.types[i] == PRISMATIC else "revolute"
        joints.append(
            Joint(
                name=chain.joint_names[i],
                type="continuous" if chain.continuous[i] else kind,
                parent=parent.name,
                child=child.name,
                origin=back @ constants[i],
                after=child.offset,
                drive=chain.drives[i],
                **limits,
            )
        )
    return joints
