"""The drawn robot: a tree of links with their bodies."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from robomech_ros._kernels.tolerances import LARGEST_LENGTH
from robomech_ros.errors import RobomechError
from robomech_ros.kinematics.joint_poses import JointPoses
from robomech_ros.robots import RobotDescription, urdf_from_description
from robomech_ros.robots.joint import Joint
from robomech_ros.robots.urdf.document import description_from_urdf
from robomech_ros.robots.urdf.mesh_files import MeshError, mesh_file
from robomech_ros.robots.urdf.shapes import COLOURS, Shape, generated_shapes
from robomech_ros.robots.urdf.visuals import Visual, read_visuals
from robomech_ros.rvs.model.bodies.mesh_files import read_mesh
from robomech_ros.rvs.model.bodies.solids import Solid, box, cylinder, sphere
from robomech_ros.typing import Array

Colour = tuple[float, float, float, float]

# Default colour of bodies, and size of the placeholder for a missing mesh (m).
PLAIN: Colour = (0.72, 0.74, 0.77, 1.0)
STAND_IN = 0.03
# Links nearer together than this are at one point (m).
POINT = 1e-9


class _ShapeError(RobomechError):
    """A box, cylinder or sphere has impossible sizes; the text names them."""

    def __init__(self, visual: Visual) -> None:
        sizes = " x ".join(f"{measure:g}" for measure in visual.measures)
        expected = f"positive sizes up to {LARGEST_LENGTH:g} m"
        super().__init__(f"a {visual.kind} of {sizes} m cannot be shown, expected {expected}")


@dataclass(frozen=True, eq=False)
class BodyVisual:
    """A body of a link."""

    link: str
    #: Pose in the link (m), shape (4, 4).
    pose: Array
    solid: Solid
    #: Red, green, blue and alpha from 0 to 1.
    colour: Colour


@dataclass(frozen=True, eq=False)
class VisualModel:
    """A robot and its drawn bodies."""

    #: Links and joints of the robot; every joint's axis is in the frame of its link.
    tree: RobotDescription
    #: Bodies, at least one for each rigid part.
    bodies: tuple[BodyVisual, ...]
    #: A sentence for each body that cannot be shown; a generated one stands for it.
    missing: tuple[str, ...]
    #: Generated drums, rods and bars of every part, by link.
    shapes: Mapping[str, list[Shape]]

    def joint_poses(self, positions: Mapping[str, float]) -> tuple[Array, Array]:
        """Compute the poses of the links that joints move in the links before them.

        - ``positions``: positions by joint (rad or m); joints that mimic others follow them.

        Returns positions (m), shape (k, 3), and unit quaternions, scalar last, shape (k, 4), in the
        order of :attr:`moving`.
        """
        at = self.tree.joint_positions(positions)
        return self._poses.at(np.array([at[joint.name] for joint in self.moving]))

    @cached_property
    def _poses(self) -> JointPoses:
        return JointPoses(self.moving)

    @cached_property
    def moving(self) -> tuple[Joint, ...]:
        """The joints that move."""
        return tuple(joint for joint in self.tree.joints if joint.moves)

    @property
    def reach(self) -> float:
        """Size of the robot at rest (m): how far its links are from the root, at least 0.1.

        If all links turn about one point: the distance of its bodies.
        """
        places = [T[:3, 3] for T in self.tree.link_poses().values()]
        size = max([0.0, *(float(np.linalg.norm(place)) for place in places)])
        if size < POINT:
            corners = (body.solid.vertices + body.pose[:3, 3] for body in self.bodies)
            size = max([0.0, *(float(np.linalg.norm(at, axis=1).max()) for at in corners)])
        return max(0.1, size)


def load_visual_model(description: RobotDescription) -> VisualModel:
    """Collect the drawn bodies of a robot; RobotDescriptionError for an invalid number."""
    document = urdf_from_description(description)
    tree = description_from_urdf(document, description.where)
    file = Path(description.where)
    folder = file.parent.resolve() if file.is_file() else None
    missing: list[str] = []
    bare: set[str] = set()
    bodies: list[BodyVisual] = []
    for visual in read_visuals(document, description.where):
        try:
            bodies += _bodies(visual, folder)
        except (MeshError, _ShapeError) as error:
            missing.append(f"{visual.link}: {error}; a generated body stands for it")
            bare.add(visual.link)
    everywhere = generated_shapes(tree.root, tree.joints, ())
    for link in sorted(bare - {body.link for body in bodies}):
        shapes = everywhere.get(link) or [Shape(np.eye(4), STAND_IN, 2.0 * STAND_IN, 0)]
        bodies += [_generated(link, shape) for shape in shapes]
    return VisualModel(tree, tuple(bodies), tuple(missing), everywhere)


def _bodies(visual: Visual, folder: Path | None) -> list[BodyVisual]:
    colour = visual.colour or PLAIN
    if visual.kind == "mesh":
        parts = read_mesh(mesh_file(visual.filename, folder), visual.filename)
        return [
            BodyVisual(
                visual.link,
                visual.pose,
                Solid(_scaled(part.solid.vertices, visual), part.solid.faces),
                visual.colour or part.colour or PLAIN,
            )
            for part in parts
        ]
    if not all(0.0 <= measure <= LARGEST_LENGTH for measure in visual.measures):
        raise _ShapeError(visual)
    makers: dict[str, Callable[..., Solid]] = {"box": box, "cylinder": cylinder, "sphere": sphere}
    solid = makers[visual.kind](*visual.measures)
    # A flat body is visible, one without any width is not.
    if np.count_nonzero(np.ptp(solid.vertices, axis=0)) < 2:
        raise _ShapeError(visual)
    return [BodyVisual(visual.link, visual.pose, solid, colour)]


def _scaled(vertices: Array, visual: Visual) -> Array:
    with np.errstate(over="ignore"):
        scaled: Array = vertices * visual.measures
    if not np.abs(scaled).max() <= LARGEST_LENGTH:
        size, most = f"{np.abs(scaled).max():g}", f"{LARGEST_LENGTH:g}"
        raise MeshError(visual.filename, f"reaches {size} m from its origin, at most {most} m")
    return scaled


def _generated(link: str, shape: Shape) -> BodyVisual:
    width = 2.0 * shape.radius
    if shape.box:
        solid = box(width, width, shape.length)
    else:
        solid = cylinder(shape.radius, shape.length)
    return BodyVisual(link, shape.pose, solid, COLOURS[shape.colour])
