"""``robomech demo``: a robot at work, checked, with a plot and a page."""

import argparse
import signal
import sys
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from tempfile import TemporaryFile

from robomech_ros.cli.kind_options import note_kinds, refuse_options
from robomech_ros.cli.warmup import FLOATING, OBSTACLES, demonstration_modules, warm
from robomech_ros.errors import BadValueError
from robomech_ros.nodes.commands.bringup import refuse_of_kind
from robomech_ros.nodes.process.launch_options import LaunchOptions
from robomech_ros.nodes.process.nodes_by_kind import KIND_NODES, REFUSED, NodesOfKind
from robomech_ros.robots import load_description
from robomech_ros.robots.documents.numbers_in_text import number
from robomech_ros.robots.robot_kinds import ARM, check_name, kind_of

EXIT_FAILED = 1
# As the controller's parameter payload_mass, kg.
HEAVIEST_PAYLOAD = 1000.0
# Options of arms; parallel robots refuse the last.
_ARM_OPTIONS = ("dynamic", "payload", "obstacles")
_REFUSED_BY_PLATFORMS = (*REFUSED["parallel robots"], "obstacles")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("--robot", default="puma560", help="name or path of a robot (puma560)")
    parser.add_argument(
        "--srdf", default="", help="SRDF whose state home is the start and the end of the motion"
    )
    parser.add_argument("--group", default="", help="group of the SRDF to move")
    parser.add_argument(
        "--dynamic",
        action="store_true",
        help="simulate drives with mass, friction and effort limits",
    )
    parser.add_argument(
        "--payload",
        type=number,
        default=0.0,
        help="with --dynamic: mass in kg to pick and place, which the drive controller does not "
        "know (0)",
    )
    parser.add_argument(
        "--obstacles",
        action="store_true",
        help="carry a part around a wall with the planner of move_group, and prove that nothing "
        "touched anything",
    )
    parser.add_argument(
        "--output",
        type=Path,
        default=Path("demo_output"),
        help="folder for the plot and the page (demo_output)",
    )
    shown = [f"{one.kind_name}s" for one in KIND_NODES.values() if one.demonstration]
    others = {kind: (*REFUSED[kind], *_ARM_OPTIONS) for kind in shown}
    note_kinds(parser, {"parallel robots": _REFUSED_BY_PLATFORMS, **others})


def _kind(args: argparse.Namespace) -> NodesOfKind | None:
    """Look up what is done with a robot that is no arm and not parallel; None for the others."""
    shown = [kind for kind, nodes in KIND_NODES.items() if nodes.demonstration]
    check_name(args.robot, (ARM, "parallel", *shown))
    kind = kind_of(args.robot)
    own = KIND_NODES.get(kind)
    if own is not None:
        if not own.demonstration:
            expected = f"a robot with a demonstration: a {own.kind_name} has none"
            raise BadValueError("--robot", args.robot, expected)
        own.load(args.robot)
        refuse_of_kind(args, own, _ARM_OPTIONS)
    elif kind == "parallel":
        refuse_options(args, _REFUSED_BY_PLATFORMS, args.robot, "a parallel robot")
    return own


def _floats(args: argparse.Namespace) -> bool:
    """Return whether the document of an arm has a floating base, whose drives are not simulated."""
    floats = load_description(args.robot).floating_base is not None
    if floats and args.dynamic:
        raise BadValueError("--dynamic", args.robot, "a robot on a fixed base; this one floats")
    return floats


def _check_folder(folder: Path) -> None:
    """Make the folder, and refuse one that takes no files: a demonstration runs for a minute."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with TemporaryFile(dir=folder):
            pass
    except OSError as error:
        expected = f"a folder that can be written ({error.strerror})"
        raise BadValueError("--output", str(folder), expected) from None


def run(args: argparse.Namespace) -> int:
    """Run the demonstration; returns 0 if every step of it succeeded, else 1."""
    own = _kind(args)
    floats = kind_of(args.robot) == ARM and _floats(args)
    if args.payload and not args.dynamic:
        raise BadValueError("--payload", args.payload, "0 without --dynamic: nothing has mass")
    if not 0.0 <= args.payload <= HEAVIEST_PAYLOAD:
        raise BadValueError("--payload", args.payload, f"0 to {HEAVIEST_PAYLOAD:g} kg")
    if args.obstacles and args.dynamic:
        expected = "no --dynamic beside it: friction would keep the drives off the proved path"
        raise BadValueError("--obstacles", "with --dynamic", expected)
    _check_folder(args.output)

    def demonstration() -> None:
        if own is not None:
            import_module(own.demonstration).demonstrate(args.robot, args.output)
            return
        which = LaunchOptions(args.robot, srdf=args.srdf, group=args.group, servo=False)
        if args.obstacles:
            from robomech_ros.nodes.move_group.node import require_messages

            require_messages()
            from robomech_ros.nodes.demonstration.obstacle_session import demonstrate_obstacles

            demonstrate_obstacles(which, args.output)
            return
        if floats:
            from robomech_ros.nodes.demonstration.capture_session import demonstrate_capture

            demonstrate_capture(which, args.output)
            return
        from robomech_ros.nodes.demonstration.session import demonstrate

        demonstrate(which, args.output, args.payload if args.dynamic else None)

    kind = OBSTACLES if args.obstacles else FLOATING if floats else kind_of(args.robot)
    return run_demonstration("demo", args.robot, kind, demonstration)


def run_demonstration(
    command: str, robot: str, kind: str, demonstration: Callable[[], None]
) -> int:
    """Run the demonstration of a robot; returns 0 if every step of it succeeded, else 1."""
    # Contexts are left in order on SIGTERM, too: no node outlives the demonstration.
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(128 + signal.SIGTERM))
    warm(demonstration_modules(robot, kind), silent_if_quick=True)
    from robomech_ros.nodes.demonstration.suite import DemoFailedError

    try:
        demonstration()
    except DemoFailedError as error:
        print(f"robomech {command} failed: {error}", file=sys.stderr)
        return EXIT_FAILED
    return 0
