"""Legged robots by name, by path or from a YAML document.

Joints are given by their axes in the trunk, where all joints of the leg are at zero, and so are
feet::

    kind: walking
    name: phantomx
    source: where the numbers come from
    trunk: base_link
    mass_centre: [0.0, 0.0, 0.0]
    legs:
      - name: LF
        foot: [0.3, 0.2, 0.0]
        home: [0.0, 0.2, -1.5]
        joints:
          - {name: coxa, axis: [0, 0, 1], point: [0.1, 0.1, 0], lower: -1, upper: 1, velocity: 6}

A joint may have an ``effort`` (N m) and the ``body`` that it moves, and the document a
``trunk_body``, as in Denavit-Hartenberg documents. Bodies are in the frame of the trunk with all
joints at zero::

    trunk_body: {mass: 4.8, com: [0, 0, 0], inertia: {ixx: 0.02, iyy: 0.04, izz: 0.04}}

or a document names a URDF beside it, in place of the joints; its masses give the mass centre::

    urdf: robot.urdf
    legs:
      - {name: LF, foot: LF_foot_link, home: [0.0, 0.2, -1.5]}
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from robomech_ros.errors import RobomechError, RobotDescriptionError
from robomech_ros.errors.formatting import counted
from robomech_ros.kinematics.forward_uncompiled import link_transforms
from robomech_ros.parallel.mechanism.limb import Axis
from robomech_ros.robots import Body, RobotDescription, SerialChain, load_description
from robomech_ros.robots.documents.guarded_yaml import check_keys
from robomech_ros.robots.documents.yaml_bodies import body_from_yaml
from robomech_ros.robots.documents.yaml_rows import (
    read_number,
    read_positive,
    read_range,
    read_text,
)
from robomech_ros.robots.robot_kinds import checked_document, names_of, source_of
from robomech_ros.spatial.poses import rigid_inverse
from robomech_ros.typing import Array
from robomech_ros.walking.pantograph import leg_of_axes
from robomech_ros.walking.robot import LeggedRobot

_LEAST_AXIS = 1e-6


def list_legged() -> tuple[str, ...]:
    """List the names of the legged robots in all folders, sorted.

    Examples
    --------
    >>> from robomech_ros.walking import list_legged
    >>> "phantomx" in list_legged()
    True
    """
    return names_of("walking")


def load_legged(name_or_path: str | os.PathLike[str]) -> LeggedRobot:
    """Load a legged robot.

    Parameters
    ----------
    name_or_path : str or path
        A name (see :func:`list_legged`), the path of a YAML file, or the text of one.

    Raises
    ------
    UnknownRobotError
        No robot of this name; the error lists those there are.
    RobotDescriptionError
        The document cannot be used: the message says where and why.

    Examples
    --------
    >>> from robomech_ros.walking import load_legged
    >>> load_legged("go1").leg_names
    ('FL', 'FR', 'RL', 'RR')
    """
    text, where = source_of("walking", name_or_path)
    optional = ("trunk", "mass_centre", "urdf", "trunk_body")
    document = checked_document("walking", text, where, ("legs",), optional)
    rows = document["legs"]
    if not isinstance(rows, list) or not rows:
        raise RobotDescriptionError(f"{where}: legs", "expected a list of legs")
    try:
        tree = None
        if "urdf" in document:
            path = Path(read_text(document["urdf"], f"{where}: urdf", longest=None))
            tree = load_description(Path(where).parent / path)
        legs, homes = _legs(document, rows, where, tree)
        given = document.get("mass_centre")
        centre = None if given is None else _numbers(given, f"{where}: mass_centre", 3)
        return LeggedRobot(
            legs,
            home=np.concatenate(homes),
            mass_centre=centre,
            name=document["name"],
            source=document["source"],
            tree=tree,
            trunk_body=_body(document, "trunk_body", where),
        )
    except RobotDescriptionError:
        raise
    except RobomechError as error:
        raise RobotDescriptionError(where, str(error)) from None


def _legs(
    document: Mapping[str, Any], rows: list[Any], where: str, tree: RobotDescription | None
) -> tuple[dict[str, SerialChain], list[Array]]:
    """Read the legs, which are those of a tree or have axes of their own, and their homes."""
    own = () if tree else ("joints",)
    trunk = "" if tree else read_text(document.get("trunk", "base_link"), f"{where}: trunk")
    legs, homes = dict[str, SerialChain](), []
    for i, row in enumerate(rows):
        place = f"{where}: leg {i + 1}"
        check_keys(row, place, ("name", "foot", "home", *own), ())
        name = read_text(row["name"], f"{place}: name")
        if name in legs:
            raise RobotDescriptionError(f"{place}: name", f"'{name}' is there twice")
        if tree:
            legs[name] = tree.chain(document.get("trunk"), read_text(row["foot"], place))
        else:
            legs[name] = _leg_of_axes(row, name, trunk, place)
        homes.append(_numbers(row["home"], f"{place}: home", 3))
    return legs, homes


def _leg_of_axes(row: Mapping[str, Any], name: str, trunk: str, place: str) -> SerialChain:
    joints = row["joints"]
    if not isinstance(joints, list) or len(joints) != 3:
        raise RobotDescriptionError(f"{place}: joints", "expected a list of three joints")
    axes = [_axis(joint, name, f"{place}: joint {k + 1}") for k, joint in enumerate(joints)]
    speeds = [
        read_positive(joint["velocity"], "velocity", f"{place}: joint {k + 1}")
        for k, joint in enumerate(joints)
    ]
    efforts = [
        read_positive(joint["effort"], "effort", f"{place}: joint {k + 1}")
        if "effort" in joint
        else np.nan
        for k, joint in enumerate(joints)
    ]
    given = [_body(joint, "body", f"{place}: joint {k + 1}") for k, joint in enumerate(joints)]
    chain = leg_of_axes(name, axes, _numbers(row["foot"], f"{place}: foot", 3), trunk)
    bodies = [
        body and body.expressed_in(rigid_inverse(T))
        for body, T in zip(given, link_transforms(chain, np.zeros(3)), strict=False)
    ]
    limits = np.array([speeds, efforts])
    return replace(chain, bodies=tuple(bodies), velocity=limits[0], effort=limits[1])


def _body(row: Mapping[str, Any], key: str, where: str) -> Body | None:
    return body_from_yaml(row[key], f"{where}: {key}") if key in row else None


def _axis(joint: object, leg: str, where: str) -> Axis:
    needed = ("name", "axis", "point", "lower", "upper", "velocity")
    row = check_keys(joint, where, needed, ("effort", "body"))
    name = f"{leg}_{read_text(row['name'], f'{where}: name')}"
    axis = _numbers(row["axis"], f"{where}: axis", 3)
    length = float(np.linalg.norm(axis))
    if length < _LEAST_AXIS:
        raise RobotDescriptionError(f"{where}: axis", f"{row['axis']}, expected a direction")
    point = _numbers(row["point"], f"{where}: point", 3)
    limits = read_range({key: row[key] for key in ("lower", "upper")}, "revolute", where)
    return Axis(name, f"{name}_link", axis / length, point, limits=limits)


def _numbers(value: object, where: str, count: int) -> Array:
    if not isinstance(value, list) or len(value) != count:
        raise RobotDescriptionError(where, f"expected a list of {counted(count, 'number')}")
    return np.array([read_number(item, "entry", where) for item in value])
