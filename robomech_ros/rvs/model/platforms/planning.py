"""Plans of a parallel robot between two remembered postures, made by our own planners."""

from __future__ import annotations

from typing import Any

import numpy as np

from robomech_ros.errors import BadValueError
from robomech_ros.parallel import Mechanism, follow_drives, plan_drives, plan_platform
from robomech_ros.rvs.model.planning import (
    JOINTS,
    PATH_KINDS,
    SAME,
    MadePlan,
    along_line,
    sample_times,
)
from robomech_ros.rvs.motion import Motion
from robomech_ros.spatial.arrays import as_choice
from robomech_ros.trajectory import PROFILES
from robomech_ros.trajectory.waypoints import PiecewiseTrajectory
from robomech_ros.typing import Array


def plan_platform_between(
    mechanism: Mechanism, start: Array, goal: Array, kind: str, profile: str
) -> MadePlan:
    """Plan a motion from rest to rest, in one assembly mode.

    Parameters
    ----------
    mechanism : Mechanism
        Of n joints, within whose limits to move.
    start, goal : ndarray, shape (n,)
        Postures (rad or m), loops closed; along a line of the platform, the pose of the goal
        counts, otherwise its drives.
    kind : str
        One of ``PATH_KINDS``: the drives together, or the platform along a line.
    profile : str
        One of :data:`robomech_ros.trajectory.PROFILES`; not each of them suits a line.

    Raises
    ------
    BadValueError
        An unknown way or profile, or the start is the goal.
    RobomechError
        As for the planners: limits are missing, a posture is outside them.
    """
    as_choice("way", kind, PATH_KINDS)
    if kind != JOINTS:
        poses = mechanism.pose(np.stack([start, goal]))

        def made(trajectory: PiecewiseTrajectory, sentence: str, complete: bool) -> MadePlan:
            return _made(mechanism, trajectory, start, goal if complete else None, sentence)

        def plan_path(path: Any) -> Any:
            return plan_platform(mechanism, path, start, profile=profile)

        return along_line(poses, plan_path, made, profile)
    as_choice("profile", profile, tuple(PROFILES))
    points = np.stack([start, goal])[:, mechanism.drive_index]
    if np.array_equal(points[0], points[1]):
        raise BadValueError("goal", "the drives of the start", "other drives")
    plan = plan_drives(mechanism, points, start, profile=profile)
    times, stop = plan.sampled.waypoints.times, plan.way.stop
    if stop is not None:
        at = times[max(stop - 1, 0)]
        why = f"It would stop {at:.2f} s after its start, of {times[-1]:.2f} s: {plan.way.reason}"
        return MadePlan(None, why, False)
    trajectory = plan.sampled.trajectory
    sentence = f"{profile}: {trajectory.duration:.2f} s"
    return _made(mechanism, trajectory, start, goal, sentence)


def _made(
    mechanism: Mechanism,
    trajectory: PiecewiseTrajectory,
    start: Array,
    goal: Array | None,
    sentence: str,
) -> MadePlan:
    """Let all joints follow a motion of the drives; the goal is None if it ends before."""
    times = sample_times(trajectory)
    motion = followed_motion(mechanism, times, *trajectory.sample(times)[:3], start)
    if goal is not None and np.abs(motion.q[-1] - goal).max() > SAME:
        sentence += "; it ends in another assembly mode, or with other limbs, than the goal"
    return MadePlan(motion, sentence, goal is not None)


def followed_motion(
    mechanism: Mechanism,
    times: Array,
    drives: Array,
    rates: Array | None,
    accelerations: Array | None,
    start: Array,
) -> Motion:
    """Return the motion of all joints that a motion of the drives causes.

    Parameters
    ----------
    mechanism : Mechanism
        Of n joints and d drives.
    times : ndarray, shape (m,)
        s.
    drives, rates, accelerations : ndarray, shape (m, d)
        rad or m, and over s and s^2; the latter two None if they are not known.
    start : ndarray, shape (n,)
        Posture from which the joints follow, rad or m.

    Returns
    -------
    Motion
        As far as the robot can follow.
    """
    q = follow_drives(mechanism, drives, start).q
    k, qd, qdd = len(q), None, None
    if rates is not None:
        qd, _ = mechanism.rates(q, rates[:k])
        if accelerations is not None:
            qdd, _ = mechanism.accelerations(q, qd, accelerations[:k])
    return Motion(mechanism, times[:k], q, (), qd, qdd)
