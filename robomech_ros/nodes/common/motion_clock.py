"""Time for motions: it never jumps, even where simulated time does."""

import time
from collections.abc import Callable

from builtin_interfaces.msg import Time
from rclpy.clock import Clock, ClockType, JumpThreshold, TimeJump
from rclpy.duration import Duration
from rclpy.node import Node

__all__ = ["MotionClock"]

_NANO = 1e-9
# Simulated time that goes on by more than this (s) from one message to the next has jumped.
LONGEST_STEP = 0.5
# Two clocks are read at once if that takes no longer than this (ns); so often it is tried.
_AT_ONCE = 20_000
_LOOKS = 5


class MotionClock:
    """Seconds since the start of the node.

    The steady clock of the machine, which the setting of the system's clock does not touch; with
    the parameter ``use_sim_time`` the simulated time, so that motions keep pace with the
    simulation.  Jumps of that, forward or back, are left out, and where it goes back a little this
    clock stands still.  Stamps of messages are always ROS time.

    Parameters
    ----------
    node : Node
        Whose time it is.

    Attributes
    ----------
    clock : Clock
        For timers.
    simulated : bool
        Whether it is the simulated time.
    """

    def __init__(self, node: Node) -> None:
        self._ros = node.get_clock()
        self._logger = node.get_logger()
        self.simulated = bool(node.get_parameter("use_sim_time").value)
        self.clock = self._ros if self.simulated else Clock(clock_type=ClockType.STEADY_TIME)
        self._listeners: list[Callable[[float], None]] = []
        self._jumped = self._latest = 0
        self._epoch = int(self._ros.now().nanoseconds) if self.simulated else time.monotonic_ns()
        if self.simulated:
            limit = Duration(seconds=LONGEST_STEP)
            back = Duration(nanoseconds=-limit.nanoseconds)
            threshold = JumpThreshold(min_forward=limit, min_backward=back, on_clock_change=False)
            # Jumps are reported as long as this is kept.
            self._handle = self._ros.create_jump_callback(threshold, post_callback=self._take_jump)

    def on_jump(self, listener: Callable[[float], None]) -> None:
        """Report every jump of simulated time, in s, negative where it jumped back."""
        self._listeners.append(listener)

    def _take_jump(self, jump: TimeJump) -> None:
        by = int(jump.delta.nanoseconds)
        self._jumped += by
        # Before its first message the time is 0: there it begins.
        if int(self._ros.now().nanoseconds) != by:
            how = "forward" if by > 0 else "back"
            self._logger.warning(
                f"the clock jumped {how} by {abs(by) * _NANO:.4g} s; motions go on as if it had not"
            )
        for listener in self._listeners:
            listener(by * _NANO)

    def _nanoseconds(self) -> int:
        if not self.simulated:
            return time.monotonic_ns() - self._epoch
        passed = int(self._ros.now().nanoseconds) - self._jumped - self._epoch
        self._latest = max(self._latest, passed)
        return self._latest

    def now(self) -> float:
        """Give the time, s."""
        return self._nanoseconds() * _NANO

    def stamp(self, moment: float) -> int:
        """Give the ROS time (ns) that belongs to a time of this clock (s)."""
        return self._ros_ahead() + round(moment / _NANO)

    def until(self, stamp: Time, now: float) -> float:
        """Give how far a stamp is ahead of a time of this clock (s), negative if past.

        It is 0 for the stamp 0.
        """
        if not (stamp.sec or stamp.nanosec):
            return 0.0
        given = int(stamp.sec) * 1_000_000_000 + int(stamp.nanosec)
        return float(given - self.stamp(now)) * _NANO

    def _ros_ahead(self) -> int:
        """Give how far ROS time is ahead of this clock (ns).

        A thread may be held up between two looks at clocks, which would show as so much time.
        """
        if self.simulated:
            return int(self._ros.now().nanoseconds) - self._nanoseconds()
        shortest = ahead = 0
        for look in range(_LOOKS):
            begin = time.monotonic_ns()
            ros = int(self._ros.now().nanoseconds)
            end = time.monotonic_ns()
            if not look or end - begin < shortest:
                shortest, ahead = end - begin, ros - (begin + end) // 2
            if shortest <= _AT_ONCE:
                break
        return ahead + self._epoch
