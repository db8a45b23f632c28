"""The tree of links and joints of a mechanism, whose limbs end side by side."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from robomech_ros.robots import Body, Joint, RobotDescription, SerialChain
from robomech_ros.robots.chain_layout import PRISMATIC
from robomech_ros.robots.urdf.shapes import Shape
from robomech_ros.robots.urdf.writer import written_urdf

LIMITS = ("lower", "upper", "velocity", "acceleration", "jerk", "effort")


def tree_of_limbs(
    name: str,
    chains: Sequence[SerialChain],
    platform: Body | None,
    shapes: Mapping[str, Sequence[Shape]],
) -> RobotDescription:
    """Put chains from one base side by side, with shapes that are seen of their links.

    The link that a joint moves has the frame of the joint, whose axis is z.  The first chain ends
    at the platform, which has a body of its own.
    """
    joints = tuple(joint for chain in chains for joint in _joints(chain))
    links = (chains[0].base, *(joint.child for joint in joints))
    bodies = {} if platform is None else {chains[0].tip: platform}
    for chain in chains:
        for link, body in zip(links_of_joints(chain), chain.bodies, strict=True):
            if body is not None:
                bodies[link] = body
    tree = RobotDescription(name, links, joints, bodies=bodies, where=name)
    return replace(tree, document=written_urdf(tree, shapes))


def links_of_joints(chain: SerialChain) -> list[str]:
    """Name the link that each joint of a chain moves, the tip not among them."""
    along = [chain.link_frame(link) for link in chain.links]
    names = []
    for i, joint in enumerate(chain.joint_names):
        own = [link.name for link in along if link.joints == i + 1 and link.name != chain.tip]
        names.append(own[0] if own else f"{joint}_link")
    return names


def _joints(chain: SerialChain) -> list[Joint]:
    constants = chain.transforms
    links = [chain.base, *links_of_joints(chain)]
    joints = []
    for i, name in enumerate(chain.joint_names):
        limits: dict[str, Any] = {key: float(getattr(chain, key)[i]) for key in LIMITS}
        kind = "prismatic" if chain.types[i] == PRISMATIC else "revolute"
        joints.append(
            Joint(
                name=name,
                type="continuous" if chain.continuous[i] else kind,
                parent=links[i],
                child=links[i + 1],
                origin=constants[i],
                drive=chain.drives[i],
                **limits,
            )
        )
    return [*joints, Joint(f"{chain.tip}_joint", "fixed", links[-1], chain.tip, constants[-1])]
