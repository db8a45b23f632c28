"""Robots described in YAML: Denavit-Hartenberg tables, and what URDF cannot say.

A table (all numbers in m, rad, s, N m or N)::

    name: planar3r
    source: where the numbers come from
    joints:
      - {name: joint_1, type: revolute, a: 1.0, b: 0.0, alpha: 0.0, lower: -3.0, upper: 3.0}

A joint may have the ``body`` that it moves, in frame i + 1 of the table, and its ``drive``, as
:mod:`robomech_ros.robots.yaml_bodies` reads them::

        body: {mass: 2.0, com: [-0.5, 0.0, 0.0], inertia: {ixx: 0.0, iyy: 0.17, izz: 0.17}}
        drive: {viscous: 0.1, coulomb: 0.5, rotor_inertia: 2.0e-4, gear_ratio: 100.0}

Beside a URDF of the same stem a file gives its source, and what URDF has no place for::

    source: where the numbers come from
    joints:
      joint_1: {acceleration: 10.0, jerk: 50.0}
"""

import dataclasses
import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robomech_ros._kernels.tolerances import LARGEST_LENGTH
from robomech_ros.errors import RobomechError, RobotDescriptionError
from robomech_ros.robots.chain import SerialChain
from robomech_ros.robots.description import Joint, RobotDescription
from robomech_ros.robots.dh import chain_from_dh
from robomech_ros.robots.guarded_yaml import check_keys, parse_yaml
from robomech_ros.robots.limit_arrays import position_limits
from robomech_ros.robots.yaml_bodies import body_from_yaml, drive_from_yaml
from robomech_ros.spatial import matrix_from_roll_pitch_yaw

__all__ = ["description_from_yaml", "with_yaml_limits"]

Array = NDArray[np.float64]

_TOP_KEYS = ("name", "source", "joints")
_TOP_OPTIONAL = ("notes", "base_link", "tip_link", "first_link", "base", "tool")
_ROW_KEYS = ("name", "type", "a", "b", "alpha")
_ROW_OPTIONAL = ("theta", "body", "drive")
_LIMITS = ("lower", "upper", "velocity", "acceleration", "jerk", "effort")
_TYPES = ("revolute", "continuous", "prismatic")
_MOST_JOINTS = 64
_LONGEST_NAME = 256


def description_from_yaml(text: str | bytes, where: str = "YAML") -> RobotDescription:
    """Read a robot from the YAML form of a Denavit-Hartenberg table.

    Parameters
    ----------
    text : str or bytes
        The document.
    where : str, optional
        What it is called in messages.

    Raises
    ------
    RobotDescriptionError
        Keys are unknown or missing, or a value is not what it should be: the place in the
        document, the value and what is allowed are named.
    """
    document = check_keys(parse_yaml(text, where), where, _TOP_KEYS, _TOP_OPTIONAL)
    rows = _rows(document["joints"], where)
    chain = _chain(document, rows, where)
    links = [frame.name for frame in chain.frames]
    bodies = {
        link: row["body"] for link, row in zip(links[1:], rows, strict=False) if "body" in row
    }
    first = None
    if "first_link" in document:
        first = _text(document["first_link"], f"{where}: first_link")
        if first in links:
            why = f"'{first}', expected a name other than {', '.join(links)}"
            raise RobotDescriptionError(f"{where}: first_link", why)
        links.insert(1, first)
    return RobotDescription(
        name=_text(document["name"], f"{where}: name"),
        links=tuple(links),
        joints=_joints(chain, rows, first),
        where=where,
        source=_text(document["source"], f"{where}: source", longest=None),
        dh=chain.dh_given,
        bodies=bodies,
    )


def _rows(rows: object, where: str) -> list[dict[str, Any]]:
    where = f"{where}: joints"
    if not isinstance(rows, list) or not rows:
        raise RobotDescriptionError(where, "expected a list of joints")
    if len(rows) > _MOST_JOINTS:
        raise RobotDescriptionError(where, f"{len(rows)}, at most {_MOST_JOINTS} are allowed")
    checked = [_row(row, f"{where}: joint {i + 1}") for i, row in enumerate(rows)]
    names = [row["name"] for row in checked]
    for name in names:
        if names.count(name) > 1:
            raise RobotDescriptionError(where, f"'{name}' is given twice")
    return checked


def _chain(document: Mapping[str, Any], rows: list[dict[str, Any]], where: str) -> SerialChain:
    base_link = _text(document.get("base_link", "base_link"), f"{where}: base_link")
    tip_link = _text(document.get("tip_link", "tool0"), f"{where}: tip_link")
    try:
        chain = chain_from_dh(
            *([row[key] for row in rows] for key in ("a", "b", "alpha", "theta")),
            types=["P" if row["type"] == "prismatic" else "R" for row in rows],
            base=_pose(document.get("base"), f"{where}: base"),
            tool=_pose(document.get("tool"), f"{where}: tool"),
            base_link=base_link,
            tip_link=tip_link,
        )
    except RobotDescriptionError:
        raise
    except RobomechError as error:
        raise RobotDescriptionError(where, str(error)) from None
    return chain


def _joints(chain: SerialChain, rows: list[dict[str, Any]], first: str | None) -> tuple[Joint, ...]:
    """Make the joints of the tree, a fixed one to the tip included, and one to a first link."""
    table = chain.dh_given
    assert table is not None
    frames = chain.frames
    joints = []
    parent, origin = chain.base, table.base
    if first is not None:
        joints.append(Joint(f"{first}_fixed_joint", "fixed", parent, first, origin))
        parent, origin = first, np.eye(4)
    for i, row in enumerate(rows):
        joints.append(
            Joint(
                name=row["name"],
                type=row["type"],
                parent=parent if i == 0 else frames[i].name,
                child=frames[i + 1].name,
                origin=origin if i == 0 else np.eye(4),
                after=frames[i + 1].offset,
                drive=row["drive"],
                **{key: row[key] for key in _LIMITS},
            )
        )
    tip = f"{chain.tip}_fixed_joint"
    return (*joints, Joint(tip, "fixed", frames[-2].name, chain.tip, table.tool))


def with_yaml_limits(
    description: RobotDescription, text: str | bytes, where: str
) -> RobotDescription:
    """Add source, acceleration and jerk limits from the file beside a URDF.

    Parameters
    ----------
    description : RobotDescription
        From the URDF.
    text : str or bytes
        The YAML document.
    where : str
        What it is called in messages.

    Raises
    ------
    RobotDescriptionError
        Keys or joints are unknown, or a limit is not a positive number.
    """
    document = check_keys(parse_yaml(text, where), where, ("source",), ("name", "notes", "joints"))
    limits = document.get("joints") or {}
    if not isinstance(limits, dict):
        why = "expected joint names, each with acceleration, jerk and drive"
        raise RobotDescriptionError(f"{where}: joints", why)
    moving = [joint.name for joint in description.joints if joint.moves]
    changes: dict[str, dict[str, Any]] = {}
    for name, values in limits.items():
        place = f"{where}: joint '{str(name)[:80]}'"
        if name not in moving:
            names = ", ".join(moving[:40])
            raise RobotDescriptionError(place, f"{description.where} has only: {names}")
        check_keys(values, place, (), ("acceleration", "jerk", "drive"))
        changes[name] = {
            key: drive_from_yaml(value, f"{place}: drive")
            if key == "drive"
            else _positive(value, key, place)
            for key, value in values.items()
        }
    joints = tuple(
        dataclasses.replace(joint, **changes.get(joint.name, {})) for joint in description.joints
    )
    source = _text(document["source"], f"{where}: source", longest=None)
    return dataclasses.replace(description, joints=joints, source=source)


def _row(row: object, where: str) -> dict[str, Any]:
    checked = dict(check_keys(row, where, _ROW_KEYS, (*_ROW_OPTIONAL, *_LIMITS)))
    where = f"{where} ('{_text(checked['name'], f'{where}: name')}')"
    kind = checked["type"]
    if kind not in _TYPES:
        raise RobotDescriptionError(
            where, f"type is {str(kind)[:80]!r}, expected one of {', '.join(_TYPES)}"
        )
    for key in ("a", "b", "alpha"):
        checked[key] = _number(checked[key], key, where)
        if abs(checked[key]) > LARGEST_LENGTH:
            raise RobotDescriptionError(where, f"{key} is {checked[key]:g}, at most 1e6 is allowed")
    checked["theta"] = _number(checked.get("theta", 0.0), "theta", where)
    checked["lower"], checked["upper"] = _range(checked, kind, where)
    for key in _LIMITS[2:]:
        checked[key] = _positive(checked[key], key, where) if key in checked else math.nan
    if "body" in checked:
        checked["body"] = body_from_yaml(checked["body"], f"{where}: body")
    checked["drive"] = drive_from_yaml(checked.get("drive", {}), f"{where}: drive")
    return checked


def _range(row: Mapping[str, Any], kind: str, where: str) -> tuple[float, float]:
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
    lower, upper = (_number(row[key], key, where) for key in ("lower", "upper"))
    if lower > upper:
        raise RobotDescriptionError(where, f"lower {lower:g} is above upper {upper:g}")
    return position_limits(lower, upper)


def _number(value: object, key: str, where: str) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise RobotDescriptionError(
            where, f"{key} is {str(value)[:80]!r}, expected a finite number"
        )
    return float(value)


def _positive(value: object, key: str, where: str) -> float:
    number = _number(value, key, where)
    if number <= 0.0:
        raise RobotDescriptionError(where, f"{key} limit is {number:g}, expected a positive number")
    return number


def _text(value: object, where: str, longest: int | None = _LONGEST_NAME) -> str:
    if not isinstance(value, str) or not value.strip():
        raise RobotDescriptionError(where, f"{str(value)[:80]!r}, expected a text")
    if longest is not None and len(value) > longest:
        raise RobotDescriptionError(where, f"longer than {longest}")
    return value.strip()


def _pose(value: object, where: str) -> Array | None:
    """Read a pose: ``xyz`` (m) and ``rpy`` about fixed axes (rad), both optional."""
    if value is None:
        return None
    pose = check_keys(value, where, (), ("xyz", "rpy"))
    numbers = {}
    for key in ("xyz", "rpy"):
        entry = pose.get(key, [0.0, 0.0, 0.0])
        if not isinstance(entry, list) or len(entry) != 3:
            raise RobotDescriptionError(where, f"{key} must be a list of three numbers")
        numbers[key] = [_number(item, key, where) for item in entry]
        if max(map(abs, numbers[key])) > LARGEST_LENGTH:
            raise RobotDescriptionError(where, f"{key} is {entry}, at most 1e6 is allowed")
    T = np.eye(4)
    T[:3, :3] = matrix_from_roll_pitch_yaw(numbers["rpy"])
    T[:3, 3] = numbers["xyz"]
    return T
