"""Programs: postures, and moves between them again and again, read from a YAML file.

::

    cycles: 3                  # 0 = until it is cancelled
    postures:                  # rad or m, base to tip
      above: [0.1, 0.5, -0.6, 0.0, 0.3, 0.0]
      down: [0.1, 0.7, -0.8, 0.0, 0.3, 0.0]
    steps:
      - {move: above, profile: ruckig, velocity_scale: 0.5}
      - {move: down, duration: 1.5}
      - {move: home}           # as the SRDF or the robot's description has it
      - {wait: 0.2}            # s
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

from robomech_ros.errors import RobomechError, RobotDescriptionError
from robomech_ros.errors.formatting import counted
from robomech_ros.regular_files import read_regular
from robomech_ros.robots import SemanticDescription, SerialChain
from robomech_ros.robots.documents.guarded_yaml import (
    LARGEST_YAML,
    check_keys,
    describe_value,
    parse_yaml,
)

# Positions (rad or m) by the names of postures.
_Positions = dict[str, tuple[float, ...]]

_PROFILE = "poly345"
_OPTIONS = ("profile", "duration", "velocity_scale", "acceleration_scale", "jerk_scale")
_LONGEST_WAIT = 3600.0
_MOST_CYCLES = 1_000_000


@dataclass(frozen=True)
class Step:
    """A move to a posture, or a wait."""

    posture: str = ""  #: Name of the goal posture; empty for a wait.
    positions: tuple[float, ...] = ()  #: Joint positions of the posture (rad or m).
    wait: float = 0.0  #: Duration of a wait (s).
    options: Mapping[str, Any] = field(default_factory=dict)  #: Keywords of `point_to_point`.


@dataclass(frozen=True)
class Program:
    """Steps to execute, and their repetitions."""

    steps: tuple[Step, ...]  #: Steps in the order of execution.
    cycles: int  #: Number of repetitions; 0 for without end.


def read_program(path: Path, chain: SerialChain, semantic: SemanticDescription) -> Program:
    """Read a program for a robot.

    - ``path``: path of the YAML file.
    - ``chain``: the robot, for the number of joints and their ranges.
    - ``semantic``: named postures of the robot, for those that the program does not define.

    Raises RobotDescriptionError: the file cannot be read, or has an invalid entry; the text names
    its place.
    """
    where = f"program '{path}'"
    try:
        text = read_regular(path, LARGEST_YAML)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise RobotDescriptionError(where, f"not readable: {reason}") from None
    given = check_keys(parse_yaml(text, where), where, ("steps",), ("postures", "cycles"))
    cycles = given.get("cycles", 1)
    if type(cycles) is not int or not 0 <= cycles <= _MOST_CYCLES:
        expected = f"a whole number from 0 (until cancelled) on to {_MOST_CYCLES}"
        raise _unexpected(where, "cycles", cycles, expected)
    own = _postures(given.get("postures", {}), where, chain)
    find = partial(_posture, own, chain, semantic)
    steps = given["steps"]
    if not isinstance(steps, list) or not steps:
        raise RobotDescriptionError(where, "steps is no list with at least one step")
    read = [_step(step, f"{where}: step {k + 1}", find) for k, step in enumerate(steps)]
    if not any(step.posture for step in read):
        raise RobotDescriptionError(where, "no step moves")
    return Program(tuple(read), cycles)


def _posture(
    given: _Positions, chain: SerialChain, semantic: SemanticDescription, name: str, where: str
) -> tuple[float, ...]:
    """Find a posture (rad or m); one that the program gives takes precedence."""
    if name in given:
        return given[name]
    known = semantic.postures(chain)
    if name not in known:
        names = ", ".join(dict.fromkeys([*given, *known]))
        raise RobotDescriptionError(where, f"no posture {describe_value(name)}; there are {names}")
    try:
        return tuple(semantic.posture(chain, name).tolist())
    except RobomechError as error:
        raise RobotDescriptionError(where, str(error)) from None


def _postures(given: object, where: str, chain: SerialChain) -> _Positions:
    if not isinstance(given, dict):
        raise RobotDescriptionError(where, "postures is no mapping of names to positions")
    return {
        str(name): _positions(values, f"{where}: posture {describe_value(name)}", chain)
        for name, values in given.items()
    }


def _positions(given: object, where: str, chain: SerialChain) -> tuple[float, ...]:
    if not isinstance(given, list) or len(given) != chain.n:
        names = ", ".join(chain.joint_names)
        raise RobotDescriptionError(where, f"expected {counted(chain.n, 'position')}, of {names}")
    for name, value, low, high, unit in zip(
        chain.joint_names, given, chain.lower, chain.upper, chain.units, strict=True
    ):
        if not _is_number(value) or not low <= value <= high:
            expected = f"a number from {low:.6g} to {high:.6g} {unit}"
            raise _unexpected(where, f"joint '{name}'", value, expected)
    return tuple(float(value) for value in given)


def _step(given: object, where: str, find: Callable[[str, str], tuple[float, ...]]) -> Step:
    if isinstance(given, dict) and "wait" in given:
        wait = check_keys(given, where, ("wait",), ())["wait"]
        if not _is_number(wait) or not 0.0 <= wait <= _LONGEST_WAIT:
            raise _unexpected(where, "wait", wait, f"a number from 0 to {_LONGEST_WAIT:g} s")
        return Step(wait=float(wait))
    step = check_keys(given, where, ("move",), _OPTIONS)
    name = str(step["move"])
    positions = find(name, where)
    from robomech_ros.trajectory import PROFILES  # compiled code, which takes long to load

    options = {"profile": _PROFILE, **{key: step[key] for key in _OPTIONS if key in step}}
    if options["profile"] not in PROFILES:
        raise _unexpected(where, "profile", options["profile"], f"one of {', '.join(PROFILES)}")
    for key in _OPTIONS[1:]:
        if key in options and not (_is_number(options[key]) and options[key] > 0.0):
            raise _unexpected(where, key, options[key], "a number above 0")
    return Step(posture=name, positions=positions, options=options)


def _unexpected(where: str, what: str, value: object, expected: str) -> RobotDescriptionError:
    return RobotDescriptionError(where, f"{what} is {describe_value(value)}, expected {expected}")


def _is_number(value: object) -> bool:
    return type(value) in (int, float) and math.isfinite(value)  # type: ignore[arg-type]
