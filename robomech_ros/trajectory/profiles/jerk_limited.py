"""Time-optimal motion within velocity, acceleration and jerk limits, computed by Ruckig."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from robomech_ros._kernels.timing.quintic import upper_coefficients
from robomech_ros.errors import BadValueError, DurationTooShortError, LimitExceededError
from robomech_ros.trajectory.curves.bounds import extremes
from robomech_ros.trajectory.curves.compiled_sampling import sample_many
from robomech_ros.trajectory.curves.motion_to_rest import check_positions, check_rates, settled
from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial
from robomech_ros.trajectory.limits import RATES, Limits, Rate
from robomech_ros.trajectory.profiles.ruckig_phases import (
    EndRates,
    JointPhases,
    Phases,
    common_phases,
    jerk_phases,
    phases_from_rest,
    rest_to_rest,
)
from robomech_ros.trajectory.profiles.velocity_profiles import DoubleS, along_line
from robomech_ros.trajectory.sample import Sample
from robomech_ros.trajectory.tolerances import DURATION_ROUNDING, LIMIT_SLACK, SHORTEST_TRAJECTORY
from robomech_ros.typing import Array, ArrayLike

# Power k of x + c is _SHIFTS[i, k] c^_SHIFTED[i, k] times power i of x, summed; for k = 3, 4, 5.
_SHIFTS = np.array([[math.comb(k, i) for k in range(3, 6)] for i in range(6)], float)
_SHIFTED = np.array([[max(k - i, 0) for k in range(3, 6)] for i in range(6)])
# Powers of time times these are derivatives.
_FACTORIALS = np.array([1.0, 1.0, 2.0, 6.0])
# The excess over a jerk limit, in parts of it, that is rounding; with more the motion is planned
# again, at most so often, within a limit that is lower by so many times the excess.
_EXCESS, _ROUNDS, _ROOM = 1e-10, 4, 1.5


@dataclass(frozen=True, eq=False)
class JerkLimited:
    """Piecewise constant jerk, all joints arriving together, at rest.

    From rest every joint whose limits permit it follows the course of the slowest one, so that
    the path is as straight as possible; that costs no time.  A wanted duration slows the fastest
    motion down as a whole; from a moving start it is left to Ruckig.
    The breaks of its pieces are the steps of the jerk of any joint.  Limits are kept to 1e-9 of
    them.  As instants are rounded, accelerations of neighbouring pieces agree to 2e-15 of the
    duration times the jerk.

    Attributes
    ----------
    start, goal : ndarray, shape (n,)
        Joint values in rad or m.
    limits : Limits
    course : Phases or ruckig.Trajectory
        The way from the start on; from Ruckig, in s, rad and m, only from rest to rest.
    """

    start: Array
    goal: Array
    limits: Limits
    course: Phases | Any

    def __init__(self, start: Array, goal: Array, limits: Limits, course: Phases | Any) -> None:
        # The initialisation of a frozen dataclass takes a tenth of the time of a plan.
        fields = self.__dict__
        fields["start"], fields["goal"] = start, goal
        fields["limits"], fields["course"] = limits, course

    REQUIRED: ClassVar[tuple[Rate, ...]] = RATES
    STARTS_MOVING: ClassVar[bool] = True
    ACCELERATION_STEPS: ClassVar[bool] = False

    @classmethod
    def plan(
        cls,
        start: Array,
        goal: Array,
        limits: Limits,
        duration: float | None = None,
        start_velocity: Array | None = None,
        start_acceleration: Array | None = None,
    ) -> JerkLimited:
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
            If the start is faster than the limits, its acceleration must make it so, or the motion
            overshoots a position limit.
        BadValueError
            If Ruckig fails.
        """
        if start_velocity is None and start_acceleration is None and duration is None:
            course = rest_to_rest(goal - start, limits, SHORTEST_TRAJECTORY)
            if course is not None:
                return cls(start, goal, limits, course)
        rest = np.zeros(len(start))
        velocity = rest if start_velocity is None else start_velocity
        acceleration = rest if start_acceleration is None else start_acceleration
        check_state("start", limits, velocity, acceleration)
        least = SHORTEST_TRAJECTORY
        moving = bool(velocity.any() or acceleration.any())
        if moving and duration is not None:
            least = max(least, duration)
        begin, end = (velocity, acceleration), (rest, rest)
        phases, pieces = planned_between(start, goal, limits, least, begin, end)
        check_in_time(duration, pieces, phases.alone, limits)
        if moving:
            check_rates(pieces, limits)
            check_positions(pieces, start, limits)
        elif duration is not None and duration > phases.duration:
            phases = phases.slowed(duration / phases.duration)
        return cls(start, goal, limits, phases)

    @property
    def duration(self) -> float:
        """Time from start to end, in s."""
        return self.course.duration

    @cached_property
    def phases(self) -> Phases:
        """The way from the start on, in phases in which no joint changes its jerk."""
        if isinstance(self.course, Phases):
            return self.course
        return phases_from_rest(self.course, self.goal - self.start, self.limits)

    @cached_property
    def pieces(self) -> PiecewisePolynomial:
        """The curve, from t = 0 on, exactly from the start to the goal."""
        return curve_of(self.phases, self.start, self.goal, np.zeros(len(self.goal)))

    def sample(self, t: ArrayLike) -> Sample:
        """Sample positions and derivatives, (n,) or (m, n), at instants (s), () or (m,).

        Before 0 the joints rest at the start, from the end on at the goal.
        """
        return settled(sample_many(self.pieces, t), t, self.pieces, self.goal)

    def __getstate__(self) -> dict[str, Any]:
        # Ruckig's result cannot be copied or stored, but its phases can.
        return vars(self) | {"course": self.phases}


def check_in_time(
    wanted: float | None, pieces: PiecewisePolynomial, alone: Array, limits: Limits
) -> None:
    """Refuse a curve that takes longer than wanted (s); name its slowest joint, and its limits."""
    least = max(wanted or 0.0, SHORTEST_TRAJECTORY)
    if wanted is None or pieces.duration <= least + DURATION_ROUNDING * (1.0 + least):
        return
    joint = int(np.argmax(alone))
    low, high = extremes(pieces)
    binding = []
    for order, rate in enumerate(RATES, start=1):
        peak = max(-low[order, joint], high[order, joint])
        if peak > (1.0 - LIMIT_SLACK) * getattr(limits, rate)[joint]:
            binding.append(rate)
    names = " and ".join(binding) or "jerk"
    raise DurationTooShortError(wanted, pieces.duration, limits.joint_names[joint], names)


def check_state(end: str, limits: Limits, velocity: Array, acceleration: Array) -> None:
    """Raise `LimitExceededError` where the rates (n,) at an end of a motion are over a limit."""
    rates = (("velocity", velocity), ("acceleration", acceleration))
    for order, (rate, values) in enumerate(rates, start=1):
        bound = getattr(limits, rate)
        over = np.flatnonzero(np.abs(values) > bound * (1.0 + LIMIT_SLACK))
        if len(over):
            k = int(over[0])
            name, unit = limits.joint_names[k], limits.unit(k, order)
            value, limit = float(values[k]), float(bound[k])
            raise LimitExceededError(f"{end} {rate}", name, value, limit, unit)


def planned_between(
    start: Array, goal: Array, limits: Limits, least: float, begin: EndRates, end: EndRates
) -> tuple[Phases, PiecewisePolynomial]:
    """Plan from state to state in a least time (s), with room for a goal that Ruckig misses."""
    allowed = limits
    for _ in range(_ROUNDS):
        try:
            phases = jerk_phases(goal - start, begin, end, allowed, least)
        except BadValueError:
            if any(rates.any() for rates in (*begin, *end)):
                raise
            phases = _resting_phases(goal - start, allowed, least)
        pieces = curve_of(phases, start, goal, end[0])
        low, high = extremes(pieces)
        excess = np.maximum(-low, high)[3] / limits.jerk - 1.0
        if not (excess > _EXCESS).any():
            break
        allowed = allowed.scaled(jerk=1.0 / (1.0 + _ROOM * np.maximum(excess, 0.0)))
    return phases, pieces


def curve_of(
    phases: Phases, start: Array, goal: Array, final_velocity: Array
) -> PiecewisePolynomial:
    """Shift the phases to start and goal exactly.

    Ruckig misses it by a part in 1e8 of the way at most, and the velocity there by less.  What is
    missing is made up by a quintic over the whole duration, where it is nothing; in the last step
    alone it would be a jump of the jerk.
    """
    breaks, given = phases.breaks, phases.coefficients
    span = breaks[-1] - breaks[-2]
    powers = np.array([1.0, span, span * span, span * span * span])
    missing = goal - start - powers @ given[:, -1]
    faster = final_velocity - np.array([1.0, 2.0 * span, 3.0 * span**2]) @ given[1:, -1]
    coefficients = np.zeros((6, *given.shape[1:]))
    coefficients[:4] = given
    coefficients[0] += start
    # The quintic's powers since the beginning of each segment, which begins at a part of it.
    part = breaks[:-1] / breaks[-1]
    shifts = _SHIFTS * part[:, None, None] ** _SHIFTED
    quintic = np.stack(upper_coefficients(1.0, missing, 0.0, faster * breaks[-1], 0.0, 0.0))
    scales = breaks[-1] ** -np.arange(6.0)
    coefficients += (shifts @ quintic).transpose(1, 0, 2) * scales[:, None, None]
    return PiecewisePolynomial(breaks, coefficients)


def _resting_phases(rise: Array, limits: Limits, shortest: float) -> Phases:
    """Compute the fastest motion from rest to rest by `rise` (n,) that takes at least a time (s).

    Every joint follows the double-S profile of its own way, slowed down to the duration of all.
    Positions count from the start.
    """
    moving = np.flatnonzero(rise)
    rates = 1.0 / (np.abs(rise[moving]) * limits.inverses[:, moving])
    shapes = [DoubleS.shape(*of)[:2] for of in rates.T.tolist()]
    alone = np.zeros(len(rise))
    alone[moving] = [lasting for _, lasting in shapes]
    total = max(shortest, float(alone.max()))
    joints: list[JointPhases] = [(np.array([0.0, total]), np.zeros((2, 4))) for _ in rise]
    for joint, (ramp, lasting) in zip(moving, shapes, strict=True):
        slow = tuple(part * (total / lasting) for part in ramp)
        line = along_line(np.zeros(1), rise[joint : joint + 1], slow, total)
        states = np.zeros((len(line.breaks), 4))
        states[:-1] = line.coefficients[:, :, 0].T * _FACTORIALS
        states[-1, 0] = rise[joint]
        joints[joint] = line.breaks, states
    return Phases(*common_phases(joints, total), alone)
