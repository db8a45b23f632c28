"""Shapes of collision objects, from messages to the library."""

from collections.abc import Callable
from typing import Any

import numpy as np
from geometry_msgs.msg import Pose, Quaternion
from shape_msgs.msg import SolidPrimitive

from robomech_ros.collision import Box, Cone, Cylinder, Mesh, Plane, Sphere
from robomech_ros.collision.meshes import check_triangles
from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.nodes.common.messages.pose_messages import matrix_from_pose, pose_from_matrix
from robomech_ros.typing import Array

# Shape of the library, and its pose (4, 4) in the object (m).
PlacedShape = tuple[Any, Array]

# Constructor of each primitive, and its number of sizes.
_PRIMITIVES: dict[int, tuple[Callable[..., Any], int]] = {
    SolidPrimitive.BOX: (Box, 3),
    SolidPrimitive.SPHERE: (Sphere, 1),
    SolidPrimitive.CYLINDER: (lambda height, radius: Cylinder(radius, height), 2),
    SolidPrimitive.CONE: (lambda height, radius: Cone(radius, height), 2),
}
_ZERO = Quaternion(x=0.0, y=0.0, z=0.0, w=0.0)


def shapes_of(message: Any) -> list[PlacedShape]:
    """Read the shapes of a CollisionObject, and write out the poses that it leaves out.

    Raises RobomechError: a size, pose, vertex or type is invalid; it is named.
    """
    result = []
    for kind, poses, read in KINDS:
        shapes, given = getattr(message, kind), getattr(message, poses)
        if len(given) > len(shapes):
            raise WrongSizeError(poses, len(given), f"at most {len(shapes)}, as {kind}")
        # As in MoveIt a shape without a pose is at the origin of its object.
        every = [*given, *(Pose() for _ in range(len(shapes) - len(given)))]
        setattr(message, poses, every)
        for i, (shape, pose) in enumerate(zip(shapes, every, strict=True)):
            result.append((read(shape, f"{kind}[{i}]"), pose_of(pose, f"{poses}[{i}]")))
    return result


def has_shapes(message: Any) -> bool:
    """Return whether a CollisionObject has a shape."""
    return any(getattr(message, kind) for kind, _, _ in KINDS)


def append_shapes(message: Any, more: Any, between: Array) -> None:
    """Append the shapes of another CollisionObject, which is at a pose (4, 4) in the first (m)."""
    for kind, poses, _ in KINDS:
        moved = [between @ pose_of(pose, poses) for pose in getattr(more, poses)]
        setattr(message, kind, [*getattr(message, kind), *getattr(more, kind)])
        setattr(message, poses, [*getattr(message, poses), *map(pose_from_matrix, moved)])


def pose_of(pose: Any, what: str) -> Array:
    """Read a pose, (4, 4) (m); as in MoveIt a quaternion of zeros is no rotation."""
    if pose.orientation == _ZERO:
        pose = Pose(position=pose.position)
    return matrix_from_pose(pose, what)


def _primitive(shape: Any, what: str) -> Any:
    if shape.type not in _PRIMITIVES:
        expected = "BOX (1), SPHERE (2), CYLINDER (3) or CONE (4)"
        raise BadValueError(f"{what}.type", shape.type, expected)
    make, count = _PRIMITIVES[shape.type]
    if len(shape.dimensions) != count:
        raise WrongSizeError(f"{what}.dimensions", len(shape.dimensions), count)
    return make(*shape.dimensions)


def _mesh(mesh: Any, what: str) -> Any:
    # Refuse a large mesh before copying it.
    check_triangles(what, len(mesh.triangles))
    vertices = np.array([(point.x, point.y, point.z) for point in mesh.vertices])
    faces = np.array([one.vertex_indices for one in mesh.triangles], dtype=np.int64)
    return Mesh(vertices.reshape(-1, 3), faces.reshape(-1, 3))


def _plane(plane: Any, what: str) -> Any:
    *normal, constant = plane.coef
    return Plane(np.array(normal), -constant)


# Field of shapes, field of their poses, and reader of such a shape.
KINDS = (
    ("primitives", "primitive_poses", _primitive),
    ("meshes", "mesh_poses", _mesh),
    ("planes", "plane_poses", _plane),
)
