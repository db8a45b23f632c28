"""Clock for motions that never jumps, even if simulated time does."""

import time
from collections.abc import Callable

from builtin_interfaces.msg import Time
from rclpy.clock import Clock, ClockType, JumpThreshold, TimeJump
from rclpy.duration import Duration
from rclpy.node import Node

from robomech_ros.nodes.middleware.throttled_log import ThrottledLog

_NANO = 1e-9
# Simulated time that goes on by more than this (s) from one message to the next has jumped, and so
# has one that goes on by so many times its usual steps and by more than the shortest jump (s).
LONGEST_STEP, SHORTEST_JUMP, _JUMP_FACTOR = 0.5, 0.05, 5.0
# Rate at which the usual step approaches the present steps, as a fraction per step.
_FORGET = 0.1
# Least jump that is logged (s).
_LOGGED_JUMP = 0.1
# From the first difference (ns) on, a change of the system's clock is followed at once; from the
# second on slowly, by a fraction of the time.  Below it is the error of reading two clocks.
_CLOCK_SET, _CLOCK_DRIFT, _DRIFT_RATE = 1_000_000, 50_000, 1e-3
# Longest simultaneous reading of two clocks (ns), and number of attempts.
_READ_TIME = 20_000
_LOOKS = 5


class MotionClock:
    """Seconds since the start of the node.

    The steady clock of the machine, which the setting of the system's clock does not touch; with
    the parameter ``use_sim_time`` the simulated time, so that motions keep pace with the
    simulation.  Steps back, or forward by more than usual, are left out: no step
    of the clock moves a joint.  Stamps of messages are always ROS time.

    - ``node``: gives the ROS time, and the parameter use_sim_time.
    """

    def __init__(self, node: Node) -> None:
        self._ros = node.get_clock()
        self._log = ThrottledLog(node.get_logger())
        #: Whether the clock shows simulated time.
        self.simulated = bool(node.get_parameter("use_sim_time").value)
        #: Clock for timers.
        self.clock = self._ros if self.simulated else Clock(clock_type=ClockType.STEADY_TIME)
        self._listeners: list[Callable[[float], None]] = []
        self._jumped = self._latest = 0
        # The usual step of simulated time (s), and how far ROS time was ahead (ns), and when.
        self._usual = LONGEST_STEP
        self._ahead: int | None = None
        self._looked = 0
        self._epoch = int(self._ros.now().nanoseconds) if self.simulated else time.monotonic_ns()
        if self.simulated:
            least, back = Duration(nanoseconds=1), Duration(nanoseconds=-1)
            threshold = JumpThreshold(min_forward=least, min_backward=back, on_clock_change=False)
            # Steps are reported while this object exists.
            self._handle = self._ros.create_jump_callback(threshold, post_callback=self._take_step)

    @property
    def runs(self) -> bool:
        """True if there is time: simulated time is 0 until the first message on ``/clock``."""
        return not self.simulated or bool(self._ros.now().nanoseconds)

    def on_jump(self, listener: Callable[[float], None]) -> None:
        """Report every jump of simulated time, in s, negative where it jumped back."""
        self._listeners.append(listener)

    def _take_step(self, step: TimeJump) -> None:
        """Classify a step of simulated time as a jump or as usual."""
        by = float(step.delta.nanoseconds) * _NANO
        if 0.0 <= by <= min(max(_JUMP_FACTOR * self._usual, SHORTEST_JUMP), LONGEST_STEP):
            self._usual = max(by, (1.0 - _FORGET) * self._usual)
            return
        # A clock with longer steps than before is accepted after some of them.
        self._usual = min(2.0 * self._usual, LONGEST_STEP)
        self._take_jump(int(step.delta.nanoseconds))

    def _take_jump(self, by: int) -> None:
        self._jumped += by
        # Before its first message the time is 0: there it begins.
        if int(self._ros.now().nanoseconds) == by:
            self._usual = LONGEST_STEP
        elif abs(by) * _NANO > _LOGGED_JUMP:
            how = "forward" if by > 0 else "back"
            self._log.warning(
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
        """Return the time, s."""
        return self._nanoseconds() * _NANO

    def stamp(self, moment: float) -> int:
        """Return the ROS time (ns) that belongs to a time of this clock (s)."""
        return self._ros_ahead() + round(moment / _NANO)

    def until(self, stamp: Time, now: float) -> float:
        """Return the time (s) from `now` to a stamp, negative if past; 0 for the stamp 0."""
        if not (stamp.sec or stamp.nanosec):
            return 0.0
        given = int(stamp.sec) * 1_000_000_000 + int(stamp.nanosec)
        return float(given - self.stamp(now)) * _NANO

    def _ros_ahead(self) -> int:
        """Return the lead of ROS time over this clock (ns), steady between looks.

        Otherwise the stamps of a regular motion would be irregular by some microseconds.
        """
        if self.simulated:
            return int(self._ros.now().nanoseconds) - self._nanoseconds()
        found, now = self._difference(), time.monotonic_ns()
        known = self._ahead
        if known is None or abs(found - known) > _CLOCK_SET:
            known = found
        elif abs(found - known) > _CLOCK_DRIFT:
            most = round(_DRIFT_RATE * (now - self._looked))
            known += max(min(found - known, most), -most)
        self._ahead, self._looked = known, now
        return known

    def _difference(self) -> int:
        """Measure the lead of ROS time over this clock (ns).

        A thread may stall between two readings of clocks, which would add to the result.
        """
        shortest = ahead = 0
        for look in range(_LOOKS):
            begin = time.monotonic_ns()
            ros = int(self._ros.now().nanoseconds)
            end = time.monotonic_ns()
            if not look or end - begin < shortest:
                shortest, ahead = end - begin, ros - (begin + end) // 2
            if shortest <= _READ_TIME:
                break
        return ahead + self._epoch
