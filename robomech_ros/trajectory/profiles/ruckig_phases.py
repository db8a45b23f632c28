"""Ruckig, asked in units that suit it, and its answer as polynomials.

References
----------
L. Berscheid, T. Kröger, "Jerk-limited Real-time Trajectory Generation with Arbitrary Target
States", Robotics: Science and Systems XVII, 2021.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from operator import sub
from typing import Any, NamedTuple, NoReturn

import numpy as np
import ruckig

from robomech_ros.errors import BadValueError
from robomech_ros.trajectory.limits import Limits
from robomech_ros.typing import Array

# Ruckig refuses durations of more than 7600 of its units of time; this leaves room for a detour.
_LONG = 1000.0
# Ways below this (rad, m) are no unit of length.
_SHORTEST_WAY = 1e-9
# What making up for a missed goal may add to the jerk, in parts of its limit; and the jerk of the
# 3-4-5 polynomial that makes up for it, over the way and the duration to the power of -3.
_LARGEST_MISS = 1e-9
_MISS_JERK = 60.0
# By how much Ruckig lets itself miss a goal at most, in its unit of length.
_RUCKIG_MISS = 1e-8
# Where two shapes of a profile fit equally well, as with a displacement of 2 A^3 / J^2, rounding
# makes Ruckig reject both.  Limits lower by this part decide, and cost 1e-12 of the time at most.
_TIE_BREAK, _TIED = 1e-12, ("max_jerk", "max_acceleration", "max_velocity")
# Breaks nearer to each other than this, in parts of the duration, are one.
_SAME_BREAK = 2e-15
# Rounding of the peaks of a joint whose limits another joint's course just meets.
_SAME_LIMIT = 1e-12

# Phases of one joint: when each begins (p,), and [q, v, a, jerk] there (p, 4).
JointPhases = tuple[Array, Array]
# Velocity and acceleration (n,) at an end of a motion.
EndRates = tuple[Array, Array]


@dataclass(frozen=True, eq=False)
class Phases:
    """A motion of piecewise constant jerk.

    The jerk of any joint may step at the breaks (s + 1,), from 0 to the duration (s). The
    coefficients (4, s, n) are positions in powers of the time since the beginning of the segment.
    ``alone`` (n,) is how long each joint would take if it did not wait for the others (s).
    """

    breaks: Array
    coefficients: Array
    alone: Array

    @property
    def duration(self) -> float:
        """Time from start to end, in s."""
        return float(self.breaks[-1])

    def slowed(self, factor: float) -> "Phases":
        """Scale all durations by `factor`."""
        slower = self.coefficients * (factor ** -np.arange(4.0))[:, None, None]
        return Phases(self.breaks * factor, slower, self.alone * factor)


class _Solver(NamedTuple):
    """Ruckig with a request from rest to rest, which takes longer to make than to use.

    The goal may be missed by ``bearable`` (rad or m) times the duration to the power of 3.
    """

    ruckig: Any
    request: Any
    bearable: float


def rest_to_rest(rise: Array, limits: Limits, shortest: float) -> Any:
    """Compute the fastest motion from rest to rest that takes at least a given time.

    No joint goes beyond its start or its goal on the way.  The phases are left to
    `phases_from_rest`: who compares durations does not need them.  Returns a ``ruckig.Trajectory``,
    or None where Ruckig cannot do it, or not well enough, in SI units, or where there are no
    joints. `shortest` is the same in all calls with these limits.
    """
    if not len(rise):
        return None
    spare = limits.tools  # those that are not at work, in this thread or another
    try:
        solver = spare.pop()
    except IndexError:
        solver = _solver(limits, shortest)
    target = rise.tolist()
    solver.request.target_position = target
    motion = ruckig.Trajectory(len(target))
    try:
        solver.ruckig.calculate(solver.request, motion)
    except (ValueError, ruckig.RuckigError):
        return None
    spare.append(solver)
    duration = motion.duration
    bearable = solver.bearable * duration * duration * duration
    # If any miss is accepted, none is measured.
    if bearable < _RUCKIG_MISS:
        miss = max(map(abs, map(sub, motion.at_time(duration)[0], target)))
        return motion if miss <= bearable else None
    return motion


def phases_from_rest(motion: Any, rise: Array, limits: Limits) -> Phases:
    """Return the phases of what `rest_to_rest` found; positions count from the start."""
    still = np.zeros_like(rise)
    return _phases_of(motion, _request(rise, (still, still), limits), 1.0)


def _solver(limits: Limits, shortest: float) -> _Solver:
    still = np.zeros(len(limits.joint_names))
    request = _request(still, (still, still), limits)
    request.minimum_duration = shortest
    bearable = _LARGEST_MISS * float(limits.jerk.min(initial=np.inf)) / _MISS_JERK
    return _Solver(ruckig.Ruckig(len(still)), request, bearable)


def jerk_phases(
    rise: Array, begin: EndRates, end: EndRates, limits: Limits, shortest: float
) -> Phases:
    """Compute the fastest motion from 0 by `rise` (n,) that takes at least a given time (s)."""
    if not len(rise):
        # Ruckig itself reads memory that is not there.
        return Phases(np.array([0.0, shortest]), np.zeros((4, 1, 0)), np.zeros(0))
    way = np.abs(rise) + (np.abs(begin[0]) + np.abs(end[0])) * _starting_time(limits)
    least = max(shortest, _rough_duration(way, limits))
    rough: Phases | None = None
    reason = ""
    for time, length in _units(way, least, limits):
        request = _request(rise, begin, limits, time, length)
        request.target_velocity = (end[0] * (time / length)).tolist()
        request.target_acceleration = (end[1] * (time**2 / length)).tolist()
        request.minimum_duration = shortest / time
        motion = ruckig.Trajectory(len(rise))
        refused = failure(ruckig.Ruckig(len(rise)), request, motion)
        if refused:
            reason = reason or refused
            continue
        phases = _phases_of(motion, request, length).slowed(time)
        if (_miss(phases, rise) <= _LARGEST_MISS * limits.jerk).all():
            return phases
        rough = rough or phases
    if rough is None:
        _refuse(reason, limits)
    return rough


def _starting_time(limits: Limits) -> Array:
    """Time from rest to full speed (n,) in s; the limits may not let a joint get there."""
    return limits.velocity / limits.acceleration + limits.acceleration / limits.jerk


def _rough_duration(way: Array, limits: Limits) -> float:
    """Bound from below the time for a way (n,) from rest to rest, in s."""
    by_limit = (
        way / limits.velocity,
        2.0 * np.sqrt(way / limits.acceleration),
        np.cbrt(32.0 * way / limits.jerk),
    )
    return float(np.max(by_limit, initial=0.0))


def _units(way: Array, duration: float, limits: Limits) -> Iterator[tuple[float, Array | float]]:
    """Yield units of time (s) and length (n,) to try.

    Ruckig's tolerances are absolute, so that it cannot do with SI units where motions are tiny
    or very long: then the start of the motion, or all of it, becomes its unit.
    """
    yield 1.0, 1.0
    starting = float(_starting_time(limits).min(initial=duration))
    for time in (max(starting, duration / _LONG), duration):
        yield time, np.where(way > _SHORTEST_WAY, way, 1.0) * (time / duration)


def _request(
    rise: Array, begin: EndRates, limits: Limits, time: float = 1.0, length: Array | float = 1.0
) -> Any:
    request = ruckig.InputParameter(len(rise))
    request.synchronization = ruckig.Synchronization.Phase
    request.target_position = (rise / length).tolist()
    request.current_velocity = (begin[0] * (time / length)).tolist()
    request.current_acceleration = (begin[1] * (time**2 / length)).tolist()
    request.max_velocity = (limits.velocity * (time / length)).tolist()
    request.max_acceleration = (limits.acceleration * (time**2 / length)).tolist()
    request.max_jerk = (limits.jerk * (time**3 / length)).tolist()
    return request


def failure(solver: Any, request: Any, motion: Any) -> str:
    """Run Ruckig on a request; return why it failed, or an empty text.

    A refused request is repeated with slightly lower limits of jerk, acceleration and velocity; on
    return it is unchanged.
    """
    reason, given = "", dict[str, list[float]]()
    try:
        for name in ("", *_TIED):
            if name:
                given[name] = getattr(request, name)
                setattr(request, name, [limit * (1.0 - _TIE_BREAK) for limit in given[name]])
            try:
                solver.calculate(request, motion)
            except ruckig.RuckigError as error:
                reason = reason or str(error).strip().splitlines()[0]
            else:
                return ""
    except ValueError:  # the binding has no name for this code
        return "too long"
    finally:
        for name, limits in given.items():
            setattr(request, name, limits)
    return reason.removeprefix("[ruckig]").strip()


def _refuse(reason: str, limits: Limits) -> NoReturn:
    found = re.search(r"dof:? (\d+)", reason, re.IGNORECASE)
    joint = f" of joint '{limits.joint_names[int(found[1])]}'" if found else ""
    raise BadValueError(f"motion{joint}", reason, "one that Ruckig can compute")


def _miss(phases: Phases, rise: Array) -> Array:
    """Jerk (n,) of the 3-4-5 polynomial that makes up for missing the goal."""
    if not phases.duration > 0.0:
        return np.where(rise == 0.0, 0.0, np.inf)
    span = phases.breaks[-1] - phases.breaks[-2]
    end = span ** np.arange(4.0) @ phases.coefficients[:, -1]
    return _MISS_JERK * np.abs(end - rise) / phases.breaks[-1] ** 3


def _phases_of(motion: Any, request: Any, length: Array | float) -> Phases:
    alone = np.array(motion.independent_min_durations)
    profiles = motion.profiles[0]
    if not profiles:
        return Phases(np.array([0.0, motion.duration]), np.zeros((4, 1, 0)), alone)
    rates = request.current_velocity, request.current_acceleration, request.target_velocity
    if any(map(any, rates)):
        joints = [_phases(profile) for profile in profiles]
    else:
        joints = _on_one_course(profiles, int(np.argmax(alone)), request)
    breaks, coefficients = common_phases(joints, motion.duration)
    return Phases(breaks, coefficients * length, alone)


def _on_one_course(profiles: list[Any], leader: int, request: Any) -> list[JointPhases]:
    """Synchronise joints from rest to rest with the slowest one where that is possible.

    Ruckig does this for all joints or none; but the fewer courses there are, the fewer are the
    steps of the jerk, and the straighter is the path.
    """
    begin, states = _phases(profiles[leader])
    ways = np.array(request.target_position)
    if not ways[leader]:
        return [_phases(profile) for profile in profiles]
    peaks = _peaks(begin, states)
    bounds = np.array([request.max_velocity, request.max_acceleration, request.max_jerk])
    shares = ways / ways[leader]
    able = (np.abs(shares) * peaks[:, None] <= bounds * (1.0 + _SAME_LIMIT)).all(axis=0)
    return [
        (begin, states * share) if follows else _phases(profile)
        for profile, share, follows in zip(profiles, shares, able, strict=True)
    ]


def _peaks(begin: Array, states: Array) -> Array:
    """Largest speed, acceleration and jerk (magnitudes) of the phases of one joint."""
    peaks: Array = np.abs(states[:, 1:]).max(axis=0)
    _, velocity, acceleration, jerk = states[:-1].T
    # Inside a phase the speed is largest where the acceleration passes through zero.
    turns = (jerk != 0.0) & (acceleration * (acceleration + jerk * np.diff(begin)) < 0.0)
    inside = velocity[turns] - acceleration[turns] ** 2 / (2.0 * jerk[turns])
    peaks[0] = max(peaks[0], np.abs(inside).max(initial=0.0))
    return peaks


def common_phases(phases: list[JointPhases], duration: float) -> tuple[Array, Array]:
    """Bring the phases of all joints onto common breaks (s + 1,); coefficients (4, s, n)."""
    same = _SAME_BREAK * duration
    courses = {id(begin): begin for begin, _ in phases}
    ends = np.concatenate(list(courses.values()))
    inner = np.unique(ends[(ends > same) & (ends < duration - same)])
    inner = inner[np.diff(inner, prepend=0.0) > same]
    breaks = np.concatenate([[0.0], inner, [duration]])
    coefficients = np.empty((4, len(breaks) - 1, len(phases)))
    middle = (breaks[:-1] + breaks[1:]) / 2.0
    for course, begin in courses.items():
        joints = [joint for joint, (own, _) in enumerate(phases) if id(own) == course]
        states = np.stack([phases[joint][1] for joint in joints], axis=2)
        phase = np.searchsorted(begin, middle, side="right") - 1
        # The start of each phase: the break that represents the starts near it.
        at = breaks[np.searchsorted(breaks, begin, side="right") - 1]
        at[begin >= duration - same] = duration
        states[:-1, 3] = _gentler(states, np.diff(at))
        elapsed = (breaks[:-1] - at[phase])[:, None]
        position, velocity, acceleration, jerk = states[phase].transpose(1, 0, 2)
        coefficients[0, :, joints] = (
            position + elapsed * (velocity + elapsed * (acceleration / 2.0 + elapsed * jerk / 6.0))
        ).T
        coefficients[1, :, joints] = (velocity + elapsed * (acceleration + elapsed * jerk / 2.0)).T
        coefficients[2, :, joints] = (acceleration + elapsed * jerk).T / 2.0
        coefficients[3, :, joints] = jerk.T / 6.0
    return breaks, coefficients


def _gentler(states: Array, spans: Array) -> Array:
    """Lower jerks (p, n) that would lead beyond the next of the states (p + 1, 4, n).

    Phases last longer or shorter by the rounding of their instants; where these are short beside
    the duration, that shows.
    """
    acceleration, jerk = states[:, 2], states[:-1, 3]
    with np.errstate(divide="ignore", invalid="ignore"):
        enough = np.abs(np.diff(acceleration, axis=0)) / spans[:, None]
    return np.copysign(np.fmin(np.abs(jerk), enough), jerk)


def _phases(profile: Any) -> JointPhases:
    brake = profile.brake
    spans = [*brake.t, *profile.t]
    rows = list(zip(brake.p, brake.v, brake.a, brake.j, strict=True))
    rows += list(zip(profile.p[:-1], profile.v[:-1], profile.a[:-1], profile.j, strict=True))
    rows.append((profile.pf, profile.vf, profile.af, 0.0))
    begin = np.concatenate([[0.0], np.cumsum(spans)])
    lasting = np.append(np.asarray(spans) > 0.0, True)
    return begin[lasting], np.array(rows)[lasting]
