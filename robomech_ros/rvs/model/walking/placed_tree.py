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
from robomech_ros.spatial import roll_pitch_yaw_from_matrix
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
    c, s = np.cos(base[2]), np.sin(base[2])
    away = T[:3, 3] - (base[0], base[1], height)
    turn = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
    offset = [*(turn @ away).tolist(), *roll_pitch_yaw_from_matrix(turn @ T[:3, :3]).tolist()]
    return dict(zip((*BASE_JOINTS, *BODY_JOINTS), (*base.tolist(), *offset), strict=True))


def _parts(robot: RobotDescription, trunk: str, height: float) -> list[str]:
    """Write the joints that place the root, and their links."""
    # Links without bodies would get generated ones along their slides.
    nothing = visual("sphere", {"radius": 1e-4}, (0.0, 0.0, 0.0, 0.0))
    disc = visual("cylinder", {"radius": _DISC * height, "length": 1e-3}, _COLOUR)
    parts, above = [element("link", {"name": GROUND}, [disc])], GROUND
    for name, slides, axis in (*_PLACE, *_BODY):
        link = f"{name}_link"
        parts.append(element("link", {"name": link}, [nothing]))
        lift = height if name == _BODY[0][0] else 0.0
        origin = assembled(np.eye(3), np.array([0.0, 0.0, lift]))
        joint = Joint(name, "continuous", above, link, origin, axis)
        if slides:
            joint = replace(joint, type="prismatic", lower=-_FAR, upper=_FAR)
        parts.append(joint_element(joint))
        above = link
    origin = rigid_inverse(robot.link_poses()[trunk])
    parts.append(joint_element(Joint("body_trunk", "fixed", above, robot.root, origin)))
    return parts


def visual(
    shape: str, measures: dict[str, object], colour: tuple[float, float, float, float]
) -> str:
    """Write the visual element of a shape at the origin of its link."""
    material = element("material", {"name": ""}, [element("color", {"rgba": colour})])
    return element("visual", {}, [element("geometry", {}, [element(shape, measures)]), material])
