"""The ``robomech`` command."""

import argparse
import sys
from collections.abc import Sequence
from importlib import import_module

from robomech_ros import __version__
from robomech_ros.nodes.start import leave_on_signals

__all__ = ["main"]

COMMANDS = {
    "bringup": "run all nodes for a robot",
    "call": "call a service with a request in YAML",
    "plot": "draw all postures in which an arm takes a pose",
    "plot-trajectory": "draw a planned trajectory over time, with its limits",
    "map": "map which orientations an arm can take where, and how well",
    "plot-map": "draw slices through a map",
    "plot-workspace": "draw what an arm reaches: boundaries and numbers of postures",
    "symbolic": "print closed forms of a robot's kinematics and dynamics",
    "robots": "list the robots that are known by name",
    "warmup": "compile the numeric kernels, once",
    "doctor": "say what is missing on this machine, and how to mend it",
    "demo": "solve, plan, execute and check a pick and place, with a plot",
}

EXIT_USAGE = 2
EXIT_INTERRUPTED = 130


def main(args: Sequence[str] | None = None) -> int:
    """Run one subcommand; returns the exit code."""
    argv = list(sys.argv[1:] if args is None else args)
    chosen = next((word for word in argv if not word.startswith("-")), "")
    if chosen == "bringup":
        # Until there is something to stop, a signal just ends this process.
        leave_on_signals()
    try:
        return _run(argv, chosen)
    except KeyboardInterrupt:
        return EXIT_INTERRUPTED


def _run(argv: list[str], chosen: str) -> int:
    # This takes a while, in which signals have their answer already.
    from robomech_ros.errors import RobomechError

    parser = argparse.ArgumentParser(prog="robomech", description=__doc__)
    parser.add_argument("--version", action="version", version=__version__)
    commands = parser.add_subparsers(dest="command", metavar="COMMAND", required=True)
    for name, summary in COMMANDS.items():
        sub = commands.add_parser(name, help=summary, description=summary.capitalize() + ".")
        if name == chosen:
            # Only the chosen command is imported: `robomech doctor` has to run where ROS is
            # missing, and `robomech robots` need not wait for it.
            module = import_module(f"robomech_ros.nodes.commands.{name.replace('-', '_')}")
            module.add_arguments(sub)
            sub.set_defaults(run=module.run)
    parsed = parser.parse_args(argv)
    try:
        return int(parsed.run(parsed))
    except RobomechError as error:
        print(f"robomech {chosen}: {error}", file=sys.stderr)
        return EXIT_USAGE


if __name__ == "__main__":
    raise SystemExit(main())
