"""``robomech call``: a service client for machines without the ros2 tool."""

import argparse
import math
import sys
import time
from difflib import get_close_matches
from typing import Any

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node

from robomech_ros.errors import RobomechError
from robomech_ros.nodes.common.message_yaml import (
    fill_message,
    interface_class,
    parse_yaml,
    to_yaml,
)

__all__ = ["EXIT_NO_ANSWER", "add_arguments", "run", "seconds_to_wait"]

EXIT_REFUSED = 1
EXIT_NO_ANSWER = 3

_POLL = 0.02
# A day, s.
_LONGEST = 86400.0
_MOST_LISTED = 12


class NoAnswerError(RobomechError):
    """The service did not appear, or did not answer, in time."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("service", help="name, such as kinematics/solve_ik")
    parser.add_argument("request", nargs="?", default="", help="fields in YAML; default all zero")
    parser.add_argument("--type", default="", help="interface type; default: ask the graph")
    parser.add_argument(
        "--timeout",
        type=seconds_to_wait,
        default=10.0,
        help="seconds to wait for service and answer (10)",
    )
    parser.add_argument(
        "--full", action="store_true", help="show empty lists and zero times of inner messages, too"
    )


def seconds_to_wait(text: str) -> float:
    """Read a time to wait (s)."""
    try:
        seconds = float(text)
    except ValueError:
        seconds = math.nan
    if not 0.0 < seconds <= _LONGEST:
        raise argparse.ArgumentTypeError(
            f"{text[:80]!r}, expected a number of seconds above 0 and up to {_LONGEST:g}"
        )
    return seconds


def run(args: argparse.Namespace) -> int:
    """Call the service and print its answer.

    Returns 0 if the answer says so, 1 if it carries an error, 3 if there was none.
    """
    values = parse_yaml(args.request)
    deadline = time.monotonic() + args.timeout
    rclpy.init(args=[])
    node = Node("robomech_call", enable_rosout=False, start_parameter_services=False)
    try:
        response = _answer(node, args, values, deadline)
    except NoAnswerError as error:
        print(f"robomech call: {error}", file=sys.stderr)
        return EXIT_NO_ANSWER
    except ExternalShutdownException:
        return EXIT_NO_ANSWER
    finally:
        node.destroy_node()
        rclpy.try_shutdown()
    print(to_yaml(response, args.full), end="")
    return _verdict(response)


def _answer(node: Node, args: argparse.Namespace, values: Any, deadline: float) -> Any:
    service = args.service if args.service.startswith("/") else f"/{args.service}"
    kind = interface_class(args.type or _type_in_graph(node, service, deadline))
    request = kind.Request()
    fill_message(request, values)
    client = node.create_client(kind, service)
    if not client.wait_for_service(timeout_sec=max(0.0, deadline - time.monotonic())):
        raise NoAnswerError(f"service '{service}' is not there after {args.timeout:g} s")
    future = client.call_async(request)
    rclpy.spin_until_future_complete(
        node, future, timeout_sec=max(0.0, deadline - time.monotonic())
    )
    if not future.done():
        raise NoAnswerError(f"service '{service}' did not answer within {args.timeout:g} s")
    return future.result()


def _type_in_graph(node: Node, service: str, deadline: float) -> str:
    while True:
        services = dict(node.get_service_names_and_types())
        if service in services:
            return str(services[service][0])
        if time.monotonic() > deadline:
            break
        time.sleep(_POLL)
    names = [name for name in sorted(services) if not _is_plumbing(name)]
    close = get_close_matches(service, names, n=1)
    hint = f" (did you mean '{close[0]}'?)" if close else ""
    there = ", ".join(names[:_MOST_LISTED]) or "none, is anything running?"
    raise NoAnswerError(f"service '{service}' did not appear{hint}; there are: {there}")


def _is_plumbing(service: str) -> bool:
    """Whether a service is one of those that every node has, or belongs to an action."""
    last = service.rsplit("/", 1)[-1]
    return "parameter" in last or "type_description" in last or "/_action/" in service


def _verdict(response: Any) -> int:
    """Say on stderr what the answer's code means; returns the exit code."""
    code = getattr(response, "error_code", 0)
    if hasattr(code, "val"):
        return _moveit_verdict(code)
    if code:
        from robomech_ros.outcomes import name_of

        print(f"error {code} {name_of(code)}: {response.error_msg}", file=sys.stderr)
        return EXIT_REFUSED
    if getattr(response, "success", True) is False:
        print(f"no success: {getattr(response, 'message', '')}", file=sys.stderr)
        return EXIT_REFUSED
    return 0


def _moveit_verdict(code: Any) -> int:
    """Say on stderr what a code of MoveIt means; returns the exit code."""
    kind = type(code)
    if code.val == kind.SUCCESS:
        return 0
    constants = (name for name in dir(kind) if name.isupper())
    name = next((name for name in constants if getattr(kind, name) == code.val), "unknown")
    print(f"error {code.val} {name}: {getattr(code, 'message', '')}", file=sys.stderr)
    return EXIT_REFUSED
