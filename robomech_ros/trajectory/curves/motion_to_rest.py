"""Motions that are piecewise polynomials and end at rest."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from robomech_ros.errors import LimitExceededError
from robomech_ros.trajectory.curves.bounds import extremes
from robomech_ros.trajectory.curves.compiled_sampling import PiecewiseMotion, sample_many
from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial
from robomech_ros.trajectory.limits import RATES, Limits
from robomech_ros.trajectory.sample import Sample
from robomech_ros.trajectory.tolerances import LIMIT_SLACK, POSITION_SLACK
from robomech_ros.typing import Array, ArrayLike


@dataclass(frozen=True, eq=False)
class MotionToRest(PiecewiseMotion):
    """A curve from t = 0 to rest exactly at its goal (n,), rad or m."""

    goal: Array
    pieces: PiecewisePolynomial

    ACCELERATION_STEPS: ClassVar[bool] = False

    def sample(self, t: ArrayLike) -> Sample:
        """Sample positions and derivatives, (n,) or (m, n), at instants (s), () or (m,).

        Before 0 the joints rest at the start, from the end on at the goal.
        """
        return settled(sample_many(self.pieces, t), t, self.pieces, self.goal)


@dataclass(frozen=True, eq=False)
class MotionThrough(MotionToRest):
    """A motion to rest that passes start, via points and goal at its knots (m,), in s."""

    knots: Array


def settled(
    sample: Sample,
    t: ArrayLike,
    pieces: PiecewisePolynomial,
    goal: Array,
    velocity: Array | float = 0.0,
    acceleration: Array | float = 0.0,
) -> Sample:
    """Put a sample at the end of its curve in a state exactly, and a later one at rest there."""
    instants = np.asarray(t, dtype=np.float64).ravel()
    now, ended = instants == pieces.breaks[-1], instants >= pieces.breaks[-1]
    if sample.position.ndim == 1:
        now, ended = now[0], ended[0]
    sample.position[ended] = goal
    sample.velocity[now] = velocity
    sample.acceleration[now] = acceleration
    return sample


def check_positions(pieces: PiecewisePolynomial, start: Array, limits: Limits) -> None:
    """Raise `LimitExceededError` where a curve leaves the position limits on its way.

    A start (n,) in rad or m that is outside a limit, within the slack, may stay there.
    """
    low, high = (values[0] for values in extremes(pieces))
    for values, edge, bound in (
        (-low, -np.minimum(limits.lower, start), limits.lower),
        (high, np.maximum(limits.upper, start), limits.upper),
    ):
        excess = values - edge
        joint = int(np.argmax(excess)) if len(excess) else 0
        if len(excess) and excess[joint] > POSITION_SLACK:
            value = float(low[joint] if bound is limits.lower else high[joint])
            name, unit = limits.joint_names[joint], limits.unit(joint)
            raise LimitExceededError("position on the way", name, value, float(bound[joint]), unit)


def check_rates(pieces: PiecewisePolynomial, limits: Limits) -> None:
    """Raise `LimitExceededError` where a curve is over a limit of a rate, by more than rounding."""
    low, high = extremes(pieces)
    for order, rate in enumerate(RATES, start=1):
        least, largest = low[order], high[order]
        bound = getattr(limits, rate)
        over = np.flatnonzero(np.maximum(-least, largest) > bound * (1.0 + LIMIT_SLACK))
        if len(over):
            k = int(over[0])
            falling = -least[k] > largest[k]
            value, limit = (least[k], -bound[k]) if falling else (largest[k], bound[k])
            name, unit, what = limits.joint_names[k], limits.unit(k, order), f"{rate} on the way"
            raise LimitExceededError(what, name, float(value), float(limit), unit)
