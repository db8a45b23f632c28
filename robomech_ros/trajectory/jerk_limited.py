"""Time-optimal motion within velocity, acceleration and jerk limits, computed by Ruckig."""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from robomech_ros._kernels import tolerances
from robomech_ros.errors import DurationTooShortError, LimitExceededError
from robomech_ros.trajectory.bounds import extremes
from robomech_ros.trajectory.interpolation import interpolant
from robomech_ros.trajectory.limits import RATES, Limits, Rate
from robomech_ros.trajectory.motion_to_rest import MotionToRest, check_positions
from robomech_ros.trajectory.piecewise import PiecewisePolynomial
from robomech_ros.trajectory.ruckig_phases import Phases, jerk_phases
from robomech_ros.trajectory.sample import FloatArray

__all__ = ["JerkLimited", "curve_of"]


@dataclass(frozen=True, eq=False)
class JerkLimited(MotionToRest):
    """Piecewise constant jerk, all joints arriving together, at rest.

    From rest every joint whose limits permit it follows the course of the slowest one, so that
    the path is as straight as can be; that costs no time.  A wanted duration slows the fastest
    motion down as a whole; from a moving start it is left to Ruckig.
    The breaks of its pieces are the steps of the jerk of any joint.
    """

    REQUIRED: ClassVar[tuple[Rate, ...]] = RATES
    STARTS_MOVING: ClassVar[bool] = True
    ACCELERATION_STEPS: ClassVar[bool] = False

    @classmethod
    def plan(
        cls,
        start: FloatArray,
        goal: FloatArray,
        limits: Limits,
        duration: float | None = None,
        start_velocity: FloatArray | None = None,
        start_acceleration: FloatArray | None = None,
    ) -> "JerkLimited":
        """Compute the fastest motion, or one that takes a wanted time.

        Parameters
        ----------
        start, goal : ndarray, shape (n,)
            Joint values in rad or m; the goal is reached at rest.
        limits : Limits
            Velocity, acceleration and jerk limits of every joint.
        duration : float, optional
            Wanted duration in s; None for the shortest.
        start_velocity, start_acceleration : ndarray, shape (n,), optional
            Rates at the start, rad or m over s and s^2; rest where not given.

        Raises
        ------
        DurationTooShortError
            If the wanted duration would break a limit.
        LimitExceededError
            If the start is faster than the limits, or the motion overshoots a position limit.
        BadValueError
            If Ruckig fails.
        """
        rest = np.zeros(len(start))
        velocity = rest if start_velocity is None else start_velocity
        acceleration = rest if start_acceleration is None else start_acceleration
        _check_moving_start(limits, velocity, acceleration)
        least = tolerances.SHORTEST_TRAJECTORY
        moving = bool(velocity.any() or acceleration.any())
        if moving and duration is not None:
            least = max(least, duration)
        phases = jerk_phases(goal - start, velocity, acceleration, limits, least)
        planned = cls(goal, curve_of(phases, start, goal, rest))
        if duration is not None:
            planned._check_duration(duration, phases.alone, limits)
            if not moving and duration > planned.duration:
                slow = phases.slowed(duration / planned.duration)
                planned = cls(goal, curve_of(slow, start, goal, rest))
        check_positions(planned.pieces, start, limits)
        return planned

    def _check_duration(self, wanted: float, alone: FloatArray, limits: Limits) -> None:
        """Refuse where Ruckig needed longer than wanted."""
        slack = tolerances.DURATION_ROUNDING * (1.0 + wanted)
        if self.duration <= max(wanted, tolerances.SHORTEST_TRAJECTORY) + slack:
            return
        joint = int(np.argmax(alone))
        binding = []
        for order, rate in enumerate(RATES, start=1):
            low, high = extremes(self.pieces, order)
            peak = max(-low[joint], high[joint])
            if peak > (1.0 - tolerances.LIMIT_SLACK) * getattr(limits, rate)[joint]:
                binding.append(rate)
        names = " and ".join(binding) or "jerk"
        raise DurationTooShortError(wanted, self.duration, limits.joint_names[joint], names)


def _check_moving_start(limits: Limits, velocity: FloatArray, acceleration: FloatArray) -> None:
    for rate, values in (("velocity", velocity), ("acceleration", acceleration)):
        bound = getattr(limits, rate)
        over = np.flatnonzero(np.abs(values) > bound * (1.0 + tolerances.LIMIT_SLACK))
        if len(over):
            k = int(over[0])
            raise LimitExceededError(
                f"start {rate}", limits.joint_names[k], float(values[k]), float(bound[k])
            )


def curve_of(
    phases: Phases, start: FloatArray, goal: FloatArray, final_velocity: FloatArray
) -> PiecewisePolynomial:
    """Let the phases begin at the start and end at the goal exactly.

    Ruckig misses it by a part in 1e8 of the way at most.  What is missing is made up by a quintic
    over the whole duration, where it is nothing; in the last step alone it would be a jump of
    the jerk.
    """
    breaks = phases.breaks
    end = PiecewisePolynomial(breaks, phases.coefficients).sample(breaks[-1])
    none = np.zeros_like(goal)
    missing = np.stack([none, goal - start - end.position])
    # At rest the next piece does not go on with what rounding has left of the velocity.
    faster = np.stack([none, final_velocity - end.velocity if final_velocity.any() else none])
    unchanged = np.zeros_like(missing)
    quintic = interpolant(breaks[[0, -1]], missing, faster, unchanged).coefficients[:, 0]
    coefficients = np.zeros((6, *phases.coefficients.shape[1:]))
    coefficients[:4] = phases.coefficients
    coefficients[0] += start
    for power in range(6):
        for lower in range(power + 1):
            shifted = math.comb(power, lower) * breaks[:-1] ** (power - lower)
            coefficients[lower] += np.outer(shifted, quintic[power])
    return PiecewisePolynomial(breaks, coefficients)
