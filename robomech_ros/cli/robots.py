"""``robomech robots``: the robots known by name."""

import argparse
from textwrap import shorten

from rich.console import Console
from rich.table import Table

from robomech_ros.errors import RobomechError
from robomech_ros.kinematics.inverse.families.selection import family_of
from robomech_ros.robots import PRISMATIC, list_robots, load_description

__all__ = ["add_arguments", "run"]

_SHORT = 100


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("--full", action="store_true", help="show the whole of each source")


def run(args: argparse.Namespace) -> int:
    """Print the table; returns 0, or 1 if a robot cannot be loaded."""
    # Never narrower than what a pipe's reader can use.
    console = Console()
    console = Console(width=None if console.is_terminal else 160)
    table = Table("name", "joints", "inverse kinematics", "source")
    code = 0
    for name in list_robots():
        try:
            description = load_description(name)
            chain = description.chain()
            joints = "".join("P" if kind == PRISMATIC else "R" for kind in chain.types)
            source = description.source or "none given"
            shown = source if args.full else shorten(source, _SHORT, placeholder=" ...")
            table.add_row(name, joints, family_of(chain).name, shown)
        except RobomechError as error:
            table.add_row(name, "", "", f"cannot be loaded: {error}")
            code = 1
    console.print(table)
    return code
