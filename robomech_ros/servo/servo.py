"""The servo itself: the last command, how old it is, and what becomes of it in the next period."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from robomech_ros.errors import WrongSizeError
from robomech_ros.kinematics.joint_values import as_joint_values, raise_not_finite
from robomech_ros.robots.chain import SerialChain
from robomech_ros.servo.commands import Command, JointCommand, PoseCommand, TwistCommand
from robomech_ros.servo.contact_slowing import (
    ContactGuard,
    MotionAhead,
    contact_report,
    look_ahead,
    slowed,
)
from robomech_ros.servo.cubics import bernstein
from robomech_ros.servo.limits import ServoLimits
from robomech_ros.servo.motion import Samples
from robomech_ros.servo.pose_approach import PoseApproach
from robomech_ros.servo.report import ServoCondition, ServoReport, motion_report
from robomech_ros.servo.stream import Stream
from robomech_ros.servo.twist_following import TwistFollowing
from robomech_ros.servo.twist_resolver import Resolution, TwistResolver
from robomech_ros.spatial.arrays import all_finite, as_finite
from robomech_ros.typing import Array


@dataclass(frozen=True)
class ServoSettings:
    """Behaviour of a servo, with a period (s) between the knots of the stream.

    From the condition number ``slow_from`` on, over the characteristic length, motions into a
    singularity are slowed down, and at ``stop_at`` they stand. Linear motions are divided by a
    length (m), None for the characteristic one. The samples show ``lead`` knots before the latest,
    so that a late receiver goes on.
    """

    period: float = 0.01
    slow_from: float = 30.0
    stop_at: float = 90.0
    length: float | None = None
    lead: int = 1


class Servo:
    """Turns commands into a stream of joint positions for a chain of joints with velocity limits.

    The last command is kept unless it was forgotten; while ``paused`` it brakes and holds, whatever
    is commanded. With a ``guard`` it slows down before contact, and proves every plan to stop free
    of contact. Raises MissingLimitsError for a joint without a velocity limit, BadValueError for a
    chain without joints.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.robots import load_robot
    >>> from robomech_ros.servo import JointCommand, Servo, ServoSettings
    >>> arm = load_robot("ur5e")
    >>> servo = Servo(arm, ServoSettings(period=0.01))
    >>> servo.start(arm.home(), np.zeros(6))
    >>> servo.take(JointCommand(np.array([0.1, 0, 0, 0, 0, 0]), until=1.0))
    >>> reports = [servo.step(0.01 * k) for k in range(1, 51)]  # it accelerates, then follows
    >>> reports[0].condition.value, reports[-1].condition.value
    ('rate bound', 'no warning')
    """

    def __init__(self, chain: SerialChain, settings: ServoSettings) -> None:
        self.limits = ServoLimits.of(chain)
        self._chain, self._period, self._lead = chain, settings.period, settings.lead
        approach = float(np.min(self.limits.acceleration / self.limits.velocity))
        self._resolver = TwistResolver(
            chain, settings.slow_from, settings.stop_at, approach, settings.length
        )
        self._approach = PoseApproach(self._resolver)
        self._stream: Stream | None = None
        self.command: Command | None = None
        self._twists = TwistFollowing(self._resolver, self.limits, self._period)
        self.paused = False
        self.guard: ContactGuard | None = None
        self._mask: tuple[bool, ...] = (False,) * 6

    def hold(self, task_mask: Sequence[bool]) -> None:
        """Follow twists and poses with some components of the tip's pose only, from now on.

        The mask says which of x, y, z, rx, ry, rz are held, along and about the axes of the tip, of
        poses those of the target; all False for the full pose. Raises BadValueError if it is no
        mask.
        """
        if tuple(task_mask) != self._mask:
            self._resolver.hold(task_mask)
            self._mask = tuple(task_mask)
            line = None if self._stream is None else self._stream.line
            self._twists.restart(None if line is None else line.path)

    @property
    def active(self) -> bool:
        """True if the stream has begun and has not been released."""
        return self._stream is not None

    @property
    def motion(self) -> Stream:
        """The stream; only while active."""
        assert self._stream is not None
        return self._stream

    def wants_to_move(self, now: float) -> bool:
        """Return whether there is a command that is neither stale (time in s) nor paused."""
        return self.command is not None and now <= self.command.until and not self.paused

    def take(self, command: Command) -> None:
        """Follow a command from now on.

        Raises BadValueError or WrongSizeError, following the command before on, if it is not as
        described.
        """
        if isinstance(command, JointCommand):
            self._finite("rates", command.rates)
        elif isinstance(command, PoseCommand):
            as_finite("target", command.target, (4, 4))
        elif as_finite("twist", command.twist, (6,)).ndim > 1:
            raise WrongSizeError("twist", command.twist.shape, (6,))
        self.command = command

    def forget(self) -> None:
        """Follow no command."""
        self.command = None

    def start(self, position: Array, velocity: Array) -> None:
        """Begin a stream where the joints are (rad or m, and per s)."""
        given = self._finite("position", position), self._finite("velocity", velocity)
        self._stream = Stream(self.limits, self._period, *given, lead=self._lead)
        self._twists.end()

    def _finite(self, what: str, values: Array) -> Array:
        given = as_joint_values(self._chain, values, what)
        if given.ndim > 1:
            raise WrongSizeError(what, given.shape, (self._chain.n,))
        if not all_finite(given):
            raise_not_finite(self._chain, given, what)
        return given

    def end(self) -> None:
        """Release the joints."""
        self._stream = None

    def step(self, now: float) -> ServoReport:
        """Go on by one period; the time (s) decides whether the command is stale."""
        stream, command = self.motion, self.command
        if command is None or now > command.until or self.paused:
            self._twists.end()
            # On the known plan: its receivers need no more messages.
            stream.brake()
            return self.idle(now, stream.position)
        if isinstance(command, PoseCommand):
            position, velocity = stream.position, stream.velocity
            stop = stream.samples().positions[-1]
            command = self._approach.twist(command, position, position + velocity, stop)
        if self.guard is None:
            return self._follow(stream, command)
        return self._follow_guarded(self.guard, stream, command)

    def _follow_guarded(
        self, guard: ContactGuard, stream: Stream, command: TwistCommand | JointCommand
    ) -> ServoReport:
        """Follow a command for one period without contact; brake if that cannot be proved."""
        part, found = slowed(guard, self._ahead(stream, command))
        if found is not None and not part:
            stream.brake()
            number = self._resolver.condition_number(stream.position)
            still = ServoReport(ServoCondition.NO_WARNING, 0.0, number)
            return contact_report(found, still, part)
        before = stream.copy()
        report = self._follow(stream, _scaled(command, part))
        self._twists.lay_ahead(stream)
        reached = guard.obstruction(bernstein(*stream.newest()))
        if reached is not None:
            self._stream = before
            before.brake()
            found = found or reached
        return report if found is None else contact_report(found, report, part)

    def _ahead(self, stream: Stream, command: TwistCommand | JointCommand) -> MotionAhead | None:
        """Find the motion that a command leads to; None if it moves nothing."""
        if isinstance(command, TwistCommand):
            return self._twists.ahead(stream, command)
        if not command.rates.any():
            return None
        limited, stop = self.limits.limited(command.rates)
        q, seconds = stream.position, look_ahead(stop)
        end = q + seconds * limited * command.rates
        return MotionAhead(np.array((q, end)), seconds, stop, limited)

    def _follow(self, stream: Stream, command: TwistCommand | JointCommand) -> ServoReport:
        if isinstance(command, TwistCommand):
            return self._twists.follow(stream, command)
        self._twists.end()
        number = self._resolver.condition_number(stream.position)
        resolution = Resolution(command.rates, 1.0, False, number, True, np.zeros(6))
        share = self.limits.share_of(resolution.rates)
        advance = stream.advance(share[0] * resolution.rates)
        return motion_report(self.limits, resolution, share, advance, stream.velocity)

    def samples(self) -> Samples:
        """Return the stream from the first knot shown on, at rest at the end."""
        return self.motion.samples()

    def idle(self, now: float, position: Array) -> ServoReport:
        """Report that no command is followed, for joints somewhere (rad or m)."""
        number = self._resolver.condition_number(position)
        if self.paused:
            return ServoReport(ServoCondition.PAUSED, 0.0, number, (), "paused")
        if self.command is None:
            return ServoReport(ServoCondition.NO_WARNING, 1.0, number)
        age = now - self.command.until
        text = f"the last command is stale, for {max(age, 0.0):.3g} s"
        return ServoReport(ServoCondition.STALE_COMMAND, 0.0, number, (), text)


def _scaled(command: TwistCommand | JointCommand, part: float) -> TwistCommand | JointCommand:
    if isinstance(command, TwistCommand):
        return replace(command, twist=part * command.twist)
    return replace(command, rates=part * command.rates)
