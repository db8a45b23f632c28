"""Plans of an arm or a parallel robot between two remembered postures."""

from typing import NamedTuple

import numpy as np

from robomech_ros.cartesian import plan_along, waypoint_path
from robomech_ros.errors import BadValueError
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.parallel import Mechanism, plan_drives, plan_platform
from robomech_ros.robots import SerialChain
from robomech_ros.rvs.model.motions.drive_motions import followed_motion
from robomech_ros.rvs.motion import Motion
from robomech_ros.spatial.arrays import as_choice
from robomech_ros.trajectory import PROFILES, nearest_turns, point_to_point
from robomech_ros.trajectory.waypoints import PiecewiseTrajectory
from robomech_ros.typing import Array

# Kinds of paths: all joints or drives move together, or the tip or platform moves along a line.
JOINTS, LINE = "joints", "line of the tip"
PATH_KINDS = (JOINTS, LINE)
# Number of samples of a curve, and distance (s) of two samples about each of its breaks.
SAMPLES, BESIDE_BREAKS = 200, 1e-7
# Largest distance of a posture from an equal goal (rad or m).
SAME = 1e-4


class MadePlan(NamedTuple):
    """A plan and a sentence about it."""

    #: The planned motion; None if there is none.
    motion: Motion | None
    #: Sentence on the duration, or on why the motion ends early or is missing.
    sentence: str
    #: Whether the motion ends at the goal.
    complete: bool


def plan_between(
    robot: SerialChain | Mechanism, start: Array, goal: Array, kind: str, profile: str
) -> MadePlan:
    """Plan a motion from rest to rest; of a parallel robot, in one assembly mode.

    - ``robot``: robot of n joints with their limits.
    - ``start``, ``goal``: postures (rad or m), loops closed, shape (n,); along a line the pose of
      the goal counts, otherwise its joints or drives.
    - ``kind``: one of ``PATH_KINDS``.
    - ``profile``: one of :data:`robomech_ros.trajectory.PROFILES`; not each of them suits a line.

    Raises BadValueError: the kind or profile is unknown, or the start is the goal. RobomechError:
    limits are missing, or a posture is outside them.
    """
    as_choice("way", kind, PATH_KINDS)
    if kind == LINE:
        return _along_line(robot, start, goal, profile)
    as_choice("profile", profile, tuple(PROFILES))
    if isinstance(robot, Mechanism):
        return _by_drives(robot, start, goal, profile)
    if np.array_equal(start, goal):
        raise BadValueError("goal", "the start", "another posture")
    (begin, end), _ = nearest_turns([start, goal], robot.continuous)
    trajectory = point_to_point(begin, end, limits=robot, profile=profile)
    return _made(robot, trajectory, start, end, f"{profile}: {trajectory.duration:.2f} s")


def _by_drives(mechanism: Mechanism, start: Array, goal: Array, profile: str) -> MadePlan:
    """Move the drives together; the others follow."""
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
    return _made(mechanism, trajectory, start, goal, f"{profile}: {trajectory.duration:.2f} s")


def _along_line(
    robot: SerialChain | Mechanism, start: Array, goal: Array, profile: str
) -> MadePlan:
    ends = np.stack([start, goal])
    T = forward_kinematics(robot, ends) if isinstance(robot, SerialChain) else robot.pose(ends)
    try:
        path = waypoint_path(T[0], T[1:])
    except BadValueError as error:
        raise BadValueError(_of_goal(error.what), error.value, error.expected) from None
    if path is None:
        raise BadValueError("goal", "the pose of the start", "another pose")
    if isinstance(robot, SerialChain):
        plan = plan_along(robot, path, start, profile=profile)
    else:
        plan = plan_platform(robot, path, start, profile=profile)
    trajectory = plan.trajectory
    if trajectory is None or plan.stop is not None:
        why = _of_goal(plan.stop.text) if plan.stop is not None else "the path does not begin"
        sentence = f"Followed to {plan.fraction:.0%}: {why}"
        if trajectory is None or not trajectory.duration > 0.0:
            return MadePlan(None, sentence, False)
        return _made(robot, trajectory, start, None, sentence)
    sentence = f"{profile} along {path.length:.3f} m: {trajectory.duration:.2f} s"
    return _made(robot, trajectory, start, goal, sentence)


def _of_goal(text: str) -> str:
    """Name the goal, which is the only waypoint of the path."""
    return text.replace("waypoints[0]", "the goal")


def sample_times(trajectory: PiecewiseTrajectory) -> Array:
    """Return times (k,) of samples (s), dense enough to draw jumps of derivatives as jumps."""
    end = trajectory.duration
    inner = trajectory.pieces.breaks[1:-1]
    instants = [np.linspace(0.0, end, SAMPLES + 1), inner - BESIDE_BREAKS, inner + BESIDE_BREAKS]
    times = np.unique(np.concatenate(instants))
    # Samples nearer to each other would differ only by rounding.
    times = times[(times >= 0.0) & (times <= end)]
    keep = np.append(True, np.diff(times) > 0.5 * BESIDE_BREAKS)
    return np.asarray(times[keep])


def _made(
    robot: SerialChain | Mechanism,
    trajectory: PiecewiseTrajectory,
    start: Array,
    goal: Array | None,
    sentence: str,
) -> MadePlan:
    """Return the plan of a trajectory; the goal is None if the trajectory ends before it."""
    times = sample_times(trajectory)
    q, qd, qdd, qddd = trajectory.sample(times)
    if isinstance(robot, SerialChain):
        motion, other = (
            Motion(robot, times, q, (), qd, qdd, qddd),
            "another posture of the goal's pose",
        )
    else:
        motion = followed_motion(robot, times, q, qd, qdd, start)
        other = "another assembly mode, or with other limbs, than the goal"
    if goal is not None and np.abs(motion.q[-1] - goal).max() > SAME:
        sentence += f"; it ends in {other}"
    return MadePlan(motion, sentence, goal is not None)
