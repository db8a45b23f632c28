"""The node that drives the robot by twists and joint velocities, as they come."""

import math
from collections.abc import Callable, Sequence
from contextlib import suppress
from threading import Thread
from typing import Any

import numpy as np
from geometry_msgs.msg import TwistStamped
from numpy.typing import NDArray
from rclpy.clock import Clock, ClockType
from rclpy.node import Node
from rclpy.time import Time
from sensor_msgs.msg import JointState
from std_srvs.srv import SetBool
from trajectory_msgs.msg import JointTrajectory

from robomech_interfaces.msg import ServoStatus
from robomech_ros.errors import RobomechError
from robomech_ros.kinetostatics.singularities.generic_rank import scaling_length
from robomech_ros.nodes.common.error_codes import NoStateError
from robomech_ros.nodes.common.joint_state_monitor import JointStateMonitor
from robomech_ros.nodes.common.motion_clock import MotionClock
from robomech_ros.nodes.common.parameters import NodeParameters
from robomech_ros.nodes.common.polled_subscription import Inbox
from robomech_ros.nodes.common.robot_description import RobotModel, when_robot_known
from robomech_ros.nodes.process.run import run_node
from robomech_ros.nodes.servo.commands import CommandReader
from robomech_ros.nodes.servo.settings import ServoNodeSettings, check_settings, core_settings
from robomech_ros.nodes.servo.status import status_message
from robomech_ros.nodes.servo.stream import stream_message
from robomech_ros.robots import SerialChain
from robomech_ros.servo.servo import Command, Servo, ServoReport
from robomech_ros.servo.tracking import Tracking

Array = NDArray[np.float64]

# Messages of one kind that are looked at in a period; of faster senders the latest.
_DEPTH = 10
# A knot that is nearer than this part of a period is too near for the controller to get it in time.
_IN_TIME = 0.2
# How long the next state of the joints may take before it is missed (s).
_STATE_DUE = 0.2
# How long states may fail to come on top of the tracking delay while the robot is driven, and how
# long the robot is left alone after it did not follow (s).
_STATE_LOST = 0.5
_LEFT_ALONE = 0.5
# A joint that is slower than this part of its limit stands.
_STANDING = 0.01
# How often it is looked whether the robot's length is found (s).
_LOOK = 0.05
# How often a status is repeated while nothing moves, and how long it is looked for commands after
# the last one (s); after that the executor waits for them.
_REPEATED = 1.0


class ServoNode(Node):
    """Drives the robot by twists of the tip or joint velocities, within all limits."""

    SETTINGS = ServoNodeSettings

    def __init__(self, **options: Any) -> None:
        super().__init__("servo", **options)
        self._table = NodeParameters(self, ServoNodeSettings, check=check_settings)
        check_settings(self._table.settings)
        self._motion_clock = MotionClock(self)
        self._monitor = JointStateMonitor(self)
        when_robot_known(self, self._table.settings, self._serve)

    def _serve(self, model: RobotModel) -> None:
        """Find the characteristic length, which takes some seconds, while others are served."""
        if self._table.settings.characteristic_length:
            self._drive(model)
            return
        search = Thread(target=_find_length, args=(model.chain,), daemon=True)
        search.start()

        def look() -> None:
            if not search.is_alive():
                timer.cancel()
                self._drive(model)

        timer = self.create_timer(_LOOK, look, clock=Clock(clock_type=ClockType.STEADY_TIME))

    def _drive(self, model: RobotModel) -> None:
        settings, self._names = self._table.settings, model.chain.joint_names
        try:
            self._servo = Servo(model.chain, core_settings(settings))
        except RobomechError as error:
            # Other nodes that were brought up with this one can do without it.
            self.get_logger().error(f"this robot cannot be driven: {error}")
            return
        self._period, self._lead = 1.0 / settings.publish_rate, settings.lead
        self._tracking = Tracking(model.chain, settings.tracking_tolerance, settings.tracking_delay)
        # The time of the latest knot of the stream (s).
        self._knot = 0.0
        self._halts = self._heard = 0
        self._heard_at = 0.0
        # Why the robot is left alone, the joints at fault, and until when at least (s).
        self._fault: tuple[str, tuple[str, ...]] | None = None
        self._left_alone_until = 0.0
        self._waits_from: float | None = None
        self._awake_until = 0.0
        self._refusal, self._refused_until = "", -math.inf
        self._told: tuple[tuple[object, ...], float] = ((), -math.inf)
        reader = CommandReader(model, self._motion_clock, lambda: self._table.settings)
        self._readers: list[tuple[Inbox, Callable[[Any], Command]]] = [
            (self._inbox(TwistStamped, "~/delta_twist_cmds"), reader.twist),
            (self._inbox(JointState, "~/joint_velocity_cmds"), reader.joint_state),
        ]
        self._add_joint_jog(reader)
        self._stream = self.create_publisher(JointTrajectory, settings.command_out_topic, 10)
        self._status = self.create_publisher(ServoStatus, "~/status", 10)
        self.create_service(SetBool, "~/pause_servo", self._pause)
        self._timer = self.create_timer(self._period, self._tick, clock=self._motion_clock.clock)
        self._timer.cancel()
        # A timer that has not fired since it was reset would wait until its old time comes again.
        self._motion_clock.on_jump(lambda by: self._timer.is_canceled() or self._timer.reset())
        self.get_logger().info(
            f"ready: {model.chain.name}, {len(self._names)} joints, "
            f"{settings.publish_rate:g} Hz to '{self._stream.topic_name}'"
        )
        self._wake()

    def _add_joint_jog(self, reader: CommandReader) -> None:
        try:
            from control_msgs.msg import JointJog
        except ImportError as error:
            if getattr(error, "name", "") != "control_msgs":
                self.get_logger().warning(f"no delta_joint_cmds: {error}")
            return
        self._readers.append((self._inbox(JointJog, "~/delta_joint_cmds"), reader.joint_jog))

    def _inbox(self, kind: type, topic: str) -> Inbox:
        return Inbox(self, kind, topic, _DEPTH, self._wake)

    def _wake(self) -> None:
        """Look again and again, from now on until nothing is to be seen for a while."""
        self._awake_until = self._motion_clock.now() + _REPEATED
        if self._timer.is_canceled():
            for inbox, _ in self._readers:
                inbox.attend(False)
            self._timer.reset()
            self._tick()

    def _sleep(self, now: float) -> None:
        if now > self._awake_until and not self._servo.active:
            self._timer.cancel()
            for inbox, _ in self._readers:
                inbox.attend(True)

    def _pause(self, request: Any, response: Any) -> Any:
        self._servo.paused = bool(request.data)
        # What was commanded before must not move the robot after a pause.
        self._servo.forget()
        for inbox, _ in self._readers:
            list(inbox.take())
        response.success = True
        response.message = "paused: brakes and holds" if request.data else "follows commands"
        self._wake()
        return response

    def _tick(self) -> None:
        now = self._motion_clock.now()
        self._take_commands(now)
        if not self._servo.active and not self._begin(now):
            self._sleep(now)
            return
        self._catch_up(now)
        report = self._go_on(now)
        if report is None:
            return
        self._publish(now)
        self._publish_status(report, now)
        self._compare(now)
        if not self._servo.active:
            return
        idle = self._servo.motion.at_rest and not self._servo.wants_to_move(now)
        self._halts = self._halts + 1 if idle else 0
        if self._halts >= self._table.settings.halt_messages:
            self._servo.end()

    def _take_commands(self, now: float) -> None:
        for inbox, read in self._readers:
            for message in inbox.take():
                self._awake_until = now + _REPEATED
                try:
                    self._offer(read(message), inbox.topic, now)
                except RobomechError as error:
                    self._refusal = f"command on '{inbox.topic}' refused: {error}"
                    self._refused_until = now + self._table.settings.command_timeout

    def _offer(self, command: Command, topic: str, now: float) -> None:
        """Follow a command, unless one of the other kind is being followed."""
        last = self._servo.command
        if self._servo.wants_to_move(now) and type(last) is not type(command):
            text = f"command on '{topic}' refused: commands of the other kind are being followed"
            self._refusal = f"{text}; one kind at a time"
            self._refused_until = now + self._table.settings.command_timeout
            return
        if not self._servo.paused:
            self._servo.take(command)
            if self._refused_until <= now:
                self._refusal = ""

    def _begin(self, now: float) -> bool:
        """Begin a stream if there is a reason to; says whether it has begun."""
        alone = now < self._left_alone_until
        if not self._servo.wants_to_move(now) or alone:
            self._waits_from = None
            if alone:
                self._tell_fault(now)
            else:
                self._tell_idle(now)
            return False
        position = self._monitor.positions(self._names)
        heard = self._monitor.heard(self._names)
        if self._waits_from is None:
            # What was heard before may be old: the next state is the present one.
            self._waits_from, self._heard = now, heard
        if position is None or heard <= self._heard:
            overdue = position is None or now > self._waits_from + _STATE_DUE
            if overdue and self._is_new(("no state",), now):
                self._publish_status(None, now, self._why_no_state())
            return False
        velocity = self._monitor.velocities(self._names)
        if self._fault is not None:
            if (np.abs(velocity) > _STANDING * self._servo.limits.velocity).any():
                self._tell_fault(now)
                return False
            self._fault = None
        ahead = self._lead * self._period
        self._servo.start(position + ahead * velocity, velocity)
        self._tracking.begin()
        self._knot, self._waits_from, self._halts = now + ahead, None, 0
        self._heard, self._heard_at = heard, now
        return True

    def _compare(self, now: float) -> None:
        """Let go of a robot that does not do what it is told, or of which nothing is heard."""
        settings = self._table.settings
        if not settings.tracking_tolerance:
            return
        position = self._monitor.positions(self._names)
        heard = self._monitor.heard(self._names)
        if position is None or heard <= self._heard:
            silent = now - self._heard_at
            if silent > settings.tracking_delay + _STATE_LOST:
                self._let_go(now, f"no state of the joints for {silent:.3g} s", ())
            return
        self._heard, self._heard_at = heard, now
        found = self._tracking.deviation(now, position)
        if found is not None:
            self._let_go(now, found.text, (found.joint,))

    def _let_go(self, now: float, why: str, joints: tuple[str, ...]) -> None:
        """End the stream: its last message has the robot brake, unless others move it."""
        self._servo.end()
        self._servo.forget()
        self._fault = f"{why}; the stream has stopped", joints
        self._left_alone_until = now + _LEFT_ALONE
        self.get_logger().warning(self._fault[0])
        self._tell_fault(now)

    def _tell_fault(self, now: float) -> None:
        if self._fault is not None and self._is_new(self._fault, now):
            self._publish_status(None, now, *self._fault)

    def _why_no_state(self) -> str:
        try:
            self._monitor.require(self._names)
        except NoStateError as error:
            return str(error)
        return "waits for a new state of the joints"

    def _catch_up(self, now: float) -> None:
        """Where the node was held up, the controller has begun to stop, as it was told."""
        earliest = now + _IN_TIME * self._period
        while self._knot < earliest and not self._servo.motion.at_rest:
            self._servo.motion.brake()
            self._knot += self._period
        if self._knot < earliest:
            self._knot = now + self._lead * self._period

    def _go_on(self, now: float) -> ServoReport | None:
        """Go on until the stream is as far ahead as it should be; None if it is already.

        No more knots are new than a message shows before its latest.
        """
        report, enough = None, now + (self._lead + 0.5) * self._period
        for _ in range(self._lead):
            if self._knot >= enough:
                break
            report = self._servo.step(now)
            self._knot += self._period
        return report

    def _publish(self, now: float) -> None:
        """Publish the stream; its stamp is no later than now, so that it counts at once."""
        samples = self._servo.samples()
        first = self._knot - self._lead * self._period
        told = min(now, first - self._period)
        stamp = Time(nanoseconds=max(self._motion_clock.stamp(told), 0)).to_msg()
        self._stream.publish(stream_message(self._names, samples, first - told, stamp))
        self._tracking.tell(first, samples.positions[0])

    def _tell_idle(self, now: float) -> None:
        """Publish the status of a robot that is left alone, where it is new."""
        if self._is_new((self._servo.paused, self._servo.command is None), now):
            position = self._monitor.positions(self._names)
            if position is None:
                self._publish_status(None, now, self._why_no_state())
            else:
                self._publish_status(self._servo.idle(now, position), now)

    def _is_new(self, situation: tuple[object, ...], now: float) -> bool:
        """Whether a situation, or a refusal in it, was not told in the last second."""
        situation = (*situation, self._refusal_at(now))
        if situation == self._told[0] and now < self._told[1] + _REPEATED:
            return False
        self._told = (situation, now)
        return True

    def _refusal_at(self, now: float) -> str:
        return self._refusal if now <= self._refused_until else ""

    def _publish_status(
        self, report: ServoReport | None, now: float, why: str = "", joints: tuple[str, ...] = ()
    ) -> None:
        stamp, refusal = self.get_clock().now().to_msg(), self._refusal_at(now)
        self._status.publish(status_message(stamp, report, refusal, why, joints))


def _find_length(chain: SerialChain) -> None:
    """Have the length kept for who asks next; what is wrong with the chain is told then."""
    with suppress(RobomechError):
        scaling_length(chain, None)


def main(args: Sequence[str] | None = None) -> int:
    """Run the node; returns the exit code."""
    return run_node(ServoNode, args)


if __name__ == "__main__":
    raise SystemExit(main())
