"""Velocity profiles in closed form: trapezoidal, and double-S with bounded jerk.

All joints move together on a straight line in joint space.

References
----------
L. Biagiotti and C. Melchiorri, *Trajectory Planning for Automatic Machines and Robots*, Springer
2008, sections 3.2 and 3.4.
"""

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from robomech_ros._kernels import tolerances
from robomech_ros.errors import DurationTooShortError
from robomech_ros.trajectory.limits import Limits, Rate
from robomech_ros.trajectory.motion_to_rest import MotionToRest
from robomech_ros.trajectory.piecewise import PiecewisePolynomial
from robomech_ros.trajectory.sample import FloatArray

__all__ = ["DoubleS", "Trapezoidal", "unit_double_s", "unit_double_s_samples"]

# Durations of phases, and the highest derivative (of order 2 or 3) in each.
Phases = list[tuple[float, float]]


@dataclass(frozen=True, eq=False)
class _Straight(MotionToRest, ABC):
    """From rest to rest on a straight line, in phases in which one derivative is constant."""

    REQUIRED: ClassVar[tuple[Rate, ...]]
    STARTS_MOVING: ClassVar[bool] = False
    ACCELERATION_STEPS: ClassVar[bool] = False

    @staticmethod
    @abstractmethod
    def phases(*rates: float) -> tuple[Phases, Rate]:
        """Give the phases over a way of 1 within limits of its rates, and which limit binds."""

    @classmethod
    def plan(
        cls,
        start: FloatArray,
        goal: FloatArray,
        limits: Limits,
        duration: float | None = None,
        start_velocity: FloatArray | None = None,
        start_acceleration: FloatArray | None = None,
    ) -> "_Straight":
        """Compute the fastest motion within the limits, slowed down as a whole where wanted.

        Parameters
        ----------
        start, goal : ndarray, shape (n,)
            Joint values in rad or m.
        limits : Limits
            Those of ``REQUIRED`` count.
        duration : float, optional
            Wanted duration in s; None for the shortest.
        start_velocity, start_acceleration : None
            The motion starts from rest.

        Raises
        ------
        DurationTooShortError
            If the wanted duration would break a limit.
        """
        rise = goal - start
        way = np.abs(rise)
        if not way.any():
            still = max(duration or 0.0, tolerances.SHORTEST_TRAJECTORY)
            return cls(goal, _curve(start, rise, [(still, 0.0)], len(cls.REQUIRED)))
        moving = np.flatnonzero(way)
        scaled = {rate: getattr(limits, rate)[moving] / way[moving] for rate in cls.REQUIRED}
        phases, binding = cls.phases(*(float(values.min()) for values in scaled.values()))
        shortest = sum(length for length, _ in phases)
        wanted = max(shortest, tolerances.SHORTEST_TRAJECTORY)
        if duration is not None:
            if duration < wanted - tolerances.DURATION_ROUNDING * (1.0 + wanted):
                joint = limits.joint_names[moving[int(np.argmin(scaled[binding]))]]
                raise DurationTooShortError(duration, wanted, joint, binding)
            wanted = max(wanted, duration)
        order, slower = len(cls.REQUIRED), wanted / shortest
        slow = [(length * slower, value / slower**order) for length, value in phases]
        return cls(goal, _curve(start, rise, slow, order))


class Trapezoidal(_Straight):
    """Constant acceleration, constant velocity, constant deceleration.

    The acceleration steps, so that a limit of the jerk is not kept.
    """

    REQUIRED: ClassVar[tuple[Rate, ...]] = ("velocity", "acceleration")
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
            ramp = 0.5 * step + math.sqrt(0.25 * step**2 + 1.0 / acceleration)
            if ramp < 2.0 * step:
                step, binding = (0.5 / jerk) ** (1.0 / 3.0), "jerk"
                ramp = 2.0 * step
        even = ramp - 2.0 * step
        up = [(step, jerk), (even, 0.0), (step, -jerk)]
        down = [(step, -jerk), (even, 0.0), (step, jerk)]
        return [phase for phase in [*up, (cruise, 0.0), *down] if phase[0] > 0.0], binding


def unit_double_s(ramp: float, rounding: float) -> PiecewisePolynomial:
    """Give a double-S profile of one joint over a way of 1 in a time of 1.

    Parameters
    ----------
    ramp : float
        Part of the duration in which the speed rises, and in which it falls, up to 1/2.
    rounding : float
        Part of half a ramp in which the jerk acts at each of its ends, above 0 and up to 1.
    """
    lengths, jerks = _unit_phases(np.array([ramp]), np.array([rounding]))
    phases = zip(lengths[0].tolist(), jerks[0].tolist(), strict=True)
    return _curve(np.zeros(1), np.ones(1), [phase for phase in phases if phase[0] > 0.0], 3)


def unit_double_s_samples(
    ramps: FloatArray, roundings: FloatArray, inside: FloatArray
) -> FloatArray:
    """Sample many double-S profiles over a way of 1 in a time of 1.

    Parameters
    ----------
    ramps, roundings : ndarray, shape (k,)
        Of every profile, as for `unit_double_s`.
    inside : ndarray, shape (p,)
        Which parts of each of the seven phases are over.

    Returns
    -------
    ndarray, shape (4, k, 7 p)
        Way, velocity, acceleration, jerk.
    """
    lengths, jerks = _unit_phases(ramps, roundings)
    samples = np.empty((4, *lengths.shape, len(inside)))
    state = np.zeros((3, len(ramps)))
    for phase in range(lengths.shape[1]):
        jerk = jerks[:, phase, None]
        s, v, a = state[:, :, None]
        for t, out in (
            (lengths[:, phase, None] * inside, samples[:, :, phase]),
            (lengths[:, phase, None], state[:, :, None]),
        ):
            rates = (
                s + t * (v + t * (a / 2.0 + t * jerk / 6.0)),
                v + t * (a + t * jerk / 2.0),
                a + t * jerk,
                jerk + 0.0 * t,
            )
            out[:] = np.stack(rates[: len(out)])
    return samples.reshape(4, len(ramps), -1)


def _unit_phases(ramps: FloatArray, roundings: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Give lengths and jerks of the seven phases of profiles over a way and a time of 1."""
    step = 0.5 * ramps * roundings
    jerk = 1.0 / ((1.0 - ramps) * (ramps - step) * step)
    up, none = [step, ramps - 2.0 * step, step], np.zeros_like(jerk)
    lengths = np.stack([*up, 1.0 - 2.0 * ramps, *up], axis=1)
    return lengths, np.stack([jerk, none, -jerk, none, -jerk, none, jerk], axis=1)


def _curve(start: FloatArray, rise: FloatArray, phases: Phases, order: int) -> PiecewisePolynomial:
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
