"""The tree of a walking machine, with joints that place its trunk over the ground."""

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from robomech_ros.robots import RobotDescription, urdf_from_description
from robomech_ros.robots.documents.guarded_xml import parse_xml
from robomech_ros.robots.joint import Joint
from robomech_ros.robots.urdf.document import description_from_urdf
from robomech_ros.robots.urdf.elements import element, joint_element
from robomech_ros.rolling.tree import BASE_JOINTS
from robomech_ros.spatial import matrix_from_axis_angle, roll_pitch_yaw_from_matrix
from robomech_ros.spatial.poses import assembled, rigid_inverse
from robomech_ros.typing import Array

# The root, and the joints of the trunk relative to its level pose, as on sliders.
GROUND = "odom"
BODY_JOINTS = ("body_x", "body_y", "body_z", "body_roll", "body_pitch", "body_yaw")

_X, _Y, _Z = np.eye(3)
# From the ground to the trunk: name, whether it slides, axis.
_PLACE = tuple(zip(BASE_JOINTS, (True, True, False), (_X, _Y, _Z), strict=True))
_BODY = (
    ("body_x", True, _X),
    ("body_y", True, _Y),
    ("body_z", True, _Z),
    ("body_yaw", False, _Z),
    ("body_pitch", False, _Y),
    ("body_roll", False, _X),
)
# Range of these joints (m).
_FAR = 1e4
# Disc at the start of a walk: radius in heights of the trunk, and colour.
_DISC, _COLOUR = 0.15, (0.93, 0.55, 0.14, 1.0)


def placed_tree(robot: RobotDescription, trunk: str, height: float) -> RobotDescription:
    """Describe a machine with joints for its position on the ground and its trunk pose.

    - ``robot``: its legs and its trunk.
    - ``trunk``: its link.
    - ``height``: height of the level trunk (m).

    Raises RobotDescriptionError: a link or joint of the machine has the name of one of these
    joints, or of the ground.
    """
    return extended_tree(robot, _parts(robot, trunk, height))


def extended_tree(robot: RobotDescription, parts: Iterable[str]) -> RobotDescription:
    """Add links and joints, as elements of a URDF, to the tree of a robot."""
    document = urdf_from_description(robot)
    data = document.encode()
    last = parse_xml(document, robot.where).last_byte
    added = "\n".join(parts).encode()
    text = b"".join([data[:last], added, b"\n", data[last:]]).decode()
    return replace(description_from_urdf(text, robot.where), source=robot.source, home=robot.home)


def placing(base: Array, T: Array, height: float) -> dict[str, float]:
    """Return the joints that place the trunk.

    - ``base``: x, y (m) and heading (rad) of the machine, shape (3,).
    - ``T``: pose of the trunk over the ground (m), shape (4, 4).
    - ``height``: height of the level trunk (m).
    """
    away = T[:3, 3] - (base[0], base[1], height)
    turn = matrix_from_axis_angle([0.0, 0.0, 1.0], -base[2])
    offset = [*(turn @ away).tolist(), *roll_pitch_yaw_from_matrix(turn @ T[:3, :3]).tolist()]
    return dict(zip((*BASE_JOINTS, *BODY_JOINTS), (*base.tolist(), *offset), strict=True))


def _parts(robot: RobotDescription, trunk: str, height: float) -> list[str]:
    """Write the joints that place the root, and their links."""
    disc = visual("cylinder", {"radius": _DISC * height, "length": 1e-3}, _COLOUR)
    lift = assembled(np.eye(3), np.array([0.0, 0.0, height]))
    place = placing_parts(_PLACE, GROUND)
    body = placing_parts(_BODY, f"{_PLACE[-1][0]}_link", lift)
    origin = rigid_inverse(robot.link_poses()[trunk])
    last = Joint("body_trunk", "fixed", f"{_BODY[-1][0]}_link", robot.root, origin)
    return [element("link", {"name": GROUND}, [disc]), *place, *body, joint_element(last)]


def placing_parts(
    joints: Iterable[tuple[str, bool, Array]], above: str, origin: Array | None = None
) -> list[str]:
    """Write joints that place what is below them, and the links that they move.

    - ``joints``: name, whether it slides, and axis; the link of each has its name and ``_link``.
    - ``above``: link before the first joint.
    - ``origin``: pose (4, 4) of the first joint in that link (m).
    """
    parts, pose = [], np.eye(4) if origin is None else origin
    for name, slides, axis in joints:
        link = f"{name}_link"
        joint = Joint(name, "continuous", above, link, pose, axis)
        if slides:
            joint = replace(joint, type="prismatic", lower=-_FAR, upper=_FAR)
        parts += [element("link", {"name": link}, [INVISIBLE]), joint_element(joint)]
        above, pose = link, np.eye(4)
    return parts


def visual(
    shape: str, measures: dict[str, object], colour: tuple[float, float, float, float]
) -> str:
    """Write the visual element of a shape at the origin of its link."""
    material = element("material", {"name": ""}, [element("color", {"rgba": colour})])
    return element("visual", {}, [element("geometry", {}, [element(shape, measures)]), material])


# Links without a body would get generated ones along their slides.
INVISIBLE = visual("sphere", {"radius": 1e-4}, (0.0, 0.0, 0.0, 0.0))
