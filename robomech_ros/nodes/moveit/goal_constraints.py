"""Goal constraints of motion requests, as clients of MoveIt make them."""

from collections.abc import Iterable, Sequence

from geometry_msgs.msg import Pose
from moveit_msgs.msg import (
    BoundingVolume,
    Constraints,
    JointConstraint,
    OrientationConstraint,
    PositionConstraint,
)
from shape_msgs.msg import SolidPrimitive

from robomech_ros.nodes.common.messages.pose_messages import pose_from_matrix
from robomech_ros.typing import Array


def joint_goal(names: Sequence[str], q: Iterable[float], tolerance: float) -> Constraints:
    """Make a goal at joint positions q (n,), within a tolerance of each joint (rad or m)."""
    return Constraints(
        joint_constraints=[
            JointConstraint(
                joint_name=name,
                position=float(value),
                tolerance_above=tolerance,
                tolerance_below=tolerance,
                weight=1.0,
            )
            for name, value in zip(names, q, strict=True)
        ]
    )


def pose_goal(T: Array, link: str, tolerance: float, frame: str) -> Constraints:
    """Make a goal at a pose T (4, 4) of a link in a frame (m), within a tolerance (m and rad)."""
    pose = pose_from_matrix(T)
    ball = SolidPrimitive(type=SolidPrimitive.SPHERE, dimensions=[tolerance])
    region = BoundingVolume(primitives=[ball], primitive_poses=[Pose(position=pose.position)])
    position = PositionConstraint(link_name=link, constraint_region=region, weight=1.0)
    turn = OrientationConstraint(link_name=link, orientation=pose.orientation, weight=1.0)
    for axis in "xyz":
        setattr(turn, f"absolute_{axis}_axis_tolerance", tolerance)
    position.header.frame_id = turn.header.frame_id = frame
    return Constraints(position_constraints=[position], orientation_constraints=[turn])
