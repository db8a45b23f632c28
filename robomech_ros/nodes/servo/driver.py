"""Drives the robot period by period: takes commands, continues the stream, watches the joints."""

from collections.abc import Callable

import numpy as np
from rclpy.node import Node

from robomech_ros.nodes.common.joints.joint_state_monitor import JointStateMonitor
from robomech_ros.nodes.common.joints.stall_monitor import HELD_UP, StallMonitor
from robomech_ros.nodes.common.joints.tracking_monitor import Fault, TrackingMonitor
from robomech_ros.nodes.common.motion_clock import MotionClock
from robomech_ros.nodes.common.robot.robot_description import RobotModel
from robomech_ros.nodes.frames.robot_frames import RobotFrames
from robomech_ros.nodes.middleware.throttled_log import ThrottledLog
from robomech_ros.nodes.servo.command_intake import CommandIntake
from robomech_ros.nodes.servo.command_reader import CommandReader
from robomech_ros.nodes.servo.scene_guard import SceneGuard
from robomech_ros.nodes.servo.settings import ServoNodeSettings
from robomech_ros.nodes.servo.status import REPEATED, StatusPublisher
from robomech_ros.nodes.servo.stream import StreamPublisher
from robomech_ros.servo.commands import Command
from robomech_ros.servo.servo import Servo

# How long the robot is left alone after it did not follow (s).
_PAUSE_AFTER_FAULT = 0.5
# A joint that is slower than this part of its limit stands.
_STANDSTILL_PART = 0.01


class Driver:
    """Makes one robot follow commands; idle it is woken by the next of them.

    - ``servo``: turns commands into a stream.
    """

    def __init__(
        self,
        node: Node,
        model: RobotModel,
        servo: Servo,
        monitor: JointStateMonitor,
        clock: MotionClock,
        settings: Callable[[], ServoNodeSettings],
    ) -> None:
        self._servo, self._clock, self._settings = servo, clock, settings
        self._log = ThrottledLog(node.get_logger())
        self._repeats = 0
        self._fault: Fault | None = None
        # Until when at least the robot is left alone, and it is looked for commands (s).
        self._left_alone_until = self._awake_until = 0.0
        # It is looked for commands, or at rest for what to tell.
        self._hold_ups = StallMonitor()
        self._hold_ups.look(clock.now())
        frames = RobotFrames(node, model, monitor, settings)
        #: The stream to the controller.
        self.stream = StreamPublisher(node, servo, clock, model.chain.joint_names, settings())
        lead = self.stream.lead
        reader = CommandReader(
            model, frames, monitor, clock, settings, lambda: lead.periods * self.stream.period
        )
        self._intake = CommandIntake(node, servo, reader, settings, self.wake)
        self._status = StatusPublisher(node, self._intake.refusal)
        try:
            from robomech_ros.nodes.servo.moveit_interface import MoveItInterface
        except ImportError as error:
            node.get_logger().info(f"no switch_command_type and no servo_node/status: {error}")
        else:
            self._status.also = MoveItInterface(node, self._choose).publish
        self._joints = TrackingMonitor(model.chain, monitor, settings())
        self._scene = SceneGuard(node, model, monitor, settings)
        self._timer = node.create_timer(self.stream.period, self._tick, clock=clock.clock)
        self._timer.cancel()
        self._idle_timer = node.create_timer(REPEATED, self._publish_at_rest)
        # A timer that has not fired since it was reset would wait until its old time comes again.
        clock.on_jump(lambda by: self._timer.is_canceled() or self._timer.reset())

    def wake(self) -> None:
        """Look again and again, from now on until nothing is to be seen for a while."""
        now = self._clock.now()
        self._awake_until = now + REPEATED
        if self._timer.is_canceled():
            self._intake.attend(False)
            self._timer.reset()
            self._after_hold_up(now, REPEATED + HELD_UP)
            self._tick()

    def close(self) -> None:
        """End the thread that makes scenes."""
        self._scene.close()

    def pause(self, paused: bool) -> None:
        """Brake and hold whatever is commanded, or follow commands again."""
        self._servo.paused = paused
        # Earlier commands must not move the robot after a pause.
        self._servo.forget()
        self._intake.clear()
        self.wake()

    def _choose(self, kind: type[Command]) -> None:
        self._intake.choose(kind)
        self.wake()

    def _after_hold_up(self, now: float, most: float) -> None:
        """End motions after a stall of more than `most` (s): the robot has braked meanwhile."""
        if self._hold_ups.look(now, most):
            self._servo.end()
            self._servo.forget()

    def _tick(self) -> None:
        now = self._clock.now()
        self._after_hold_up(now, HELD_UP)
        if self._hold_ups.age(now):
            self._intake.clear()
            self._awake_until = now + REPEATED
        elif self._intake.take(now):
            self._awake_until = now + REPEATED
        if not self._servo.active and not self._begin(now):
            if now > self._awake_until and not self._servo.active:
                self._timer.cancel()
                self._intake.attend(True)
            return
        self._servo.hold(self._settings().task_mask)
        self._servo.guard = self._scene.current()
        self.stream.catch_up(now)
        report = self.stream.go_on(now)
        if report is None:
            return
        self._status.publish(now, report)
        if self._has_said_all(now):
            # The robot brakes by the plan of the last message, unless others move it already.
            if self._servo.motion.at_rest:
                self._servo.end()
            return
        self._joints.expect(*self.stream.publish(now))
        if fault := self._joints.fault(now):
            self._let_go(now, fault)
        elif (lag := self._joints.lag(now)) is not None:
            self.stream.lead.followed(now, lag)

    def _has_said_all(self, now: float) -> bool:
        """Return whether commands have ended and enough messages contained the plan to stop."""
        if self._servo.wants_to_move(now) or self.stream.end_moved():
            self._repeats = 0
            return False
        self._repeats += 1
        return self._repeats > self._settings().halt_messages

    def _begin(self, now: float) -> bool:
        """Begin a stream if there is a reason to; says whether it has begun."""
        alone = now < self._left_alone_until
        if alone or not self._servo.wants_to_move(now):
            self._joints.stop_waiting()
            if alone:
                self._report_fault(now)
            elif self._status.is_new((self._servo.paused, self._servo.command is None), now):
                self._publish_idle(now)
            return False
        state = self._joints.fresh_state(now)
        if state is None:
            if self._joints.is_overdue(now) and self._status.is_new(("no state",), now):
                self._status.publish(now, why=self._joints.why_no_state())
            return False
        if self._fault is not None:
            if (np.abs(state[1]) > _STANDSTILL_PART * self._servo.limits.velocity).any():
                self._report_fault(now)
                return False
            self._fault = None
        self.stream.begin(now, *state)
        self._joints.begin(now)
        self._repeats = 0
        return True

    def _let_go(self, now: float, fault: Fault) -> None:
        """End the stream: its last message has the robot brake, unless others move it."""
        self._servo.end()
        self._servo.forget()
        self._fault = fault._replace(why=f"{fault.why}; the stream has stopped")
        self._left_alone_until = now + _PAUSE_AFTER_FAULT
        self._log.warning(self._fault.why)
        self._report_fault(now)

    def _report_fault(self, now: float) -> None:
        if self._fault is not None and self._status.is_new(self._fault, now):
            self._status.publish(now, None, *self._fault)

    def _publish_at_rest(self) -> None:
        """Publish the status from time to time also where nothing has happened for long."""
        if self._timer.is_canceled():
            now = self._clock.now()
            self._after_hold_up(now, REPEATED + HELD_UP)
            self._publish_idle(now)

    def _publish_idle(self, now: float) -> None:
        position = self._joints.position()
        if position is None:
            self._status.publish(now, why=self._joints.why_no_state())
        else:
            self._status.publish(now, self._servo.idle(now, position))
