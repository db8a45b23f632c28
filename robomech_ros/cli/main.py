"""The ``robomech`` command."""

import argparse
import sys
from collections.abc import Sequence
from importlib import import_module

from robomech_ros import __version__
from robomech_ros.stop_signals import leave_on_signals

_HERE = "robomech_ros.cli"
_WITH_ROS = "robomech_ros.nodes.commands"
# Name: the package that it is a module of, and what it does.
COMMANDS = {
    "bringup": (_WITH_ROS, "run all nodes for a robot"),
    "call": (_WITH_ROS, "call a service with a request in YAML"),
    "gripper": (_WITH_ROS, "open or close the gripper of a running robot"),
    "plot": (_HERE, "draw all postures of an arm that reach a pose"),
    "plot-trajectory": (_WITH_ROS, "draw a planned trajectory over time, with its limits"),
    "map": (_HERE, "map which orientations an arm reaches at each point, and how well"),
    "plot-map": (_HERE, "draw slices through a map"),
    "plot-workspace": (_HERE, "draw the workspace of an arm: boundaries and posture counts"),
    "plot-simulation": (_HERE, "draw a simulated motion of an arm: joints, energy, drive torques"),
    "symbolic": (_HERE, "print closed forms of a robot's kinematics and dynamics"),
    "export-urdf": (_HERE, "write a URDF of a robot with all parts visible"),
    "groups": (_HERE, "list a robot's joint groups and named postures from an SRDF"),
    "security-policies": (_WITH_ROS, "write the SROS2 policy for the nodes of a robot"),
    "view": (_HERE, "show a robot in a browser and move it there, without ROS"),
    "robots": (_HERE, "list the robots known by name"),
    "warmup": (_HERE, "compile the numeric kernels, once"),
    "doctor": (_HERE, "report what is missing on this machine, and how to fix it"),
    "calibrate-demo": (_WITH_ROS, "calibrate a simulated camera on a simulated robot, with a plot"),
    "demo": (_WITH_ROS, "run and check a demonstration of a robot, with a plot and a page"),
}

EXIT_USAGE = 2
EXIT_WITHOUT_ROS = 1
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
    for name, (package, summary) in COMMANDS.items():
        sub = commands.add_parser(
            name, help=summary, description=f"{summary[:1].upper()}{summary[1:]}."
        )
        if name == chosen:
            # Only the chosen command is imported, and ROS not before it runs: `robomech doctor`
            # and all help have to work where ROS is missing.
            module = import_module(f"{package}.{name.replace('-', '_')}")
            module.add_arguments(sub)
            sub.set_defaults(run=module.run)
    parsed = parser.parse_args(argv)
    try:
        return int(parsed.run(parsed))
    except RobomechError as error:
        print(f"robomech {chosen}: {_explained(error)}", file=sys.stderr)
        return EXIT_USAGE
    except ImportError as error:
        if COMMANDS[chosen][0] != _WITH_ROS:
            raise
        text = f"ROS 2 is needed and cannot be imported ({error}); see `robomech doctor`"
        print(f"robomech {chosen}: {text}", file=sys.stderr)
        return EXIT_WITHOUT_ROS


def _explained(error: Exception) -> str:
    """Return the text of an error; of a robot of another kind than a command takes, that kind."""
    from robomech_ros.errors import UnknownRobotError
    from robomech_ros.robots.robot_kinds import kind_of

    if not isinstance(error, UnknownRobotError) or not (kind := kind_of(error.name)):
        return str(error)
    known = ", ".join(error.available)
    return (
        f"'{error.name}' is a robot of kind '{kind}', which is not taken here; available: {known}"
    )


if __name__ == "__main__":
    raise SystemExit(main())
