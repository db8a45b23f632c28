"""``robomech demo``: solve, plan, execute and check a pick and place, with a plot."""

import argparse
import signal
import sys
from pathlib import Path

from robomech_ros.errors import RobomechError
from robomech_ros.nodes.commands.warmup import warm

__all__ = ["add_arguments", "run"]

EXIT_FAILED = 1


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("--robot", default="puma560", help="name or path of a robot (puma560)")
    parser.add_argument(
        "--output", type=Path, default=Path("demo_output"), help="folder for the plot (demo_output)"
    )


def run(args: argparse.Namespace) -> int:
    """Run the demonstration; returns 0 if every step of it succeeded, else 1."""
    # Contexts are left in order on SIGTERM, too: no node outlives the demonstration.
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(128 + signal.SIGTERM))
    warm(silent_if_quick=True)
    from robomech_ros.nodes.demonstration.session import demonstrate

    try:
        demonstrate(args.robot, args.output)
    except RobomechError as error:
        print(f"robomech demo failed: {error}", file=sys.stderr)
        return EXIT_FAILED
    return 0
