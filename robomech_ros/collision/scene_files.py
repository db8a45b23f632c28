"""Scenes in the layout of MoveIt's PlanningScene messages, from files or mappings."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from robomech_ros.collision.meshes import Mesh
from robomech_ros.collision.shapes import Box, Cone, Cylinder, Plane, Shape, Sphere
from robomech_ros.errors import BadValueError, RobomechError
from robomech_ros.robots.documents.guarded_yaml import LARGEST_YAML, parse_yaml
from robomech_ros.robots.documents.source_files import read_source
from robomech_ros.spatial import pose_from_position_quaternion
from robomech_ros.typing import Array

# Kinds of shape_msgs/SolidPrimitive, by number and name, and how many sizes each has.
_PRIMITIVES = {1: ("box", 3), 2: ("sphere", 1), 3: ("cylinder", 2), 4: ("cone", 2)}
_NUMBERS = {name: kind for kind, (name, _) in _PRIMITIVES.items()}


def load_scene(scene: Any, given: Mapping[str, Any] | str | os.PathLike[str]) -> None:
    """Add a scene of MoveIt; see `PlanningScene.load`."""
    folder = None
    if not isinstance(given, Mapping):
        if not isinstance(given, str | os.PathLike):
            raise BadValueError("scene", given, "a path, or a mapping as MoveIt's PlanningScene")
        path = Path(given).expanduser()
        folder = path.resolve().parent
        given = parse_yaml(read_source(path, LARGEST_YAML), str(path))
        if not isinstance(given, Mapping):
            raise BadValueError("scene", given, "a mapping as MoveIt's PlanningScene")
    for one in _entries(_section(given, "world"), "collision_objects"):
        name, link, shapes, pose = read_object(one, folder)
        scene.add(name, shapes, pose, frame=_frame(scene, link))
    state = _section(given, "robot_state")
    for one in _entries(state, "attached_collision_objects"):
        link = str(one.get("link_name", ""))
        name, frame, shapes, pose = read_object(_section(one, "object"), folder)
        scene.add(name, shapes, pose, frame=frame or link)
        scene.attach(name, link, one.get("touch_links") or ())
    allow_pairs(scene, _section(given, "allowed_collision_matrix"))


def read_object(
    given: Mapping[str, Any], folder: Path | None = None
) -> tuple[str, str, list[tuple[Shape, Array]], Array]:
    """Read a collision object: name, frame, its shapes with their poses, and its pose."""
    name = str(given.get("id", ""))
    frame = str(_section(given, "header").get("frame_id", ""))
    shapes: list[tuple[Shape, Array]] = []
    for kind, read in (("primitive", _primitive), ("mesh", _mesh), ("plane", _plane)):
        ones = _entries(given, {"mesh": "meshes"}.get(kind, kind + "s"))
        poses = _entries(given, f"{kind}_poses")
        for k, one in enumerate(ones):
            try:
                shapes.append(
                    (read(one, folder), read_pose(poses[k]) if k < len(poses) else np.eye(4))
                )
            except RobomechError as error:
                raise BadValueError(f"{kind} {k} of object '{name}'", "given", str(error)) from None
            except (TypeError, ValueError, KeyError, IndexError) as error:
                raise BadValueError(f"{kind} {k} of object '{name}'", one, str(error)) from None
    if not shapes:
        raise BadValueError(f"shapes of object '{name}'", "none", "primitives, meshes or planes")
    return name, frame, shapes, read_pose(_section(given, "pose"))


def read_pose(given: Mapping[str, Any]) -> Array:
    """Return a pose (4, 4) of a pose message as a mapping; what is missing is 0, or no rotation."""
    position, turn = _section(given, "position"), _section(given, "orientation")
    try:
        quaternion = [float(turn.get(key, 0.0)) for key in "xyzw"]
        origin = [float(position.get(key, 0.0)) for key in "xyz"]
    except (TypeError, ValueError):
        raise BadValueError("pose", dict(given), "numbers") from None
    if not any(quaternion):
        # The value of a message that nobody has filled.
        quaternion[3] = 1.0
    return pose_from_position_quaternion(origin, quaternion)


def allow_pairs(scene: Any, matrix: Mapping[str, Any]) -> None:
    """Allow the pairs of an allowed collision matrix to touch; others stay as they are."""
    names = [str(name) for name in _listed(matrix, "entry_names")]
    known = set(scene.bodies)
    for i, row in enumerate(_entries(matrix, "entry_values")):
        for j, allowed in enumerate(_listed(row, "enabled")):
            # A matrix may name bodies of another robot.
            if j < i < len(names) and allowed and {names[i], names[j]} <= known:
                scene.allow(names[i], names[j], "allowed by the scene")
    defaults = _listed(matrix, "default_entry_names"), _listed(matrix, "default_entry_values")
    for name, allowed in zip(map(str, defaults[0]), defaults[1], strict=False):
        if allowed and name in known:
            for other in scene.bodies:
                if other != name:
                    scene.allow(name, other, "allowed by the scene")


def _primitive(one: Mapping[str, Any], _: Path | None) -> Shape:
    kind = one["type"]
    number = _NUMBERS.get(kind, kind) if isinstance(kind, str) else kind
    if number not in _PRIMITIVES:
        raise BadValueError("type", kind, "1 box, 2 sphere, 3 cylinder or 4 cone")
    name, count = _PRIMITIVES[number]
    sizes = [float(size) for size in one["dimensions"]]
    if len(sizes) != count:
        raise BadValueError(f"number of dimensions of a {name}", len(sizes), str(count))
    if name == "box":
        return Box(*sizes)
    if name == "sphere":
        return Sphere(*sizes)
    return (Cylinder if name == "cylinder" else Cone)(radius=sizes[1], height=sizes[0])


def _mesh(one: Mapping[str, Any], folder: Path | None) -> Shape:
    if "resource" in one:
        path = Path(str(one["resource"]).removeprefix("file://"))
        return Mesh(path if folder is None else folder / path)
    vertices = [[float(point[key]) for key in "xyz"] for point in one["vertices"]]
    return Mesh(vertices, [list(face["vertex_indices"]) for face in one["triangles"]])


def _plane(one: Mapping[str, Any], _: Path | None) -> Shape:
    a, b, c, d = (float(number) for number in one["coef"])
    return Plane((a, b, c), -d)  # type: ignore[arg-type]


def _section(given: Mapping[str, Any], key: str) -> Mapping[str, Any]:
    found = given.get(key) or {}
    if not isinstance(found, Mapping):
        raise BadValueError(key, found, "a mapping")
    return found


def _listed(given: Mapping[str, Any], key: str) -> list[Any]:
    found = given.get(key) or []
    if not isinstance(found, list | tuple):
        raise BadValueError(key, found, "a list")
    return list(found)


def _entries(given: Mapping[str, Any], key: str) -> list[Mapping[str, Any]]:
    found = _listed(given, key)
    if not all(isinstance(one, Mapping) for one in found):
        raise BadValueError(key, found, "a list of mappings")
    return found


def _frame(scene: Any, name: str) -> str | None:
    """Return a frame as a link; the world and the base are the base."""
    return None if name.lstrip("/") in ("", "world", scene.chain.base) else name
