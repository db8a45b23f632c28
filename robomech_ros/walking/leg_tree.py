"""A legged robot as a tree of links, as a URDF has it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from robomech_ros.parallel.mechanism.tree import tree_of_limbs
from robomech_ros.robots import RobotDescription, SerialChain, urdf_from_description


def leg_tree_description(name: str, legs: Sequence[SerialChain], source: str) -> RobotDescription:
    """Put legs side by side below their trunk, with bodies that can be seen.

    Parameters
    ----------
    name : str
        What the robot is called.
    legs : sequence of SerialChain
        From the trunk to the feet.
    source : str
        Where the numbers come from.
    """
    tree = replace(tree_of_limbs(name, legs, None, {}), document="", source=source)
    return replace(tree, document=urdf_from_description(tree))
