"""Motions from rest to rest on a straight line in joint space, along one of the book's laws.

References
----------
J. Angeles, *Fundamentals of Robotic Mechanical Systems*, 4th ed., sections 6.3 and 6.4.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np
import numpy.typing as npt

from robomech_ros._kernels import time_straight, tolerances
from robomech_ros.errors import DurationTooShortError
from robomech_ros.trajectory.laws import CYCLOIDAL, POLY345, POLY4567, Law
from robomech_ros.trajectory.limits import RATES, Limits, Rate
from robomech_ros.trajectory.piecewise import PiecewisePolynomial
from robomech_ros.trajectory.sample import FloatArray, Sample, checked_times, held_outside

__all__ = ["Cycloidal", "Polynomial345", "Polynomial4567", "RestToRest"]


@dataclass(frozen=True, eq=False)
class RestToRest:
    r"""From rest to rest, all joints together.

    .. math:: q(t) = q_0 + (q_1 - q_0) s(t / T)

    The joints keep the ratio of their displacements, so that the path is a straight line in joint
    space.

    Attributes
    ----------
    start, goal : ndarray, shape (n,)
        Joint values in rad or m.
    duration : float
        T in s.
    """

    start: FloatArray
    goal: FloatArray
    duration: float

    def __init__(self, start: FloatArray, goal: FloatArray, duration: float) -> None:
        # What a frozen dataclass does for this takes a sixth of the time of a whole plan.
        vars(self).update(start=start, goal=goal, duration=duration)

    LAW: ClassVar[Law]
    REQUIRED: ClassVar[tuple[Rate, ...]] = ("velocity", "acceleration")
    STARTS_MOVING: ClassVar[bool] = False
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
    ) -> "RestToRest":
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
            The motion starts from rest.

        Raises
        ------
        DurationTooShortError
            If the wanted duration would break a limit.
        """
        least = time_straight.shortest_duration(start, goal, limits.inverses, *cls.LAW.magnitudes)
        shortest = max(least, tolerances.SHORTEST_TRAJECTORY)
        if duration is not None:
            slack = tolerances.DURATION_ROUNDING * (1.0 + shortest)
            if duration < shortest - slack and least > duration:
                rate, joint = cls._binding(np.abs(goal - start), limits)
                raise DurationTooShortError(duration, shortest, joint, rate)
            shortest = max(shortest, duration)
        return cls(start, goal, shortest)

    @classmethod
    def _binding(cls, way: FloatArray, limits: Limits) -> tuple[Rate, str]:
        """Find which limit of which joint makes ways (n,) take longest."""
        shares = way * limits.inverses * np.array(cls.LAW.magnitudes)[:, None]
        needed = shares ** (1.0 / np.arange(1.0, 4.0))[:, None]
        order, joint = np.unravel_index(int(np.argmax(needed)), needed.shape)
        return RATES[order], limits.joint_names[joint]

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
            tau < 0.5,
            self.start + rise * self.LAW.progress(tau),
            self.goal - rise * self.LAW.progress(rest),
        )
        rates = self.LAW.rates(tau)
        scaled = [rise / self.duration**order * rate for order, rate in enumerate(rates, 1)]
        return held_outside(Sample(position, *scaled), inside != times)

    @cached_property
    def pieces(self) -> PiecewisePolynomial:
        """The same curve in powers of t; its breaks are where the jerk may step."""
        law, duration = self.LAW.pieces, self.duration
        if (self.goal == self.start).all():
            return PiecewisePolynomial(np.array([0.0, duration]), self.start[None, None])
        powers = duration ** np.arange(len(law.coefficients))
        coefficients = law.coefficients / powers[:, None, None] * (self.goal - self.start)
        coefficients[0] += self.start
        return PiecewisePolynomial(law.breaks * duration, coefficients)


class Polynomial345(RestToRest):
    """Along the 3-4-5 polynomial: the lowest accelerations, and steps of the jerk at the ends."""

    LAW = POLY345


class Polynomial4567(RestToRest):
    """Along the 4-5-6-7 polynomial, whose jerk vanishes at both ends, too."""

    LAW = POLY4567


class Cycloidal(RestToRest):
    """Along the cycloidal motion: uniform, less one turn of a wheel."""

    LAW = CYCLOIDAL
