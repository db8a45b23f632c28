"""The stream of knots: free motions of the joints, or motions along the way for a twist."""

import math
from collections import deque
from copy import copy

import numpy as np

from robomech_ros.servo.cubics import end_of_cubic
from robomech_ros.servo.limits import ServoLimits
from robomech_ros.servo.line_motion import Deviation, LineMotion
from robomech_ros.servo.line_path import LinePath
from robomech_ros.servo.motion import Advance, Motion, Samples
from robomech_ros.typing import Array

# In what time joints that move get onto the way for a twist (s), and no less than this part of the
# time of the mean.
JOINING_TIMES, _JOINING_OF_MEAN = (0.2, 0.5, 1.0), 1.5
# In what time they get from rest onto one that begins next to them (s, and s/rad or s/m).
_BESIDE, _BESIDE_MORE = 0.2, 10.0
# The cosine between velocities that are nearly along the way.
_ALONG = 0.9
# A place so far along the way serves to see how it bends.
_BEND = 1e-3


class Stream:
    """Commanded joint motion, along a path or free, in knots a period (s) apart.

    Positions and velocities (n,) are those at first (rad or m, and per s); a joint outside its
    limits can only move inwards. So many knots before the latest are shown as ``lead`` says.
    ``line`` is the motion along the way for a twist, while there is one.
    """

    def __init__(
        self, limits: ServoLimits, period: float, position: Array, velocity: Array, lead: int = 1
    ) -> None:
        self._limits, self._period, self._lead = limits, period, lead
        self._free = Motion(limits, period, position, velocity)
        self.line: LineMotion | None = None
        q, v = self._free.knot
        before = range(max(lead, 1), -1, -1)
        # The last knots, the latest last.
        self._knots = deque([(q - i * period * v, v) for i in before], maxlen=len(before))

    def copy(self) -> "Stream":
        """Return an independent copy."""
        other = copy(self)
        other._free, other._knots = self._free.copy(), self._knots.copy()
        other.line = None if self.line is None else self.line.copy()
        return other

    @property
    def position(self) -> Array:
        """Position of the latest knot before averaging (rad or m)."""
        return self._free.position if self.line is None else self.line.ahead()[0]

    @property
    def velocity(self) -> Array:
        """Velocity there (rad/s or m/s)."""
        return self._free.velocity if self.line is None else self.line.ahead()[1]

    @property
    def at_rest(self) -> bool:
        """True if nothing moves any more."""
        return self._free.at_rest if self.line is None else self.line.at_rest

    def advance(self, wanted: Array) -> Advance:
        """Go on by one period, towards a velocity (rad/s or m/s) as fast as limits allow.

        From the way for a twist the joints go on where that leaves them a plan to stop; before
        that they brake on it.
        """
        if self.line is not None:
            joined = Motion.joining(self._limits, self._period, self._knots[-1], self._reached()[0])
            if joined is None:
                self.brake()
                return Advance(0.0, 1.0, ())
            self._free, self.line = joined, None
        advance = self._free.advance(wanted)
        self._knots.append(self._free.knot)
        return advance

    def brake(self) -> None:
        """Go on by one period on the plan to stop."""
        if self.line is None:
            self._free.brake()
            self._knots.append(self._free.knot)
            return
        self.line.brake()
        self._knots.append(self.line.knot)
        if self.line.at_rest:
            self.leave()

    def leave(self) -> None:
        """Leave the way for a twist, on which nothing moves."""
        q, v = self._knots[-1]
        self._free, self.line = Motion(self._limits, self._period, q, np.zeros_like(v)), None

    def follow(self, wanted: float) -> Advance | None:
        """Go on by one period on the way for a twist, towards a rate on it (1/s).

        None where the motion stands for no reason that the posture gives; it has left the way then.
        """
        assert self.line is not None
        advance = self.line.advance(wanted)
        if self.line.stuck(advance):
            self.leave()
            return None
        self._knots.append(self.line.knot)
        return advance

    def begin(self, path: LinePath) -> None:
        """Go on along a way that begins where the joints rest, or next to that."""
        (begun,), (still,) = path.at(np.zeros(1), np.zeros(1))
        off = self.knot() - begun
        deviation = None
        if off.any():
            time = _BESIDE + _BESIDE_MORE * float(np.abs(off).max())
            count = round(time / self._period)
            deviation = Deviation((off, still, still), self._period, count)
        self.line = LineMotion(path, self._limits, self._period, deviation=deviation)

    def join(self, path: LinePath, share: float, time: float) -> Advance | None:
        """Go on by a period onto a way that begins near the latest knot, in motion.

        A share of the twist is wanted; the joints get onto the way in a time (s), if the mean needs
        no more. None, with nothing changed, where the limits do not allow to get there.
        """
        q, v = self._knots[-1]
        if not path.reach(max(path.nearest(q), 0.0) + _BEND):
            return None
        place = max(path.nearest(q), 0.0)
        (here,), (slope,) = path.at(np.array([place]), np.ones(1))
        rate = max(self._along(slope, v), 0.0)
        bend = (path.slope(place + _BEND) - slope) / _BEND
        reached = self._reached()
        off = q - here, v - rate * slope, reached[0] - rate**2 * bend
        shortest = _JOINING_OF_MEAN * self._limits.smoothing(self._period) * self._period
        count = round(max(time, shortest) / self._period)
        deviation = Deviation(off, self._period, count)
        line = LineMotion(path, self._limits, self._period, place, rate, deviation, reached)
        advance = line.advance(share * line.wanted)
        if line.at_rest:
            return None
        self.line = line
        self._knots.append(line.knot)
        return advance

    def moves_along(self, path: LinePath) -> bool:
        """Return whether the joints move nearly in the direction in which a way begins."""
        _, v = self._knots[-1]
        return self._along(path.slope(0.0), v) > _ALONG * math.sqrt(self._along(v, v))

    def _along(self, u: Array, v: Array) -> float:
        """Return the product of velocities, each joint over its acceleration limit."""
        return float((u / self._limits.acceleration) @ (v / self._limits.acceleration))

    def knot(self) -> Array:
        """Return the position of the latest knot (rad or m)."""
        return self._knots[-1][0]

    def _reached(self) -> Array:
        """Return acceleration and jerk (2, n) with which the latest knot was reached."""
        (q, v), (last, then) = list(self._knots)[-2:]
        return end_of_cubic(self._period, np.array((q, last)), np.array((v, then)))

    def samples(self) -> Samples:
        """Return the stream from the first knot shown on, at rest at the end."""
        return self._from(self._lead)

    def newest(self) -> Samples:
        """Return the part of the stream that the last period decided, from the knot before it."""
        return self._from(1)

    def _from(self, lead: int) -> Samples:
        plan = (self._free if self.line is None else self.line).samples()
        known = list(self._knots)[-1 - lead : -1]
        times: Array = self._period * np.arange(float(len(known)))
        return Samples(
            np.append(times, plan.times + lead * self._period),
            np.vstack([*(q for q, _ in known), plan.positions]),
            np.vstack([*(v for _, v in known), plan.velocities]),
        )
