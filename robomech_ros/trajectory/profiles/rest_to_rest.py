"""Motions from rest to rest on a straight line in joint space, along one of the book's laws.

References
----------
J. Angeles, *Fundamentals of Robotic Mechanical Systems*, 4th ed., sections 6.3, 6.4 and 6.6.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar, TypeVar

import numpy as np

from robomech_ros._kernels.compiling.jit import direct
from robomech_ros._kernels.timing import straight as time_straight
from robomech_ros.errors import WrongSizeError
from robomech_ros.spatial.arrays import LARGEST, real_array, real_within
from robomech_ros.trajectory.curves.compiled_sampling import sample_many
from robomech_ros.trajectory.curves.motion_to_rest import settled
from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial
from robomech_ros.trajectory.joint_points import check_numbers, joint_values
from robomech_ros.trajectory.limits import RATES, Limits, Rate
from robomech_ros.trajectory.profiles.laws import CUBIC, CYCLOIDAL, POLY345, POLY4567, Law
from robomech_ros.trajectory.profiles.straight_motion import StraightMotion
from robomech_ros.trajectory.sample import Sample, checked_times, held_outside
from robomech_ros.trajectory.tolerances import SHORTEST_TRAJECTORY
from robomech_ros.typing import Array, ArrayLike

_M = TypeVar("_M", bound="RestToRest")

_shortest_duration = direct(time_straight.shortest_duration)


@dataclass(frozen=True, eq=False)
class RestToRest(StraightMotion):
    r"""From rest to rest from a start (n,) to a goal (n,), rad or m, all joints together, in T (s).

    .. math:: q(t) = q_0 + (q_1 - q_0) s(t / T)

    The joints keep the ratio of their displacements, so that the path is a straight line in joint
    space.
    """

    start: Array
    goal: Array
    duration: float

    def __init__(self, start: ArrayLike, goal: ArrayLike, duration: float) -> None:
        first = real_array("start", start).copy()
        if first.ndim != 1 or not first.size:
            raise WrongSizeError("start", first.shape, "(n,)")
        last = joint_values("goal", goal, first.shape)
        check_numbers("start", first)
        check_numbers("goal", last)
        expected = f"{SHORTEST_TRAJECTORY:g} s or more, and finite"
        lasting = real_within("duration", duration, expected, SHORTEST_TRAJECTORY, LARGEST)
        self._set(first, last, lasting)

    def _set(self, start: Array, goal: Array, duration: float) -> None:
        # The initialisation of a frozen dataclass takes a sixth of the time of a plan.
        fields = self.__dict__
        fields["start"], fields["goal"], fields["duration"] = start, goal, duration

    LAW: ClassVar[Law]

    @classmethod
    def _fastest(cls, start: Array, goal: Array, limits: Limits) -> tuple[float, None]:
        velocity, acceleration, jerk = cls.LAW.magnitudes
        least = _shortest_duration(start, goal, limits.inverses, velocity, acceleration, jerk)
        return least, None

    @classmethod
    def _binding(cls, start: Array, goal: Array, limits: Limits) -> tuple[Rate, int]:
        shares = np.abs(goal - start) * limits.inverses * np.array(cls.LAW.magnitudes)[:, None]
        needed = shares ** (1.0 / np.arange(1.0, 4.0))[:, None]
        order, joint = np.unravel_index(int(np.argmax(needed)), needed.shape)
        return RATES[order], int(joint)

    @classmethod
    def _lasting(cls: type[_M], start: Array, goal: Array, duration: float, shape: None) -> _M:
        # A plan has checked them.
        motion = cls.__new__(cls)
        motion._set(start, goal, duration)
        return motion

    def sample(self, t: ArrayLike) -> Sample:
        """Sample positions and derivatives, (n,) or (m, n), at instants (s), () or (m,).

        Before 0 the joints rest at the start, after T at the goal.
        """
        return settled(sample_many(self.pieces, t), t, self.pieces, self.goal)

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
    r"""Along the 3-4-5 polynomial: the lowest accelerations, and steps of the jerk at the ends.

    .. math:: s(\tau) = 6 \tau^5 - 15 \tau^4 + 10 \tau^3

    Largest rates: :math:`s' = 15/8` in the middle, :math:`s'' = 10\sqrt3/3` at
    :math:`\tau = 1/2 \mp \sqrt3/6`, and :math:`s''' = 60` at both ends.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 6.3.1.

    Examples
    --------
    >>> from robomech_ros.trajectory import Limits, point_to_point
    >>> limits = Limits(["lift"], velocity=1.0, acceleration=4.0)
    >>> motion = point_to_point([0.0], [1.0], limits=limits, profile="poly345", duration=2.0)
    >>> type(motion).__name__, motion.sample(0.5).position.round(6)
    ('Polynomial345', array([0.103516]))
    """

    LAW = POLY345


class Polynomial4567(RestToRest):
    r"""Along the 4-5-6-7 polynomial, whose jerk vanishes at both ends, too.

    .. math:: s(\tau) = -20 \tau^7 + 70 \tau^6 - 84 \tau^5 + 35 \tau^4

    Largest rates: :math:`s' = 35/16` in the middle, :math:`s'' = 84\sqrt5/25` at
    :math:`\tau = 1/2 \mp \sqrt5/10`, and :math:`|s'''| = 105/2` in the middle.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 6.3.2.
    """

    LAW = POLY4567


class Cycloidal(RestToRest):
    r"""Along the cycloidal motion: uniform, less one turn of a wheel.

    .. math:: s(\tau) = \tau - \frac{1}{2\pi} \sin 2\pi\tau

    Largest rates: :math:`s' = 2` in the middle, :math:`s'' = 2\pi` at a quarter, and
    :math:`|s'''| = 4\pi^2` at both ends and in the middle.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 6.4.
    """

    LAW = CYCLOIDAL

    def sample(self, t: ArrayLike) -> Sample:
        """Sample as other motions, but along the sine itself: the pieces only come near it."""
        times, rise = checked_times(t), self.goal - self.start
        inside = np.clip(times, 0.0, self.duration)
        rates = self.LAW.rates((inside / self.duration)[..., None])
        scaled = [rise / self.duration**order * rate for order, rate in enumerate(rates, 1)]
        return held_outside(Sample(super().sample(t).position, *scaled), inside != times)


class CubicSplineMotion(RestToRest):
    """Along the cubic spline through both points, at rest at its ends: the jerk steps inside."""

    LAW = CUBIC
