"""The tree of a robot in space, with joints that place its base and a captured body."""

import numpy as np

from robomech_ros.robots import Body, RobotDescription
from robomech_ros.robots.joint import Joint
from robomech_ros.robots.urdf.elements import element, joint_element
from robomech_ros.rvs.model.walking.placed_tree import (
    GROUND,
    INVISIBLE,
    extended_tree,
    placing_parts,
    visual,
)
from robomech_ros.spatial import roll_pitch_yaw_from_matrix
from robomech_ros.spatial.poses import assembled
from robomech_ros.typing import Array

CRAFT, CAPTURED = "craft", "captured"
_X, _Y, _Z = np.eye(3)
_PLACE = (
    *(("x", True, _X), ("y", True, _Y), ("z", True, _Z)),
    *(("yaw", False, _Z), ("pitch", False, _Y), ("roll", False, _X)),
)
_COLOURS = {CRAFT: (0.75, 0.77, 0.8, 1.0), CAPTURED: (0.83, 0.62, 0.2, 1.0)}


def floating_tree(robot: RobotDescription, base: Body, captured: Body) -> RobotDescription:
    """Describe a robot and a body that float freely, each drawn as the box with its inertia.

    Parameters
    ----------
    robot : RobotDescription
    base : Body
        Body of the robot's base, in the frame of its root.
    captured : Body
        Captured body, in its own frame.

    Raises
    ------
    RobotDescriptionError
        A link or joint of the robot has the name of an added one.
    """
    parts = [element("link", {"name": GROUND}, [INVISIBLE])]
    parts += _free(CRAFT, base, robot.root)
    parts += _free(CAPTURED, captured)
    return extended_tree(robot, parts)


def free_joints(name: str, poses: Array) -> dict[str, Array]:
    """Return the joints (m,) that place a free body at poses (m, 4, 4) (m)."""
    roll, pitch, yaw = np.unwrap(roll_pitch_yaw_from_matrix(poses[:, :3, :3]), axis=0).T
    columns = (*poses[:, :3, 3].T, yaw, pitch, roll)
    return {f"{name}_{axis}": row for (axis, *_), row in zip(_PLACE, columns, strict=True)}


def _free(name: str, body: Body, carried: str = "") -> list[str]:
    """Write the joints that place a body, its box, and a link that it carries."""
    joints = [(f"{name}_{axis}", slides, direction) for axis, slides, direction in _PLACE]
    parts = placing_parts(joints, GROUND)
    above = f"{name}_{_PLACE[-1][0]}_link"
    moments, axes = np.linalg.eigh(body.inertia)
    axes[:, 2] *= np.linalg.det(axes)
    size = np.sqrt(np.maximum(6.0 / body.mass * (moments.sum() - 2.0 * moments), 1e-6))
    box = visual("box", {"size": size}, _COLOURS[name])
    parts.append(element("link", {"name": f"{name}_body"}, [box]))
    parts.append(
        joint_element(
            Joint(f"{name}_body_joint", "fixed", above, f"{name}_body", assembled(axes, body.com))
        )
    )
    if carried:
        parts.append(joint_element(Joint(f"{name}_{carried}", "fixed", above, carried, np.eye(4))))
    return parts
