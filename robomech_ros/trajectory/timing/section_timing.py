"""The timing of a joint path between two rests, by profile."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from robomech_ros.trajectory.curves.fewer_pieces import with_fewer_pieces
from robomech_ros.trajectory.curves.interpolation import interpolant
from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial
from robomech_ros.trajectory.curves.time_scaling import fitted, stretch_needed
from robomech_ros.trajectory.limits import RATES, Limits, Rate
from robomech_ros.trajectory.paths.joint_path import JointPath
from robomech_ros.trajectory.profiles.laws import CUBIC, CYCLOIDAL, POLY345, POLY4567, Law, law_of
from robomech_ros.trajectory.profiles.velocity_profiles import unit_double_s, unit_double_s_samples
from robomech_ros.trajectory.timing.path_limits import SpeedLimit, largest_parts
from robomech_ros.trajectory.timing.path_timing import time_optimal
from robomech_ros.trajectory.timing.time_optimal_motions import with_ramps
from robomech_ros.typing import Array

# Instants of a section to begin with, and at most; between them the joints follow quintics.
_FEWEST, _MOST = 32, 4096
# How far these may be off the path, rad or m, and the part of the duration below which two
# instants have none between them.
_ON_PATH, _NEAREST = 1e-7, 2e-6
# Shapes of the double-S profile that are tried: parts of the duration for one ramp, and parts of
# half a ramp in which the jerk acts; then nearer and nearer to the best, by these factors.
_RAMPS = np.array([0.5, 0.4, 0.3, 0.2, 0.1, 0.05, 0.02, 0.005])
_ROUNDINGS = np.array([1.0, 0.7, 0.45, 0.25, 0.1, 0.03])
_NEARER = (1.25, 1.08, 1.03, 1.01)
# Instants looked at in each phase of a shape, and places of a section at which other speeds are
# known.
_IN_PHASE = np.linspace(1e-6, 1.0 - 1e-6, 33)
_SPEED_PLACES = 512


@dataclass(frozen=True, eq=False)
class PathSection:
    """A part of a joint path, from a low to a high coordinate (m), at whose ends the motion rests.

    ``speeds`` are what else must not be too fast, over the path coordinate.
    """

    joints: JointPath
    low: float
    high: float
    limits: Limits
    speeds: tuple[SpeedLimit, ...]

    @property
    def length(self) -> float:
        """Length (m)."""
        return self.high - self.low

    def at(self, done: Array) -> Array:
        """Path coordinates where parts of the section are done.

        At the end it is the limit from the left: the next part begins with other derivatives.
        """
        return np.minimum(self.low + self.length * done, np.nextafter(self.high, self.low))

    def pieces(self) -> PiecewisePolynomial:
        """Return the joints over the path coordinate in this section only."""
        whole = self.joints.pieces
        first, last = np.searchsorted(whole.breaks, [self.low, self.high])
        return whole.between(first, last)


@dataclass(frozen=True)
class SectionTiming:
    """A way to run through a section, which cannot do without the limits that are ``required``.

    ``timed`` gives the motion of the joints, from t = 0 on, as fast as section and limits allow.
    The second derivative of a section must be continuous to rounding if it ``needs_smooth``.
    """

    timed: Callable[[PathSection], PiecewisePolynomial]
    required: tuple[Rate, ...] = ("velocity", "acceleration")
    needs_smooth: bool = False


def _by_law(law: Law) -> SectionTiming:
    return SectionTiming(lambda section: _along_law(section, law))


def _along_law(section: PathSection, law: Law) -> PiecewisePolynomial:
    """Time a path by a law of its coordinate, as fast as joints and other speeds may be."""
    tau = _instants(law, _FEWEST)
    while True:
        s, v, a = _coordinates(section, law, tau)
        q, first, second, _ = section.joints.derivatives(s[:, 0])
        q[-1] = section.joints.derivatives(section.high)[0]
        unit = interpolant(tau, q, first * v, second * v**2 + first * a)
        middle = 0.5 * (tau[1:] + tau[:-1])
        between, rates, _ = _coordinates(section, law, middle)
        exact = section.joints.derivatives(between[:, 0])[0]
        off = np.abs(unit.sample(middle).position - exact).max(axis=1)
        coarse = (off > _ON_PATH) & (unit.spans > _NEAREST)
        # Rounding and corners of the path would let this go on for ever.
        if not coarse.any() or len(tau) + coarse.sum() > _MOST:
            break
        tau = np.sort(np.concatenate([tau, middle[coarse]]))
    curve = fitted(unit, section.limits)
    places, rates = np.concatenate([s, between])[:, 0], np.concatenate([v, rates])[:, 0]
    least = float(largest_parts(section.speeds, places, rates).max())
    return curve.stretched(max(least / curve.duration, 1.0))


def _instants(law: Law, count: int) -> Array:
    """Divide a duration of 1 into about `count` parts, at the breaks of the law, too."""
    edges = law.pieces.breaks
    counts = np.ceil(np.diff(edges) * count * (1.0 - 1e-9)).astype(int)
    parts = [
        low + (high - low) * np.arange(number) / number
        for low, high, number in zip(edges[:-1], edges[1:], counts, strict=True)
    ]
    return np.concatenate([*parts, edges[-1:]])


def _coordinates(section: PathSection, law: Law, tau: Array) -> tuple[Array, ...]:
    """Path coordinate and its first two rates over a duration of 1, shape (m, 1)."""
    rates = law.rates(tau)
    velocity, acceleration = section.length * rates.velocity, section.length * rates.acceleration
    return section.at(law.progress(tau))[:, None], velocity[:, None], acceleration[:, None]


def _jerk_limited(section: PathSection) -> PiecewisePolynomial:
    """Time a path by the double-S profile with the fastest shape."""
    speed = _all_speeds(section)
    ramps, roundings = (grid.ravel() for grid in np.meshgrid(_RAMPS, _ROUNDINGS))
    best = (np.inf, 0.5, 1.0)
    for nearer in (None, *_NEARER):
        if nearer is not None:
            _, ramp, rounding = best
            steps = nearer ** np.arange(-2.0, 3.0)
            grids = np.meshgrid(np.minimum(ramp * steps, 0.5), np.minimum(rounding * steps, 1.0))
            ramps, roundings = (grid.ravel() for grid in grids)
        durations = _shape_durations(section, ramps, roundings, speed)
        k = int(np.argmin(durations))
        best = min(best, (float(durations[k]), float(ramps[k]), float(roundings[k])))
    return _along_law(section, law_of(unit_double_s(*best[1:])))


def _all_speeds(section: PathSection) -> SpeedLimit:
    """Combine all other speeds into one whose limit is 1, known at many places."""
    places = section.at(np.linspace(0.0, 1.0, 2 * _SPEED_PLACES + 1))
    largest = largest_parts(section.speeds, places, 1.0)
    # Between its places it is linear: as much higher as that is too low half way.
    linear = 0.5 * (largest[:-2:2] + largest[2::2])
    low = largest[1::2] / np.where(linear > 0.0, linear, 1.0)
    return SpeedLimit((places[::2], largest[::2] * max(1.0, float(low.max()))), 1.0)


def _shape_durations(
    section: PathSection, ramps: Array, roundings: Array, speed: SpeedLimit
) -> Array:
    """Estimate how long the section takes by each of k shapes, shape (k,)."""
    samples = unit_double_s_samples(ramps, roundings, _IN_PHASE)
    s = section.at(np.clip(samples[0], 0.0, 1.0))
    v, a, j = (section.length * rate[..., None] for rate in samples[1:])
    _, first, second, third = (
        values.reshape(*s.shape, -1) for values in section.joints.derivatives(s.ravel())
    )
    rates = (first * v, second * v**2 + first * a, third * v**3 + 3.0 * second * v * a + first * j)
    needed = [
        (np.abs(values) / getattr(section.limits, rate)).max(axis=(1, 2)) ** (1.0 / order)
        for order, (rate, values) in enumerate(zip(RATES, rates, strict=True), 1)
    ]
    needed.append((speed.rate(s) * v[..., 0]).max(axis=1))
    return np.max(needed, axis=0)


def _time_optimal(section: PathSection) -> PiecewisePolynomial:
    """Time a path as fast as possible everywhere.

    What smoothing the jerk costs may be more than what one double-S profile leaves.
    """
    smooth = with_ramps(section.limits, everywhere=True)
    speeds = [_all_speeds(section)] if section.speeds else []
    timed = time_optimal(section.pieces(), smooth, speed_limits=speeds, jerk_smoothing=True)
    curve = with_fewer_pieces(timed.pieces, smooth)
    curve = curve.stretched(max(stretch_needed(curve, smooth)[0], 1.0))
    plain = _jerk_limited(replace(section, limits=smooth))
    return min(curve, plain, key=lambda motion: motion.duration)


SECTION_TIMINGS: dict[str, SectionTiming] = {
    "poly345": _by_law(POLY345),
    "poly4567": _by_law(POLY4567),
    "cycloidal": _by_law(CYCLOIDAL),
    "cubic_spline": _by_law(CUBIC),
    "ruckig": SectionTiming(_jerk_limited, RATES),
    "time_optimal": SectionTiming(_time_optimal, needs_smooth=True),
}
