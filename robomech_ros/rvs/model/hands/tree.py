"""The tree of a hand and of the object that it holds."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from robomech_ros.hands import Hand
from robomech_ros.parallel.mechanism.tree import tree_of_limbs
from robomech_ros.robots import Joint, RobotDescription, SerialChain
from robomech_ros.robots.urdf.shapes import Shape, generated_shapes
from robomech_ros.robots.urdf.writer import written_urdf

# The link of the object, and the joints that place it in the palm: m, then rad.
OBJECT = "object"
OBJECT_JOINTS = ("object_x", "object_y", "object_z", "object_yaw", "object_pitch", "object_roll")
_AXES = ((1, 0, 0), (0, 1, 0), (0, 0, 1), (0, 0, 1), (0, 1, 0), (1, 0, 0))
# Radius of the ball of a link without a body (m): too small to be visible.
_UNSEEN = [Shape(np.eye(4), 1e-5, 0.0, 0)]


def hand_tree(hand: Hand) -> tuple[RobotDescription, Mapping[str, Sequence[Shape]]]:
    """Describe fingers on one palm, and joints that place an object without a body.

    Returns ``tree``: the link that a joint moves has the name of the joint, and ``_link``;
    ``shapes``: bodies of the fingers, by link.
    """
    fingers = fingers_tree(hand)
    shapes = generated_shapes(fingers.root, fingers.joints, ())
    places, parent = [], fingers.root
    for name, axis in zip(OBJECT_JOINTS, _AXES, strict=True):
        child = OBJECT if name == OBJECT_JOINTS[-1] else f"{name}_link"
        kind = "prismatic" if name in OBJECT_JOINTS[:3] else "revolute"
        places.append(Joint(name, kind, parent, child, np.eye(4), np.array(axis, dtype=np.float64)))
        parent = child
    tree = replace(
        fingers,
        links=(*fingers.links, *(joint.child for joint in places)),
        joints=(*fingers.joints, *places),
        document="",
    )
    unseen = {joint.child: _UNSEEN for joint in places}
    return replace(tree, document=written_urdf(tree, {**shapes, **unseen})), shapes


def fingers_tree(hand: Hand) -> RobotDescription:
    """Describe fingers on one palm; the link of a joint has its name and ``_link``."""
    chains = [_with_own_links(finger) for finger in hand.fingers]
    return replace(tree_of_limbs(hand.name, chains, None, {}), document="", source=hand.source)


def finger_links(finger: SerialChain) -> tuple[str, ...]:
    """Name the links of a finger in the tree."""
    return (*(f"{joint}_link" for joint in finger.joint_names), finger.tip)


def _with_own_links(finger: SerialChain) -> SerialChain:
    """Remove names of links, which two fingers may share."""
    ends = (finger.link_frame(finger.base), finger.link_frame(finger.tip))
    return replace(finger, frames=(ends[0], replace(ends[1], parent=finger.base)))
