"""Between ROS messages and the arrays of the core; the only place that knows both orders.

The core puts angular before linear components and names nothing but by position; ROS messages
are linear first and match joints by name.  Single poses are converted with plain numbers, since
NumPy's overhead on four of them would be a good part of a service's answer time.
"""

import math
from array import array
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from builtin_interfaces.msg import Duration
from geometry_msgs.msg import Point, Pose, PoseStamped
from numpy.typing import NDArray
from sensor_msgs.msg import JointState
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from robomech_ros._kernels.tolerances import QUATERNION_NORM
from robomech_ros.errors import (
    BadQuaternionError,
    BadValueError,
    NonFiniteError,
    UnknownJointError,
    WrongSizeError,
)
from robomech_ros.spatial.quaternions import matrix_from_quaternion

__all__ = [
    "TrajectoryPoints",
    "append_numbers",
    "duration_from_seconds",
    "floats",
    "joint_state",
    "joint_trajectory",
    "linear_rows_first",
    "matrices_from_pose_rows",
    "matrix_from_pose",
    "point_vector",
    "pose_from_matrix",
    "positions_by_name",
    "seconds_from_duration",
    "stamped_pose",
]

Array = NDArray[np.float64]

_NANO = 1_000_000_000
_POSE_NUMBERS = 7
# Point messages that are kept from one trajectory to the next, 1 kB each.
_POINTS_KEPT = 2000


def positions_by_name(
    state: JointState,
    joint_names: Sequence[str],
    what: str,
    others: Iterable[str] = (),
    field: str = "position",
) -> Array:
    """Read the positions of joints, or other numbers, from a joint state, matched by name.

    Parameters
    ----------
    state : JointState
        Positions in rad or m.  Without names they are in the order of `joint_names`.
    joint_names : sequence of str
        The joints wanted, n of them.
    what : str
        What the state is, for messages: ``"seed"``, ``"start"``.
    others : iterable of str, optional
        Further joints of the robot, which the state may contain and which are passed over.
    field : {"position", "velocity", "effort"}
        Which numbers.

    Returns
    -------
    ndarray, shape (n,)
        In the order of `joint_names`.

    Raises
    ------
    WrongSizeError
        As many names as positions are required, each name once, and no joint may be missing.
    UnknownJointError
        A name that is neither among the joints nor among the others.
    NonFiniteError
        A position that is not a finite number; the joint is named.
    """
    names, positions = state.name, getattr(state, field)
    if names:
        if len(names) != len(positions):
            expected = f"{len(names)}, one for every name"
            raise WrongSizeError(f"{what}.{field}", len(positions), expected)
        if list(names) != list(joint_names):
            positions = _matched(names, positions, joint_names, what, others)
    elif len(positions) != len(joint_names):
        expected = f"{len(joint_names)} for {', '.join(joint_names)}"
        raise WrongSizeError(f"{what}.{field}", len(positions), expected)
    for name, value in zip(joint_names, positions, strict=True):
        if not math.isfinite(value):
            number = what if field == "position" else f"{what}.{field}"
            raise NonFiniteError(f"{number} of joint '{name}'", value)
    return np.array(positions, dtype=np.float64)


def _matched(
    names: Sequence[str],
    positions: Sequence[float],
    joint_names: Sequence[str],
    what: str,
    others: Iterable[str],
) -> list[float]:
    by_name = dict(zip(names, positions, strict=True))
    if len(by_name) != len(names):
        twice = next(name for i, name in enumerate(names) if name in names[:i])
        raise WrongSizeError(f"{what}.name", len(names), f"every name once; '{twice}' is repeated")
    known = {*joint_names, *others}
    for name in names:
        if name not in known:
            raise UnknownJointError(name, joint_names)
    missing = [name for name in joint_names if name not in by_name]
    if missing:
        expected = f"all of {', '.join(joint_names)}; missing: {', '.join(missing)}"
        raise WrongSizeError(f"{what}.name", len(names), expected)
    return [by_name[name] for name in joint_names]


def floats(values: Array) -> "array[float]":
    """Copy an array into what the messages' float64[] fields take without conversion."""
    result = array("d")
    result.frombytes(values.tobytes())
    return result


def append_numbers(target: "array[Any]", values: NDArray[Any]) -> None:
    """Append the entries of an array, in its own order, to one of Python's arrays."""
    target.frombytes(values.astype(target.typecode).tobytes())


def joint_state(joint_names: Sequence[str], positions: Array) -> JointState:
    """Make a joint state with positions (rad or m) only."""
    return JointState(name=list(joint_names), position=floats(positions))


def matrix_from_pose(pose: Pose, what: str = "pose") -> Array:
    """Convert a pose message to a homogeneous transform.

    Parameters
    ----------
    pose : Pose
        Position in m; the quaternion's norm may differ from 1 by 1e-3 and is then made 1.
    what : str
        What the pose is, for messages.

    Returns
    -------
    ndarray, shape (4, 4)

    Raises
    ------
    NonFiniteError
        A number is NaN or infinite.
    BadQuaternionError
        The quaternion is zero or far from unit length.
    """
    p, o = pose.position, pose.orientation
    x, y, z, w = o.x, o.y, o.z, o.w
    if not math.isfinite(p.x + p.y + p.z):
        _refuse_non_finite(f"{what}.position", p, "xyz")
    norm = math.sqrt(x * x + y * y + z * z + w * w)
    if not abs(norm - 1.0) <= QUATERNION_NORM:
        _refuse_non_finite(f"{what}.orientation", o, "xyzw")
        reason = "all zero" if norm == 0.0 else f"its norm is {norm:.9g}"
        expected = f"expected norm 1 within {QUATERNION_NORM:g}"
        raise BadQuaternionError([x, y, z, w], f"{what}.orientation: {reason}, {expected}")
    x, y, z, w = x / norm, y / norm, z / norm, w / norm
    return np.array((
        (1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - z * w), 2.0 * (x * z + y * w), p.x),
        (2.0 * (x * y + z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - x * w), p.y),
        (2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y), p.z),
        (0.0, 0.0, 0.0, 1.0),
    ))  # fmt: skip


def _refuse_non_finite(what: str, vector: object, fields: str) -> None:
    for name in fields:
        value = getattr(vector, name)
        if not math.isfinite(value):
            raise NonFiniteError(f"{what}.{name}", value)
    # Finite numbers whose sum or norm overflows are as useless as infinite ones.
    if fields == "xyz":
        raise NonFiniteError(what, math.inf)


def pose_from_matrix(T: Array) -> Pose:
    """Convert a homogeneous transform, shape (4, 4), to a pose message, as :func:`fill_pose`."""
    message = Pose()
    fill_pose(message, T)
    return message


def fill_pose(message: Pose, T: Array) -> None:
    """Write a homogeneous transform, shape (4, 4), to a pose message.

    Of the two quaternions the one with w >= 0 is given, and with w = 0 the one whose first number
    that is not zero is positive.
    """
    (a, b, c, px), (d, e, f, py), (g, h, i, pz) = T[:3].tolist()
    # The largest of the four parameters is found first: no division by a small number.
    traces = (1.0 + a - e - i, 1.0 - a + e - i, 1.0 - a - e + i, 1.0 + a + e + i)
    largest = traces.index(max(traces))
    x, y, z, w = (
        (traces[0], b + d, c + g, h - f),
        (b + d, traces[1], f + h, c - g),
        (c + g, f + h, traces[2], d - b),
        (h - f, c - g, d - b, traces[3]),
    )[largest]
    norm = math.sqrt(x * x + y * y + z * z + w * w)
    if (w, x, y, z) < (0.0, 0.0, 0.0, 0.0):
        norm = -norm
    # Adding 0 turns -0 into 0: equal poses are equal bytes.
    position, orientation = message.position, message.orientation
    position.x, position.y, position.z = px, py, pz
    orientation.x, orientation.y = x / norm + 0.0, y / norm + 0.0
    orientation.z, orientation.w = z / norm + 0.0, w / norm + 0.0


def stamped_pose(T: Array, frame: str) -> PoseStamped:
    """Convert a homogeneous transform to a pose message in a frame; the stamp stays 0."""
    message = PoseStamped(pose=pose_from_matrix(T))
    message.header.frame_id = frame
    return message


def matrices_from_pose_rows(rows: Sequence[float], what: str = "poses") -> Array:
    """Convert rows of x y z qx qy qz qw to homogeneous transforms.

    Parameters
    ----------
    rows : sequence of float
        7 m numbers: position in m, unit quaternion within 1e-3.

    Returns
    -------
    ndarray, shape (m, 4, 4)

    Raises
    ------
    WrongSizeError
        Not a multiple of seven numbers.
    NonFiniteError, BadQuaternionError
        The row is named.
    """
    if len(rows) % _POSE_NUMBERS:
        raise WrongSizeError(what, len(rows), "a multiple of 7: x y z qx qy qz qw of every pose")
    table = np.array(rows, dtype=np.float64).reshape(-1, _POSE_NUMBERS)
    if not np.isfinite(table).all():
        raise NonFiniteError(what, table)
    T = np.zeros((len(table), 4, 4))
    T[:, :3, 3] = table[:, :3]
    T[:, :3, :3] = matrix_from_quaternion(table[:, 3:])
    T[:, 3, 3] = 1.0
    return T


def point_vector(point: Point, what: str) -> Array:
    """Convert a point message (m) to an array of shape (3,); it must be finite."""
    vector = np.array((point.x, point.y, point.z))
    if not np.isfinite(vector).all():
        raise NonFiniteError(what, vector)
    return vector


def linear_rows_first(J: Array) -> Array:
    """Reorder the rows of a Jacobian, shape (6, n), from angular first to linear first."""
    return np.concatenate((J[3:], J[:3]))


def seconds_from_duration(duration: Duration, what: str) -> float:
    """Convert a duration message to s.

    Raises
    ------
    BadValueError
        It is negative.
    """
    seconds = float(duration.sec + duration.nanosec / _NANO)
    if seconds < 0.0:
        raise BadValueError(what, seconds, "a duration that is not negative (s)")
    return seconds


def duration_from_seconds(seconds: float) -> Duration:
    """Convert s to a duration message, rounded to nanoseconds."""
    whole, nano = divmod(round(seconds * _NANO), _NANO)
    return Duration(sec=int(whole), nanosec=int(nano))


class TrajectoryPoints:
    """Trajectory points that are used again for one trajectory after the other.

    To make a point message takes longer than to fill it.  Who uses them must have sent one
    trajectory before the next is made: rclpy copies what it sends.
    """

    def __init__(self) -> None:
        self._points: list[JointTrajectoryPoint] = []

    def filled(
        self, times: Array, positions: Array, velocities: Array, accelerations: Array
    ) -> list[JointTrajectoryPoint]:
        """Give m points; times (m,) in s, the others (m, n) in rad or m, per s and s^2."""
        new = [JointTrajectoryPoint() for _ in range(len(times) - len(self._points))]
        points = self._points[: len(times)] + new
        self._points += new[: max(0, _POINTS_KEPT - len(self._points))]
        # A part of Python's array is copied faster than a row of numpy's.
        q, v, a = floats(positions), floats(velocities), floats(accelerations)
        whole, nano = np.divmod(np.rint(times * _NANO).astype(np.int64), _NANO)
        end, n = 0, positions.shape[1]
        for point, sec, nanosec in zip(points, whole.tolist(), nano.tolist(), strict=True):
            begin, end = end, end + n
            point.positions, point.velocities = q[begin:end], v[begin:end]
            point.accelerations = a[begin:end]
            time = point.time_from_start
            time.sec, time.nanosec = sec, nanosec
        return points


def joint_trajectory(
    joint_names: Sequence[str],
    times: Array,
    positions: Array,
    velocities: Array,
    accelerations: Array,
    points: TrajectoryPoints | None = None,
) -> JointTrajectory:
    """Make a trajectory message from sampled curves.

    Parameters
    ----------
    joint_names : sequence of str
        n joints.
    times : ndarray, shape (m,)
        Times from start (s).
    positions, velocities, accelerations : ndarray, shape (m, n)
        rad or m, and per s and s^2.
    points : TrajectoryPoints, optional
        To be filled; default new ones.

    Returns
    -------
    JointTrajectory
        With stamp 0: start when received.
    """
    filled = (points or TrajectoryPoints()).filled(times, positions, velocities, accelerations)
    return JointTrajectory(joint_names=list(joint_names), points=filled)
