"""Limits of joints as trajectories see them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Literal, Protocol

import numpy as np

from robomech_ros._kernels.tolerances import LARGEST_LENGTH
from robomech_ros.errors import (
    BadValueError,
    LimitExceededError,
    MissingLimitsError,
    SeedOutsideLimitsError,
    WrongSizeError,
)
from robomech_ros.spatial.arrays import listed, real_array
from robomech_ros.trajectory.tolerances import POSITION_SLACK
from robomech_ros.typing import Array, ArrayLike, BoolArray

Rate = Literal["velocity", "acceleration", "jerk"]
RATES: tuple[Rate, ...] = ("velocity", "acceleration", "jerk")
# Smallest limit of a speed or its derivatives: with less the powers of durations would overflow.
SMALLEST_LIMIT = 1e-12
# Suffixes of the unit of a position for its derivatives.
_PER = ("", "/s", "/s^2", "/s^3")
# Planned within the limits less these parts, samples stay within the limits despite the rounding
# of numbers and of times to nanoseconds.
MARGIN = 1e-7
JERK_MARGIN = 1e-5


class JointLimits(Protocol):
    """Robot limits that a planner reads; a chain model fits, and so does `Limits`."""

    @property
    def joint_names(self) -> Sequence[str]:
        """The joints, in the order of all arrays."""

    @property
    def lower(self) -> ArrayLike:
        """Lowest positions, rad or m, shape (n,)."""

    @property
    def upper(self) -> ArrayLike:
        """Highest positions, rad or m, shape (n,)."""

    @property
    def velocity(self) -> ArrayLike:
        """Largest speeds, rad/s or m/s, shape (n,)."""

    @property
    def acceleration(self) -> ArrayLike:
        """Largest magnitudes of the accelerations, rad/s^2 or m/s^2, shape (n,)."""

    @property
    def jerk(self) -> ArrayLike:
        """Largest magnitudes of the jerks, rad/s^3 or m/s^3, shape (n,)."""


class Tools(list[Any]):
    """A list whose contents are neither copied nor stored with it."""

    def __reduce__(self) -> tuple[type[Tools], tuple[()]]:
        return Tools, ()


@dataclass(frozen=True, eq=False)
class Limits:
    """Limits of n joints; a scalar stands for the same value at every joint.

    Attributes
    ----------
    joint_names : tuple of str
        The joints, in the order of all arrays.
    velocity, acceleration, jerk : ndarray, shape (n,)
        Largest magnitudes in rad or m over s, s^2 and s^3; infinite where there is no limit
        (None and NaN stand for that as well).
    lower, upper : ndarray, shape (n,)
        Position limits, rad or m, infinite where there is none.
    units : tuple of str
        ``"rad"`` or ``"m"`` for each joint, for messages; empty texts where that is not known.

    Raises
    ------
    BadValueError
        If names are no list of different names, a limit is no number, zero (below 1e-12) or
        negative, or a lower position limit lies above the upper one.
    """

    joint_names: tuple[str, ...]
    velocity: Array = None  # type: ignore[assignment]
    acceleration: Array = None  # type: ignore[assignment]
    jerk: Array = None  # type: ignore[assignment]
    lower: Array = None  # type: ignore[assignment]
    upper: Array = None  # type: ignore[assignment]
    units: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "joint_names", _names(self.joint_names))
        object.__setattr__(self, "units", self._checked_units())
        for name in (*RATES, "upper"):
            object.__setattr__(self, name, self._array(name, np.inf))
        object.__setattr__(self, "lower", self._array("lower", -np.inf))
        least = f"> 0, at least {SMALLEST_LIMIT:g}"
        for name in RATES:
            values = getattr(self, name)
            self._refuse(f"{name} limit", ~(values >= SMALLEST_LIMIT), values, least)
        nowhere = (self.lower == np.inf) | (self.upper == -np.inf)
        expected = "a finite number, or -infinity for none (the upper one +infinity)"
        self._refuse("lower limit", nowhere, self.lower, expected)
        crossed = self.lower > self.upper
        self._refuse("lower limit", crossed, self.lower, "at most the upper limit")

    def _checked_units(self) -> tuple[str, ...]:
        n = len(self.joint_names)
        expected = "rad or m for each joint, or empty texts"
        units = listed("units", self.units, expected) or ("",) * n
        if len(units) != n:
            raise WrongSizeError("units", len(units), n)
        if not all(unit in ("rad", "m", "") for unit in units):
            raise BadValueError("units", units, expected)
        return units

    def unit(self, joint: int, order: int = 0) -> str:
        """Return the unit of a joint's position or, by order, of its velocity and so on."""
        unit = self.units[joint]
        return unit + _PER[order] if unit else ""

    def _array(self, name: str, missing: float) -> Array:
        given = getattr(self, name)
        n = len(self.joint_names)
        if isinstance(given, list | tuple):
            given = [missing if entry is None else entry for entry in given]
        values = real_array(f"{name} limits", missing if given is None else given)
        if values.shape not in ((), (n,)):
            raise WrongSizeError(f"{name} limits", values.shape, (n,))
        values = np.where(np.isnan(values), missing, values) * np.ones(n)
        values.setflags(write=False)
        return values

    def _refuse(self, what: str, bad: BoolArray, values: Array, expected: str) -> None:
        if bad.any():
            k = int(np.flatnonzero(bad)[0])
            name = self.joint_names[k]
            raise BadValueError(f"{what} of joint '{name}'", float(values[k]), expected)

    @classmethod
    def of(cls, limits: JointLimits | Any) -> Limits:
        """Read the limits of anything that has them as attributes; what it lacks is unlimited.

        Raises
        ------
        BadValueError
            It names no joints.
        """
        if isinstance(limits, cls):
            return limits
        if not hasattr(limits, "joint_names") or isinstance(limits, type):
            expected = "a SerialChain, Limits, or an object with the same attributes"
            raise BadValueError("limits", limits, expected)
        fields: dict[str, Any] = {
            name: getattr(limits, name, None) for name in (*RATES, "lower", "upper")
        }
        return cls(_names(limits.joint_names), **fields, units=getattr(limits, "units", ()))

    def scaled(
        self,
        *,
        velocity: Array | float = 1.0,
        acceleration: Array | float = 1.0,
        jerk: Array | float = 1.0,
    ) -> Limits:
        """Multiply the limits by factors, one for all joints or one for each."""
        return replace(
            self,
            velocity=self.velocity * velocity,
            acceleration=self.acceleration * acceleration,
            jerk=self.jerk * jerk,
        )

    def only(self, joints: Sequence[int]) -> Limits:
        """Return the limits of some joints, by their numbers."""
        if list(joints) == list(range(len(self.joint_names))):
            return self
        kept = list(joints)
        arrays = {name: getattr(self, name)[kept] for name in (*RATES, "lower", "upper")}
        names, units = ([row[k] for k in kept] for row in (self.joint_names, self.units))
        return Limits(tuple(names), **arrays, units=tuple(units))

    def require(self, *rates: Rate) -> None:
        """Raise `MissingLimitsError` with the names of the joints that lack one of `rates`."""
        if self._missing:
            for rate in rates:
                if rate in self._missing:
                    raise MissingLimitsError(rate, self._missing[rate])

    @cached_property
    def _missing(self) -> dict[Rate, list[str]]:
        """Names of the joints without a limit, for those rates that lack some."""
        found: dict[Rate, list[str]] = {}
        for rate in RATES:
            without = np.flatnonzero(~np.isfinite(getattr(self, rate)))
            if len(without):
                found[rate] = [self.joint_names[k] for k in without]
        return found

    @cached_property
    def tools(self) -> Tools:
        """Objects that planners reuse for the next plan within these limits."""
        return Tools()

    @cached_property
    def with_margin(self) -> Limits:
        """These limits less the room that the rounding of samples needs."""
        return self.scaled(velocity=1.0 - MARGIN, acceleration=1.0 - MARGIN, jerk=1.0 - JERK_MARGIN)

    @cached_property
    def ranges(self) -> Array:
        """Lowest and highest positions, (2, n) in rad or m; finite where a joint has no limit."""
        largest = LARGEST_LENGTH
        return np.stack([self.lower.clip(-largest, None), self.upper.clip(None, largest)])

    @cached_property
    def continuous(self) -> BoolArray:
        """Mask (n,) of joints that turn without position limits."""
        turning = np.array([unit == "rad" for unit in self.units], dtype=np.bool_)
        return turning & np.isinf(self.lower) & np.isinf(self.upper)

    @cached_property
    def rates(self) -> Array:
        """Limits of velocity, acceleration and jerk, (3, n)."""
        return np.stack([self.velocity, self.acceleration, self.jerk])

    @cached_property
    def least_rates(self) -> Array:
        """The smallest limits of velocity, acceleration and jerk of any joint, (3,)."""
        return self.rates.min(axis=1, initial=np.inf)

    @cached_property
    def scales(self) -> Array:
        """Limits of velocity, acceleration and jerk, (3, n); 1 where there is none."""
        return np.where(np.isfinite(self.rates), self.rates, 1.0)

    @cached_property
    def inverses(self) -> Array:
        """One over the limits of velocity, acceleration and jerk, (3, n)."""
        return 1.0 / self.rates

    def check_start(self, position: Array) -> None:
        """Raise `SeedOutsideLimitsError` where a start (n,) in rad or m is outside the limits."""
        k = self._outside(position)
        if k is not None:
            name, unit = self.joint_names[k], self.units[k]
            value, lower, upper = float(position[k]), float(self.lower[k]), float(self.upper[k])
            raise SeedOutsideLimitsError(name, value, lower, upper, what="start", unit=unit)

    def check_goal(self, position: Array, what: str = "goal position") -> None:
        """Raise `LimitExceededError` where a goal (n,) in rad or m is outside the limits."""
        k = self._outside(position)
        if k is not None:
            limit = self.lower[k] if position[k] < self.lower[k] else self.upper[k]
            name, unit = self.joint_names[k], self.units[k]
            raise LimitExceededError(what, name, float(position[k]), float(limit), unit)

    def _outside(self, position: Array) -> int | None:
        """Index of the joint that is farthest outside the position limits, if any."""
        excess = np.maximum(self.lower - position, position - self.upper)
        k = int(np.argmax(excess)) if len(excess) else 0
        return k if len(excess) and excess[k] > POSITION_SLACK else None


def _names(names: object) -> tuple[str, ...]:
    expected = "a list of different names"
    given = listed("joint_names", names, expected)
    if not all(isinstance(name, str) and name for name in given) or len(set(given)) < len(given):
        raise BadValueError("joint_names", given, expected)
    return given
