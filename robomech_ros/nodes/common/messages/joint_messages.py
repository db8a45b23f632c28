"""Conversion of joint states and trajectories, matched by name, to ordered arrays."""

import math
from array import array
from collections.abc import Iterable, Iterator, Sequence
from typing import Any

import numpy as np
from builtin_interfaces.msg import Time
from sensor_msgs.msg import JointState
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from robomech_ros.errors import NonFiniteError, UnknownJointError, WrongSizeError, format_value
from robomech_ros.execution.received_trajectory import ReceivedTrajectory
from robomech_ros.nodes.common.messages.message_fields import NANO, floats
from robomech_ros.servo.motion import Samples
from robomech_ros.typing import Array

# Number of point messages kept from one trajectory to the next, 1 kB each.
_POINTS_KEPT = 2000


def positions_by_name(
    state: JointState,
    joint_names: Sequence[str],
    what: str,
    others: Iterable[str] = (),
    field: str = "position",
) -> Array:
    """Read the positions of joints, or other numbers, from a joint state, matched by name.

    - ``state``: positions in rad or m. Without names they are in the order of `joint_names`.
    - ``joint_names``: the joints wanted, n of them.
    - ``what``: what the state is, for messages: ``"seed"``, ``"start"``.
    - ``others``: further joints of the robot, which the state may contain and which are passed
      over.
    - ``field``: which numbers, one of "position", "velocity", "effort".

    Returns an array (n,) in the order of `joint_names`.

    Raises WrongSizeError: as many names as positions are required, each name once, and no joint may
    be missing. UnknownJointError: a name that is neither among the joints nor among the others.
    NonFiniteError: a position that is not a finite number; the joint is named.
    """
    names, positions = state.name, getattr(state, field)
    if names:
        if list(names) != list(joint_names) or len(names) != len(positions):
            values = values_by_name(names, positions, what, field)
            positions = _matched(values, joint_names, what, others)
    elif len(positions) != len(joint_names):
        expected = f"{len(joint_names)} for {', '.join(joint_names)}"
        raise WrongSizeError(f"{what}.{field}", len(positions), expected)
    for name, value in zip(joint_names, positions, strict=True):
        if not math.isfinite(value):
            number = what if field == "position" else f"{what}.{field}"
            raise NonFiniteError(f"{number} of joint '{name}'", value)
    return np.array(positions, dtype=np.float64)


def values_by_name(
    names: Sequence[str], values: Sequence[float], what: str, field: str = "position"
) -> dict[str, float]:
    """Return values by name; refuse another number of values, or a repeated name."""
    if len(names) != len(values):
        expected = f"{len(names)}, one for every name"
        raise WrongSizeError(f"{what}.{field}", len(values), expected)
    by_name = dict(zip(names, values, strict=True))
    if len(by_name) != len(names):
        twice = next(name for i, name in enumerate(names) if name in names[:i])
        expected = f"every name once; {format_value(twice)} is repeated"
        raise WrongSizeError(f"{what}.name", len(names), expected)
    return by_name


def _matched(
    values: dict[str, float], joint_names: Sequence[str], what: str, others: Iterable[str]
) -> list[float]:
    known = {*joint_names, *others}
    for name in values:
        if name not in known:
            raise UnknownJointError(name, joint_names)
    missing = [name for name in joint_names if name not in values]
    if missing:
        expected = f"all of {', '.join(joint_names)}; missing: {', '.join(missing)}"
        raise WrongSizeError(f"{what}.name", len(values), expected)
    return [values[name] for name in joint_names]


def joint_state(joint_names: Sequence[str], positions: Array) -> JointState:
    """Make a joint state with positions (rad or m) only."""
    return JointState(name=list(joint_names), position=floats(positions))


def received_trajectory(message: JointTrajectory) -> ReceivedTrajectory:
    """Convert an unchecked message; its points are not copied."""
    points = list(message.points)
    spans = [point.time_from_start for point in points]
    times = [span.sec + span.nanosec * 1e-9 for span in spans]
    return ReceivedTrajectory(message.joint_names, times, points)


class TrajectoryPoints:
    """Reusable trajectory points.

    Making a point message takes longer than filling it.  Callers must send one
    trajectory before the next is made: rclpy copies on sending.
    """

    def __init__(self) -> None:
        self._points: list[JointTrajectoryPoint] = []

    def filled(
        self, times: Array | None, positions: Array, *rates: Array
    ) -> list[JointTrajectoryPoint]:
        """Return m points at times (m,) (s), always with as many rates; or always positions only.

        Positions, and velocities and accelerations if given, are of shape (m, n) (rad or m).
        """
        m, n = positions.shape
        new = [JointTrajectoryPoint() for _ in range(m - len(self._points))]
        points = self._points[:m] + new
        self._points += new[: max(0, _POINTS_KEPT - len(self._points))]
        # The parts of an empty list are empty.
        q, v, a = [*map(floats, (positions, *rates)), array("d"), array("d")][:3]
        # A part of Python's array is copied faster than a row of numpy's.  The setter of the field
        # would copy it once more; its slot does not.
        if times is None:
            for k, point in enumerate(points):
                point._positions = q[k * n : k * n + n]
            return points
        i, instants = 0, divmod(np.rint(times * NANO).astype(np.int64), NANO)
        for point, sec, nanosec in zip(points, *map(np.ndarray.tolist, instants), strict=False):
            j = i + n
            point._positions, point._velocities, point._accelerations = q[i:j], v[i:j], a[i:j]
            i, time = j, point._time_from_start
            time._sec, time._nanosec = sec, nanosec
        return points


class SampledPoints(Sequence[JointTrajectoryPoint]):
    """Trajectory points that are made on reading, for a message that is kept.

    A point message takes 1 kB, its numbers less than 0.2 kB, and rclpy keeps a result for 10 s.

    - ``samples``: times (m,) (s), positions and, if any, rates (m, n); see
      `TrajectoryPoints.filled`.
    """

    def __init__(self, *samples: Array) -> None:
        self._samples = samples

    def __len__(self) -> int:
        return len(self._samples[0])

    def __iter__(self) -> Iterator[JointTrajectoryPoint]:
        return iter(self[:])

    def __getitem__(self, index: Any) -> Any:
        rows = index if isinstance(index, slice) else slice(index, index + 1 or None)
        times, *curves = (values[rows] for values in self._samples)
        points = TrajectoryPoints().filled(times, *curves)
        return points if rows is index else points[0]


def joint_trajectory(
    names: Sequence[str], times: Array, positions: Array, velocities: Array, accelerations: Array
) -> JointTrajectory:
    """Make a trajectory message from sampled curves.

    - ``names``: n joints.
    - ``times``: times from start (s), shape (m,).
    - ``positions``, ``velocities``, ``accelerations``: rad or m, and per s and s^2, shape (m, n).

    The message has stamp 0: start when received.
    """
    points = SampledPoints(times, positions, velocities, accelerations)
    return JointTrajectory(joint_names=list(names), points=points)


def stream_message(
    names: Sequence[str], samples: Samples, ahead: float, stamp: Time
) -> JointTrajectory:
    """Make the message: positions and velocities only, between which a cubic is exact.

    - ``names``: the n joints.
    - ``samples``: from a knot to rest.
    - ``ahead``: how long after the stamp the knot is (s).
    - ``stamp``: when the message was made, in ROS time.
    """
    points = TrajectoryPoints().filled(ahead + samples.times, samples.positions, samples.velocities)
    message = JointTrajectory(joint_names=list(names), points=points)
    message.header.stamp = stamp
    return message
