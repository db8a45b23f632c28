"""The 3-4-5 interpolating polynomial.

References
----------
J. Angeles, *Fundamentals of Robotic Mechanical Systems*, 4th ed., ch. 6 (pick-and-place
trajectories).
"""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np
import numpy.typing as npt

from robomech_ros._kernels import tolerances
from robomech_ros.errors import DurationTooShortError
from robomech_ros.trajectory.limits import RATES, Limits, Rate
from robomech_ros.trajectory.piecewise import PiecewisePolynomial
from robomech_ros.trajectory.sample import FloatArray, Sample, checked_times, held_outside

__all__ = ["Polynomial345"]

# Largest magnitudes of the first three derivatives of s(tau) over 0 <= tau <= 1.
PEAKS: dict[Rate, float] = {
    "velocity": 15.0 / 8.0,
    "acceleration": 10.0 * math.sqrt(3.0) / 3.0,
    "jerk": 60.0,
}


@dataclass(frozen=True, eq=False)
class Polynomial345:
    r"""Rest to rest along the 3-4-5 polynomial, all joints together.

    .. math:: q(t) = q_0 + (q_1 - q_0) s(t / T), \quad s(\tau) = 6\tau^5 - 15\tau^4 + 10\tau^3

    Velocities and accelerations are zero at both ends; the joints keep the ratio of their
    displacements, so that the path is a straight line in joint space.

    Attributes
    ----------
    start, goal : ndarray, shape (n,)
        Joint values in rad or m.
    duration : float
        T in s.

    References
    ----------
    Angeles, 4th ed., ch. 6.
    """

    start: FloatArray
    goal: FloatArray
    duration: float

    REQUIRED: ClassVar[tuple[Rate, ...]] = ("velocity", "acceleration")
    STARTS_MOVING: ClassVar[bool] = False

    @classmethod
    def plan(
        cls,
        start: FloatArray,
        goal: FloatArray,
        limits: Limits,
        duration: float | None = None,
        start_velocity: FloatArray | None = None,
        start_acceleration: FloatArray | None = None,
    ) -> "Polynomial345":
        """Choose the duration: the shortest within the limits, or the one wanted.

        Parameters
        ----------
        start, goal : ndarray, shape (n,)
            Joint values in rad or m.
        limits : Limits
            Velocity and acceleration limits count, and those jerk limits that are finite.
        duration : float, optional
            Wanted duration in s; None for the shortest.
        start_velocity, start_acceleration : None
            The polynomial starts from rest.

        Raises
        ------
        DurationTooShortError
            If the wanted duration would break a limit.
        """
        rise = np.abs(goal - start)
        needed = {
            rate: (PEAKS[rate] * rise / getattr(limits, rate)) ** (1.0 / order)
            for order, rate in enumerate(RATES, start=1)
        }
        rate = max(RATES, key=lambda name: needed[name].max(initial=0.0))
        shortest = max(float(needed[rate].max(initial=0.0)), tolerances.SHORTEST_TRAJECTORY)
        if duration is not None:
            slack = tolerances.DURATION_ROUNDING * (1.0 + shortest)
            if duration < shortest - slack and needed[rate].max(initial=0.0) > duration:
                joint = limits.joint_names[int(np.argmax(needed[rate]))]
                raise DurationTooShortError(duration, shortest, joint, rate)
            shortest = max(shortest, duration)
        return cls(start, goal, shortest)

    def sample(self, t: npt.ArrayLike) -> Sample:
        """Sample positions and derivatives.

        Parameters
        ----------
        t : array_like, shape () or (m,)
            Instants in s; before 0 the joints rest at the start, after T at the goal.

        Returns
        -------
        Sample
            Arrays of shape (n,) or (m, n).

        Raises
        ------
        NonFiniteError
            If an instant is NaN or infinite.
        """
        times = checked_times(t)
        inside = np.clip(times, 0.0, self.duration)
        tau = (inside / self.duration)[..., None]
        rest = 1.0 - tau
        rise = self.goal - self.start
        # The half nearer to an end counts from that end, so that both are met exactly.
        position = np.where(
            tau < 0.5, self.start + rise * _progress(tau), self.goal - rise * _progress(rest)
        )
        velocity = rise / self.duration * (30.0 * (tau * rest) ** 2)
        acceleration = rise / self.duration**2 * (60.0 * tau * rest * (1.0 - 2.0 * tau))
        jerk = rise / self.duration**3 * (60.0 - 360.0 * tau * rest)
        return held_outside(Sample(position, velocity, acceleration, jerk), inside != times)

    @cached_property
    def pieces(self) -> PiecewisePolynomial:
        """The same curve in powers of t; its breaks are where the jerk may step."""
        rise, duration = self.goal - self.start, self.duration
        coefficients = np.zeros((6, 1, len(rise)))
        coefficients[0] = self.start
        for power, factor in ((3, 10.0), (4, -15.0), (5, 6.0)):
            coefficients[power] = factor * rise / duration**power
        return PiecewisePolynomial(np.array([0.0, duration]), coefficients)


def _progress(tau: FloatArray) -> FloatArray:
    return tau**3 * (10.0 + tau * (6.0 * tau - 15.0))
