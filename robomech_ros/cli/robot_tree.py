"""The tree of links and joints of a robot of any kind."""

from __future__ import annotations

from robomech_ros.hands import load_hand
from robomech_ros.parallel import load_tree_description
from robomech_ros.robots import RobotDescription
from robomech_ros.robots.robot_kinds import ARM, KINDS, check_name, kind_of
from robomech_ros.rolling import load_rolling, rolling_description
from robomech_ros.rvs.model.hands.tree import fingers_tree
from robomech_ros.walking import load_legged


def describe(robot: str) -> tuple[RobotDescription, str]:
    """Describe a robot as its nodes do, and say what a tree does not tell.

    Parameters
    ----------
    robot : str
        A name, the path of a file, or the text of a document.

    Returns
    -------
    description : RobotDescription
    lost : str
        What of the robot is not in it; empty for nothing.

    Raises
    ------
    RobomechError
        There is no such robot, or its document cannot be used.
    """
    check_name(robot, (ARM, *KINDS))
    kind = kind_of(robot)
    if kind == "rolling":
        return rolling_description(load_rolling(robot), placed=False), ""
    if kind == "walking":
        return load_legged(robot).description, ""
    if kind == "hand":
        return fingers_tree(load_hand(robot)), ""
    described = load_tree_description(robot)
    lost = ""
    if described.mechanism is not None:
        ends = ", ".join(limb.chain.tip for limb in described.mechanism.limbs[1:])
        platform = described.mechanism.limbs[0].chain.tip
        lost = f"a URDF is a tree: the loops are cut at {ends}, which belong at '{platform}'"
    return described.description, lost
