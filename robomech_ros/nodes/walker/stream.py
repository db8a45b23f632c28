"""A walk that is some time ahead, and what is due of it; it knows neither ROS nor a clock."""

from collections import deque
from typing import NamedTuple

import numpy as np

from robomech_ros.servo.motion import Samples
from robomech_ros.typing import Array
from robomech_ros.walking import Walker, WalkUpdate

# Periods in which the joints brake behind the last knot of a message.
_BRAKING = 2
# Messages that repeat where the joints stand.
_REPEATS = 4
_STILL = np.zeros(3)
# Joints that are slower than this (rad/s, m/s) stand.
_REST = 1e-9
# So long (s) the past of the walk is kept: somewhere there are the joints of a robot that stopped.
_KEPT = 2.0
# All joints of such a robot are this near to where the walk had them (rad or m).
_NEAR = 0.05
# In this time (s) they go there.
_SETTLING = 0.3
# Part of its limit above which a joint is fast: a cubic can be faster than its mean by a half.
_FAST = 2.0 / 3.0
# A rise takes at least this long (s).
_SHORTEST_RISE = 0.5
# The greatest rate of a cubic from rest to rest, over its mean.
_PEAK = 1.5


class Knot(NamedTuple):
    """A moment of the walk."""

    time: float  #: Time of the moment (s).
    update: WalkUpdate  #: State of the walk.
    moment: Walker  #: The walker, ready to go on from this state.


class WalkStream:
    """Keeps a walk ahead of its time.

    - ``lead``: how far ahead (s).
    """

    def __init__(self, walker: Walker, lead: float) -> None:
        self.walker, self._lead = walker, lead
        self._past: deque[Knot] = deque()
        self._knots: deque[Knot] = deque()
        self._repeats, self._settled = 0, -np.inf
        #: Where the walk is at present: x, y (m) and yaw (rad) over the ground, shape (3,).
        self.place = _STILL

    def begin(self, now: float) -> None:
        """Begin with a robot that stands at home, where the walk has come to."""
        self.walker.stand(self.place)
        self._past.clear()
        self._knots = deque([self._next(now)])
        self._repeats = 0

    def resume(self, now: float, position: Array) -> bool:
        """Go on from the moment of the walk at which the joints are (n,), if there is one.

        Then the robot stands on the same feet as it did, and as safely.
        """
        known = [*self._past, *self._knots]
        if not known:
            return False
        off = np.abs(np.array([knot.update.q for knot in known]) - position).max(axis=1)
        # The latest of equal ones.
        best = len(known) - 1 - int(np.argmin(off[::-1]))
        if off[best] > _NEAR:
            return False
        self.walker.resume(known[best].moment)
        self._past.clear()
        # The walk waits while the joints go there.
        self._knots = deque([known[best]._replace(time=now)])
        self._settled, self._repeats = now + _SETTLING, 0
        return True

    def go_on(self, now: float) -> None:
        """Go on until the walk is as far ahead as it should be."""
        period = self.walker.period
        if now > self._knots[-1].time + period:
            # Held up: the joints have braked, and the walk goes on from where it is, without
            # commands that nobody may give any more.
            if now > self._knots[-1].time + self.walker.timeout:
                self.walker.command(_STILL)
            self._past.extend(self._knots)
            self._knots = deque([self._knots[-1]._replace(time=now)])
        # One more than is sent: rates at a knot are those between its neighbours.
        while (last := self._knots[-1]).time < now + self._lead + period:
            time = last.time + period
            waits = time < self._settled
            self._knots.append(last._replace(time=time) if waits else self._next(time))
        while len(self._knots) > 1 and self._knots[1].time <= now:
            self._past.append(self._knots.popleft())
        while self._past and self._past[0].time < now - _KEPT:
            self._past.popleft()
        self.place = self._knots[0].update.base

    def _next(self, time: float) -> Knot:
        return Knot(time, self.walker.update(), self.walker.moment())

    @property
    def present(self) -> Knot:
        """The latest knot that is not ahead."""
        return self._knots[0]

    @property
    def around_present(self) -> tuple[WalkUpdate, WalkUpdate, WalkUpdate]:
        """The updates before, at and after the present knot, a period apart."""
        here = self._knots[0]
        before = self._past[-1] if self._past else here
        after = self._knots[1] if len(self._knots) > 1 else here
        return before.update, here.update, after.update

    @property
    def moves(self) -> bool:
        """True if joints move between the knots, or messages are to be repeated."""
        settles = self._knots[0].time < self._settled
        updates = [knot.update for knot in self._knots]
        if settles or any(one.walking or np.abs(one.rates).max() > _REST for one in updates):
            self._repeats = _REPEATS
            return True
        self._repeats = max(self._repeats - 1, 0)
        return self._repeats > 0

    def samples(self) -> Samples:
        """Return positions and rates of the joints to rest, timed from the present knot (s)."""
        q = np.array([knot.update.q for knot in self._knots])
        period = self.walker.period
        robot = self.walker.robot
        means = np.diff(q, axis=0) / period
        rates = 0.5 * (means[:-1] + means[1:])
        # Between two knots a cubic is faster than its mean where both ends are slower: not near
        # the limits.
        faster = np.where(np.abs(means[:-1]) > np.abs(means[1:]), means[:-1], means[1:])
        rates = np.where(np.abs(faster) > _FAST * robot.velocity, faster, rates)
        # The last knot only serves for rates: behind the one before it the joints brake.
        last = q[-2] + 0.5 * _BRAKING * period * rates[-1]
        positions = np.vstack([q[1:-1], np.clip(last, robot.lower, robot.upper)])
        times = np.append(np.arange(1, len(q) - 1), len(q) - 2 + _BRAKING) * period
        rates = np.vstack([rates, np.zeros(q.shape[1])])
        # Those before the joints have settled are too near; the last one always counts.
        ahead = times + self._knots[0].time >= min(self._settled, self._knots[0].time + times[-1])
        return Samples(times[ahead], positions[ahead], rates[ahead])


def rising(walker: Walker, position: Array, part: float) -> Samples:
    """Return the motion of the joints from their present positions to the stance of the walker.

    - ``position``: present joint positions (rad or m), shape (n,).
    - ``part``: fraction of the speed limits that is used.
    """
    robot = walker.robot
    needed = _PEAK * np.abs(robot.home - position) / (part * robot.velocity)
    time = np.array([max(float(needed.max()), _SHORTEST_RISE)])
    return Samples(time, robot.home[None], np.zeros((1, robot.n)))
