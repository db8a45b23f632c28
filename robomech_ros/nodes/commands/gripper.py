"""``robomech gripper``: opens and closes the gripper of a running robot."""

import argparse
import sys
from importlib.util import find_spec

from robomech_ros.nodes.commands.call import EXIT_NO_ANSWER, EXIT_REFUSED, seconds_to_wait


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("width", help="open, close, or the width between the fingers in m")
    parser.add_argument(
        "--namespace", default="", help="namespace of the robot's nodes, such as left"
    )
    parser.add_argument(
        "--controller",
        default="joint_trajectory_controller",
        help="node whose parameters define the gripper joints (joint_trajectory_controller)",
    )
    parser.add_argument(
        "--timeout", type=seconds_to_wait, default=10.0, help="total seconds to wait (10)"
    )


def run(args: argparse.Namespace) -> int:
    """Move the gripper and print its width.

    Returns 0 if it got there, 1 if something stopped it or the messages are missing, 3 if nobody
    answered.
    """
    from robomech_ros.nodes.commands.service_client import NoAnswerError

    if find_spec("control_msgs") is None:
        lacking = "control_msgs, which defines GripperCommand, is not installed"
        print(f"robomech gripper: {lacking}; 'make setup' builds it", file=sys.stderr)
        return EXIT_REFUSED
    from robomech_ros.nodes.commands.gripper_client import move_gripper

    try:
        text, reached = move_gripper(args.width, args.namespace, args.controller, args.timeout)
    except NoAnswerError as error:
        print(f"robomech gripper: {error}", file=sys.stderr)
        return EXIT_NO_ANSWER
    print(f"gripper: {text}")
    return 0 if reached else EXIT_REFUSED
