"""The servo itself: the last command, how old it is, and what becomes of it in the next period."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robomech_ros.errors import WrongSizeError
from robomech_ros.kinematics.joint_values import as_joint_values, raise_not_finite
from robomech_ros.robots.chain import SerialChain
from robomech_ros.servo.commands import Command, JointCommand, PoseCommand, TwistCommand
from robomech_ros.servo.departures import Start
from robomech_ros.servo.joining import Joining
from robomech_ros.servo.leaving import Leaving
from robomech_ros.servo.limits import ServoLimits
from robomech_ros.servo.line_laying import LineLaying
from robomech_ros.servo.line_path import LinePath
from robomech_ros.servo.motion import Advance, Samples
from robomech_ros.servo.pose_approach import PoseApproach
from robomech_ros.servo.report import ServoCondition, ServoReport, motion_report
from robomech_ros.servo.resolution import Resolution, TwistResolver
from robomech_ros.servo.stream import Stream
from robomech_ros.spatial.arrays import all_finite, as_finite

__all__ = ["Servo", "ServoSettings"]

Array = NDArray[np.float64]

# Twists whose directions differ by less than this are the same.
_SAME = 1e-9
# The least part of a twist with which its way passes a singularity.
_PASSING = 0.2
# A way so short (s^2, by acceleration limits) leads nowhere.
_BEGINNING = 1e-6


@dataclass(frozen=True)
class ServoSettings:
    """How a servo behaves.

    Attributes
    ----------
    period : float
        Time between knots of the stream (s).
    slow_from, stop_at : float
        Condition numbers, over the characteristic length, from which on motions into a
        singularity are slowed down, and at which they stand.
    length : float or None
        By which linear motions are divided (m); None for the characteristic length.
    lead : int
        How many knots before the latest the samples show, so that who gets them late goes on.
    """

    period: float = 0.01
    slow_from: float = 30.0
    stop_at: float = 90.0
    length: float | None = None
    lead: int = 1


class Servo:
    """Turns commands into a stream of joint positions for one chain.

    Parameters
    ----------
    chain : SerialChain
        Of n joints with velocity limits.
    settings : ServoSettings
        How it behaves.

    Raises
    ------
    MissingLimitsError
        A joint has no velocity limit.
    BadValueError
        The chain has no joint.

    Attributes
    ----------
    paused : bool
        Whether it brakes and holds, whatever is commanded.
    """

    def __init__(self, chain: SerialChain, settings: ServoSettings) -> None:
        self.limits = ServoLimits.of(chain)
        self._chain, self._period, self._lead = chain, settings.period, settings.lead
        approach = float(np.min(self.limits.acceleration / self.limits.velocity))
        self._resolver = TwistResolver(
            chain, settings.slow_from, settings.stop_at, approach, settings.length
        )
        self._approach = PoseApproach(chain)
        self._stream: Stream | None = None
        self._command: Command | None = None
        # The twist of the period before, in its axes.
        self._last: TwistCommand | None = None
        self._joining = Joining()
        self._leaving = Leaving(self._resolver)
        self.paused = False

    @property
    def active(self) -> bool:
        """Whether the stream has begun and not been let go."""
        return self._stream is not None

    @property
    def motion(self) -> Stream:
        """The stream; only while active."""
        assert self._stream is not None
        return self._stream

    @property
    def command(self) -> Command | None:
        """The last command, unless it was forgotten."""
        return self._command

    def wants_to_move(self, now: float) -> bool:
        """Whether there is a command that is neither stale (time in s) nor paused."""
        return self._command is not None and now <= self._command.until and not self.paused

    def take(self, command: Command) -> None:
        """Follow a command from now on.

        Raises
        ------
        BadValueError, WrongSizeError, NonFiniteError
            It is not as described; the command before is followed on.
        """
        if isinstance(command, JointCommand):
            self._finite("rates", command.rates)
        elif isinstance(command, PoseCommand):
            as_finite("target", command.target, (4, 4))
        elif as_finite("twist", command.twist, (6,)).ndim > 1:
            raise WrongSizeError("twist", command.twist.shape, (6,))
        self._command = command

    def forget(self) -> None:
        """Follow no command."""
        self._command = None

    def start(self, position: Array, velocity: Array) -> None:
        """Begin a stream where the joints are (rad or m, and per s).

        Raises
        ------
        BadValueError, WrongSizeError, NonFiniteError
            Not n finite numbers each.
        """
        given = self._finite("position", position), self._finite("velocity", velocity)
        self._stream = Stream(self.limits, self._period, *given, lead=self._lead)
        self._last = None

    def _finite(self, what: str, values: Array) -> Array:
        """Check n numbers, one for each joint."""
        given = as_joint_values(self._chain, values, what)
        if given.ndim > 1:
            raise WrongSizeError(what, given.shape, (self._chain.n,))
        if not all_finite(given):
            raise_not_finite(self._chain, given, what)
        return given

    def end(self) -> None:
        """Let the joints go."""
        self._stream = None

    def step(self, now: float) -> ServoReport:
        """Go on by one period; the time (s) decides whether the command is stale."""
        stream, command = self.motion, self._command
        if command is None or now > command.until or self.paused:
            self._last = None
            # On the plan that is known already: who has it needs no more messages.
            stream.brake()
            return self._standing(now)
        if isinstance(command, PoseCommand):
            command = self._towards(command)
        if isinstance(command, TwistCommand):
            return self._follow(command)
        self._last = None
        number = self._condition_number()
        resolution = Resolution(command.rates, 1.0, False, number, True, np.zeros(6))
        share = self.limits.share_of(resolution.rates)
        advance = stream.advance(share[0] * resolution.rates)
        return motion_report(self.limits, resolution, share, advance, stream.velocity)

    def _towards(self, command: PoseCommand) -> TwistCommand:
        """Give the twist that leads to a pose."""
        position, velocity = self.motion.position, self.motion.velocity
        stop = self.motion.samples().positions[-1]
        return self._approach.twist(command, position, position + velocity, stop)

    def _follow(self, command: TwistCommand) -> ServoReport:
        """Go on by one period with a twist."""
        stream = self.motion
        velocity = stream.velocity
        # The wanted velocity is that at the next knot.
        position = stream.position + self._period * velocity
        twist = _twist_of(command, position)
        if self._last is None:
            self._leaving.forget()
        if self._last is None or not _ratio(_twist_of(self._last, position), twist):
            self._joining.begin()
            self._leaving.begin()
        self._last = command
        found = self._resolver.resolve(position, twist, velocity)
        beyond = found.condition_number >= self._resolver.stop_at
        if stream.line is not None:
            stream.line.path.begin_period()
        elif stream.at_rest and twist.any() and (found.scale or beyond):
            self._begin_line(command, twist, beyond)
        advance = None
        if stream.line is not None:
            found, advance = self._on_line(position, twist, found)
        elif not (stream.at_rest or beyond) and found.scale and twist.any():
            part = min(self.limits.share_of(found.rates)[0], found.scale)
            advance = self._joining.attempt(
                stream, part, lambda: self._path(command, Start(stream.knot()))
            )
        if advance is None:
            found = self._resolver.unheld(position, twist, found, self.limits.acceleration)
            part = min(self.limits.share_of(found.rates)[0], found.scale)
            advance = stream.advance(self._joining.slower * part * found.rates)
        share = self.limits.share_of(found.rates)
        return motion_report(self.limits, found, share, advance, stream.velocity)

    def _path(self, command: TwistCommand, start: Start) -> LinePath:
        """Give the way for a twist."""
        weights = 1.0 / self.limits.acceleration
        way = LineLaying(self._resolver, weights, start, lambda q: _twist_of(command, q))
        return LinePath(way)

    def _begin_line(self, command: TwistCommand, twist: Array, beyond: bool) -> None:
        """Go on on the line of a twist from rest, where there is one."""
        knot = self.motion.knot()
        if not beyond:
            path = self._path(command, Start(knot))
            if path.reach(_BEGINNING) or path.singular or path.unfinished:
                self.motion.begin(path)
            return
        out = self._leaving.way(knot, twist, lambda start: self._path(command, start))
        if out is not None:
            self.motion.begin(out)

    def _on_line(
        self, position: Array, twist: Array, found: Resolution
    ) -> tuple[Resolution, Advance | None]:
        """Go on by one period on the line of a twist; None where that cannot be."""
        stream, line = self.motion, self.motion.line
        assert line is not None
        ratio = _ratio(line.path.twist(position), twist)
        if ratio == 0.0:
            return found, None
        if line.leaves:
            rates = ratio * line.wanted * line.path.slope(line.place)
            # The wrist turns no faster, for a small twist, than at the hard stop.
            scale = min(
                1.0, float(np.abs(found.rates).max()) / max(float(np.abs(rates).max()), 1e-300)
            )
            found = found._replace(rates=rates, scale=scale, leaving=True)
        else:
            # Whether it ends, and where, is known of the way.
            found = found._replace(scale=max(found.scale, _PASSING))
        part = min(self.limits.share_of(found.rates)[0], found.scale)
        advance = stream.follow(part * ratio * line.wanted)
        if advance is not None and line.path.singular and not advance.bound:
            # The end of the way is in sight.
            found = found._replace(scale=min(part, line.rate / max(line.wanted, 1e-300)))
        return found, advance

    def samples(self) -> Samples:
        """Give the stream from the first knot shown on, at rest at the end."""
        return self.motion.samples()

    def idle(self, now: float, position: Array) -> ServoReport:
        """Report without a stream, for joints somewhere (rad or m)."""
        return self._standing(now, self._resolver.condition_number(position))

    def _condition_number(self) -> float:
        return self._resolver.condition_number(self.motion.position)

    def _standing(self, now: float, condition: float | None = None) -> ServoReport:
        number = self._condition_number() if condition is None else condition
        if self.paused:
            return ServoReport(ServoCondition.PAUSED, 0.0, number, (), "paused")
        if self._command is None:
            return ServoReport(ServoCondition.NO_WARNING, 1.0, number)
        age = now - self._command.until
        text = f"the last command is stale, for {max(age, 0.0):.3g} s"
        return ServoReport(ServoCondition.STALE_COMMAND, 0.0, number, (), text)


def _twist_of(command: TwistCommand, q: Array) -> Array:
    """Give the twist of a command in base axes."""
    axes = command.axes(q)
    if axes is None:
        return command.twist
    return np.concatenate((axes @ command.twist[:3], axes @ command.twist[3:]))


def _ratio(first: Array, second: Array) -> float:
    """Give how much larger the second of two twists is; 0 where their directions differ."""
    sizes = [float(np.abs(twist).max()) for twist in (first, second)]
    if not all(sizes):
        return 0.0
    unlike = np.abs(first / sizes[0] - second / sizes[1]).max()
    return sizes[1] / sizes[0] if unlike <= _SAME else 0.0
