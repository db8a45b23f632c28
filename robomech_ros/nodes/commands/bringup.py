"""``robomech bringup``: all nodes for one robot, as processes or in one."""

import argparse
import os
import re
import signal
import sys
import threading
from collections.abc import Callable
from dataclasses import fields
from importlib import import_module
from pathlib import Path
from types import FrameType
from typing import Any

from robomech_ros.cli.kind_options import note_kinds, refuse_options
from robomech_ros.errors import BadValueError
from robomech_ros.nodes.process.discovery_range import ports_left, reach, stay_on_this_machine
from robomech_ros.nodes.process.entry_points import EXIT_CANNOT_START, NODE_MODULES
from robomech_ros.nodes.process.launch_options import OPTIONAL_NODES, LaunchOptions
from robomech_ros.nodes.process.nodes_by_kind import KIND_NODES, REFUSED, NodesOfKind
from robomech_ros.nodes.process.process_group import ProcessGroup
from robomech_ros.parallel import DescribedRobot, load_tree_description
from robomech_ros.robots import load_semantics, main_chain
from robomech_ros.robots.documents.numbers_in_text import integer, number
from robomech_ros.robots.robot_kinds import ARM, KINDS, check_name, kind_of

EXIT_CHILD_FAILED = 1
# Only arms have a servo to be left out; without one the option is harmless.
_OF_SERVO = ("no_servo",)

# Options that are texts, empty by default, and those that are switches.
_TEXTS = {
    "--robot": "name (see `robomech robots`) or path of a URDF or YAML file; default: wait for the "
    "topic robot_description",
    "--base-link": "first link of the chain",
    "--tip-link": "last link of the chain",
    "--srdf": "SRDF with groups of joints and named states; the robot starts at its state home. "
    "Default: the topic robot_description_semantic",
    "--group": "group whose chain is used",
    "--namespace": "namespace of all nodes, such as /left",
    "--joint-limits": "YAML with limits missing from the robot description, such as MoveIt's "
    "joint_limits.yaml",
}
_SWITCHES = {
    "--dynamic": "simulate drives with mass, friction and effort limits",
    "--auto-execute": "execute every new plan at once; default: only by "
    "trajectory_publisher/execute",
    "--no-servo": "all nodes but the servo",
    "--calibration": "also start the hand-eye calibration node; set its frames by parameters, see "
    "`calibration_node --help`",
    "--move-group": "also start MoveIt's services, actions and topics, and the planning scene",
    "--view": "also show the robot in a browser; prints the address",
}

_PART_OF_A_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
# A remap that gives every node the same name.
_NAME_OF_ALL = re.compile(r"__(node|name):=")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument(
        "--localhost",
        action="store_true",
        help="only this machine can discover the nodes; default: ROS_AUTOMATIC_DISCOVERY_RANGE, "
        "or the whole subnet",
    )
    parser.add_argument(
        "--in-one-process", action="store_true", help="run all nodes in one process and executor"
    )
    add_launch_arguments(parser)


def add_launch_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments that say which nodes there are, and of which robot."""
    for option, text in _TEXTS.items():
        parser.add_argument(option, default="", help=text)
    parser.add_argument(
        "--frame-prefix",
        help="prefix of frames in headers and on /tf; default: the namespace and a slash, such as "
        "left/, or none without a namespace",
    )
    parser.add_argument("--rate", type=number, help="rate of joint_states in Hz (100)")
    parser.add_argument("--params-file", action="append", default=[], help="YAML with parameters")
    for option, text in _SWITCHES.items():
        parser.add_argument(option, action="store_true", help=text)
    parser.add_argument("--view-port", type=integer, help="page port; 0 takes a free one (8080)")
    parser.add_argument(
        "--view-host", help="address on which the page listens (127.0.0.1: this machine only)"
    )
    parser.add_argument(
        "--ros-args",
        nargs=argparse.REMAINDER,
        default=[],
        metavar="...",
        help="all following arguments go to every node, such as -r /tf:=tf -p use_sim_time:=true",
    )
    note_kinds(parser, {kind: (*names, *_OF_SERVO) for kind, names in REFUSED.items()})


def run(args: argparse.Namespace) -> int:
    """Bring the nodes up; returns 0 after SIGINT or SIGTERM, 1 if a needed node ended."""
    check(args)
    if own := KIND_NODES.get(kind_of(args.robot)):
        own.load(args.robot)
        refuse_of_kind(args, own)
    elif args.robot and (robot := _load(args)).mechanism is not None:
        _check_parallel(args, robot)
    if args.localhost:
        stay_on_this_machine()
    _say(reach(os.environ))
    if left := ports_left(os.environ):
        _say(f"{left}; `fastdds shm clean` of Fast DDS removes them")
    options = launch_options(args)
    return _run_here(options) if args.in_one_process else _supervise(options.commands())


def launch_options(args: argparse.Namespace) -> LaunchOptions:
    """Pick what the nodes are started with."""
    given: dict[str, Any] = {
        row.name: getattr(args, row.name, None) for row in fields(LaunchOptions)
    }
    kind = kind_of(args.robot)
    given |= {
        "params_files": tuple(args.params_file),
        "servo": not args.no_servo,
        "kind": kind if kind in KIND_NODES else "",
        "ros_args": tuple(args.ros_args),
    }
    return LaunchOptions(**given)


def refuse_of_kind(
    args: argparse.Namespace, kind: NodesOfKind, besides: tuple[str, ...] = ()
) -> None:
    """Refuse options that a kind of robot has no use for, and others that a command names.

    Raises OptionRefusedError: it names the option, and those that apply.
    """
    refused = *kind.refused, *besides
    refuse_options(args, refused, args.robot, f"a {kind.kind_name}", _OF_SERVO)


def _check_parallel(args: argparse.Namespace, robot: DescribedRobot) -> None:
    """Refuse what does not serve parallel robots; leave out the servo, and say so."""
    from robomech_ros.nodes.common.robot.robot_description import RobotModel, RobotSettings

    refuse_options(args, REFUSED["parallel robots"], args.robot, "a parallel robot", _OF_SERVO)
    ends = RobotSettings(base_link=args.base_link, tip_link=args.tip_link)
    RobotModel(robot.description, ends, robot=robot.robot)
    if not args.no_servo:
        args.no_servo = True
        _say("no servo and no services of MoveIt, which serve no parallel robots")


def _load(args: argparse.Namespace) -> DescribedRobot:
    """Load the robot here, so that a fault in it is reported once and not by every node."""
    robot = load_tree_description(args.robot)
    if robot.mechanism is not None:
        return robot
    description = robot.description
    if args.joint_limits:
        from robomech_ros.nodes.common.joints.joint_limits import read_joint_limits

        description = read_joint_limits(args.joint_limits).on(description)
    if args.srdf or not args.group:
        known = load_semantics(description, args.srdf)
        main_chain(description, known, args.base_link, args.tip_link, args.group)
    return robot


def _run_here(options: LaunchOptions) -> int:
    from robomech_ros.nodes.process.run import run_nodes

    with options.arguments_of_one_process() as arguments:
        return run_nodes([node_class(node) for node in options.nodes], ["robomech", *arguments])


def check(args: argparse.Namespace) -> None:
    """Refuse here, once, what every node would refuse in the middleware's words.

    Raises UnknownRobotError: it names robots. BadValueError: it names the option.
    """
    check_name(args.robot, (ARM, *KINDS))
    for path in args.params_file:
        if not Path(path).is_file():
            raise BadValueError("--params-file", path, "a YAML file that exists")
    parts = args.namespace.strip("/").split("/")
    if args.namespace.strip("/") and not all(_PART_OF_A_NAME.fullmatch(part) for part in parts):
        expected = "words of letters, digits and underscores, such as /left or /cell_1/left"
        raise BadValueError("--namespace", args.namespace, expected)
    if args.frame_prefix and args.frame_prefix.startswith("/"):
        expected = "a text without a slash in front, such as left/"
        raise BadValueError("--frame-prefix", args.frame_prefix, expected)
    _check_view(args)
    if args.ros_args:
        _check_ros_args(args.ros_args)


def _check_view(args: argparse.Namespace) -> None:
    """Refuse what the view could not use, and its options without it."""
    for option in ("view_port", "view_host"):
        if getattr(args, option) is not None and not args.view:
            name = f"--{option.replace('_', '-')}"
            raise BadValueError(name, getattr(args, option), "nothing without --view")
    if args.view:
        from robomech_ros.rvs.opening import require_viser
        from robomech_ros.rvs.serving.address import GREATEST_PORT

        require_viser()
        if args.view_port is not None and not 0 <= args.view_port <= GREATEST_PORT:
            raise BadValueError("--view-port", args.view_port, f"0 to {GREATEST_PORT}")


def _check_ros_args(words: list[str]) -> None:
    """Refuse words that ROS does not understand, and one name for all nodes."""
    from rclpy.context import Context

    if any(_NAME_OF_ALL.match(word) for word in words):
        expected = "no name, which all nodes would have; in a launch file leave out name="
        raise BadValueError("--ros-args", " ".join(words), expected)
    context = Context()
    try:
        context.init(["robomech", "--ros-args", *words], initialize_logging=False)
        context.shutdown()
    except Exception as error:
        # rclpy has one class for each kind of fault, below none of its own.
        if not type(error).__module__.startswith(("rclpy", "_rclpy_pybind11")):
            raise
        expected = f"arguments as `ros2 run` takes them ({' '.join(str(error).split())})"
        raise BadValueError("--ros-args", " ".join(words), expected) from None


def node_class(node: str) -> Any:
    """Find the class of a node in its module: the one that has a table of parameters."""
    module = import_module(NODE_MODULES[node])
    return next(
        value
        for value in vars(module).values()
        if getattr(value, "__module__", "") == module.__name__ and hasattr(value, "SETTINGS")
    )


def _supervise(commands: dict[str, list[str]]) -> int:
    told_to_stop = threading.Event()
    _on_signals(lambda *_: told_to_stop.set())
    group = ProcessGroup(commands)

    def stop(number: int, frame: object) -> None:
        told_to_stop.set()
        group.interrupt_wait()

    _on_signals(stop)
    first, ended = None, set[str]()
    while not told_to_stop.is_set() and (first := group.wait_for_end()) is not None:
        name, code = first
        if name not in OPTIONAL_NODES or code == EXIT_CANNOT_START:
            break
        ended.add(name)
        _say(f"{name} ended with exit code {code}; the other nodes go on")
    codes = {name: code for name, code in group.stop().items() if name not in ended}
    if first is not None and not told_to_stop.is_set():
        name, code = first
        how = f"{name} ended with exit code {code} (its last words are above)"
        _say(f"{how}; the other nodes were stopped")
        return EXIT_CHILD_FAILED
    failed = {name: code for name, code in codes.items() if code}
    for name, code in failed.items():
        _say(f"{name} ended with exit code {code}")
    return EXIT_CHILD_FAILED if failed else 0


def _say(text: str) -> None:
    print(f"robomech bringup: {text}", file=sys.stderr, flush=True)


def _on_signals(handler: Callable[[int, FrameType | None], object]) -> None:
    for one in (signal.SIGINT, signal.SIGTERM):
        signal.signal(one, handler)
