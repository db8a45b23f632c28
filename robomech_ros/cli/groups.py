"""``robomech groups``: groups of joints, end effectors and named postures of a robot."""

import argparse

from rich.console import Console
from rich.markup import escape
from rich.table import Table

from robomech_ros.robots import SemanticDescription, load_description, load_semantics


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("robot", help="name, or path of a URDF or YAML file")
    parser.add_argument("--srdf", required=True, help="SRDF with groups and named states")


def run(args: argparse.Namespace) -> int:
    """Print what the SRDF says of the robot; returns 0."""
    known = load_semantics(load_description(args.robot), args.srdf)
    console = Console(highlight=False)
    console = Console(highlight=False, width=None if console.is_terminal else 160)
    console.print(_groups(known))
    for one in known.end_effectors.values():
        console.print(f"end effector '{one.name}': group '{one.group}' on link '{one.parent_link}'")
    if known.disabled_collisions:
        console.print(f"link pairs without collisions: {len(known.disabled_collisions)}")
    for note in known.notes:
        console.print(f"note: {note}", markup=False)
    return 0


def _groups(known: SemanticDescription) -> Table:
    table = Table("group", "chain", "joints", "named postures")
    for name, group in known.groups.items():
        chain = " to ".join(group.ends) if group.ends else "no one chain"
        states = [
            f"{state} (unusable)" if (name, state) in known.unusable else state
            for state in known.states.get(name, {})
        ]
        rows = (name, chain, ", ".join(group.joints), ", ".join(states))
        table.add_row(*map(escape, rows))
    return table
