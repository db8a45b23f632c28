"""The limits that a servo keeps; it needs those of velocity."""

import math
from typing import Any

import numpy as np

from robomech_ros.errors import MissingLimitsError
from robomech_ros.execution.joints import Joints
from robomech_ros.trajectory.limits import JointLimits, Limits
from robomech_ros.typing import Array

# A stream stays this far inside its bounds, over rounding: rad or m, and a part of the rates.
POSITION_ROUNDING = 1e-9
RATE_ROUNDING = 1e-9


class ServoLimits(Limits):
    """Limits of n joints, of which those of velocity and acceleration are finite."""

    @classmethod
    def of(cls, limits: JointLimits | Any) -> "ServoLimits":
        """Read them of a chain; a missing acceleration limit is guessed as the controller does.

        Raises MissingLimitsError for a joint without a velocity limit.
        """
        missing = np.isnan(np.asarray(limits.velocity, dtype=np.float64))
        if missing.any():
            names = [limits.joint_names[int(i)] for i in np.flatnonzero(missing)]
            raise MissingLimitsError("velocity", names)
        known = Limits.of(limits)
        rates = known.velocity, Joints.of(limits).acceleration, known.jerk
        return cls(known.joint_names, *rates, known.lower, known.upper, known.units)

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

    def limited(self, rates: Array) -> tuple[float, float]:
        """Return the allowed part of rates, and the time to stop from it (s)."""
        part = self.share_of(rates)[0]
        return part, part * float(np.max(np.abs(rates) / self.acceleration))

    def smoothing(self, period: float) -> int:
        """Return over how many periods (s) positions are averaged so that jerks stay in limits.

        The acceleration of the average changes in such a time by twice its limit at most.
        """
        longest = float(np.max(2.0 * self.acceleration / self.jerk, initial=0.0))
        return math.ceil(longest / period - RATE_ROUNDING)
