"""Parallel robots by name, by path or from a YAML document.

A document says what the robot is, where its numbers come from, and the arguments of its class::

    kind: parallel
    name: hexapod
    source: where the numbers come from
    type: stewart_gough
    base_points: [[0.0, 0.5, 0.0], ...]
    platform_points: [[0.0, 0.2, 0.0], ...]
    strokes: [0.6, 0.9]
    bodies:
      platform: {mass: 12.0, com: [0.0, 0.0, 0.0], inertia: {ixx: 0.3, iyy: 0.3, izz: 0.5}}
      rod: {mass: 1.5, com: [-0.2, 0.0, 0.0], inertia: {ixx: 0.001, iyy: 0.03, izz: 0.03}}
    drive: {viscous: 50.0, coulomb: 5.0}

Bodies are those of :class:`LinkBodies`, with the keys that bodies of arms have.  Names are those of
files in the folder ``parallel`` of the folders of robots.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from inspect import signature
from typing import Any

from robomech_ros.errors import RobomechError, RobotDescriptionError
from robomech_ros.parallel.delta import Delta
from robomech_ros.parallel.limbs_document import mechanism_from_limbs
from robomech_ros.parallel.mechanism.model import Mechanism
from robomech_ros.parallel.mechanism.parts import LinkBodies
from robomech_ros.parallel.planar import Planar3RPR, Planar3RRR
from robomech_ros.parallel.spherical import Spherical3RRR
from robomech_ros.parallel.stewart_gough import StewartGough
from robomech_ros.robots.documents.guarded_yaml import check_choices, check_keys
from robomech_ros.robots.documents.yaml_bodies import body_from_yaml, drive_from_yaml
from robomech_ros.robots.robot_kinds import checked_document, source_of

ParallelRobot = StewartGough | Delta | Planar3RPR | Planar3RRR | Spherical3RRR
AnyParallelRobot = ParallelRobot | Mechanism

# Constructor of each type, from arguments of these names.
TYPES: dict[str, Callable[..., Any]] = {
    "stewart_gough": StewartGough,
    "delta": Delta,
    "planar_3rpr": Planar3RPR,
    "planar_3rrr": Planar3RRR,
    "spherical_3rrr": Spherical3RRR,
    "limbs": mechanism_from_limbs,
}
_HEAD = ("kind", "name", "source", "type")
_PARTS = ("bodies", "drive")


def _keys_of(make: Callable[..., Any]) -> tuple[list[str], list[str]]:
    """Return the keys that a type needs, and those it may have."""
    known = {k: v for k, v in signature(make).parameters.items() if k not in ("name", "parts")}
    needed = [key for key, value in known.items() if value.default is value.empty]
    return needed, [key for key in known if key not in needed]


_KEYS = sorted({key for make in TYPES.values() for keys in _keys_of(make) for key in keys})


def load_parallel(name_or_path: str | os.PathLike[str]) -> AnyParallelRobot:
    """Load a parallel robot.

    Parameters
    ----------
    name_or_path : str or path
        A name (see :func:`list_parallel`), the path of a YAML file, or the text of one.

    Returns
    -------
    StewartGough, Delta, Planar3RPR, Planar3RRR, Spherical3RRR, or Mechanism for limbs of any kind

    Raises
    ------
    UnknownRobotError
        No robot of this name; the error lists those there are.
    RobotDescriptionError
        The document cannot be used: the message says where and why.

    Examples
    --------
    >>> from robomech_ros.parallel import load_parallel
    >>> load_parallel("hexapod").family
    '3-6 planar'
    """
    return parallel_from_yaml(*source_of("parallel", name_or_path))


def parallel_from_yaml(text: str | bytes, where: str) -> AnyParallelRobot:
    """Make a parallel robot of the text of a document, called ``where`` in messages."""
    document = checked_document("parallel", text, where, ("type",), (*_PARTS, *_KEYS))
    check_choices(document, where, type=TYPES)
    make = TYPES[document["type"]]
    others = (*_HEAD, *_PARTS, "notes")
    geometry = {key: value for key, value in document.items() if key not in others}
    check_keys(geometry, where, *_keys_of(make))
    try:
        parts = _parts(document, where)
        if document["type"] == "limbs":
            return mechanism_from_limbs(**geometry, parts=parts, name=document["name"])
        robot: ParallelRobot = make(**geometry, name=document["name"])
        robot.parts = parts
    except RobomechError as error:
        raise RobotDescriptionError(where, str(error)) from None
    return robot


def _parts(document: Mapping[str, Any], where: str) -> LinkBodies:
    given, place = document.get("bodies", {}), f"{where}: bodies"
    if not isinstance(given, dict):
        raise RobotDescriptionError(place, "expected names of links with their bodies")
    bodies = {str(name): body_from_yaml(body, f"{place}: {name}") for name, body in given.items()}
    return LinkBodies(bodies, drive_from_yaml(document.get("drive", {}), f"{where}: drive"))
