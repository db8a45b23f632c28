"""Trajectories as they arrive: checked field by field before anything is computed from them."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from robomech_ros.errors import BadValueError, NonFiniteError, UnknownJointError, WrongSizeError
from robomech_ros.execution.rejections import JointMismatchError, TrajectoryRefusedError
from robomech_ros.trajectory.waypoints import Waypoints
from robomech_ros.typing import Array

# A velocity up to this (rad/s, m/s) in the last point is zero with rounding.
REST = 1e-6
# Place of a joint that a trajectory does not name.
MISSING = -1
# No robot has numbers beyond this (SI); curves through larger ones could overflow.
LARGEST = 1e6


@dataclass(frozen=True, eq=False)
class ReceivedTrajectory:
    """A trajectory as received; nothing about it has been checked.

    The joints are in the order of the numbers of every point, the times since the start (s). Points
    are such as trajectory_msgs/JointTrajectoryPoint: positions in rad or m, velocities and
    accelerations per s and s^2 or empty, effort.
    """

    joint_names: Sequence[str]
    times: Sequence[float]
    points: Sequence[Any]


def read_waypoints(
    trajectory: ReceivedTrajectory,
    joint_names: Sequence[str],
    max_points: int,
    max_duration: float,
    *,
    partial: bool = False,
    to_rest: bool = True,
) -> Waypoints:
    """Check a trajectory by the rules of joint_trajectory_controller, and put its joints in order.

    It must name each of the n joints of the robot once, in any order; if it may be ``partial``,
    some of them. There may be ``max_points``, up to ``max_duration`` (s) from start. The last
    velocity, where there is one, must be 0 if the motion is ``to_rest``. In the waypoints a point
    without velocities or accelerations has a row of NaN, a joint that is missing a column. Raises
    UnknownJointError or TrajectoryRefusedError with the point, the joint and the number at fault.
    """
    order = joint_order(trajectory.joint_names, joint_names, partial=partial)
    if not trajectory.points:
        raise TrajectoryRefusedError("the trajectory has no points")
    if len(trajectory.points) > max_points:
        raise WrongSizeError("points", len(trajectory.points), f"at most {max_points}")
    times = _times(trajectory.times, max_duration)
    names = tuple(trajectory.joint_names)
    positions = _rows(trajectory.points, "positions", names, required=True)
    velocities = _rows(trajectory.points, "velocities", names)
    accelerations = _rows(trajectory.points, "accelerations", names)
    _refuse_effort(trajectory.points)
    if to_rest:
        _require_rest(velocities[-1], names)
    rows = [values[:, order] for values in (positions, velocities, accelerations)]
    missing = [place == MISSING for place in order]
    for values in rows:
        values[:, missing] = math.nan
    return Waypoints(times, *rows)


def joint_order(
    received: Sequence[str], joint_names: Sequence[str], *, partial: bool = False
) -> list[int]:
    """Find where each joint of the robot is among those of a trajectory, -1 if it is missing.

    Joints may be missing if it may be ``partial``. Raises UnknownJointError for a name that the
    robot does not have, JointMismatchError for one that comes twice or is missing.
    """
    known = set(joint_names)
    for name in received:
        if name not in known:
            raise UnknownJointError(name, joint_names)
    place = {name: index for index, name in enumerate(received)}
    if len(place) != len(received):
        twice = next(name for index, name in enumerate(received) if place[name] != index)
        expected = f"every joint once; '{twice}' is repeated"
        raise JointMismatchError("joint_names", len(received), expected)
    missing = [name for name in joint_names if name not in place]
    if missing and not (partial and place):
        expected = f"{len(joint_names)}, all joints of the robot; missing: {', '.join(missing)}"
        raise JointMismatchError("joint_names", len(received), expected)
    return [place.get(name, MISSING) for name in joint_names]


def _times(given: Sequence[float], max_duration: float) -> Array:
    times = np.array(given, dtype=np.float64)
    if not np.isfinite(times).all():
        raise NonFiniteError("time_from_start", times)
    if times[0] < 0.0:
        raise BadValueError("points[0].time_from_start", float(times[0]), "0 s or more")
    late = np.flatnonzero(np.diff(times) <= 0.0)
    if len(late):
        k = int(late[0]) + 1
        expected = f"more than {times[k - 1]:.9g} s, the time of the point before it"
        raise BadValueError(f"points[{k}].time_from_start", float(times[k]), expected)
    if times[-1] > max_duration:
        last = f"points[{len(times) - 1}].time_from_start"
        raise BadValueError(last, float(times[-1]), f"at most {max_duration:g} s")
    return times


def _rows(
    points: Sequence[Any], field: str, names: Sequence[str], *, required: bool = False
) -> Array:
    """Read one field of all points, shape (m, n); rows of NaN where it is empty."""
    n = len(names)
    given = [getattr(point, field) for point in points]
    for index, values in enumerate(given):
        if len(values) != n and (required or len(values)):
            expected = f"{n}{'' if required else ' or 0'}"
            raise WrongSizeError(f"points[{index}].{field}", len(values), expected)
    rows = np.full((len(points), n), math.nan)
    there = [index for index, values in enumerate(given) if len(values)]
    if there:
        found = np.array([given[index] for index in there], dtype=np.float64)
        good = np.abs(found) <= LARGEST
        if not good.all():
            row, joint = np.argwhere(~good)[0]
            what = f"points[{there[row]}].{field} of joint '{names[joint]}'"
            value = float(found[row, joint])
            if not math.isfinite(value):
                raise NonFiniteError(what, value)
            raise BadValueError(what, value, f"at most {LARGEST:g} in magnitude")
        rows[there] = found
    return rows


def _refuse_effort(points: Sequence[Any]) -> None:
    for index, point in enumerate(points):
        if len(point.effort):
            expected = "0: positions, velocities and accelerations are read, no effort"
            raise WrongSizeError(f"points[{index}].effort", len(point.effort), expected)


def _require_rest(last: Array, names: Sequence[str]) -> None:
    moving = np.abs(last) > REST
    if moving.any():
        joint = int(np.nanargmax(np.abs(last)))
        what = f"velocity of joint '{names[joint]}' in the last point"
        raise BadValueError(what, float(last[joint]), "0: the robot holds when a trajectory ends")
