"""Velocity profiles in closed form: trapezoidal, and double-S with bounded jerk.

All joints move together on a straight line in joint space.

References
----------
L. Biagiotti and C. Melchiorri, *Trajectory Planning for Automatic Machines and Robots*, Springer
2008, sections 3.2 and 3.4.
"""

from __future__ import annotations

import math
from abc import abstractmethod
from typing import ClassVar, TypeVar

import numpy as np

from robomech_ros.trajectory.curves.motion_to_rest import MotionToRest
from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial
from robomech_ros.trajectory.limits import RATES, Limits, Rate
from robomech_ros.trajectory.profiles.straight_motion import StraightMotion
from robomech_ros.trajectory.sample import FloatArray

__all__ = ["DoubleS", "Trapezoidal", "along_line"]

_M = TypeVar("_M", bound="_Straight")

# Durations of phases, and the highest derivative (of order 2 or 3) in each.
Phases = list[tuple[float, float]]


class _Straight(MotionToRest, StraightMotion):
    """From rest to rest on a straight line, in phases in which one derivative is constant."""

    @staticmethod
    @abstractmethod
    def phases(*rates: float) -> tuple[Phases, Rate]:
        """Give the phases over a way of 1 within limits of its rates, and which limit binds."""

    @classmethod
    def _fastest(cls, start: FloatArray, goal: FloatArray, limits: Limits) -> tuple[float, Phases]:
        shares = (np.abs(goal - start) * limits.inverses).max(axis=1, initial=0.0).tolist()
        if not any(shares):
            return 0.0, []
        phases, _ = cls.phases(*(1.0 / share for share in shares[: len(cls.REQUIRED)]))
        return sum(length for length, _ in phases), phases

    @classmethod
    def _binding(cls, start: FloatArray, goal: FloatArray, limits: Limits) -> tuple[Rate, int]:
        shares = np.abs(goal - start) * limits.inverses
        _, rate = cls.phases(*(1.0 / share for share in shares.max(axis=1)[: len(cls.REQUIRED)]))
        return rate, int(np.argmax(shares[RATES.index(rate)]))

    @classmethod
    def _lasting(
        cls: type[_M], start: FloatArray, goal: FloatArray, duration: float, shape: Phases
    ) -> _M:
        order = len(cls.REQUIRED)
        slower = duration / sum(length for length, _ in shape) if shape else 1.0
        slow = [(length * slower, value / slower**order) for length, value in shape]
        return cls(goal, along_line(start, goal - start, slow or [(duration, 0.0)], order))


class Trapezoidal(_Straight):
    """Constant acceleration, constant velocity, constant deceleration.

    The acceleration steps, so that a limit of the jerk is not kept.
    """

    ACCELERATION_STEPS: ClassVar[bool] = True

    @staticmethod
    def phases(*rates: float) -> tuple[Phases, Rate]:
        """Give the phases over a way of 1 within limits of velocity and acceleration."""
        velocity, acceleration = rates
        ramp = velocity / acceleration
        cruise = 1.0 / velocity - ramp
        if cruise <= 0.0:
            ramp = math.sqrt(1.0 / acceleration)
            return [(ramp, acceleration), (ramp, -acceleration)], "acceleration"
        return [(ramp, acceleration), (cruise, 0.0), (ramp, -acceleration)], "velocity"


class DoubleS(_Straight):
    """Seven phases of constant jerk: limits of velocity, acceleration and jerk are kept."""

    REQUIRED: ClassVar[tuple[Rate, ...]] = ("velocity", "acceleration", "jerk")

    @staticmethod
    def phases(*rates: float) -> tuple[Phases, Rate]:
        """Give the phases over a way of 1 within limits of velocity, acceleration and jerk."""
        velocity, acceleration, jerk = rates
        binding: Rate = "velocity"
        step = min(acceleration / jerk, math.sqrt(velocity / jerk))
        ramp = max(step + velocity / (jerk * step), 2.0 * step)
        cruise = 1.0 / velocity - ramp
        if cruise <= 0.0:
            cruise = 0.0
            step, binding = acceleration / jerk, "acceleration"
            ramp = 0.5 * step + math.hypot(0.5 * step, math.sqrt(1.0 / acceleration))
            if ramp < 2.0 * step:
                step, binding = (0.5 / jerk) ** (1.0 / 3.0), "jerk"
                ramp = 2.0 * step
        even = ramp - 2.0 * step
        up = [(step, jerk), (even, 0.0), (step, -jerk)]
        down = [(step, -jerk), (even, 0.0), (step, jerk)]
        return [phase for phase in [*up, (cruise, 0.0), *down] if phase[0] > 0.0], binding


def along_line(
    start: FloatArray, rise: FloatArray, phases: Phases, order: int
) -> PiecewisePolynomial:
    """Integrate a way from 0 to 1 from rest, and lay it on the line from `start` along `rise`."""
    lengths = np.array([length for length, _ in phases])
    taylor = np.zeros((order + 1, len(phases)))
    state = [0.0] * order
    for k, (length, value) in enumerate(phases):
        known = [*state, value]
        taylor[:, k] = [rate / math.factorial(d) for d, rate in enumerate(known)]
        state = [
            sum(rate * length**i / math.factorial(i) for i, rate in enumerate(known[d:]))
            for d in range(order)
        ]
    coefficients = taylor[:, :, None] * rise
    coefficients[0] += start
    return PiecewisePolynomial(np.concatenate([[0.0], np.cumsum(lengths)]), coefficients)
