"""From where the robot is, onto a trajectory: one smooth curve, verified as it will be followed."""

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from robomech_ros.errors import LimitExceededError
from robomech_ros.execution.entering import (
    LATENCY,
    STANDING,
    Joined,
    entered,
    refusal,
    smoothed,
    violation_of,
)
from robomech_ros.execution.joints import Joints, State
from robomech_ros.execution.refusals import StartMismatchError, TrajectoryOverError
from robomech_ros.execution.smoothing import with_braking
from robomech_ros.trajectory.interpolation import interpolant
from robomech_ros.trajectory.piecewise import PiecewisePolynomial
from robomech_ros.trajectory.sample import FloatArray
from robomech_ros.trajectory.waypoints import Waypoints

__all__ = ["join", "join_in_steps"]

# Without interpolation the last point is told for this long (s) before the trajectory is over.
_INSTANT = 1e-9


@dataclass(frozen=True, eq=False)
class _Course:
    """A trajectory as a curve that the robot may be on already.

    Attributes
    ----------
    curve : PiecewisePolynomial
        From the first point to the last and, where the robot moves there, until it has braked.
    velocity : ndarray, shape (n,)
        With which the joints come to the first point (rad/s or m/s).
    place : ndarray, shape (n,)
        Where the joints should be now (rad or m).
    corners : bool
        Whether it begins as a straight line.
    """

    curve: PiecewisePolynomial
    velocity: FloatArray
    place: FloatArray
    corners: bool


def join(
    waypoints: Waypoints,
    present: State,
    joints: Joints,
    start_tolerance: float,
    late: float = 0.0,
    cycle: float = 0.0,
) -> Joined:
    """Make the curve that leads from the present state along a trajectory to its end.

    A first point at time 0 must be where the robot is, within tolerance; what is left of the
    step, and the difference in velocity if the robot moves, is smoothed out with a quintic within
    the acceleration limits.  A first point later than that is reached from the present state as
    the points among each other: linearly, or by a cubic or quintic where it has velocities and
    accelerations.

    A trajectory that should have begun, or whose first point is less than a cycle away, is taken
    up where it should be now, if the robot is there within tolerance: the step is smoothed out in
    the same way.  Otherwise points that are over are dropped, and the next one is reached from
    the present state.  A trajectory whose first point the robot cannot reach in time by a little,
    or which it cannot catch up with, is followed later: a stream goes on where its messages come
    early or late.

    Parameters
    ----------
    waypoints : Waypoints
        m points of n joints.  A joint whose column is NaN stays where it is.
    present : State
        Where the robot is when the trajectory begins.
    joints : Joints
        Limits; whole turns between the present position and the trajectory are removed for
        continuous joints.
    start_tolerance : float
        Largest step at the start, rad or m; a moving joint may be off by another 0.1 s of way.
    late : float
        How long ago the trajectory should have begun, s.
    cycle : float
        How often the robot is told where to be, s: a point less than that away is as good as over
        where there is another one.

    Returns
    -------
    Joined
        From t = 0, now, to the end and, where the robot moves there, on until it has braked;
        within the limits of position and velocity.

    Raises
    ------
    StartMismatchError
        The start is farther from the present position than allowed.
    TrajectoryOverError
        The trajectory has ended already.
    LimitExceededError
        A position or velocity limit would be exceeded, on the points or between them.
    """
    known = _completed(waypoints, present)
    left = _remaining(known, late)
    ahead = float(known.times[0] - late)
    if ahead <= 0.0 or (ahead < cycle and len(known.times) > 1):
        course = _course(known, present, joints, late)
        mismatch = _mismatch(course.place, present, joints, start_tolerance)
        if mismatch is None:
            return _entered(course, late, present, joints)
        if left.times[0] <= 0.0:
            raise mismatch
    try:
        return Joined(_approached(left, present, joints))
    except LimitExceededError:
        if not 0.0 < ahead < LATENCY:
            raise
        course = _course(known, present, joints, late)
        if _mismatch(course.place, present, joints, start_tolerance) is not None:
            raise
        return _entered(course, late, present, joints)


def join_in_steps(
    waypoints: Waypoints,
    present: State,
    joints: Joints,
    start_tolerance: float,
    late: float = 0.0,
    cycle: float = 0.0,
) -> Joined:
    """Make the curve of a trajectory that is not interpolated: each point is told at once.

    As with ros2_control's ``interpolation_method: none`` the joints stay where they are until a
    first point later than now, and between two points they are told the second one.  Velocities
    and accelerations do not matter.  What the joints would do between the points is refused as by
    `join`; parameters and errors are those of `join`.
    """
    left = _remaining(_completed(waypoints, present), late)
    positions = left.positions + _turns(left.positions[0], present, joints)
    times, told = left.times, np.vstack([positions[1:], positions[-1:]])
    mismatch = _mismatch(positions[0], present, joints, start_tolerance)
    if mismatch is not None and times[0] <= 0.0:
        raise mismatch
    if times[0] > 0.0:
        told = np.vstack([present.position, told])
        # A robot that is near is there in time for the point after the first one.
        if mismatch is not None or not times[0] < cycle:
            positions = np.vstack([present.position, positions])
    violation = violation_of(
        interpolant(np.append(0.0, times)[-len(positions) :], positions), joints
    )
    if violation is not None:
        raise refusal(violation, float(left.times[0]))
    if times[0] > 0.0:
        times = np.append(0.0, times)
    return Joined(PiecewisePolynomial(np.append(times, times[-1] + _INSTANT), told[None]))


def _turns(place: FloatArray, present: State, joints: Joints) -> FloatArray:
    """Give the whole turns (rad), of continuous joints, from a place to near the robot's."""
    turns = np.round((present.position - place) / math.tau)
    return np.where(joints.continuous, turns * math.tau, 0.0)


def _course(known: Waypoints, present: State, joints: Joints, late: float) -> _Course:
    """Make the curve of a trajectory by itself."""
    times, positions, velocities = known.times, known.positions, known.velocities
    curve = interpolant(times, positions, velocities, known.accelerations)
    given = None if velocities is None or np.isnan(velocities[0]).any() else velocities[0]
    velocity = curve.sample(times[0]).velocity if given is None else given
    if velocities is not None:
        curve = with_braking(curve, velocities[-1], joints)
    early = min(late - times[0], 0.0)
    place = curve.sample(max(late, times[0])).position + early * velocity
    turns = _turns(place, present, joints)
    coefficients = curve.coefficients.copy()
    coefficients[0] += turns
    curve = PiecewisePolynomial(curve.breaks, coefficients)
    return _Course(curve, velocity, place + turns, given is None)


def _entered(course: _Course, late: float, present: State, joints: Joints) -> Joined:
    return entered(course.curve, late, course.velocity, present, joints, corners=course.corners)


def _completed(waypoints: Waypoints, present: State) -> Waypoints:
    """Let the joints that the trajectory does not name stay where they are."""
    missing = np.isnan(waypoints.positions[0])
    if not missing.any():
        return waypoints
    positions = np.where(missing, present.position, waypoints.positions)
    rates = (_stilled(rate, missing) for rate in (waypoints.velocities, waypoints.accelerations))
    return Waypoints(waypoints.times, positions, *rates)


def _stilled(rate: FloatArray | None, missing: npt.NDArray[np.bool_]) -> FloatArray | None:
    """Fill the columns of missing joints with 0 in those rows that have numbers at all."""
    if rate is None:
        return None
    there = ~np.all(np.isnan(rate), axis=1, keepdims=True)
    return np.where(missing & there, 0.0, rate)


def _remaining(waypoints: Waypoints, late: float) -> Waypoints:
    """Drop what should have happened before now."""
    if late <= 0.0:
        return waypoints
    left = waypoints.times > late
    if not left.any():
        raise TrajectoryOverError(late, waypoints.times[-1])
    velocities, accelerations = waypoints.velocities, waypoints.accelerations
    return Waypoints(
        waypoints.times[left] - late,
        waypoints.positions[left],
        None if velocities is None else velocities[left],
        None if accelerations is None else accelerations[left],
    )


def _mismatch(
    start: FloatArray, present: State, joints: Joints, tolerance: float
) -> StartMismatchError | None:
    """Say which joint is too far from where it should be."""
    allowed = tolerance + LATENCY * np.abs(present.velocity)
    excess = np.abs(start - present.position) - allowed
    worst = int(np.argmax(excess))
    if excess[worst] <= 0.0:
        return None
    return StartMismatchError(
        joints.names[worst],
        start[worst],
        present.position[worst],
        allowed[worst],
        turns=bool(joints.revolute[worst]),
    )


def _approached(left: Waypoints, present: State, joints: Joints) -> PiecewisePolynomial:
    """Reach the first point from the present state as the points among each other."""
    positions = left.positions + _turns(left.positions[0], present, joints)
    velocities, accelerations = left.velocities, left.accelerations
    curve = interpolant(
        np.concatenate([[0.0], left.times]),
        np.vstack([present.position, positions]),
        None if velocities is None else np.vstack([present.velocity, velocities]),
        None if accelerations is None else np.vstack([present.acceleration, accelerations]),
    )
    corners = velocities is None or bool(np.isnan(velocities[0]).any())
    if velocities is not None:
        curve = with_braking(curve, velocities[-1], joints)
    kick = present.velocity - curve.sample(0.0).velocity
    if corners and np.max(np.abs(present.velocity)) <= STANDING:
        kick = np.zeros_like(kick)
    return smoothed(curve, np.zeros_like(kick), kick, joints, float(left.times[0]))
