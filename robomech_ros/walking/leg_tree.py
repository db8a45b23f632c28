"""Legs in the tree of links of their robot: checks, and bodies at home."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

from robomech_ros._kernels.walking.gait_step import MOST_LEGS
from robomech_ros.errors import BadValueError
from robomech_ros.parallel.mechanism.tree import links_of_joints, tree_of_limbs
from robomech_ros.robots import Body, RobotDescription, SerialChain, urdf_from_description
from robomech_ros.robots.bodies import combine_bodies
from robomech_ros.spatial.arrays import check_kind
from robomech_ros.spatial.poses import inverse_pose

JOINTS = 3


def check_legs(legs: Mapping[str, SerialChain]) -> None:
    """Raise an error unless these are 3 to 16 uncoupled legs of three joints on one trunk."""
    if not isinstance(legs, Mapping) or not all(isinstance(one, str) for one in legs):
        raise BadValueError("legs", legs, "chains by the names of the legs")
    if len(legs) < 3:
        raise BadValueError("number of legs", len(legs), "3 or more, else it cannot stand")
    if len(legs) > MOST_LEGS:
        raise BadValueError("number of legs", len(legs), f"at most {MOST_LEGS}")
    for leg, chain in legs.items():
        check_kind(f"leg '{leg}'", chain, SerialChain, "a SerialChain")
        if chain.n != JOINTS:
            raise BadValueError(f"number of joints of leg '{leg}'", chain.n, str(JOINTS))
        chain.require_uncoupled(f"leg '{leg}'", "describe the leg without <mimic>")
    trunks = sorted({chain.base for chain in legs.values()})
    if len(trunks) > 1:
        raise BadValueError("base links of the legs", trunks, "one trunk")


def tree_of_legs(
    name: str, source: str, legs: Sequence[SerialChain], trunk_body: Body | None
) -> RobotDescription:
    """Describe a robot that has legs only, with a generated URDF."""
    made = tree_of_limbs(name, legs, None, {})
    trunk = {} if trunk_body is None else {legs[0].base: trunk_body}
    tree = replace(made, document="", source=source, bodies={**made.bodies, **trunk})
    return replace(tree, document=urdf_from_description(tree))


def rest_of_tree(tree: RobotDescription, legs: Sequence[SerialChain]) -> Body | None:
    """Combine all links that no leg moves, at home and in the trunk."""
    moved = {
        link
        for leg in legs
        for first in links_of_joints(leg)[:1]
        for link in (first, *tree.links_below(first))
    }
    return one_body(tree, legs[0].base, [link for link in tree.bodies if link not in moved])


def one_body(tree: RobotDescription, trunk: str, links: Iterable[str]) -> Body | None:
    """Combine the bodies of links, at home and in the trunk."""
    poses = tree.link_poses(tree.home)
    back = inverse_pose(poses[trunk])
    return combine_bodies([tree.bodies[link].expressed_in(back @ poses[link]) for link in links])
