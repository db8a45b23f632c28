"""``robomech security-policies``: what SROS2 has to allow our nodes, found by starting them."""

import argparse
import re
import sys
from pathlib import Path

from robomech_ros.errors import BadValueError
from robomech_ros.nodes.commands.bringup import add_launch_arguments, check, launch_options

_ENCLAVE = re.compile(r"(/[A-Za-z0-9_]+)+")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument(
        "--enclave",
        default="/robomech",
        help="enclave of all nodes, as in bringup --ros-args --enclave (/robomech)",
    )
    parser.add_argument("--output", default="", help="policy file; default: standard output")
    add_launch_arguments(parser)


def run(args: argparse.Namespace) -> int:
    """Write the policy of the nodes that bringup starts with the same options; returns 0."""
    check(args)
    if not args.robot:
        expected = "a robot: without one the nodes only wait for it"
        raise BadValueError("--robot", args.robot, expected)
    if not _ENCLAVE.fullmatch(args.enclave):
        expected = "a path of letters, digits and underscores, such as /robomech or /cell/left"
        raise BadValueError("--enclave", args.enclave, expected)
    from robomech_ros.nodes.commands.policy_xml import policy_xml
    from robomech_ros.nodes.commands.started_nodes import rights_of_started

    text = policy_xml(rights_of_started(launch_options(args)), args.enclave)
    if args.output:
        try:
            Path(args.output).write_text(text, encoding="utf-8")
        except OSError as error:
            raise BadValueError("--output", args.output, f"a file ({error.strerror})") from None
    else:
        sys.stdout.write(text)
    return 0
