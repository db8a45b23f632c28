"""A clock that a test publishes."""

import threading

from builtin_interfaces.msg import Time
from rosgraph_msgs.msg import Clock

# How far what is seen of a robot may be behind, s.
LAG = 0.05


class SimulatedTime:
    """Publishes /clock in steps (s), at a part or a multiple of the speed of time; it may jump."""

    def __init__(self, node, step=0.01, speed=2.0):
        self._publisher = node.create_publisher(Clock, "/clock", 10)
        self._lock, self._now, self._step = threading.Lock(), 10_000.0, step
        self._states = []
        node.create_timer(step / speed, self._tick)

    def wait_for(self, states):
        """Stand while the latest of these joint states is behind: a simulator in lockstep."""
        self._states = states

    def _behind(self):
        if not self._states:
            return False
        seen = self._states[-1].header.stamp
        return seen.sec + 1e-9 * seen.nanosec < self._now - LAG

    def _tick(self):
        with self._lock:
            if not self._behind():
                self._now += self._step
        message = Clock(clock=self.stamp())
        self._publisher.publish(message)

    def stamp(self, ahead=0.0):
        with self._lock:
            sec, nanosec = divmod(round((self._now + ahead) * 1e9), 10**9)
        return Time(sec=sec, nanosec=nanosec)

    def jump(self, by):
        """Jump, and return the time before (ns)."""
        with self._lock:
            before = round(self._now * 1e9)
            self._now += by - self._step
        return before
