"""Onto a curve where the robot nearly is already: the step at the start is smoothed out.

A robot that lags behind a curve at its largest speed cannot catch up.  It follows the curve later
then, and if it is slower, at a lower pace at first.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from robomech_ros.errors import LimitExceededError
from robomech_ros.execution.joints import Joints, State
from robomech_ros.execution.smoothing import fading_time, rest_of, with_fading
from robomech_ros.trajectory.piecewise import PiecewisePolynomial
from robomech_ros.trajectory.sample import FloatArray
from robomech_ros.trajectory.verification import Violation, first_violation

__all__ = ["LATENCY", "STANDING", "Joined", "entered", "refusal", "smoothed", "violation_of"]

# A moving joint may be off the start by the way it covers in this time (s): the client has seen
# the joint states some time ago.  By as much may a curve be followed later.
LATENCY = 0.1
# A start off by less than this (rad, m and per s) is no step that would have to be smoothed.
NO_STEP = 1e-9
# A velocity below this (rad/s, m/s) counts as standing: the robot then follows a trajectory
# without velocities as it is given, corners included, as ros2_control does.
STANDING = 1e-6
# Times that are tried one after the other, in units of the one in which the smoothing takes half
# the acceleration limit.
_STRETCHES = (1.0, 2.0, 4.0, 0.5)
# Parts of its limit: a slower joint can catch up for sure, a faster one than the other cannot.
_SLOW, _FULL = 0.1, 0.9
# A robot that is faster than a curve on its way to the largest speed must be ahead for as long as
# the curve takes to get there: by a least time (s), and by this part of the way that the difference
# makes in the time of smoothing.  Multiples are tried.
_LEAST, _PART = 2.5e-4, 0.4
_MULTIPLES = (0.0, 1.0, 2.0, 4.0, 8.0)


class Joined(NamedTuple):
    """How a robot joins a trajectory.

    Attributes
    ----------
    curve : PiecewisePolynomial
        From t = 0, now, on.
    pace : float
        With which a robot that moves follows it at first, above 0 up to 1.
    """

    curve: PiecewisePolynomial
    pace: float = 1.0


def entered(
    curve: PiecewisePolynomial,
    time: float,
    velocity: FloatArray,
    present: State,
    joints: Joints,
    *,
    corners: bool,
) -> Joined:
    """Follow a curve from a time (s) on, from where the robot is.

    Parameters
    ----------
    curve : PiecewisePolynomial
        Of n joints.
    time : float
        On its clock, before its end (s).
    velocity : ndarray, shape (n,)
        With which the curve goes on to its first break (rad/s or m/s).
    present : State
        Where the robot is.
    joints : Joints
        Limits.
    corners : bool
        Whether a robot that stands begins to move at once, as on a curve of straight lines.

    Raises
    ------
    LimitExceededError
        A limit of position or velocity would be exceeded.
    """
    begin = rest_of(curve, time, velocity)
    step, kick = _off(begin, present)
    if corners:
        kick = np.where(np.max(np.abs(present.velocity)) <= STANDING, 0.0, kick)

    def later() -> Joined | None:
        rests = (
            rest_of(curve, time - delay, velocity) for delay in _delays(begin, present, joints)
        )
        tried = (_followed_later(rest, present, joints) for rest in rests)
        return next((joined for joined in tried if joined is not None), None)

    # What is caught up with in the end of a stream's message never is: the next one replaces it.
    joined = later() if _at_full_speed(begin, step, joints) else None
    if joined is not None:
        return joined
    try:
        return Joined(smoothed(begin, step, kick, joints, 0.0))
    except LimitExceededError:
        joined = later()
        if joined is None:
            raise
        return joined


def _off(curve: PiecewisePolynomial, present: State) -> tuple[FloatArray, FloatArray]:
    """Give how far the robot is from the start of a curve, and how much faster it is."""
    start = curve.sample(0.0)
    return present.position - start.position, present.velocity - start.velocity


def _at_full_speed(curve: PiecewisePolynomial, step: FloatArray, joints: Joints) -> bool:
    """Say whether a robot is behind a curve that leaves no speed to catch up."""
    speed = curve.sample(0.0).velocity
    full = np.abs(speed) > _FULL * joints.limits.velocity
    return bool((full & (step * speed < 0.0)).any())


def _fast(speed: FloatArray, joints: Joints) -> npt.NDArray[np.bool_]:
    limit = joints.limits.velocity
    fast: npt.NDArray[np.bool_] = np.abs(speed) > _SLOW * limit
    return fast


def _delays(curve: PiecewisePolynomial, present: State, joints: Joints) -> Iterator[float]:
    """Give by how much later (s) a curve can be tried that a robot cannot catch up with."""
    speed = curve.sample(0.0).velocity
    fast = _fast(speed, joints)
    if not fast.any():
        return
    step, kick = _off(curve, present)
    behind = max(float(np.max(-step[fast] / speed[fast])), 0.0)
    faster = max(float(np.max(kick[fast] / speed[fast])), 0.0)
    more = _LEAST + _PART * faster * fading_time(step + behind * speed, kick, joints)
    delays = (min(behind + multiple * more, LATENCY) for multiple in _MULTIPLES)
    yield from dict.fromkeys(delay for delay in delays if delay > 0.0)


def _followed_later(curve: PiecewisePolynomial, present: State, joints: Joints) -> Joined | None:
    """Follow a curve from its start on, at the pace that the robot has; None beyond limits."""
    speed = curve.sample(0.0).velocity
    fast = _fast(speed, joints)
    pace = float(np.min(present.velocity[fast] / speed[fast], initial=1.0))
    if not pace > _SLOW:
        return None
    step = present.position - curve.sample(0.0).position
    kick = present.velocity / pace - speed
    try:
        return Joined(smoothed(curve, step, kick, joints, 0.0), pace)
    except LimitExceededError:
        return None


def smoothed(
    curve: PiecewisePolynomial, step: FloatArray, kick: FloatArray, joints: Joints, first: float
) -> PiecewisePolynomial:
    """Smooth out the step at the start, in a time that keeps the limits.

    Parameters
    ----------
    curve : PiecewisePolynomial
        Of n joints, from time 0 on.
    step, kick : ndarray, shape (n,)
        How far the robot is from its start, and how much faster (rad or m, and per s).
    joints : Joints
        Limits.
    first : float
        When the robot is on the trajectory itself, for the text of the error (s).

    Raises
    ------
    LimitExceededError
        A limit of position or velocity would be exceeded.
    """
    violation = violation_of(curve, joints)
    if violation is not None:
        raise refusal(violation, first)
    if max(np.max(np.abs(step)), np.max(np.abs(kick))) <= NO_STEP:
        return curve
    time = fading_time(step, kick, joints)
    found = None
    for stretch in _STRETCHES:
        candidate = with_fading(curve, step, kick, stretch * time)
        violation = violation_of(candidate, joints)
        if violation is None:
            return candidate
        found = found or violation
    assert found is not None
    raise refusal(found, max(first, time))


def violation_of(curve: PiecewisePolynomial, joints: Joints) -> Violation | None:
    """Find where a curve first exceeds a limit of position or velocity."""
    return first_violation(
        curve, joints.limits, from_zero=False, to_rest=False, rates=("velocity",)
    )


def refusal(violation: Violation, joined: float) -> LimitExceededError:
    """Make the error; what is wrong before the robot has joined (s) is on the way there."""
    what = f"at t = {violation.time:.6g} s the {violation.what}"
    if violation.time < joined:
        what = f"on the way from the present state, {what}"
    return LimitExceededError(what, violation.joint, violation.value, violation.limit)
