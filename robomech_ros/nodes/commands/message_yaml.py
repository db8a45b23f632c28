"""Messages from and to YAML, with the same meaning as in ``ros2 service call``."""

import array
import base64
import contextlib
import math
import re
from collections.abc import Iterator, Mapping
from importlib import import_module
from typing import Any

import numpy as np
import yaml

from robomech_ros.errors import BadValueError, RobomechError
from robomech_ros.errors.names import did_you_mean
from robomech_ros.robots.documents.guarded_yaml import UniqueKeyLoader
from robomech_ros.robots.documents.numbers_in_text import number

_PARTS_OF_A_TYPE = 3
_SEQUENCE = "tag:yaml.org,2002:seq"
# Services of MoveIt by words of their names and types, and those that need no types of MoveIt.
_WITHOUT_MOVEIT = {
    "compute_ik": "kinematics/solve_ik",
    "GetPositionIK": "kinematics/solve_ik",
    "compute_fk": "kinematics/solve_fk",
    "GetPositionFK": "kinematics/solve_fk",
    "compute_cartesian_path": "trajectory_planner/plan_cartesian",
    "GetCartesianPath": "trajectory_planner/plan_cartesian",
}
_INTEGER = re.compile(r"(?P<unsigned>u?)int(?P<bits>8|16|32|64)")
_LIST = re.compile(r"sequence<(?P<sequence>.+?)(, (?P<bound>\d+))?>|(?P<array>.+)\[(?P<size>\d+)\]")


class UnknownFieldError(RobomechError):
    """A field that a message does not have."""

    def __init__(self, field: str, kind: str, available: list[str]) -> None:
        self.field, self.kind = field, kind
        self.available = tuple(available)
        hint = did_you_mean(field, available)
        super().__init__(f"{kind} has no field '{field}'{hint}; it has: {', '.join(available)}")


def interface_class(name: str) -> Any:
    """Import the class of an interface, such as ``robomech_interfaces/srv/SolveIK``.

    Raises BadValueError: the name is not of that form, or the interface is not installed here.
    """
    parts = name.split("/")
    if len(parts) != _PARTS_OF_A_TYPE or not all(part.isidentifier() for part in parts):
        raise BadValueError("interface type", name, "package/srv/Name or package/msg/Name")
    try:
        return getattr(import_module(".".join(parts[:2])), parts[2])
    except (ImportError, AttributeError) as error:
        expected = f"an interface installed here ({error}){without_types(name)}"
        raise BadValueError("interface type", name, expected) from None


def without_types(name: str) -> str:
    """Say what does the same as a service of MoveIt; empty for other services and types."""
    other = _WITHOUT_MOVEIT.get(name.rsplit("/", 1)[-1])
    if not other:
        return ""
    return f"; it needs MoveIt's message types (see `robomech doctor`), {other} does not"


def parse_yaml(text: str) -> Mapping[str, Any]:
    """Parse a YAML mapping, empty for an empty text; BadValueError if it is not one."""
    try:
        values = yaml.load(text, Loader=UniqueKeyLoader) if text.strip() else {}
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        raise BadValueError("request", text, f"YAML ({' '.join(str(error).split())})") from None
    if values is None:
        return {}
    if not isinstance(values, Mapping):
        raise BadValueError("request", text, "a YAML mapping of field names to values")
    return values


def fill_message(message: Any, values: Mapping[str, Any], where: str = "") -> None:
    """Set the fields of a message from nested mappings, lists and scalars.

    - ``message``: changed in place; fields that are not given keep their defaults.
    - ``values``: field names to values. An integer field takes the name of a constant of the
      message, too.
    - ``where``: place of the message in the request, for error messages.

    Raises UnknownFieldError, BadValueError: a field that does not exist, or a value that does not
    fit; the place is named.
    """
    kinds = message.get_fields_and_field_types()
    for field, value in values.items():
        if field not in kinds:
            kind = type(message).__name__ + (f" (at {where})" if where else "")
            raise UnknownFieldError(str(field), kind, list(kinds))
        place = f"{where}.{field}" if where else str(field)
        if isinstance(value, str) and _INTEGER.fullmatch(kinds[field]):
            value = getattr(type(message), value.upper(), value)
        setattr(message, field, _converted(kinds[field], value, place))


def _converted(kind: str, value: Any, place: str) -> Any:
    """Convert a value to a type named as rosidl names it; messages themselves check nothing."""
    if match := _LIST.fullmatch(kind):
        return _converted_list(match, value, place)
    if "/" in kind:
        nested = interface_class(kind.replace("/", "/msg/", 1))()
        if not isinstance(value, Mapping):
            fields = ", ".join(nested.get_fields_and_field_types())
            raise BadValueError(place, value, f"a mapping with fields of {kind}: {fields}")
        fill_message(nested, value, place)
        return nested
    return _scalar(kind, value, place)


def _converted_list(match: "re.Match[str]", value: Any, place: str) -> list[Any]:
    kind = match["sequence"] or match["array"]
    exact, most = match["size"], match["bound"]
    length = f"{exact} " if exact else f"at most {most} " if most else ""
    fits = isinstance(value, list | tuple) and (
        (not exact or len(value) == int(exact)) and (not most or len(value) <= int(most))
    )
    if not fits:
        raise BadValueError(place, value, f"a list of {length}{kind}")
    return [_converted(kind, entry, f"{place}[{i}]") for i, entry in enumerate(value)]


def _scalar(kind: str, value: Any, place: str) -> Any:
    if kind == "boolean" and isinstance(value, bool):
        return value
    if kind in ("float", "double") and type(value) is not bool:
        # A string, too: YAML 1.1 does not read 1e-3 as a number.
        with contextlib.suppress(TypeError, ValueError):
            return number(value) if isinstance(value, str) else float(value)
    if kind.startswith(("string", "wstring")) and not isinstance(value, Mapping | list):
        # Like `ros2 service call`: a bare word that YAML reads as a number is a string here.
        return "" if value is None else str(value)
    if (match := _INTEGER.fullmatch(kind)) and type(value) is int:
        bits, signed = int(match["bits"]), not match["unsigned"]
        low, high = (-(1 << bits - 1), 1 << bits - 1) if signed else (0, 1 << bits)
        if low <= value < high:
            return value
    if kind in ("octet", "byte") and type(value) is int and 0 <= value < 256:
        return bytes([value])
    raise BadValueError(place, value, f"a value of type {kind}")


class _Dumper(yaml.SafeDumper):
    """Puts lists of plain values on one line, and indents lists of messages."""

    def increase_indent(self, flow: bool = False, indentless: bool = False) -> None:
        super().increase_indent(flow, False)


class _Line(list[Any]):
    """A list that stands on one line."""


_Dumper.add_representer(
    _Line, lambda dumper, line: dumper.represent_sequence(_SEQUENCE, line, flow_style=True)
)


def to_yaml(message: Any, full: bool = False, digits: int = 17) -> str:
    """Write a message as YAML.

    - ``message``: any message, request or response.
    - ``full``: False leaves out the empty lists and zero times inside nested messages.
    - ``digits``: how many significant ones of numbers that are no integers.
    """
    plain = dict(_plain_fields(message, True, full, digits))
    return yaml.dump(
        plain, Dumper=_Dumper, sort_keys=False, default_flow_style=False, width=math.inf,
        allow_unicode=True,
    )  # fmt: skip


def _plain_fields(
    message: Any, full: bool, inner_full: bool, digits: int
) -> Iterator[tuple[str, Any]]:
    for field in message.get_fields_and_field_types():
        value = _plain(getattr(message, field), inner_full, digits)
        if full or value not in ([], {"sec": 0, "nanosec": 0}):
            yield field, value


def _plain(value: Any, full: bool, digits: int) -> Any:
    if hasattr(value, "get_fields_and_field_types"):
        return dict(_plain_fields(value, full, full, digits))
    if isinstance(value, float):
        return float(f"{value:.{digits}g}")
    if isinstance(value, bytes | bytearray):
        return base64.b64encode(value).decode()
    if isinstance(value, np.ndarray | array.array | list | tuple):
        plain = value.tolist() if isinstance(value, np.ndarray) else value
        entries = [_plain(entry, full, digits) for entry in plain]
        return entries if any(isinstance(e, dict) for e in entries) else _Line(entries)
    return value
