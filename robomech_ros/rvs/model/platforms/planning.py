"""Plans of a parallel robot between two remembered postures, made by our own planners."""

from __future__ import annotations

import numpy as np

from robomech_ros.cartesian import waypoint_path
from robomech_ros.errors import BadValueError
from robomech_ros.parallel import Mechanism, follow_drives, plan_drives, plan_platform
from robomech_ros.rvs.model.planning import (
    JOG_DIRECTIONS,
    JOINTS,
    SAME,
    MadePlan,
    of_goal,
    sample_times,
)
from robomech_ros.rvs.motion import Motion
from robomech_ros.spatial.arrays import as_choice
from robomech_ros.trajectory import PROFILES
from robomech_ros.trajectory.waypoints import PiecewiseTrajectory
from robomech_ros.typing import Array


def plan_platform_between(
    mechanism: Mechanism, start: Array, goal: Array, way: str, profile: str
) -> MadePlan:
    """Plan a motion from rest to rest, in one assembly mode.

    Parameters
    ----------
    mechanism : Mechanism
        Of n joints, within whose limits to move.
    start, goal : ndarray, shape (n,)
        Postures (rad or m), loops closed; along a line of the platform, the pose of the goal
        counts, otherwise its drives.
    way : str
        One of ``JOG_DIRECTIONS``: the drives together, or the platform along a line.
    profile : str
        One of :data:`robomech_ros.trajectory.PROFILES`; not each of them suits a line.

    Raises
    ------
    BadValueError
        An unknown way or profile, or the start is the goal.
    RobomechError
        As for the planners: limits are missing, a posture is outside them.
    """
    as_choice("way", way, JOG_DIRECTIONS)
    if way != JOINTS:
        return _along_line(mechanism, start, goal, profile)
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


def _along_line(mechanism: Mechanism, start: Array, goal: Array, profile: str) -> MadePlan:
    T = mechanism.pose(np.stack([start, goal]))
    path = waypoint_path(T[0], T[1:])
    if path is None:
        raise BadValueError("goal", "the pose of the start", "another pose")
    plan = plan_platform(mechanism, path, start, profile=profile)
    trajectory = plan.trajectory
    if trajectory is None or plan.stop is not None:
        why = of_goal(plan.stop.text) if plan.stop is not None else "the path does not begin"
        sentence = f"Followed to {plan.fraction:.0%}: {why}"
        if trajectory is None or not trajectory.duration > 0.0:
            return MadePlan(None, sentence, False)
        return _made(mechanism, trajectory, start, None, sentence)
    sentence = f"{profile} along {path.length:.3f} m: {trajectory.duration:.2f} s"
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
