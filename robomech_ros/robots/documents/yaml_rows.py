"""Entries of a robot's YAML: the joints of a table, numbers, texts and poses."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from robomech_ros._kernels.tolerances import LARGEST_LENGTH
from robomech_ros.errors import RobotDescriptionError
from robomech_ros.robots.chain_layout import MOST_JOINTS
from robomech_ros.robots.documents.guarded_yaml import check_keys, describe_value
from robomech_ros.robots.documents.yaml_bodies import body_from_yaml, drive_from_yaml
from robomech_ros.robots.limit_arrays import KEYS as LIMITS, position_limits
from robomech_ros.spatial import matrix_from_roll_pitch_yaw
from robomech_ros.typing import Array

_ROW_KEYS = ("name", "type", "a", "alpha")
_ROW_OPTIONAL = ("b", "d", "theta", "body", "drive")
# Fields with an angle or its rate, for every joint and for revolute joints.
_ANGLES = ("alpha", "theta")
_TURNS = ("lower", "upper", "velocity", "acceleration", "jerk")
JOINT_TYPES = ("revolute", "continuous", "prismatic")
_LONGEST_NAME = 256


def read_unit(document: Mapping[str, Any], where: str) -> float:
    """Read the key ``units``; returns the unit of angles in rad."""
    units = document.get("units", "radians")
    if units not in ("radians", "degrees"):
        raise RobotDescriptionError(
            f"{where}: units", f"{describe_value(units)}, expected radians, degrees"
        )
    return math.radians(1.0) if units == "degrees" else 1.0


def read_rows(rows: object, where: str, angle: float = 1.0) -> list[dict[str, Any]]:
    """Read the joints of a table, each with all keys; angles are in a unit that is given in rad."""
    where = f"{where}: joints"
    if not isinstance(rows, list) or not rows:
        raise RobotDescriptionError(where, "expected a list of joints")
    if len(rows) > MOST_JOINTS:
        raise RobotDescriptionError(where, f"{len(rows)}, at most {MOST_JOINTS} are allowed")
    checked = [_row(row, f"{where}: joint {i + 1}", angle) for i, row in enumerate(rows)]
    names = [row["name"] for row in checked]
    for name in names:
        if names.count(name) > 1:
            raise RobotDescriptionError(where, f"'{name}' is given twice")
    return checked


def _row(row: object, where: str, angle: float) -> dict[str, Any]:
    checked = dict(check_keys(row, where, _ROW_KEYS, (*_ROW_OPTIONAL, *LIMITS)))
    where = f"{where} ('{read_text(checked['name'], f'{where}: name')}')"
    kind = checked["type"]
    if kind not in JOINT_TYPES:
        raise RobotDescriptionError(
            where, f"type is {str(kind)[:80]!r}, expected one of {', '.join(JOINT_TYPES)}"
        )
    if ("b" in checked) == ("d" in checked):
        why = "needs exactly one of b and d, two names of the same parameter"
        raise RobotDescriptionError(where, why)
    checked["b"] = checked.pop("d", checked.get("b"))
    for key in (*_ANGLES, *(() if kind == "prismatic" else _TURNS)):
        if key in checked:
            checked[key] = read_number(checked[key], key, where) * angle
    for key in ("a", "b", "alpha"):
        checked[key] = read_number(checked[key], key, where)
        if abs(checked[key]) > LARGEST_LENGTH:
            raise RobotDescriptionError(where, f"{key} is {checked[key]:g}, at most 1e6 is allowed")
    checked["theta"] = read_number(checked.get("theta", 0.0), "theta", where)
    checked["lower"], checked["upper"] = read_range(checked, kind, where)
    for key in LIMITS[2:]:
        checked[key] = read_positive(checked[key], key, where) if key in checked else math.nan
    if "body" in checked:
        checked["body"] = body_from_yaml(checked["body"], f"{where}: body")
    checked["drive"] = drive_from_yaml(checked.get("drive", {}), f"{where}: drive")
    return checked


def read_range(row: Mapping[str, Any], kind: str, where: str) -> tuple[float, float]:
    """Read the least and greatest position of a joint (rad or m)."""
    given = [key for key in ("lower", "upper") if key in row]
    if kind == "continuous":
        if given:
            why = "a continuous joint has no lower and upper; write type revolute"
            raise RobotDescriptionError(where, why)
        return -math.inf, math.inf
    if len(given) < 2:
        why = f"a {kind} joint needs lower and upper" + (
            "; write type continuous for one without" if kind == "revolute" else ""
        )
        raise RobotDescriptionError(where, why)
    lower, upper = (read_number(row[key], key, where) for key in ("lower", "upper"))
    if lower > upper:
        raise RobotDescriptionError(where, f"lower {lower:g} is above upper {upper:g}")
    return position_limits(lower, upper)


def read_number(value: object, key: str, where: str) -> float:
    """Read a finite number."""
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise RobotDescriptionError(
            where, f"{key} is {str(value)[:80]!r}, expected a finite number"
        )
    return float(value)


def read_positive(value: object, key: str, where: str) -> float:
    """Read a positive limit."""
    number = read_number(value, key, where)
    if number <= 0.0:
        raise RobotDescriptionError(where, f"{key} limit is {number:g}, expected a positive number")
    return number


def read_text(value: object, where: str, longest: int | None = _LONGEST_NAME) -> str:
    """Read a text that is not blank."""
    if not isinstance(value, str) or not value.strip():
        raise RobotDescriptionError(where, f"{str(value)[:80]!r}, expected a text")
    if longest is not None and len(value) > longest:
        raise RobotDescriptionError(where, f"longer than {longest}")
    return value.strip()


def read_pose(value: object, where: str, angle: float = 1.0) -> Array | None:
    """Read a pose: ``xyz`` (m) and ``rpy`` about fixed axes (of a unit in rad), both optional."""
    if value is None:
        return None
    pose = check_keys(value, where, (), ("xyz", "rpy"))
    numbers = {}
    for key in ("xyz", "rpy"):
        entry = pose.get(key, [0.0, 0.0, 0.0])
        if not isinstance(entry, list) or len(entry) != 3:
            raise RobotDescriptionError(where, f"{key} must be a list of three numbers")
        numbers[key] = [read_number(item, key, where) for item in entry]
        if max(map(abs, numbers[key])) > LARGEST_LENGTH:
            raise RobotDescriptionError(where, f"{key} is {entry}, at most 1e6 is allowed")
    T = np.eye(4)
    T[:3, :3] = matrix_from_roll_pitch_yaw(angle * np.array(numbers["rpy"]))
    T[:3, 3] = numbers["xyz"]
    return T
