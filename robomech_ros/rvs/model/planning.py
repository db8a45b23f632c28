"""Plans between two remembered postures, made by our own planners."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from robomech_ros.cartesian import plan_along, waypoint_path
from robomech_ros.errors import BadValueError
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.robots import SerialChain
from robomech_ros.rvs.motion import Motion
from robomech_ros.spatial.arrays import as_choice
from robomech_ros.trajectory import PROFILES, nearest_turns, point_to_point
from robomech_ros.trajectory.waypoints import PiecewiseTrajectory
from robomech_ros.typing import Array

# Ways from posture to posture: all joints together, or the tip along a line.
JOINTS, LINE = "joints", "line of the tip"
PATH_KINDS = (JOINTS, LINE)
# A curve is drawn by so many samples, and one at either side of each of its breaks (s).
SAMPLES, BESIDE_BREAKS = 200, 1e-7
# Another posture than the goal begins at this distance (rad or m).
SAME = 1e-4


class MadePlan(NamedTuple):
    """A plan, and what is to be said of it.

    Parameters
    ----------
    motion : Motion or None
        None where there is none.
    sentence : str
        How long it is, or why it ends early or is not there.
    complete : bool
        Whether it ends at the goal.
    """

    motion: Motion | None
    sentence: str
    complete: bool


def plan_between(
    chain: SerialChain, start: Array, goal: Array, kind: str, profile: str
) -> MadePlan:
    """Plan a motion from rest to rest.

    Parameters
    ----------
    chain : SerialChain
        Of n joints, within whose limits to move.
    start, goal : ndarray, shape (n,)
        Postures (rad or m); along a line of the tip, the pose of the goal counts.
    kind : str
        One of ``PATH_KINDS``.
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
    if kind == JOINTS:
        as_choice("profile", profile, tuple(PROFILES))
        if np.array_equal(start, goal):
            raise BadValueError("goal", "the start", "another posture")
        points, _ = nearest_turns([start, goal], chain.continuous)
        trajectory = point_to_point(*points, limits=chain, profile=profile)
        return _made(chain, trajectory, f"{profile}: {trajectory.duration:.2f} s", True)
    T = forward_kinematics(chain, np.array([start, goal]))

    def made(trajectory: PiecewiseTrajectory, sentence: str, complete: bool) -> MadePlan:
        end = trajectory.sample(trajectory.duration).position
        if complete and np.abs(end - goal).max() > SAME:
            sentence += "; it ends in another posture of the goal's pose"
        return _made(chain, trajectory, sentence, complete)

    return along_line(
        T, lambda path: plan_along(chain, path, start, profile=profile), made, profile
    )


def along_line(
    T: Array,
    plan_path: Callable[[Any], Any],
    made: Callable[[PiecewiseTrajectory, str, bool], MadePlan],
    profile: str,
) -> MadePlan:
    """Plan along the line between two poses, as far as it can be followed.

    Parameters
    ----------
    T : ndarray, shape (2, 4, 4)
        In the base (m).
    plan_path : callable
        Plans along a path.
    made : callable
        Gives the plan for a trajectory, what is said of it, and whether it arrives.
    profile : str
    """
    try:
        path = waypoint_path(T[0], T[1:])
    except BadValueError as error:
        raise BadValueError(_of_goal(error.what), error.value, error.expected) from None
    if path is None:
        raise BadValueError("goal", "the pose of the start", "another pose")
    plan = plan_path(path)
    trajectory = plan.trajectory
    if trajectory is None or plan.stop is not None:
        why = _of_goal(plan.stop.text) if plan.stop is not None else "the path does not begin"
        sentence = f"Followed to {plan.fraction:.0%}: {why}"
        if trajectory is None or not trajectory.duration > 0.0:
            return MadePlan(None, sentence, False)
        return made(trajectory, sentence, False)
    sentence = f"{profile} along {path.length:.3f} m: {trajectory.duration:.2f} s"
    return made(trajectory, sentence, True)


def _of_goal(text: str) -> str:
    """Name the goal, which is the only waypoint of the path."""
    return text.replace("waypoints[0]", "the goal")


def sample_times(trajectory: PiecewiseTrajectory) -> Array:
    """Return times (k,) in s at which steps of the derivatives of a plan are seen as steps."""
    end = trajectory.duration
    inner = trajectory.pieces.breaks[1:-1]
    instants = [np.linspace(0.0, end, SAMPLES + 1), inner - BESIDE_BREAKS, inner + BESIDE_BREAKS]
    times = np.unique(np.concatenate(instants))
    # Nearer to the ends, and to each other, samples differ by their rounding alone.
    times = times[(times >= 0.0) & (times <= end)]
    keep = np.append(True, np.diff(times) > 0.5 * BESIDE_BREAKS)
    return np.asarray(times[keep])


def _made(
    chain: SerialChain, trajectory: PiecewiseTrajectory, sentence: str, complete: bool
) -> MadePlan:
    times = sample_times(trajectory)
    q, *rates = trajectory.sample(times)
    return MadePlan(Motion(chain, times, q, (), *rates), sentence, complete)
