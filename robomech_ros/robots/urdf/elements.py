"""Elements of a URDF, written from the model."""

import math
from collections.abc import Iterable, Mapping
from xml.sax.saxutils import quoteattr

import numpy as np

from robomech_ros.robots.bodies import Body
from robomech_ros.robots.drives import DRIVE_KEYS, Drive
from robomech_ros.robots.joint import Joint
from robomech_ros.robots.limit_arrays import LARGEST_ANGLE
from robomech_ros.robots.urdf.joints import DRIVE_TAG
from robomech_ros.robots.urdf.shapes import Shape
from robomech_ros.typing import Array

_INDENT = "  "


def element(tag: str, attributes: Mapping[str, object], children: Iterable[str] = ()) -> str:
    """Write an element; numbers so that they are read back to the last bit."""
    inside = "".join(f" {key}={quoteattr(_text(value))}" for key, value in attributes.items())
    lines = [line for child in children for line in child.split("\n")]
    if not lines:
        return f"<{tag}{inside}/>"
    return "\n".join([f"<{tag}{inside}>", *(_INDENT + line for line in lines), f"</{tag}>"])


def _text(value: object) -> str:
    if isinstance(value, str):
        return value
    numbers = np.atleast_1d(np.asarray(value, dtype=np.float64)) + 0.0
    return " ".join(f"{number!r}" for number in numbers.tolist())


def _origin(pose: Array) -> str:
    from robomech_ros.spatial import roll_pitch_yaw_from_matrix

    return element("origin", {"xyz": pose[:3, 3], "rpy": roll_pitch_yaw_from_matrix(pose[:3, :3])})


def visual_elements(shapes: Iterable[Shape]) -> list[str]:
    """Write the visual elements of a link."""
    written = []
    for shape in shapes:
        measures: dict[str, object] = {"radius": shape.radius, "length": shape.length}
        if shape.box:
            measures = {"size": (2.0 * shape.radius, 2.0 * shape.radius, shape.length)}
        kind = "box" if shape.box else "cylinder"
        if shape.length == 0.0:
            kind, measures = "sphere", {"radius": shape.radius}
        body = element(kind, measures)
        colour = element("color", {"rgba": shape.rgba})
        material = element("material", {"name": f"robomech_{shape.colour}"}, [colour])
        parts = [_origin(shape.pose), element("geometry", {}, [body]), material]
        written.append(element("visual", {}, parts))
    return written


def inertial_element(body: Body) -> str:
    """Write the inertial element of a link."""
    place = np.eye(4)
    place[:3, 3] = body.com
    rows, columns = np.triu_indices(3)
    moments: dict[str, object] = {
        f"i{'xyz'[row]}{'xyz'[column]}": body.inertia[row, column]
        for row, column in zip(rows, columns, strict=True)
    }
    if body.as_measured:
        moments["as_measured"] = "true"
    mass = element("mass", {"value": body.mass})
    return element("inertial", {}, [_origin(place), mass, element("inertia", moments)])


def joint_element(joint: Joint) -> str:
    """Write a joint, its child's frame being that of the joint."""
    children = [
        element("parent", {"link": joint.parent}),
        element("child", {"link": joint.child}),
        _origin(joint.origin),
    ]
    if joint.moves:
        children += [element("axis", {"xyz": joint.axis}), _limit(joint)]
        drive = joint.drive
        if drive.viscous or drive.coulomb:
            friction = {"damping": drive.viscous, "friction": drive.coulomb}
            children.append(element("dynamics", friction))
        if drive != Drive(drive.viscous, drive.coulomb):
            children.append(drive_element(drive))
    if joint.mimic is not None:
        follows = {"joint": joint.mimic, "multiplier": joint.multiplier, "offset": joint.offset}
        children.append(element("mimic", follows))
    return element("joint", {"name": joint.name, "type": joint.type}, children)


def drive_element(drive: Drive) -> str:
    """Write what <dynamics> has no attributes for."""
    return element(DRIVE_TAG, {key: getattr(drive, key) for key in DRIVE_KEYS})


def _limit(joint: Joint) -> str:
    limits: dict[str, object] = {}
    if joint.type != "continuous":
        # As exporters write none.
        limits["lower"] = max(joint.lower, -10.0 * LARGEST_ANGLE)
        limits["upper"] = min(joint.upper, 10.0 * LARGEST_ANGLE)
    for key in ("effort", "velocity"):
        value = getattr(joint, key)
        limits[key] = 0.0 if math.isnan(value) else value
    for key in ("acceleration", "jerk"):
        value = getattr(joint, key)
        if not math.isnan(value):
            limits[key] = value
    return element("limit", limits)


def new_name(name: str, taken: set[str]) -> str:
    """Take a name, with ``_`` behind it where it is taken."""
    while name in taken:
        name += "_"
    taken.add(name)
    return name
