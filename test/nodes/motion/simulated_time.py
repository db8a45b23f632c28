"""A clock that a test publishes."""

import threading

from builtin_interfaces.msg import Time
from rosgraph_msgs.msg import Clock


class SimulatedTime:
    """Publishes /clock in steps (s), at a part or a multiple of the speed of time; it may jump."""

    def __init__(self, node, step=0.01, speed=2.0):
        self._publisher = node.create_publisher(Clock, "/clock", 10)
        self._lock, self._now, self._step = threading.Lock(), 10_000.0, step
        node.create_timer(step / speed, self._tick)

    def _tick(self):
        with self._lock:
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
