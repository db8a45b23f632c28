"""``robomech bringup``: all nodes for one robot, as processes or in one."""

import argparse
import json
import re
import signal
import sys
import threading
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from types import FrameType
from typing import Any

from robomech_ros.errors import BadValueError
from robomech_ros.nodes.common.joint_limits import read_joint_limits
from robomech_ros.nodes.process.process_group import NODE_MODULES, ProcessGroup, node_command
from robomech_ros.robots import load_description, robot_folders

__all__ = ["add_arguments", "node_commands", "run"]

EXIT_CHILD_FAILED = 1

_PART_OF_A_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument(
        "--robot",
        default="",
        help="name (see `robomech robots`) or path of a URDF or YAML file; default: wait for the "
        "topic robot_description",
    )
    parser.add_argument("--base-link", default="", help="first link of the chain")
    parser.add_argument("--tip-link", default="", help="last link of the chain")
    parser.add_argument("--namespace", default="", help="namespace of all nodes, such as /left")
    parser.add_argument("--rate", type=float, help="rate of joint_states in Hz (100)")
    parser.add_argument(
        "--joint-limits",
        default="",
        help="YAML with limits that the robot's description lacks, such as MoveIt's "
        "joint_limits.yaml",
    )
    parser.add_argument(
        "--dynamic",
        action="store_true",
        help="drives move the simulated robot, through mass, friction and effort limits",
    )
    parser.add_argument("--params-file", action="append", default=[], help="YAML with parameters")
    parser.add_argument("--no-servo", action="store_true", help="all nodes but the servo")
    parser.add_argument(
        "--in-one-process", action="store_true", help="all nodes in one process and one executor"
    )


def run(args: argparse.Namespace) -> int:
    """Bring the nodes up; returns 0 after SIGINT or SIGTERM, 1 if a node ended by itself."""
    _check(args)
    if args.robot:
        # Said once, here, instead of once by every node.
        description = load_description(args.robot)
        if args.joint_limits:
            description = read_joint_limits(args.joint_limits).on(description)
        description.chain(args.base_link, args.tip_link)
    if args.in_one_process:
        from robomech_ros.nodes.process.run import run_nodes

        nodes = _nodes(args)
        everything = [argument for node in nodes for argument in _config_file(node)]
        arguments = ["robomech", "--ros-args", *everything, *_ros_arguments(args)]
        return run_nodes([_factory(node) for node in nodes], arguments)
    return _supervise(_commands(args))


def _check(args: argparse.Namespace) -> None:
    """Refuse here, once, what every node would refuse in the middleware's words."""
    for path in args.params_file:
        if not Path(path).is_file():
            raise BadValueError("--params-file", path, "a YAML file that exists")
    parts = args.namespace.strip("/").split("/")
    if args.namespace.strip("/") and not all(_PART_OF_A_NAME.fullmatch(part) for part in parts):
        expected = "words of letters, digits and underscores, such as /left or /cell_1/left"
        raise BadValueError("--namespace", args.namespace, expected)


def node_commands(robot: str, *options: str) -> dict[str, list[str]]:
    """Give the command lines of all nodes but the servo, as `robomech bringup` starts them.

    Parameters
    ----------
    robot : str
        Name or path.
    *options : str
        Further options.
    """
    parser = argparse.ArgumentParser()
    add_arguments(parser)
    return _commands(parser.parse_args(["--robot", robot, "--no-servo", *options]))


def _nodes(args: argparse.Namespace) -> list[str]:
    """List the nodes that are wanted."""
    return [node for node in NODE_MODULES if not (args.no_servo and node == "servo")]


def _commands(args: argparse.Namespace) -> dict[str, list[str]]:
    arguments = _ros_arguments(args)
    return {node: node_command(node, [*_config_file(node), *arguments]) for node in _nodes(args)}


def _ros_arguments(args: argparse.Namespace) -> list[str]:
    """Turn the options into ROS arguments for every node."""
    robot = args.robot
    if robot and (Path(robot).suffix or "/" in robot):
        robot = str(Path(robot).expanduser().resolve())
    result = []
    for name in args.params_file:
        result += ["--params-file", name]
    if args.namespace:
        result += ["-r", f"__ns:=/{args.namespace.strip('/')}"]
    values = {
        "robot_description": robot,
        "base_link": args.base_link,
        "tip_link": args.tip_link,
    }
    for name, value in values.items():
        if value:
            # Quoted: YAML would read a robot called 7 as a number.
            result += ["-p", f"{name}:={json.dumps(value)}"]
    if args.joint_limits:
        path = json.dumps(str(Path(args.joint_limits).expanduser().resolve()))
        result += ["-p", f"trajectory_planner:joint_limits:={path}"]
    if args.rate is not None:
        result += ["-p", f"joint_trajectory_controller:publish_rate:={float(args.rate)}"]
    if args.dynamic:
        result += ["-p", "joint_trajectory_controller:simulation:=dynamic"]
    return result


def _config_file(node: str) -> list[str]:
    """Find the parameters that the package ships for a node."""
    for folder in robot_folders():
        path = folder.parent / f"{node}.yaml"
        if path.is_file():
            return ["--params-file", str(path)]
    return []


def _factory(node: str) -> Any:
    """Find the node's class in its module: the one that has a table of parameters."""
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
    first = None if told_to_stop.is_set() else group.wait_for_first()
    codes = group.stop()
    if first is not None and not told_to_stop.is_set():
        name, code = first
        print(
            f"robomech bringup: {name} ended with exit code {code} (its last words are above); "
            "the other nodes were stopped",
            file=sys.stderr,
        )
        return EXIT_CHILD_FAILED
    failed = {name: code for name, code in codes.items() if code}
    for name, code in failed.items():
        print(f"robomech bringup: {name} ended with exit code {code}", file=sys.stderr)
    return EXIT_CHILD_FAILED if failed else 0


def _on_signals(handler: Callable[[int, FrameType | None], object]) -> None:
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, handler)
