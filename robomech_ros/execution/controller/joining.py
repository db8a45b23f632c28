"""From where the robot is, onto a trajectory: one smooth curve, verified as it will be followed."""

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from robomech_ros.errors import LimitExceededError
from robomech_ros.execution.controller.curve_parts import peaks
from robomech_ros.execution.controller.transitions import (
    delayed,
    fading_time,
    with_braking,
    with_fading,
)
from robomech_ros.execution.joints import Joints, State, approached, paced_state
from robomech_ros.execution.rejections import StartMismatchError, TrajectoryOverError
from robomech_ros.trajectory.curves.interpolation import interpolant
from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial
from robomech_ros.trajectory.plans.verification import first_violation
from robomech_ros.trajectory.plans.violations import Violation
from robomech_ros.trajectory.waypoints import Waypoints
from robomech_ros.typing import Array, BoolArray

# A moving joint may be off the start by the way it covers in this time (s): the client has seen
# the joint states some time ago.
LATENCY = 0.1
# A start off by less than this (rad, m, per s and s^2) is no step that would have to be smoothed.
NO_STEP = 1e-9
# A velocity below this (rad/s, m/s) counts as standing: the robot then follows a trajectory
# without velocities as it is given, corners included, as ros2_control does.
STANDING = 1e-6
# So many points of a late trajectory that cannot be reached in time are passed over, of those that
# come within LATENCY: a robot farther behind would leave the planned path.
_PASSED_OVER = 64
# Without interpolation the last point is commanded this long (s) before the trajectory is over, and
# a point of a late trajectory that is due within this time is over.
_INSTANT = 1e-9
# Times that are tried one after the other, in units of the one in which the smoothing takes half
# the acceleration limit.
_STRETCHES = (1.0, 2.0, 4.0, 0.5)
# Rounding of accelerations, as their part.
_SLACK = 1e-6


def join(
    waypoints: Waypoints, present: State, joints: Joints, start_tolerance: float, late: float = 0.0
) -> PiecewisePolynomial:
    """Make the curve that leads from the present state along a trajectory to its end.

    A first point at time 0 must be where the robot is, within tolerance; a moving joint may be off
    by another 0.1 s of way. A quintic smooths out the rest of the step and, if the robot moves, the
    differences in velocity and acceleration; it takes as long as the limits of acceleration and
    jerk require. All three are then continuous, except the acceleration if the limits of position
    and velocity leave no room. A trajectory that begins at rest and needs the acceleration for
    itself begins later by that time.

    A first point later than 0 is reached from the present state as any point from the one before:
    linearly, or by a cubic or quintic if it has velocities and accelerations.

    A joint whose column is NaN stays where it is; whole turns to the first point are removed for
    continuous joints. Of a late trajectory (s) points before now are dropped, and of the next 0.1 s
    those that cannot be reached in time, if there is one after them that can. The curve begins at t
    = 0, now, and goes on at the end until the robot has braked; it is within the limits of position
    and velocity.

    Raises
    ------
    StartMismatchError
        The start is farther from the present position than allowed.
    TrajectoryOverError
        The trajectory has ended already.
    LimitExceededError
        A position or velocity limit would be exceeded, on the points or between them.
    """
    remaining = _remaining(completed(waypoints, present), present, joints, late)
    positions = _turned(remaining, present, joints, start_tolerance)
    if remaining.times[0] <= 0.0:
        curve = interpolant(
            remaining.times, positions, remaining.velocities, remaining.accelerations
        )
    else:
        curve = approached(remaining, positions, present)
    velocities = remaining.velocities
    if velocities is not None:
        curve = with_braking(curve, velocities[-1], joints)
    apart = present - paced_state(curve.sample(0.0), 1.0, 0.0)
    step, kick, push = apart.position, apart.velocity, apart.acceleration
    standing = bool(np.max(np.abs(present.velocity)) <= STANDING)
    if standing or remaining.times[0] > 0.0:
        push = np.zeros_like(push)
    if standing and (velocities is None or np.isnan(velocities[0]).any()):
        kick = np.zeros_like(kick)
    return _smoothed(curve, (step, kick, push), joints, float(remaining.times[0]))


def join_in_steps(
    waypoints: Waypoints, present: State, joints: Joints, start_tolerance: float, late: float = 0.0
) -> PiecewisePolynomial:
    """Make the curve of a trajectory that is not interpolated: one point at a time.

    As with ros2_control's ``interpolation_method: none`` the joints stay where they are until a
    first point later than now, and between two points the second is commanded.  Velocities and
    accelerations do not matter.  What the joints would do between the points is refused as by
    `join`; parameters and errors are those of `join`.
    """
    named = completed(Waypoints(waypoints.times, waypoints.positions), present)
    remaining = _remaining(named, present, joints, late)
    positions = _turned(remaining, present, joints, start_tolerance)
    times, commanded = remaining.times, np.vstack([positions[1:], positions[-1:]])
    if times[0] > 0.0:
        positions = np.vstack([present.position, positions])
        times, commanded = np.append(0.0, times), np.vstack([present.position, commanded])
    violation = violation_of(interpolant(times, positions), joints)
    if violation is not None:
        raise _refusal(violation, float(remaining.times[0]))
    return PiecewisePolynomial(np.append(times, times[-1] + _INSTANT), commanded[None])


def _turned(waypoints: Waypoints, present: State, joints: Joints, start_tolerance: float) -> Array:
    """Take whole turns off the positions, and require a first point at time 0 to be near."""
    positions = without_turns(waypoints.positions, present, joints)
    if waypoints.times[0] <= 0.0:
        _require_near(positions[0], present, joints, start_tolerance)
    return positions


def without_turns(positions: Array, present: State, joints: Joints) -> Array:
    """Move continuous joints by the whole turns that bring the first point near the present."""
    turns = np.round((present.position - positions[0]) / math.tau)
    return positions + np.where(joints.continuous, turns * math.tau, 0.0)


def completed(waypoints: Waypoints, present: State) -> Waypoints:
    """Add the unnamed joints to the trajectory, at their present positions."""
    missing = np.isnan(waypoints.positions[0])
    if not missing.any():
        return waypoints
    positions = np.where(missing, present.position, waypoints.positions)
    rates = (_stilled(rate, missing) for rate in (waypoints.velocities, waypoints.accelerations))
    return Waypoints(waypoints.times, positions, *rates)


def _stilled(rate: Array | None, missing: BoolArray) -> Array | None:
    """Fill the columns of missing joints with 0 in those rows that have numbers at all."""
    if rate is None:
        return None
    there = ~np.all(np.isnan(rate), axis=1, keepdims=True)
    return np.where(missing & there, 0.0, rate)


def _remaining(waypoints: Waypoints, present: State, joints: Joints, late: float) -> Waypoints:
    """Drop what should have happened before now, and what cannot be reached in time."""
    if late <= 0.0:
        return waypoints
    over = int(np.searchsorted(waypoints.times, late + _INSTANT, side="right"))
    if over == len(waypoints.times):
        raise TrajectoryOverError(late, waypoints.times[-1])
    left = waypoints.part(slice(over, None))
    left = replace(left, times=left.times - late)
    near = int(np.searchsorted(left.times, LATENCY, side="right"))
    for k in range(min(_PASSED_OVER, near)):
        point = left.part(slice(k, k + 1))
        place = _turned(point, present, joints, 0.0)
        if violation_of(approached(point, place, present), joints) is None:
            return left.part(slice(k, None))
        if violation_of(interpolant([0.0], place), joints) is not None:
            break  # Nobody should be there at any time.
    return left


def _require_near(start: Array, present: State, joints: Joints, tolerance: float) -> None:
    allowed = tolerance + LATENCY * np.abs(present.velocity)
    excess = np.abs(start - present.position) - allowed
    worst = int(np.argmax(excess))
    if excess[worst] > 0.0:
        raise StartMismatchError(
            joints.names[worst],
            start[worst],
            present.position[worst],
            allowed[worst],
            joints.limits.units[worst],
        )


def _smoothed(
    curve: PiecewisePolynomial, offset: tuple[Array, Array, Array], joints: Joints, first: float
) -> PiecewisePolynomial:
    """Smooth out the offset at the start, in a time that keeps the limits.

    Those of acceleration and jerk are kept if that is possible; a planned motion that is over them
    anyway is followed as it is.
    """
    step, kick, push = offset
    violation = violation_of(curve, joints)
    if violation is not None:
        raise _refusal(violation, first)
    if max(np.max(np.abs(part)) for part in offset) <= NO_STEP:
        return curve
    time = fading_time(step, kick, push, joints)
    # Its limit, or what is planned or there already.
    here = np.abs(curve.sample(0.0).acceleration + push)
    acceleration = np.maximum(joints.acceleration, np.maximum(peaks(curve, 2), here))
    jerk = np.maximum(joints.limits.jerk, peaks(curve, 3))
    found, best = list[Violation](), None
    for candidate in _candidates(curve, offset, time):
        violation = violation_of(candidate, joints)
        if violation is not None:
            found.append(violation)
            continue
        over = peaks(candidate, 2) / acceleration, peaks(candidate, 3) / jerk
        excess = float(np.max(over))
        if excess <= 1.0 + _SLACK:
            return candidate
        if best is None or excess < best[0]:
            best = excess, candidate
    if best is not None:
        return best[1]
    if push.any():
        # A robot that still accelerates at its speed limit can only step to the plan.
        return _smoothed(curve, (step, kick, np.zeros_like(push)), joints, first)
    raise _refusal(found[0], max(first, time))


def _candidates(
    curve: PiecewisePolynomial, offset: tuple[Array, Array, Array], time: float
) -> Iterator[PiecewisePolynomial]:
    """Smooth out the offset in several times, then before the trajectory begins if it can wait."""
    for stretch in _STRETCHES:
        yield with_fading(curve, offset, stretch * time)
    if np.max(np.abs(curve.sample(0.0).velocity)) <= STANDING:
        step, kick, push = offset
        # The curve waits without the acceleration that it begins with.
        waiting = step, kick, push + curve.sample(0.0).acceleration
        for stretch in _STRETCHES[:3]:
            yield with_fading(delayed(curve, stretch * time), waiting, stretch * time)


def violation_of(curve: PiecewisePolynomial, joints: Joints) -> Violation | None:
    """Find where a curve leaves the limits of position and velocity first."""
    return first_violation(
        curve, joints.limits, from_zero=False, to_rest=False, rates=("velocity",)
    )


def _refusal(violation: Violation, joined: float) -> LimitExceededError:
    what = f"at t = {violation.time:.6g} s the {violation.what}"
    if violation.time < joined:
        what = f"on the way from the present state, {what}"
    return LimitExceededError(
        what, violation.joint, violation.value, violation.limit, violation.unit
    )
