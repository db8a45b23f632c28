"""The constraints of a MoveIt request, as conditions on the positions of all joints."""

import math
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

import numpy as np
from geometry_msgs.msg import Pose
from moveit_msgs.msg import MoveItErrorCodes, OrientationConstraint
from shape_msgs.msg import SolidPrimitive

from robomech_ros.errors import BadValueError, UnknownJointError, WrongSizeError
from robomech_ros.nodes.common.messages.message_fields import finite_number, not_negative
from robomech_ros.nodes.common.messages.pose_messages import matrix_from_pose, point_vector
from robomech_ros.nodes.frames.robot_frames import FrameAttachment
from robomech_ros.nodes.moveit.serving import RejectedError
from robomech_ros.nodes.moveit.whole_robot import Positions, WholeRobot
from robomech_ros.spatial import (
    inverse_pose,
    roll_pitch_yaw_from_matrix,
    rotation_vector_from_matrix,
)
from robomech_ros.typing import Array

# Says of the positions of all joints what is wrong with them; "" where nothing is.
_Condition = Callable[[Positions], str]
_Places = Mapping[str, FrameAttachment]

# Solutions are exact to about this, rad and m; an equality must not fail by it.
_ROUNDING = 1e-9
_SIZES = {SolidPrimitive.BOX: 3, SolidPrimitive.SPHERE: 1, SolidPrimitive.CYLINDER: 2}
_TURNS = (OrientationConstraint.XYZ_EULER_ANGLES, OrientationConstraint.ROTATION_VECTOR)


class Conditions:
    """Constraints of a request, to be checked on an answer.

    - ``constraints``: the Constraints message of a request.
    - ``places``: poses of the frames that `frames_of` lists.
    - ``what``: name of the constraints in the request.

    Raises RejectedError: this node cannot judge a constraint. RobomechError: a joint or link is not
    part of the robot, or a number is invalid.
    """

    def __init__(
        self, constraints: Any, robot: WholeRobot, places: _Places, what: str = "constraints"
    ) -> None:
        if constraints.visibility_constraints:
            raise RejectedError(
                MoveItErrorCodes.INVALID_GOAL_CONSTRAINTS,
                f"{what}.visibility_constraints has {len(constraints.visibility_constraints)} "
                "entries, expected none: this node knows no shapes that could be in the way",
            )
        turning = _turning(constraints)
        joints = [one.joint_name for one in constraints.joint_constraints]
        for one in turning:
            joints += robot.joints_to(one.link_name)
            joints += places[one.header.frame_id].joint_names
        #: The joints whose positions the conditions are about.
        self.joints = tuple(dict.fromkeys(joints))
        self._all: list[_Condition] = []
        for kind, make in (
            ("joint", _of_joint),
            ("position", _of_position),
            ("orientation", _of_turn),
        ):
            for i, message in enumerate(getattr(constraints, f"{kind}_constraints")):
                one = f"{what}.{kind}_constraints[{i}]"
                finite_number(f"{one}.weight", message.weight)
                self._all.append(make(one, message, robot, places))

    def __bool__(self) -> bool:
        return bool(self._all)

    def broken(self, positions: Positions) -> str:
        """Say which condition the positions (rad or m) of all joints break; "" for none."""
        return next((text for one in self._all if (text := one(positions))), "")


def frames_of(constraints: Any) -> list[str]:
    """List the frames that the constraints of a request name."""
    return [one.header.frame_id for one in _turning(constraints)]


def _turning(constraints: Any) -> tuple[Any, ...]:
    """Return the constraints on poses of links."""
    return (*constraints.position_constraints, *constraints.orientation_constraints)


def _of_joint(what: str, message: Any, robot: WholeRobot, places: _Places) -> _Condition:
    name = message.joint_name
    if name not in robot.joint_names:
        raise UnknownJointError(name, robot.joint_names)
    wanted = finite_number(f"{what}.position", message.position)
    above = _tolerance(f"{what}.tolerance_above", message.tolerance_above)
    below = _tolerance(f"{what}.tolerance_below", message.tolerance_below)

    def judge(positions: Positions) -> str:
        apart = positions[name] - wanted
        if name in robot.continuous:
            apart = math.remainder(apart, 2.0 * math.pi)
        if -below - _ROUNDING <= apart <= above + _ROUNDING:
            return ""
        unit = robot.model.units[name]
        return f"{what}: joint '{name}' would be at {positions[name]:.6g} {unit}"

    return judge


def _of_position(what: str, message: Any, robot: WholeRobot, places: _Places) -> _Condition:
    offset = np.append(point_vector(message.target_point_offset, f"{what}.target_point_offset"), 1)
    frame, region = places[message.header.frame_id], message.constraint_region
    if region.meshes:
        raise BadValueError(f"{what}.constraint_region.meshes", len(region.meshes), "no meshes")
    shapes, poses = region.primitives, region.primitive_poses
    if not shapes or len(poses) != len(shapes):
        expected = f"{max(len(shapes), 1)}, one for every one of primitives, of which one is needed"
        raise WrongSizeError(f"{what}.constraint_region.primitive_poses", len(poses), expected)
    inside = [
        partial(_inside, *_shape(f"{what}.constraint_region.primitives[{k}]", shape, pose))
        for k, (shape, pose) in enumerate(zip(shapes, poses, strict=True))
    ]

    def judge(positions: Positions) -> str:
        point = _seen_from(frame, robot.pose(message.link_name, positions), positions) @ offset
        if any(one(point) for one in inside):
            return ""
        place = ", ".join(f"{number:.6g}" for number in point[:3])
        return f"{what}: the point on '{message.link_name}' would be at ({place}) m"

    return judge


def _seen_from(frame: FrameAttachment, T: Array, positions: Positions) -> Array:
    """Return a pose (4, 4) in the base as seen from a frame."""
    return np.asarray(inverse_pose(frame.pose(positions)) @ T)


def _shape(what: str, shape: Any, pose: Any) -> tuple[int, list[float], Array]:
    """Read a primitive: its type, its sizes (m), and the frame of the region in its own."""
    if shape.type not in _SIZES:
        raise BadValueError(f"{what}.type", shape.type, "BOX (1), SPHERE (2) or CYLINDER (3)")
    sizes = [_tolerance(f"{what}.dimensions", size) for size in shape.dimensions]
    if len(sizes) != _SIZES[shape.type]:
        raise WrongSizeError(f"{what}.dimensions", len(sizes), _SIZES[shape.type])
    return shape.type, sizes, inverse_pose(matrix_from_pose(pose, f"{what}: its pose"))


def _inside(kind: int, sizes: list[float], to_shape: Array, point: Array) -> bool:
    """Return whether a point, homogeneous, shape (4,) (m), is inside a primitive."""
    own = to_shape @ point
    if kind == SolidPrimitive.SPHERE:
        return bool(np.linalg.norm(own[:3]) <= sizes[0] + _ROUNDING)
    if kind == SolidPrimitive.BOX:
        return bool((np.abs(own[:3]) <= 0.5 * np.array(sizes) + _ROUNDING).all())
    height, radius = sizes
    across = math.hypot(own[0], own[1])
    return bool(abs(own[2]) <= 0.5 * height + _ROUNDING and across <= radius + _ROUNDING)


def _of_turn(what: str, message: Any, robot: WholeRobot, places: _Places) -> _Condition:
    link, kind = message.link_name, message.parameterization
    frame = places[message.header.frame_id]
    if kind not in _TURNS:
        expected = "XYZ_EULER_ANGLES (0) or ROTATION_VECTOR (1)"
        raise BadValueError(f"{what}.parameterization", kind, expected)
    wanted = matrix_from_pose(Pose(orientation=message.orientation), what)[:3, :3]
    names = [f"absolute_{axis}_axis_tolerance" for axis in "xyz"]
    most = np.array([_tolerance(f"{what}.{name}", getattr(message, name)) for name in names])

    def judge(positions: Positions) -> str:
        reached = _seen_from(frame, robot.pose(link, positions), positions)[:3, :3]
        apart = wanted.T @ reached
        if kind == OrientationConstraint.ROTATION_VECTOR:
            turned = wanted @ rotation_vector_from_matrix(apart)
        else:
            # Angles about x, y and z one after another: roll, pitch and yaw of the inverse, less.
            turned = -roll_pitch_yaw_from_matrix(apart.T)
        if (np.abs(turned) <= most + _ROUNDING).all():
            return ""
        angles = ", ".join(f"{angle:.6g}" for angle in turned)
        return f"{what}: link '{link}' would be turned by ({angles}) rad"

    return judge


def _tolerance(what: str, value: float) -> float:
    return not_negative(what, value, "a number that is not negative")
