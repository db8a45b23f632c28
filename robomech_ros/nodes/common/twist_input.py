"""Reads twist commands from topics, and reports rejected ones."""

from collections.abc import Callable, Sequence
from typing import Any

from builtin_interfaces.msg import Time
from geometry_msgs.msg import Twist, TwistStamped
from rclpy.node import Node

from robomech_ros.errors import RobomechError
from robomech_ros.nodes.common.joints.stall_monitor import StallMonitor
from robomech_ros.nodes.common.messages.pose_messages import require_finite
from robomech_ros.nodes.common.motion_clock import MotionClock
from robomech_ros.nodes.middleware.polled_subscription import Inbox
from robomech_ros.nodes.middleware.throttled_log import ThrottledLog

_DEPTH = 10


class TwistInput:
    """Passes received twist commands on to a follower.

    Stamped commands come on ``topic``, others on the topic of that name with ``_unstamped`` behind
    it.  A command without a stamp counts as new, unless the process was held up: then it counts as
    old as it can be.

    - ``topic``: topic of stamped commands.
    - ``follow``: called with ``[omega, v_x, v_y]`` (rad/s, m/s) and the age of the command (s); it
      refuses a command by a RobomechError.
    - ``refusal``: reason for rejecting the last command; empty if it was followed.
    - ``refused``: number of rejected commands.
    """

    def __init__(
        self,
        node: Node,
        topic: str,
        follow: Callable[[Sequence[float], float], None],
        clock: MotionClock,
    ) -> None:
        self._logger, self._follow, self._clock = node.get_logger(), follow, clock
        self._log = ThrottledLog(self._logger)
        self._hold_ups = StallMonitor()
        self.refusal, self.refused = "", 0
        readers: list[tuple[type, str, Callable[[Any], tuple[Twist, Time | None]]]] = [
            (TwistStamped, topic, lambda message: (message.twist, message.header.stamp)),
            (Twist, f"{topic}_unstamped", lambda message: (message, None)),
        ]
        self._readers = [(Inbox(node, kind, name, _DEPTH), read) for kind, name, read in readers]

    @property
    def topic(self) -> str:
        """Full name of the topic of stamped commands."""
        return self._readers[0][0].topic

    def take(self) -> None:
        """Process all commands since the last look."""
        now = self._clock.now()
        if self._hold_ups.look(now):
            held_up = f"held up for {self._hold_ups.age(now):.3g} s"
            self._log.warning(f"{held_up}: commands without a stamp count as that old")
        for inbox, read in self._readers:
            for message in inbox.take():
                twist, stamp = read(message)
                try:
                    linear, angular = twist.linear, twist.angular
                    age = self._age(stamp, now, inbox.topic)
                    # One number that is not finite makes the whole message invalid.
                    require_finite("linear", linear)
                    require_finite("angular", angular)
                    self._follow([angular.z, linear.x, linear.y], age)
                except RobomechError as error:
                    self.refusal = f"command on '{inbox.topic}' ignored: {error}"
                    self.refused += 1
                    self._log.warning(self.refusal)
                else:
                    self.refusal = ""

    def _age(self, stamp: Time | None, now: float, topic: str) -> float:
        if stamp is not None:
            if stamp.sec or stamp.nanosec:
                return -self._clock.until(stamp, now)
            text = f"commands on '{topic}' have no stamp, which is taken for now"
            self._logger.warning(text, once=True)
        return self._hold_ups.age(now)
