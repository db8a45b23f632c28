"""Driver of a walk, cycle by cycle: rise, walk and joint monitoring."""

import math

import numpy as np
from rclpy.node import Node
from rclpy.time import Time
from trajectory_msgs.msg import JointTrajectory

from robomech_ros.nodes.common.joints.joint_state_monitor import JointStateMonitor
from robomech_ros.nodes.common.joints.tracking_monitor import TrackingMonitor
from robomech_ros.nodes.common.messages.joint_messages import stream_message
from robomech_ros.nodes.common.motion_clock import MotionClock
from robomech_ros.nodes.common.status_report import NodeHealth
from robomech_ros.nodes.middleware.throttled_log import ThrottledLog
from robomech_ros.nodes.walker.command_intake import CommandIntake
from robomech_ros.nodes.walker.load_publication import LoadPublication
from robomech_ros.nodes.walker.publication import WalkPublication
from robomech_ros.nodes.walker.settings import WalkerSettings
from robomech_ros.nodes.walker.stream import WalkStream, rising
from robomech_ros.servo.motion import Samples
from robomech_ros.walking import Walker

# A robot whose joints are all this near to where the walk has them stands there (rad or m).
_HOME_TOLERANCE = 0.02
# A joint that is slower than this part of its limit stands.
_STANDSTILL_PART = 0.01
# So often (s) the controller gets a new message.
_MESSAGE_PERIOD = 0.05
# So much longer than planned a rise may take (s).
_PATIENCE = 1.0


class Driver:
    """Drives the walk of one robot."""

    def __init__(
        self, node: Node, walker: Walker, clock: MotionClock, settings: WalkerSettings
    ) -> None:
        self._walker, self._clock, self._settings = walker, clock, settings
        self._log, robot = ThrottledLog(node.get_logger()), walker.robot
        self._names = robot.joint_names
        self._intake = CommandIntake(node, walker, clock, settings.body_pose_duration)
        self._joints = TrackingMonitor(robot, JointStateMonitor(node), settings)
        self._stream = WalkStream(walker, settings.lead)
        self._publication = WalkPublication(node, robot, settings)
        self._loads = LoadPublication(node, robot, settings)
        self._publisher = node.create_publisher(JointTrajectory, settings.command_out_topic, 10)
        self._stands, self._fault, self._streams = False, "", False
        # When a message was sent, until when a rise is waited for (s); since the last report the
        # least part of the command, and the margin.
        self._sent = self._rises_until = -math.inf
        self._part, self._margin = 1.0, math.nan

    @property
    def topics(self) -> tuple[str, str]:
        """Topics of the twists and of the controller's input."""
        return self._intake.twists.topic, str(self._publisher.topic_name)

    def cycle(self) -> None:
        """Do what is due."""
        now = self._clock.now()
        self._intake.take(self._stands)
        if not self._stands and not self._begin(now):
            return
        stream = self._stream
        stream.go_on(now)
        knot = stream.present
        if stream.moves:
            if not self._streams:
                self._joints.begin(now)
            if not self._streams or now > self._sent + _MESSAGE_PERIOD:
                self._send(stream.samples(), knot.time)
                self._sent = now
            self._streams = True
            self._joints.expect(knot.time, knot.update.q)
            if fault := self._joints.fault(now):
                self._let_go(fault.why)
                return
        else:
            self._streams = False
            if (why := self._elsewhere()) and self._settings.tracking_tolerance:
                self._let_go(why)
                return
        self._part = min(self._part, knot.update.part)
        self._margin = knot.update.margin
        stamp = self._clock.stamp(knot.time)
        self._publication.publish(knot.update, stamp)
        self._loads.publish(stream, stamp)

    def _begin(self, now: float) -> bool:
        """Begin to walk where the robot stands, go on where it stopped, else have it rise."""
        state = self._joints.fresh_state(now)
        if state is None:
            return False
        position, rates = state
        robot = self._walker.robot
        if (np.abs(rates) > _STANDSTILL_PART * robot.velocity).any():
            return False
        at_home = np.abs(position - robot.home).max() <= _HOME_TOLERANCE
        if at_home or self._stream.resume(now, position):
            if at_home:
                self._stream.begin(now)
            self._publication.forget()
            self._joints.stop_waiting()
            self._stands, self._fault, self._streams = True, "", False
            return True
        if self._intake.commanded and now > self._rises_until:
            rise = rising(self._walker, position, self._settings.rising_speed)
            self._send(rise, now)
            self._rises_until = now + float(rise.times[-1]) + _PATIENCE
            self._log.info(f"rises in {rise.times[-1]:.3g} s")
        return False

    def _elsewhere(self) -> str:
        """Say which joint somebody else has moved; empty for none."""
        position = self._joints.position()
        if position is None:
            return ""
        off = np.abs(position - self._stream.present.update.q)
        worst = int(np.argmax(off))
        if off[worst] <= self._settings.tracking_tolerance:
            return ""
        return f"joint '{self._names[worst]}' was moved by {off[worst]:.4g} from where it stood"

    def _let_go(self, why: str) -> None:
        """Send nothing more: the joints brake by the last message, unless others move them."""
        self._stands = False
        self._fault = f"{why}; the robot is let go until its joints stand"
        self._log.warning(self._fault)

    def _send(self, samples: Samples, begin: float) -> None:
        """Send joints that move from a time (s) on."""
        stamp = Time(nanoseconds=max(self._clock.stamp(begin), 0)).to_msg()
        self._publisher.publish(stream_message(self._names, samples, 0.0, stamp))

    def condition(self) -> NodeHealth:
        """Describe the walk, for the diagnostics."""
        intake, walker = self._intake, self._walker
        part, self._part = self._part, 1.0
        summary = "walks" if self._streams else "stands"
        if not self._stands:
            summary = self._fault or self._waits_for()
        limited = f"follows {part:.0%} of the command, which legs or joints limit"
        refusal = "; ".join(filter(None, (intake.refusal, intake.twists.refusal)))
        trouble = refusal or (limited if part < 1.0 else "")
        values = {
            "gait": walker.gait,
            "stability margin (m)": f"{self._margin:.6g}",
            "stability bound (m)": f"{walker.bound:.6g}",
            "part of the command": f"{part:.3g}",
            "load of the feet": self._loads.refusal or "carried",
            "ignored commands": intake.refused + intake.twists.refused,
            "last ignored": refusal,
        }
        text = f"{summary}; {trouble}" if trouble else summary
        return NodeHealth(text, bool(trouble or not self._stands), values)

    def _waits_for(self) -> str:
        if self._joints.position() is None:
            return self._joints.why_no_state()
        if self._clock.now() <= self._rises_until:
            return "rises"
        return "does not stand as it walks: it rises at the first command"
