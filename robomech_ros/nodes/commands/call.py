"""``robomech call``: a service client for machines without the ros2 tool."""

import argparse
import math
import sys
from contextlib import suppress
from typing import Any

from robomech_ros.nodes.commands.message_yaml import parse_yaml, to_yaml
from robomech_ros.robots.documents.numbers_in_text import integer, number

EXIT_REFUSED = 1
EXIT_NO_ANSWER = 3

# A day, s.
_LONGEST = 86400.0
# Digits that people read, and digits of a double.
_DIGITS, _ALL_DIGITS = 4, 17


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("service", help="name, such as kinematics/solve_ik")
    parser.add_argument("request", nargs="?", default="", help="fields in YAML; default: all zero")
    parser.add_argument("--type", default="", help="interface type; default: from the graph")
    parser.add_argument(
        "--timeout",
        type=seconds_to_wait,
        default=10.0,
        help="seconds to wait for the service and its response (10)",
    )
    parser.add_argument(
        "--full", action="store_true", help="also show empty lists and zero times of inner messages"
    )
    parser.add_argument(
        "--digits",
        type=significant_digits,
        default=_DIGITS,
        help=f"significant digits of numbers; {_ALL_DIGITS} show all there are ({_DIGITS})",
    )


def seconds_to_wait(text: str) -> float:
    """Read a time to wait (s)."""
    try:
        seconds = number(text)
    except ValueError:
        seconds = math.nan
    if not 0.0 < seconds <= _LONGEST:
        raise argparse.ArgumentTypeError(
            f"{text[:80]!r}, expected a number of seconds above 0 and up to {_LONGEST:g}"
        )
    return seconds


def significant_digits(text: str) -> int:
    """Read how many digits of a number are shown."""
    with suppress(ValueError):
        if 1 <= (digits := integer(text)) <= _ALL_DIGITS:
            return digits
    raise argparse.ArgumentTypeError(f"{text[:80]!r}, expected an integer from 1 to {_ALL_DIGITS}")


def run(args: argparse.Namespace) -> int:
    """Call the service and print its answer; returns 0, 1 for an error, 3 without an answer."""
    values = parse_yaml(args.request)
    from robomech_ros.nodes.commands.service_client import NoAnswerError, call_service

    try:
        response = call_service(args.service, args.type, values, args.timeout)
    except NoAnswerError as error:
        print(f"robomech call: {error}", file=sys.stderr)
        return EXIT_NO_ANSWER
    print(to_yaml(response, args.full, args.digits), end="")
    return _verdict(response)


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
