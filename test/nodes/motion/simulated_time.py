"""A clock that a test publishes."""

import threading

from builtin_interfaces.msg import Time
from rosgraph_msgs.msg import Clock

STEP = 0.01


class SimulatedTime:
    """Publishes /clock at twice the speed of time, and lets it jump."""

    def __init__(self, graph):
        self._publisher = graph.client.create_publisher(Clock, "/clock", 10)
        self._lock, self._now = threading.Lock(), 10_000.0
        graph.client.create_timer(0.5 * STEP, self._tick)

    def _tick(self):
        with self._lock:
            self._now += STEP
        message = Clock(clock=self.stamp())
        self._publisher.publish(message)

    def stamp(self, ahead=0.0):
        with self._lock:
            sec, nanosec = divmod(round((self._now + ahead) * 1e9), 10**9)
        return Time(sec=sec, nanosec=nanosec)

    def jump(self, by):
        with self._lock:
            self._now += by - STEP
