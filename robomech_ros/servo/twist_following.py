"""Following twists: along the line of one that is held, and onto and out of such lines."""

import math

import numpy as np

from robomech_ros.servo.commands import TwistCommand
from robomech_ros.servo.contact_slowing import MotionAhead, look_ahead
from robomech_ros.servo.cubics import FITTED, fitted
from robomech_ros.servo.exit_search import SingularityExit
from robomech_ros.servo.limits import ServoLimits
from robomech_ros.servo.line_entry import LineEntry
from robomech_ros.servo.line_laying import LineLaying
from robomech_ros.servo.line_path import LinePath
from robomech_ros.servo.motion import Advance
from robomech_ros.servo.report import ServoReport, motion_report
from robomech_ros.servo.singularity_exits import Start
from robomech_ros.servo.stream import Stream
from robomech_ros.servo.twist_resolver import SINGULAR, Resolution, TwistResolver
from robomech_ros.typing import Array

# Twists whose directions differ by less than this are the same.
_SAME = 1e-9
# The least part of a twist with which its way passes a singularity.
_PASSING = 0.2
# How far ahead it is seen how fast rates grow (rad or m), and the part of the acceleration limits
# that this may use up.
_AHEAD, _OF_ACCELERATION = 1e-3, 0.4
# If less than this part of the look-ahead is laid, the twist is extrapolated.
_LAID = 0.2
# A way so short (s^2, by acceleration limits) leads nowhere.
_BEGINNING = 1e-6


class TwistFollowing:
    """Makes a stream with knots a period (s) apart follow twists."""

    def __init__(self, resolver: TwistResolver, limits: ServoLimits, period: float) -> None:
        self._resolver, self._limits, self._period = resolver, limits, period
        # The twist of the period before, in its axes.
        self._last: TwistCommand | None = None
        # A line laid before what is held of the pose changed; it is left.
        self._outdated: LinePath | None = None
        self._joining = LineEntry()
        self._leaving = SingularityExit(resolver)

    def end(self) -> None:
        """Follow no twist: the next one is another."""
        self._last = None

    def restart(self, line: LinePath | None) -> None:
        """Lay lines anew, and leave the present one."""
        self.end()
        self._outdated = line
        self._leaving.forget()

    def follow(self, stream: Stream, command: TwistCommand) -> ServoReport:
        """Go on by one period with a twist."""
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
        outdated = stream.line is not None and stream.line.path is self._outdated
        if stream.line is not None:
            stream.line.path.begin_period()
        elif stream.at_rest and twist.any() and (found.scale or beyond):
            self._begin_line(stream, command, twist, beyond)
        advance = None
        if stream.line is not None and not outdated:
            found, advance = self._on_line(stream, position, twist, found)
        elif not (outdated or stream.at_rest or beyond) and found.scale and twist.any():
            part = min(self._limits.share_of(found.rates)[0], found.scale)
            advance = self._joining.attempt(
                stream, part, lambda: self._path(command, Start(stream.knot()))
            )
        if advance is None:
            found = self._along_no_line(position, twist, found)
            part = min(self._limits.share_of(found.rates)[0], found.scale)
            advance = stream.advance(self._joining.slower * part * found.rates)
        share = self._limits.share_of(found.rates)
        return motion_report(self._limits, found, share, advance, stream.velocity)

    def ahead(self, stream: Stream, command: TwistCommand) -> MotionAhead | None:
        """Find the motion that a twist leads to, along its line as far as laid; None at rest."""
        q = stream.position
        twist = _twist_of(command, q)
        line = stream.line
        if line is not None and line.path is not self._outdated:
            rate = _ratio(line.path.twist(q), twist) * line.wanted
            slope = line.path.slope(line.place)
            limited, stop = self._limits.limited(rate * slope)
            rate *= limited
            laid = (line.path.laid - line.place) / max(rate, 1e-300)
            seconds = min(look_ahead(stop), laid)
            if rate and seconds > _LAID * look_ahead(stop):
                places = line.place + rate * seconds * FITTED
                curve = fitted(line.path.at(places, np.zeros_like(places))[0])
                return MotionAhead(curve, seconds, stop, limited)
        if not twist.any():
            return None
        rates = self._resolver.heading(q, twist).rates
        largest = float(np.abs(rates).max())
        if not largest:
            return None
        limited, stop = self._limits.limited(rates)
        later = q + _AHEAD / largest * rates
        change = self._resolver.heading(later, _twist_of(command, later)).rates - rates
        seconds = look_ahead(stop)
        step = limited * seconds * rates
        bend = (limited * seconds) ** 2 * largest / _AHEAD * change
        return MotionAhead(
            np.array((q, q + 0.5 * step, q + step + 0.5 * bend)), seconds, stop, limited
        )

    def lay_ahead(self, stream: Stream) -> None:
        """Lay the line as far as the look-ahead, if this period has time left."""
        if (line := stream.line) is not None:
            rate = line.wanted
            limited, stop = self._limits.limited(rate * line.path.slope(line.place))
            line.path.reach(line.place + look_ahead(stop) * limited * rate)

    def _along_no_line(self, q: Array, twist: Array, found: Resolution) -> Resolution:
        """Return rates and scale of a twist that is followed along no line, from those found.

        Towards a singularity the scale is one with which joints can still turn round: with more of
        it their rates would grow faster than they accelerate, and the tip would leave the direction
        of the twist.  Beyond the hard stop it is 0, but on the way out.
        """
        beyond = found.condition_number >= self._resolver.stop_at
        here = self._resolver.heading(q, twist, beyond)
        largest = float(np.abs(here.rates).max())
        if not here.possible or (largest == 0.0 and not beyond):
            return found
        time = _AHEAD / max(largest, 1e-300)
        ahead = self._resolver.heading(q + time * here.rates, twist, beyond)
        growth = np.abs(ahead.rates - here.rates) / time / self._limits.acceleration
        scale = min(1.0, math.sqrt(_OF_ACCELERATION / max(float(growth.max()), 1e-300)))
        if beyond:
            nearer = ahead.condition >= here.condition or here.condition > SINGULAR
            if nearer or not ahead.possible:
                return found._replace(scale=0.0)
            return found._replace(rates=here.rates, scale=scale, leaving=True)
        if ahead.condition <= here.condition or not ahead.possible:
            return found
        return found._replace(scale=min(found.scale, scale))

    def _path(self, command: TwistCommand, start: Start) -> LinePath:
        weights = 1.0 / self._limits.acceleration
        way = LineLaying(self._resolver, weights, start, lambda q: _twist_of(command, q))
        return LinePath(way)

    def _begin_line(
        self, stream: Stream, command: TwistCommand, twist: Array, beyond: bool
    ) -> None:
        """Go on on the line of a twist from rest, where there is one."""
        knot = stream.knot()
        if not beyond:
            path = self._path(command, Start(knot))
            if path.reach(_BEGINNING) or path.singular or path.unfinished:
                stream.begin(path)
            return
        out = self._leaving.way(knot, twist, lambda start: self._path(command, start))
        if out is not None:
            stream.begin(out)

    def _on_line(
        self, stream: Stream, position: Array, twist: Array, found: Resolution
    ) -> tuple[Resolution, Advance | None]:
        """Go on by one period on the line of a twist; None where that cannot be."""
        line = stream.line
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
        part = min(self._limits.share_of(found.rates)[0], found.scale)
        advance = stream.follow(part * ratio * line.wanted)
        if advance is not None and line.path.singular and not advance.bound:
            # The end of the way is in sight.
            found = found._replace(scale=min(part, line.rate / max(line.wanted, 1e-300)))
        return found, advance


def _twist_of(command: TwistCommand, q: Array) -> Array:
    axes = command.axes(q)
    if axes is None:
        return command.twist
    return np.concatenate((axes @ command.twist[:3], axes @ command.twist[3:]))


def _ratio(first: Array, second: Array) -> float:
    """Return how much larger the second of two twists is; 0 where their directions differ."""
    sizes = [float(np.abs(twist).max()) for twist in (first, second)]
    if not all(sizes):
        return 0.0
    unlike = np.abs(first / sizes[0] - second / sizes[1]).max()
    return sizes[1] / sizes[0] if unlike <= _SAME else 0.0
