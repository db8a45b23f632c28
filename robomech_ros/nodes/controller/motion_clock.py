"""Time for motions: it never jumps unless time itself is simulated."""

import time

from builtin_interfaces.msg import Time
from rclpy.clock import Clock, ClockType
from rclpy.node import Node

__all__ = ["MotionClock"]

_NANO = 1e-9


class MotionClock:
    """Seconds since the start of the node.

    The steady clock of the machine, which the setting of the system's clock does not touch; with
    the parameter ``use_sim_time`` the simulated time, so that motions keep pace with the
    simulation.  Stamps of messages are always ROS time.

    Parameters
    ----------
    node : Node
        Whose time it is.

    Attributes
    ----------
    clock : Clock
        For timers.
    """

    def __init__(self, node: Node) -> None:
        self._ros = node.get_clock()
        self._simulated = bool(node.get_parameter("use_sim_time").value)
        self.clock = self._ros if self._simulated else Clock(clock_type=ClockType.STEADY_TIME)
        self._epoch = 0
        self._epoch = self._nanoseconds()

    def _nanoseconds(self) -> int:
        return int(self._ros.now().nanoseconds) if self._simulated else time.monotonic_ns()

    def now(self) -> float:
        """Give the time, s."""
        return (self._nanoseconds() - self._epoch) * _NANO

    def stamp(self, time: float) -> int:
        """Give the ROS time (ns) that belongs to a time of this clock (s)."""
        return int(self._ros.now().nanoseconds) - round((self.now() - time) / _NANO)

    def until(self, stamp: Time) -> float:
        """Give how far a stamp is in the future, s, negative if past; 0 for the stamp 0."""
        if not (stamp.sec or stamp.nanosec):
            return 0.0
        ros_now = self._ros.now().nanoseconds
        return float(stamp.sec * 1_000_000_000 + stamp.nanosec - ros_now) * _NANO
