"""``robomech export-urdf``: a URDF of any robot, with bodies that can be seen."""

import argparse
import sys
from pathlib import Path

from robomech_ros.cli.robot_tree import describe
from robomech_ros.robots import urdf_from_description


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
