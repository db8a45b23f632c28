"""The limits that a servo keeps; it needs those of velocity."""

import math
from dataclasses import dataclass

import numpy as np

from robomech_ros.errors import MissingLimitsError
from robomech_ros.execution.joints import Joints
from robomech_ros.robots.chain import SerialChain
from robomech_ros.typing import Array

# A stream stays this far inside its bounds, over rounding: rad or m, and a part of the rates.
POSITION_ROUNDING = 1e-9
RATE_ROUNDING = 1e-9


@dataclass(frozen=True, eq=False)
class ServoLimits:
    """Limits of n joints.

    Attributes
    ----------
    names : tuple of str
        The joints.
    lower, upper : ndarray, shape (n,)
        Positions, infinite where there is no limit (rad or m).
    velocity, acceleration : ndarray, shape (n,)
        Largest magnitudes (rad or m, per s and s^2).
    jerk : ndarray, shape (n,)
        Largest magnitudes (rad/s^3 or m/s^3), infinite where there is none.
    units : tuple of str
        ``"rad"`` or ``"m"`` for each joint.
    """

    names: tuple[str, ...]
    lower: Array
    upper: Array
    velocity: Array
    acceleration: Array
    jerk: Array
    units: tuple[str, ...]

    @classmethod
    def of(cls, chain: SerialChain) -> "ServoLimits":
        """Read them of a chain; a missing acceleration limit is guessed as the controller does.

        Raises
        ------
        MissingLimitsError
            A joint has no velocity limit.
        """
        missing = np.isnan(chain.velocity)
        if missing.any():
            names = [chain.joint_names[i] for i in np.flatnonzero(missing)]
            raise MissingLimitsError("velocity", names)
        jerk = np.where(np.isnan(chain.jerk), np.inf, chain.jerk)
        acceleration = Joints.of(chain).acceleration
        given = chain.lower, chain.upper, chain.velocity, acceleration, jerk
        return cls(chain.joint_names, *given, chain.units)

    @property
    def inside(self) -> tuple[Array, Array]:
        """Position limits with room for rounding, which a range of no width has not."""
        room = np.clip(0.5 * (self.upper - self.lower), 0.0, POSITION_ROUNDING)
        return self.lower + room, self.upper - room

    def share_of(self, rates: Array) -> tuple[float, int]:
        """Return how much of rates (rad/s or m/s) is allowed, and which joint needs that most."""
        share = np.abs(rates) / self.velocity
        fastest = int(np.argmax(share))
        return min(1.0, 1.0 / max(float(share[fastest]), 1e-300)), fastest

    def smoothing(self, period: float) -> int:
        """Return over how many periods (s) positions are averaged so that jerks stay in limits.

        The acceleration of the average changes in such a time by twice its limit at most.
        """
        longest = float(np.max(2.0 * self.acceleration / self.jerk, initial=0.0))
        return math.ceil(longest / period - RATE_ROUNDING)
