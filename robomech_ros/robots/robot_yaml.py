"""Robots described in YAML: Denavit-Hartenberg tables, and what URDF cannot say.

A table (all numbers in m, rad, s, N m or N)::

    name: planar3r
    source: where the numbers come from
    joints:
      - {name: joint_1, type: revolute, a: 1.0, b: 0.0, alpha: 0.0, lower: -3.0, upper: 3.0}

The source may be left out, and ``b`` may be called ``d``.  After ``units: degrees`` all angles,
their limits and their rates are in degrees.

A joint may have the ``body`` that it moves, in frame i + 1 of the table, and its ``drive``, as
:mod:`robomech_ros.robots.documents.yaml_bodies` reads them::

        body: {mass: 2.0, com: [-0.5, 0.0, 0.0], inertia: {ixx: 0.0, iyy: 0.17, izz: 0.17}}
        drive: {viscous: 0.1, coulomb: 0.5, rotor_inertia: 2.0e-4, gear_ratio: 100.0}

A robot in space floats with the free body that carries it, in the frame of the root link::

    floating_base: {mass: 9.0e3, com: [0.0, 0.0, -2.0], inertia: {ixx: 7e4, iyy: 7e4, izz: 7e4}}

Beside a URDF of the same stem a file gives its source, and what URDF has no place for::

    source: where the numbers come from
    joints:
      joint_1: {acceleration: 10.0, jerk: 50.0}

Both may give the posture in which the robot stands to begin with, within its limits::

    home: {joint_1: 0.0, joint_2: 1.5}
"""

import dataclasses
import math
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from robomech_ros.errors import RobomechError, RobotDescriptionError, format_value
from robomech_ros.robots.bodies import Body
from robomech_ros.robots.chain import SerialChain
from robomech_ros.robots.description import RobotDescription
from robomech_ros.robots.dh import chain_from_dh
from robomech_ros.robots.dh_table import implausible_angles
from robomech_ros.robots.documents.guarded_yaml import check_keys, parse_yaml
from robomech_ros.robots.documents.yaml_bodies import body_from_yaml, drive_from_yaml
from robomech_ros.robots.documents.yaml_rows import (
    read_number,
    read_pose,
    read_positive,
    read_rows,
    read_text,
    read_unit,
)
from robomech_ros.robots.joint import Joint
from robomech_ros.robots.limit_arrays import KEYS as LIMITS

# Limits (rad) beyond four turns are mostly degrees; wrists turn twice either way.
_WIDEST = 8.0 * math.pi
_TOP_KEYS = ("name", "joints")
_TOP_OPTIONAL = (
    "source",
    "units",
    "notes",
    "base_link",
    "tip_link",
    "first_link",
    "base",
    "tool",
    "home",
    "floating_base",
)


def description_from_yaml(text: str | bytes, where: str = "YAML") -> RobotDescription:
    """Read a robot from the YAML form of a Denavit-Hartenberg table.

    - ``text``: the document.
    - ``where``: name of the document in messages.

    Raises RobotDescriptionError: keys are unknown or missing, or a value is not what it should be:
    the place in the document, the value and what is allowed are named.
    """
    given = parse_yaml(text, where)
    if "kind" in given:
        why = f"{format_value(given['kind'])}, expected the document of an arm, which has no kind"
        raise RobotDescriptionError(f"{where}: kind", why)
    document = check_keys(given, where, _TOP_KEYS, _TOP_OPTIONAL)
    angle = read_unit(document, where)
    rows = read_rows(document["joints"], where, angle)
    chain = _chain(document, rows, where, angle)
    links = [frame.name for frame in chain.frames]
    bodies = {
        link: row["body"] for link, row in zip(links[1:], rows, strict=False) if "body" in row
    }
    first = None
    if "first_link" in document:
        first = read_text(document["first_link"], f"{where}: first_link")
        if first in links:
            why = f"'{first}', expected a name other than {', '.join(links)}"
            raise RobotDescriptionError(f"{where}: first_link", why)
        links.insert(1, first)
    joints = _joints(chain, rows, first)
    return RobotDescription(
        name=read_text(document["name"], f"{where}: name"),
        links=tuple(links),
        joints=joints,
        where=where,
        source=_source(document, where),
        dh=chain.dh_given,
        bodies=bodies,
        home=_home(document, joints, where, angle),
        notes=tuple(_implausible(rows)),
        floating_base=_floating_base(document, f"{where}: floating_base"),
    )


def _floating_base(document: Mapping[str, Any], where: str) -> Body | None:
    if "floating_base" not in document:
        return None
    body = body_from_yaml(document["floating_base"], where)
    if fault := body.fault():
        raise RobotDescriptionError(where, fault)
    return body


def _source(document: Mapping[str, Any], where: str) -> str:
    if "source" not in document:
        return ""
    return read_text(document["source"], f"{where}: source", longest=None)


def _implausible(rows: list[dict[str, Any]]) -> Iterator[str]:
    """Yield a note for each value that is probably in degrees."""
    names = [row["name"] for row in rows]
    for key in ("alpha", "theta"):
        yield from implausible_angles(key, [row[key] for row in rows], names)
    for row in rows:
        widest = max(abs(row["lower"]), abs(row["upper"]))
        if row["type"] == "revolute" and _WIDEST < widest < math.inf:
            yield (
                f"joint '{row['name']}': a limit of {widest:g} rad is more than four turns; "
                "if degrees were meant, add the key 'units: degrees'"
            )


def _chain(
    document: Mapping[str, Any], rows: list[dict[str, Any]], where: str, angle: float
) -> SerialChain:
    base_link = read_text(document.get("base_link", "base_link"), f"{where}: base_link")
    tip_link = read_text(document.get("tip_link", "tool0"), f"{where}: tip_link")
    try:
        chain = chain_from_dh(
            *([row[key] for row in rows] for key in ("a", "b", "alpha", "theta")),
            types=["P" if row["type"] == "prismatic" else "R" for row in rows],
            base=read_pose(document.get("base"), f"{where}: base", angle),
            tool=read_pose(document.get("tool"), f"{where}: tool", angle),
            joint_names=[row["name"] for row in rows],
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
                **{key: row[key] for key in LIMITS},
            )
        )
    tip = f"{chain.tip}_fixed_joint"
    return (*joints, Joint(tip, "fixed", frames[-2].name, chain.tip, table.tool))


def with_yaml_limits(
    description: RobotDescription, text: str | bytes, where: str
) -> RobotDescription:
    """Add source, home, acceleration and jerk limits from the file beside a URDF.

    - ``description``: from the URDF.
    - ``text``: the YAML document.
    - ``where``: name of the document in messages.
    """
    optional = ("source", "name", "notes", "joints", "home")
    document = check_keys(parse_yaml(text, where), where, (), optional)
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
            else read_positive(value, key, place)
            for key, value in values.items()
        }
    joints = tuple(
        dataclasses.replace(joint, **changes.get(joint.name, {})) for joint in description.joints
    )
    source, home = _source(document, where), _home(document, joints, where)
    return dataclasses.replace(description, joints=joints, source=source, home=home)


def _home(
    document: Mapping[str, Any], joints: tuple[Joint, ...], where: str, angle: float = 1.0
) -> dict[str, float]:
    place = f"{where}: home"
    given = document.get("home") or {}
    moving = {joint.name: joint for joint in joints if joint.moves and joint.mimic is None}
    if not isinstance(given, dict) or not given.keys() <= moving.keys():
        why = f"{str(given)[:80]!r}, expected positions of joints among {', '.join(moving)}"
        raise RobotDescriptionError(place, why)
    home = {}
    for name, value in given.items():
        unit = 1.0 if moving[name].type == "prismatic" else angle
        home[name] = read_number(value, name, place) * unit
        lower, upper = moving[name].lower, moving[name].upper
        if not lower <= home[name] <= upper:
            why = f"{name} is {home[name]:g}, expected a number from {lower:.6g} to {upper:.6g}"
            raise RobotDescriptionError(place, why)
    return home
