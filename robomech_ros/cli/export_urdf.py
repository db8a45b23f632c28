"""``robomech export-urdf``: a URDF of any robot, with bodies that can be seen."""

import argparse
import sys
from pathlib import Path

from robomech_ros.hands import load_hand
from robomech_ros.parallel import load_tree_description
from robomech_ros.robots import RobotDescription, urdf_from_description
from robomech_ros.robots.robot_kinds import ARM, KINDS, check_name, kind_of
from robomech_ros.rolling import load_rolling, rolling_description
from robomech_ros.rvs.model.hands.tree import fingers_tree
from robomech_ros.walking import load_legged


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("robot", help="name, path of a URDF or YAML file, or its text")
    parser.add_argument("--output", type=Path, help="output file; default: standard output")


def run(args: argparse.Namespace) -> int:
    """Write the document; returns 0, or 1 if the file cannot be written."""
    description, lost = describe(args.robot)
    text = urdf_from_description(description)
    if lost:
        print(f"robomech export-urdf: {lost}", file=sys.stderr)
    if args.output is None:
        sys.stdout.write(text)
        return 0
    try:
        args.output.write_text(text, encoding="utf-8")
    except OSError as error:
        print(f"robomech export-urdf: {args.output}: {error.strerror}", file=sys.stderr)
        return 1
    print(f"wrote {args.output}")
    return 0


def describe(robot: str) -> tuple[RobotDescription, str]:
    """Describe a robot as its nodes do, and say what a tree does not tell.

    - ``robot``: a name, the path of a file, or the text of a document.

    Returns the description, and what of the robot is not in it; empty for nothing.

    Raises RobomechError: there is no such robot, or its document cannot be used.
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
