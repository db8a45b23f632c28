"""Limbs of any kind from a YAML document.

Joints are given by their axes in the base where all of them are at zero, together with the pose of
the platform there, or by rows of Denavit and Hartenberg, as arms have them::

    type: limbs
    platform: {xyz: [0.0, 0.0, 0.5]}
    limbs:
      - name: leg1
        actuated: [slide]
        joints:
          - {name: slide, type: prismatic, axis: [0, 0, 1], point: [0.3, 0, 0],
             lower: 0, upper: 0.2}
          - {name: knee, type: revolute, axis: [0, 1, 0], point: [0.3, 0, 0], lower: -1, upper: 1}
          - {name: ball, type: spherical, axis: [0, 0, 1], point: [0.1, 0, 0.5]}

``universal`` is two revolute joints, ``NAME_x`` and ``NAME_y``, about two ``axes``; ``spherical``
is three, the last, ``NAME_z``, about the axis given.  With a ``cone`` (rad) the first two turn no
further.
"""

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from robomech_ros._kernels.tolerances import LARGEST_LENGTH
from robomech_ros.errors import RobomechError, RobotDescriptionError
from robomech_ros.parallel.mechanism.limb import (
    Axis,
    Limb,
    chain_of_axes,
    checked_drive_limits,
    with_drive_limits,
)
from robomech_ros.parallel.mechanism.model import Mechanism
from robomech_ros.parallel.mechanism.parts import LinkBodies
from robomech_ros.parallel.rods import six_rods
from robomech_ros.robots import LinkFrame, SerialChain, chain_from_dh
from robomech_ros.robots.documents.guarded_yaml import check_keys
from robomech_ros.robots.documents.yaml_rows import (
    JOINT_TYPES,
    read_number,
    read_pose,
    read_range,
    read_rows,
    read_text,
)
from robomech_ros.typing import Array, ArrayLike

_HALF = 0.5 * math.pi
_LEAST_AXIS = 1e-6


def mechanism_from_limbs(
    limbs: object,
    *,
    platform: object = None,
    drive_limits: Mapping[str, ArrayLike] | None = None,
    parts: LinkBodies | None = None,
    name: str = "mechanism",
) -> Mechanism:
    """Make a mechanism from the limbs of a document, as the module describes them.

    The platform is the pose in which joints with an ``axis`` are all at zero, or the one to begin
    with.  Limits are those of all drives or of each, in the order of the limbs.
    """
    if not isinstance(limbs, list) or len(limbs) < 2:
        raise RobotDescriptionError("limbs", "expected a list of two limbs or more")
    T = read_pose(platform, "platform")
    made = [_limb(limb, f"limb {i + 1}", name, T, i) for i, limb in enumerate(limbs)]
    count = sum(len(limb.actuated) for limb in made)
    made = with_drive_limits(made, checked_drive_limits(drive_limits, count))
    at_zero = all("a" not in limb["joints"][0] for limb in limbs)
    homes = None if at_zero or T is None else T[None]
    mechanism = Mechanism(made, name=name, home_poses=homes, parts=parts)
    rods = six_rods(mechanism)
    return mechanism if rods is None else mechanism.with_direct(rods)


def _limb(given: object, where: str, robot: str, T: Array | None, i: int) -> Limb:
    limb = check_keys(given, where, ("name", "actuated", "joints"), ("base", "tool"))
    name = read_text(limb["name"], f"{where}: name")
    where = f"{where} ('{name}')"
    rows, cones = limb["joints"], list[tuple[str, float]]()
    if not isinstance(rows, list) or not rows or not all(isinstance(row, dict) for row in rows):
        raise RobotDescriptionError(f"{where}: joints", "expected a list of joints")
    tip = "platform" if i == 0 else f"{name}_end"
    if "a" in rows[0]:
        chain = _by_table(limb, name, robot, tip, where)
    else:
        for key in ("base", "tool"):
            if key in limb:
                raise RobotDescriptionError(f"{where}: {key}", "only with rows of a, b and alpha")
        if T is None:
            raise RobotDescriptionError(where, "joints with an axis need the pose 'platform'")
        axes = [
            axis for k, row in enumerate(rows) for axis in _axes(row, name, f"{where}: {k + 1}")
        ]
        chain = chain_of_axes(robot, axes, T, tip)
        cones = [(f"{name}_{row['name']}_x", float(row["cone"])) for row in rows if "cone" in row]
    drives = limb["actuated"]
    if not isinstance(drives, list) or not all(isinstance(drive, str) for drive in drives):
        raise RobotDescriptionError(f"{where}: actuated", "expected a list of names of joints")
    try:
        return Limb(chain, tuple(f"{name}_{drive}" for drive in drives), cones=cones)
    except RobomechError as error:
        raise RobotDescriptionError(f"{where}: actuated", str(error)) from None


def _by_table(limb: Mapping[str, Any], name: str, robot: str, tip: str, where: str) -> SerialChain:
    rows = read_rows(limb["joints"], where)
    try:
        chain = chain_from_dh(
            *([row[key] for row in rows] for key in ("a", "b", "alpha", "theta")),
            types=["P" if row["type"] == "prismatic" else "R" for row in rows],
            base=read_pose(limb.get("base"), f"{where}: base"),
            tool=read_pose(limb.get("tool"), f"{where}: tool"),
            limits={key: [row[key] for row in rows] for key in ("lower", "upper")},
            name=robot,
            joint_names=[f"{name}_{row['name']}" for row in rows],
            tip_link=tip,
            bodies=[row.get("body") for row in rows],
            drives=[row["drive"] for row in rows],
        )
    except RobomechError as error:
        raise RobotDescriptionError(where, str(error)) from None
    links = [chain.base, *(f"{joint}_link" for joint in chain.joint_names), tip]
    frames = tuple(
        LinkFrame(link, frame.joints, frame.offset, links[k - 1] if k else "")
        for k, (link, frame) in enumerate(zip(links, chain.frames, strict=True))
    )
    return replace(chain, frames=frames)


def _axes(row: Mapping[str, Any], limb: str, where: str) -> list[Axis]:
    """Read one joint: one axis, or two or three through a point."""
    kind = row.get("type")
    known = (*JOINT_TYPES, "universal", "spherical")
    if kind not in known:
        raise RobotDescriptionError(
            where, f"type is {str(kind)[:80]!r}, expected {', '.join(known)}"
        )
    needed = ("name", "type", "axes" if kind == "universal" else "axis", "point")
    more = ("cone",) if kind in known[3:] else ("lower", "upper")
    check_keys(row, where, needed, more)
    name = f"{limb}_{read_text(row['name'], f'{where}: name')}"
    point = _three(row["point"], f"{where}: point")
    if kind in JOINT_TYPES:
        limits = read_range(row, kind, where)
        axis = _direction(row["axis"], f"{where}: axis")
        return [Axis(name, f"{name}_link", axis, point, kind == "prismatic", limits)]
    if kind == "universal":
        pair = row["axes"]
        if not isinstance(pair, list) or len(pair) != 2:
            raise RobotDescriptionError(f"{where}: axes", "expected two directions")
        x, y = (_direction(axis, f"{where}: axes") for axis in pair)
        if abs(float(x @ y)) > _LEAST_AXIS:
            raise RobotDescriptionError(f"{where}: axes", "expected two at a right angle")
        turns = {"x": x, "y": y}
    else:
        z = _direction(row["axis"], f"{where}: axis")
        x = np.cross(z, np.eye(3)[int(np.argmin(np.abs(z)))])
        x /= np.linalg.norm(x)
        turns = {"x": x, "y": np.cross(z, x), "z": z}
    cone = read_number(row.get("cone", _HALF), "cone", where)
    if not 0.0 < cone <= _HALF:
        raise RobotDescriptionError(where, f"cone is {cone:g}, expected more than 0, up to pi / 2")
    wide = (-cone, cone) if "cone" in row else (-math.inf, math.inf)
    limits_of = {"x": wide, "y": (-cone, cone), "z": (-math.inf, math.inf)}
    return [
        Axis(f"{name}_{key}", f"{name}_{key}_link", axis, point, limits=limits_of[key])
        for key, axis in turns.items()
    ]


def _three(value: object, where: str) -> Array:
    if not isinstance(value, list) or len(value) != 3:
        raise RobotDescriptionError(where, "expected a list of three numbers")
    numbers = np.array([read_number(item, "entry", where) for item in value])
    if np.abs(numbers).max() > LARGEST_LENGTH:
        raise RobotDescriptionError(where, f"{value}, at most {LARGEST_LENGTH:g} is allowed")
    return numbers


def _direction(value: object, where: str) -> Array:
    axis = _three(value, where)
    length = float(np.linalg.norm(axis))
    if length < _LEAST_AXIS:
        raise RobotDescriptionError(where, f"{value}, expected a direction")
    return np.asarray(axis / length)
