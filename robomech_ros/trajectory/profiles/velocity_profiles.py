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
from itertools import accumulate
from typing import ClassVar, TypeVar

import numpy as np

from robomech_ros.trajectory.curves.motion_to_rest import MotionToRest
from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial
from robomech_ros.trajectory.limits import RATES, Limits, Rate
from robomech_ros.trajectory.profiles.straight_motion import StraightMotion
from robomech_ros.typing import Array

_M = TypeVar("_M", bound="_Straight")

# How long the phases of a ramp from rest to full speed are, without the last one of a ramp whose
# ends are rounded, which is as long as the first: (ramp,), or (rounding, constant acceleration).
Ramp = tuple[float, ...]


class _Straight(MotionToRest, StraightMotion):
    """From rest to rest on a straight line, in phases in which one derivative is constant."""

    @staticmethod
    @abstractmethod
    def shape(*rates: float) -> tuple[Ramp, float, Rate]:
        """Return ramp, duration and the limit that binds, for a way of 1 within limits of rates."""

    @classmethod
    def _fastest(
        cls, start: Array, goal: Array, limits: Limits
    ) -> tuple[float, tuple[Ramp, float] | None]:
        shares = (np.abs(goal - start) * limits.inverses).max(axis=1, initial=0.0).tolist()
        if not any(shares):
            return 0.0, None
        ramp, duration, _ = cls.shape(*(1.0 / share for share in shares[: len(cls.REQUIRED)]))
        return duration, (ramp, duration)

    @classmethod
    def _binding(cls, start: Array, goal: Array, limits: Limits) -> tuple[Rate, int]:
        shares = np.abs(goal - start) * limits.inverses
        largest = shares.max(axis=1)[: len(cls.REQUIRED)]
        _, _, rate = cls.shape(*(1.0 / share for share in largest))
        return rate, int(np.argmax(shares[RATES.index(rate)]))

    @classmethod
    def _lasting(
        cls: type[_M], start: Array, goal: Array, duration: float, shape: tuple[Ramp, float] | None
    ) -> _M:
        if shape is None:
            return cls(goal, PiecewisePolynomial(np.array([0.0, duration]), start[None, None]))
        ramp, shortest = shape
        slow = tuple(length * (duration / shortest) for length in ramp)
        return cls(goal, along_line(start, goal - start, slow, duration))


class Trapezoidal(_Straight):
    """Constant acceleration, velocity and deceleration, without a limit of jerk."""

    ACCELERATION_STEPS: ClassVar[bool] = True

    @staticmethod
    def shape(*rates: float) -> tuple[Ramp, float, Rate]:
        """Return ramp, duration and the limit that binds, for a way of 1 within limits of rates."""
        velocity, acceleration = rates
        ramp = velocity / acceleration
        cruise = 1.0 / velocity - ramp
        if cruise <= 0.0:
            ramp = math.sqrt(1.0 / acceleration)
            return (ramp,), 2.0 * ramp, "acceleration"
        return (ramp,), 2.0 * ramp + cruise, "velocity"


class DoubleS(_Straight):
    """Seven phases of constant jerk: limits of velocity, acceleration and jerk are kept."""

    REQUIRED: ClassVar[tuple[Rate, ...]] = ("velocity", "acceleration", "jerk")

    @staticmethod
    def shape(*rates: float) -> tuple[Ramp, float, Rate]:
        """Return ramp, duration and the limit that binds, for a way of 1 within limits of rates."""
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
        return (step, ramp - 2.0 * step), 2.0 * ramp + cruise, binding


def along_line(start: Array, rise: Array, ramp: Ramp, duration: float) -> PiecewisePolynomial:
    """Lay a motion from rest to rest over a duration (s) on the line from `start` along `rise`.

    The highest derivative, of an order above the number of phases in `ramp` by one, is constant in
    each phase.  All breaks are whole multiples of the least step of numbers as large as the
    duration, so that phases last exactly as long as their polynomials say, however short they are.
    """
    up, order = _rounded(ramp, duration), len(ramp) + 1
    rising = [0.0, *up, *([sum(up)] if order == 3 else [])]
    breaks = np.array([*rising, *(duration - instant for instant in reversed(rising))])
    value = 1.0 / (math.prod(up) * (duration - sum(up)))
    signs = [1.0, 0.0, -1.0] if order == 2 else [1.0, 0.0, -1.0, 0.0, -1.0, 0.0, 1.0]
    lasting = np.diff(breaks) > 0.0
    lengths = np.diff(breaks)[lasting].tolist()
    taylor = np.zeros((order + 1, len(lengths)))
    state = [0.0] * order
    for k, (length, sign) in enumerate(zip(lengths, np.array(signs)[lasting], strict=True)):
        known = [*state, sign * value]
        taylor[:, k] = [rate / math.factorial(d) for d, rate in enumerate(known)]
        state = [
            sum(rate * length**i / math.factorial(i) for i, rate in enumerate(known[d:]))
            for d in range(order)
        ]
    coefficients = taylor[:, :, None] * rise
    coefficients[0] += start
    return PiecewisePolynomial(np.append(breaks[:-1][lasting], duration), coefficients)


def _rounded(ramp: Ramp, duration: float) -> list[float]:
    """Round the instants of a ramp up, which lowers the derivatives; both ramps must have room."""
    unit = math.ulp(duration)
    half = math.floor(0.5 * duration / unit) * unit
    up = [math.ceil(instant / unit) * unit for instant in accumulate(ramp)]
    if sum(up) > half:
        first = min(up[0], math.floor(half / (len(up) * unit)) * unit)
        up = [first, half - first][: len(up)]
    return up


def unit_double_s(ramp: float, rounding: float) -> PiecewisePolynomial:
    """Return a double-S profile of one joint over a way of 1 in a time of 1.

    `ramp` is the part of the duration in which the speed rises, and in which it falls, up to 1/2;
    `rounding` the part of half a ramp in which the jerk acts at each of its ends, above 0 and up to
    1.
    """
    step = 0.5 * ramp * rounding
    return along_line(np.zeros(1), np.ones(1), (step, ramp - 2.0 * step), 1.0)


def unit_double_s_samples(ramps: Array, roundings: Array, inside: Array) -> Array:
    """Sample k profiles of `unit_double_s`: way, velocity, acceleration and jerk, (4, k, 7 p).

    `inside` (p,) is which parts of each of the seven phases are over.
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


def _unit_phases(ramps: Array, roundings: Array) -> tuple[Array, Array]:
    """Return lengths and jerks of the seven phases of profiles over a way and a time of 1."""
    step = 0.5 * ramps * roundings
    jerk = 1.0 / ((1.0 - ramps) * (ramps - step) * step)
    up, none = [step, ramps - 2.0 * step, step], np.zeros_like(jerk)
    lengths = np.stack([*up, 1.0 - 2.0 * ramps, *up], axis=1)
    return lengths, np.stack([jerk, none, -jerk, none, -jerk, none, jerk], axis=1)
