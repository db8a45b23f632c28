"""Messages that the view reads, as what is shown, and those that it sends."""

from collections.abc import Mapping, Sequence

import numpy as np
from geometry_msgs.msg import TwistStamped
from sensor_msgs.msg import JointState
from std_msgs.msg import Header
from trajectory_msgs.msg import JointTrajectory
from visualization_msgs.msg import Marker

from robomech_interfaces.msg import ServoStatus
from robomech_ros.errors import BadValueError, NonFiniteError
from robomech_ros.execution.received_trajectory import read_waypoints
from robomech_ros.nodes.common.messages.joint_messages import received_trajectory
from robomech_ros.nodes.common.messages.pose_messages import matrix_from_pose
from robomech_ros.nodes.common.robot.robot_description import RobotModel
from robomech_ros.robots import PRISMATIC, SerialChain
from robomech_ros.rvs import Motion
from robomech_ros.rvs.model.running.jog import JogDirection
from robomech_ros.rvs.model.running.live_robot import ServoState, ViewMarker
from robomech_ros.typing import Array

# Most points of a plan, and of a marker; more would delay the page.
_MOST_POINTS = 100_000
_LONGEST = 1e6
# Coordinates and sizes of markers (m), which browsers draw in single precision.
_FARTHEST = 1e6
_KINDS = {
    Marker.ARROW: "arrow",
    Marker.CUBE: "box",
    Marker.SPHERE: "sphere",
    Marker.CYLINDER: "cylinder",
    Marker.LINE_STRIP: "lines",
    Marker.LINE_LIST: "lines",
    Marker.TEXT_VIEW_FACING: "text",
}
# Longest text of a marker; more would cover the page.
_LONGEST_TEXT = 200
# States without a command are no limits.
_SILENT = (ServoStatus.NO_WARNING, ServoStatus.STALE_COMMAND)


def motion_from_trajectory(
    model: RobotModel, trajectory: JointTrajectory, start: Mapping[str, float]
) -> Motion:
    """Read a planned trajectory.

    - ``start``: known positions (rad or m) from which the joints of a parallel robot follow its
      drives; unknown ones begin at home.

    Raises RobomechError: the trajectory does not fit the joints of the robot.
    """
    given = read_waypoints(
        received_trajectory(trajectory), model.commanded.joint_names, _MOST_POINTS, _LONGEST
    )
    qd, qdd = (
        None if rows is None or not np.isfinite(rows).all() else rows
        for rows in (given.velocities, given.accelerations)
    )
    mechanism = model.mechanism
    if mechanism is None:
        return Motion(model.chain, given.times, given.positions, qd=qd, qdd=qdd)
    from robomech_ros.rvs.model.motions.drive_motions import followed_motion

    home = zip(mechanism.joint_names, mechanism.home().tolist(), strict=True)
    q = np.array([start.get(name, at) for name, at in home])
    return followed_motion(mechanism, given.times, given.positions, qd, qdd, q)


def servo_state(status: ServoStatus) -> ServoState:
    """Read the limits on the motion from a status message."""
    return ServoState("" if status.code in _SILENT else status.message, float(status.scale))


def joint_jog(
    chain: SerialChain, direction: JogDirection, turning: float, sliding: float
) -> JointState:
    """Make the command that moves one joint.

    - ``direction``: the joint, and the sign of its motion.
    - ``turning``, ``sliding``: speeds (rad/s, m/s).
    """
    speed = direction.sign * (sliding if chain.types[direction.index] == PRISMATIC else turning)
    return JointState(name=[chain.joint_names[direction.index]], velocity=[speed])


def twist_jog(frame: str, direction: JogDirection, linear: float, angular: float) -> TwistStamped:
    """Make the command that moves the tip along or about an axis of a frame.

    - ``direction``: axis of the motion of the tip, and its sign.
    - ``linear``, ``angular``: speeds (m/s, rad/s).
    """
    message = TwistStamped(header=Header(frame_id=frame))
    speed = linear if direction.kind == "linear" else angular
    part = getattr(message.twist, direction.kind)
    setattr(part, "xyz"[direction.index], direction.sign * speed)
    return message


def read_marker(model: RobotModel, marker: Marker) -> ViewMarker:
    """Read a marker that is to be drawn.

    Raises BadValueError: the marker is of an unsupported type, in a frame that the robot does not
    have, or farther away or larger than 1e6 m. NonFiniteError: one of its numbers is NaN or
    infinite. BadQuaternionError: its quaternion is zero or far from unit length.
    """
    kind = _KINDS.get(marker.type)
    if kind is None:
        expected = "an arrow, a cube, a sphere, a cylinder, lines or a text"
        raise BadValueError("type of the marker", marker.type, expected)
    link = model.link_of(marker.header.frame_id or model.base_frame)
    if link not in model.description.links:
        raise BadValueError("frame of the marker", marker.header.frame_id, "one of the robot's")
    points = _points(marker, kind)
    size, colour = marker.scale, marker.color
    measures = (float(size.x), float(size.y), float(size.z))
    if kind == "arrow" and not len(marker.points):
        # Along x, so long as x says.
        points = np.array([[0.0, 0.0, 0.0], [measures[0], 0.0, 0.0]])
        measures = (measures[1], 2.0 * measures[1], 0.25 * measures[0])
    numbers = [*measures, colour.r, colour.g, colour.b, colour.a, *points.ravel().tolist()]
    if not np.isfinite(numbers).all():
        raise NonFiniteError("marker", numbers)
    pose = matrix_from_pose(marker.pose)
    farthest = max(map(abs, (*measures, *points.ravel().tolist(), *pose[:3, 3].tolist())))
    if farthest > _FARTHEST:
        raise BadValueError("marker", farthest, f"coordinates and sizes up to {_FARTHEST:g} m")
    shade = tuple(np.clip((colour.r, colour.g, colour.b, colour.a), 0.0, 1.0).tolist())
    text = marker.text[:_LONGEST_TEXT] if kind == "text" else ""
    return ViewMarker(f"{marker.ns}/{marker.id}", link, kind, pose, measures, points, shade, text)


def _points(marker: Marker, kind: str) -> Array:
    """Return the ends of an arrow, or pairs of ends of lines, shape (m, 3)."""
    if len(marker.points) > _MOST_POINTS:
        raise BadValueError("points of the marker", len(marker.points), f"{_MOST_POINTS} at most")
    points: Sequence[object] = [(p.x, p.y, p.z) for p in marker.points]
    ends = np.array(points, dtype=np.float64).reshape(-1, 3)
    if kind == "arrow":
        return ends[:2] if len(ends) > 1 else np.empty((0, 3))
    if kind != "lines":
        return np.empty((0, 3))
    if marker.type == Marker.LINE_STRIP:
        return np.stack([ends[:-1], ends[1:]], axis=1).reshape(-1, 3)
    return ends[: len(ends) // 2 * 2]
