"""The stream to the controller: its knots in time, and the messages that show it."""

import numpy as np
from rclpy.node import Node
from rclpy.time import Time
from trajectory_msgs.msg import JointTrajectory

from robomech_ros.nodes.common.messages.joint_messages import stream_message
from robomech_ros.nodes.common.motion_clock import MotionClock
from robomech_ros.nodes.servo.settings import ServoNodeSettings, max_lead
from robomech_ros.servo.lead import AdaptiveLead
from robomech_ros.servo.motion import Samples
from robomech_ros.servo.report import ServoReport
from robomech_ros.servo.servo import Servo
from robomech_ros.typing import Array

# A knot that is nearer than this part of a period is too near for the controller to get it in time.
_MIN_LEAD = 0.2
# Ends of two messages that differ by less are the same (rad or m).
_END_TOLERANCE = 1e-6


class StreamPublisher:
    """Keeps the stream of a servo some periods ahead of time, and publishes it.

    - ``servo``: makes the stream.
    - ``settings``: topic, rate and lead.
    - ``period``: time between knots (s).
    """

    def __init__(
        self,
        node: Node,
        servo: Servo,
        clock: MotionClock,
        names: tuple[str, ...],
        settings: ServoNodeSettings,
    ) -> None:
        self._servo, self._clock, self._names = servo, clock, names
        self._most, self.period = max_lead(settings), 1.0 / settings.publish_rate
        #: How many periods the stream is ahead.
        self.lead = AdaptiveLead(self.period, settings.lead, self._most)
        self._logger, self._said = node.get_logger(), False
        # The time of the latest knot (s).
        self._knot = 0.0
        # End of the last message (rad or m).
        self._end: Array | None = None
        self._publisher = node.create_publisher(JointTrajectory, settings.command_out_topic, 10)
        self.topic = str(self._publisher.topic_name)  #: Topic of the controller's input.

    def begin(self, now: float, position: Array, velocity: Array) -> None:
        """Begin where the joints will be at the first knot (rad or m, and per s)."""
        ahead = self.lead.periods * self.period
        self.lead.begin()
        self._servo.start(position + ahead * velocity, velocity)
        self._knot, self._end = now + ahead, None

    def catch_up(self, now: float) -> None:
        """After a delay of the node, brake as the controller already does."""
        earliest = now + _MIN_LEAD * self.period
        while self._knot < earliest and not self._servo.motion.at_rest:
            self._servo.motion.brake()
            self._knot += self.period
        if self._knot < earliest:
            self._knot = now + self.lead.periods * self.period

    def go_on(self, now: float) -> ServoReport | None:
        """Go on until the stream is as far ahead as it should be; None if it is already.

        No more knots are new than a message shows before its latest.
        """
        lead = self.lead.periods
        report, enough = None, now + (lead + 0.5) * self.period
        if self._knot < enough:
            # The next knot was due when the one before it was so far ahead.
            self._follow_lateness(now, now - (self._knot + self.period - lead * self.period))
        for _ in range(lead):
            if self._knot >= enough:
                break
            report = self._servo.step(now)
            self._knot += self.period
        return report

    def _follow_lateness(self, now: float, late: float) -> None:
        """Adapt the lead to a lateness (s), with a warning the first time."""
        self.lead.sent(now, late)
        lead = self.lead
        if lead.latest and not self._said:
            self._said = True
            enough = min(lead.needed, self._most)
            self._logger.warning(
                f"points for the controller come up to {1e3 * lead.latest:.0f} ms late, as on a "
                f"busy machine: while that goes on, the lead rises to at most {self._most} "
                f"(max_lead); lead: {enough} would have been enough from the start"
            )

    def end_moved(self) -> bool:
        """Return True if the stream no longer ends where the last message ended."""
        end = self._servo.samples().positions[-1]
        return self._end is None or bool(np.abs(end - self._end).max() > _END_TOLERANCE)

    def publish(self, now: float) -> tuple[float, Array]:
        """Publish the stream; its stamp is no later than now, so that it counts at once.

        Returns the time (s) of the first knot that is shown, and the joint positions (n,) there
        (rad or m).
        """
        samples, lead = self._servo.samples(), self.lead.periods
        self._end = samples.positions[-1]
        # The servo shows more knots than needed now.
        samples = Samples(*(part[self._most - lead :] for part in samples))
        samples.times[:] -= samples.times[0]
        first = self._knot - lead * self.period
        sent_for = min(now, first - self.period)
        stamp = Time(nanoseconds=max(self._clock.stamp(sent_for), 0)).to_msg()
        self._publisher.publish(stream_message(self._names, samples, first - sent_for, stamp))
        return first, samples.positions[0]
