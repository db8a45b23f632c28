"""Streams of a servo on a clock that steps, which servo and controller do not see at once."""

import numpy as np
from late_streams import LateStream

from robomech_ros.errors import RobomechError


class Listener:
    """Somebody's clock for motions, which leaves out a step of ROS time, as `MotionClock` does.

    It hears of the time `behind` (s) late, and of the step with a message that came `lost` (s)
    after the one before it: so much of the time is left out, too.
    """

    def __init__(self, jump, at, lost, behind=0.0):
        self._jump, self._at, self._lost, self._behind = jump, at, lost, behind
        self._latest = -np.inf

    def look(self, now):
        """Return the time of motions (s), and how far ROS time is ahead of it."""
        now -= self._behind
        over = now >= self._at
        self._latest = max(self._latest, now - self._lost * over)
        return self._latest, self._jump * over + now - self._latest


class JumpedStream(LateStream):
    """A stream whose stamps are ROS time, which steps once by `jump` (s)."""

    def __init__(self, robot, q, command, jump, servo, controller, seconds=1.0):
        self._jump, self._servo, self._controller = jump, servo, controller
        self._told = False
        super().__init__(robot, q, command, lambda count: 0.001, seconds)

    def _send(self, now):
        at, ahead = self._servo.look(now)
        super()._send(at)
        _, stamp, points = self._under_way.pop()
        self._under_way.append((now + self._delay(self._count), stamp + ahead, points))

    def _receive(self, now):
        at, ahead = self._controller.look(now)
        if not self._told and abs(ahead) > 0.5 * abs(self._jump):
            self._told = True
            self.arm.clock_jumped(ahead)
        while self._under_way and self._under_way[0][0] <= now:
            _, stamp, points = self._under_way.pop(0)
            try:
                self.arm.start(points, self._free, at, stamp - ahead - at, streamed=True)
            except RobomechError:
                # The servo would end its stream, seeing that the robot does not follow.
                continue
        self.arm.advance(at)
        # A clock that stands still moves nothing.
        if not self.states or at > self.states[-1][0]:
            self.states.append((at, self.arm.desired))
