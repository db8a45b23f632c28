"""Entry of a robot into a trajectory: in time, by catching up, or not possible yet."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from robomech_ros.errors import LimitExceededError
from robomech_ros.execution.controller.follower_settings import FollowerSettings
from robomech_ros.execution.controller.joining import completed, join, join_in_steps, without_turns
from robomech_ros.execution.controller.late_start import (
    LONGEST_LAG,
    ScheduleShift,
    extend_schedule,
    infeasibility,
    late_start,
)
from robomech_ros.execution.joints import Joints, State
from robomech_ros.execution.rejections import TrajectoryOverError
from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial
from robomech_ros.trajectory.waypoints import Waypoints


class EntryPath(NamedTuple):
    """Execution of a trajectory: the curve from now to the end, and its schedule.

    The schedule is that of the trajectory that the robot catches up with or lets pass, None if it
    is in time. It is blocked while the limits allow no entry, so that the present motion goes on.
    """

    curve: PiecewisePolynomial
    schedule: ScheduleShift | None = None
    blocked: bool = False


def entry_path(
    waypoints: Waypoints,
    present: State,
    joints: Joints,
    settings: FollowerSettings,
    late: float,
    before: ScheduleShift | None,
    unsettled: bool = False,
) -> EntryPath:
    """Join a trajectory, or catch up with a late one that the limits do not let it join.

    Soon after a jump of the clock, while a stream is ``unsettled``, a message of it in time counts
    as late, since its sender and the robot left out different times. ``before`` is what the robot
    follows, in time, on a clock that is 0 now; None where it stands. The others are those of
    `join`, and so are the errors.
    """
    joined = join if settings.interpolate else join_in_steps
    known = completed(waypoints, present)
    off_time = late > 0.0 or (unsettled and before is not None)
    may_catch_up = off_time and settings.interpolate and _can_be_caught(known, late)
    off = np.max(np.abs(known.positions[-1] - present.position))
    # A robot that stands has to be as near to the end as to a start.
    nearly_there = bool(off <= settings.start_tolerance)
    behind = may_catch_up and before is not None and not before.in_time
    curve: PiecewisePolynomial | None = None
    refused: Exception | None = None
    if not behind:
        try:
            curve = joined(waypoints, present, joints, settings.start_tolerance, late)
        except (LimitExceededError, TrajectoryOverError) as error:
            if not may_catch_up or (before is None and not nearly_there):
                raise
            refused = error
        if curve is not None:
            refused = infeasibility(curve, present, joints) if may_catch_up else None
            if refused is None:
                return EntryPath(curve)
    near = replace(known, positions=without_turns(known.positions, present, joints))
    if (found := late_start(near, present, joints, late, before)) is not None:
        return EntryPath(*found)
    if before is not None and (curve is not None or behind):
        return EntryPath(near.curve, extend_schedule(near, joints, late, before), True)
    assert refused is not None
    raise refused


def _can_be_caught(waypoints: Waypoints, late: float) -> bool:
    """Return whether a trajectory has velocities everywhere, and has not been over for long."""
    velocities = waypoints.velocities
    if velocities is None or not np.isfinite(velocities).all():
        return False
    return bool(late < waypoints.times[-1] + LONGEST_LAG)
