"""What is added to a curve: a step at its start fades out, speed at its end is braked."""

import math

import numpy as np

from robomech_ros.execution.joints import Joints
from robomech_ros.trajectory.curves.interpolation import interpolant
from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial
from robomech_ros.trajectory.sample import FloatArray

__all__ = [
    "braking_time",
    "delayed",
    "fading_time",
    "peak_accelerations",
    "with_braking",
    "with_fading",
]

# Shortest time in which a step at the start is smoothed out, s.
SHORTEST_BLEND = 0.05
# Shortest time in which speed at the end is braked, s; slower than REST (rad/s, m/s) is at rest.
SHORTEST_BRAKING = 0.02
REST = 1e-6
# Peak second derivatives of the smoothing quintic over one unit of time, per unit of step in
# position and in velocity.
_PEAK_OF_POSITION, _PEAK_OF_VELOCITY = 5.7736, 3.941


def fading_time(step: FloatArray, kick: FloatArray, joints: Joints) -> float:
    """Give the time in which the smoothing needs half the acceleration limit of the worst joint."""
    half = 0.5 * joints.acceleration
    linear = _PEAK_OF_VELOCITY * np.abs(kick)
    square = 4.0 * half * _PEAK_OF_POSITION * np.abs(step)
    times = (linear + np.sqrt(linear * linear + square)) / (2.0 * half)
    return max(float(np.max(times)), SHORTEST_BLEND)


def with_fading(
    curve: PiecewisePolynomial, offset: tuple[FloatArray, FloatArray, FloatArray], time: float
) -> PiecewisePolynomial:
    """Add a quintic that begins with an offset and has faded out after `time` (s).

    The offset (n,), (n,), (n,) is one of position, velocity and acceleration.
    """
    still = np.zeros(curve.joints)
    fading = interpolant([0.0, time], *(np.vstack([rate, still]) for rate in offset))
    curve = _with_break(curve, time)
    coefficients = np.zeros((6, *curve.coefficients.shape[1:]))
    coefficients[: len(curve.coefficients)] = curve.coefficients
    for segment, begin in enumerate(curve.breaks[:-1]):
        if begin >= time:
            break
        coefficients[:, segment] += _moved(fading.coefficients[:, 0], float(begin))
    return PiecewisePolynomial(curve.breaks, coefficients)


def delayed(curve: PiecewisePolynomial, time: float) -> PiecewisePolynomial:
    """Let a curve stay at its start for `time` (s) before it begins."""
    coefficients = np.zeros((len(curve.coefficients), len(curve.breaks), curve.joints))
    coefficients[0, 0] = curve.sample(curve.breaks[0]).position
    if len(curve.breaks) > 1:
        coefficients[:, 1:] = curve.coefficients
    breaks = np.append(curve.breaks[0], curve.breaks + time)
    return PiecewisePolynomial(breaks, coefficients)


def peak_accelerations(curve: PiecewisePolynomial) -> FloatArray:
    """Give the largest accelerations (n,) of a curve's joints, by quintics at the most."""
    if len(curve.breaks) < 2:
        return np.zeros(curve.joints)
    spans = np.diff(curve.breaks)[:, None]
    c = np.zeros((6, *curve.coefficients.shape[1:]))
    c[: len(curve.coefficients)] = curve.coefficients
    rate, half, third = 6.0 * c[3], 12.0 * c[4], 20.0 * c[5]
    with np.errstate(divide="ignore", invalid="ignore"):
        root = np.sqrt(half * half - 3.0 * third * rate)
        # The acceleration turns where rate + 2 half t + 3 third t^2 is 0.
        turns = [
            -rate / (2.0 * half),
            (-half - root) / (3.0 * third),
            (root - half) / (3.0 * third),
        ]
    times = np.clip(np.nan_to_num([0.0 * c[0], spans + 0.0 * c[0], *turns]), 0.0, spans)
    values = 2.0 * c[2] + times * (rate + times * (half + times * third))
    peaks: FloatArray = np.abs(values).max(axis=(0, 1))
    return peaks


def braking_time(velocity: FloatArray, joints: Joints) -> float:
    """Give the time (s) in which all joints brake together; NaN (no velocity given) is at rest."""
    speed = np.nan_to_num(np.abs(velocity))
    if np.max(speed) <= REST:
        return 0.0
    return max(float(np.max(speed / joints.acceleration)), SHORTEST_BRAKING)


def with_braking(
    curve: PiecewisePolynomial, velocity: FloatArray, joints: Joints
) -> PiecewisePolynomial:
    """Add a segment in which the velocity at the end (n,), rad/s or m/s, falls to 0 linearly."""
    time = braking_time(velocity, joints)
    if not time:
        return curve
    order = max(len(curve.coefficients), 3)
    segments = curve.coefficients.shape[1] if len(curve.breaks) > 1 else 0
    coefficients = np.zeros((order, segments + 1, curve.joints))
    coefficients[: len(curve.coefficients), :segments] = curve.coefficients[:, :segments]
    coefficients[0, -1] = curve.sample(curve.breaks[-1]).position
    coefficients[1, -1] = velocity
    coefficients[2, -1] = -velocity / (2.0 * time)
    return PiecewisePolynomial(np.append(curve.breaks, curve.breaks[-1] + time), coefficients)


def _with_break(curve: PiecewisePolynomial, time: float) -> PiecewisePolynomial:
    """Cut the segment at `time` in two, or let the curve rest at its end until then."""
    breaks, coefficients = curve.breaks, curve.coefficients
    if time in breaks:
        return curve
    segment = int(np.searchsorted(breaks, time)) - 1
    if time < breaks[-1]:
        added = _moved(coefficients[:, segment], float(time - breaks[segment]))
    else:
        added = np.zeros_like(coefficients[:, 0])
        added[0] = curve.sample(breaks[-1]).position
    if len(breaks) == 1:
        return PiecewisePolynomial(np.array([breaks[0], time]), added[:, None])
    # Behind the last break there is no segment yet.
    place = min(segment + 1, coefficients.shape[1])
    return PiecewisePolynomial(
        np.insert(breaks, segment + 1, time), np.insert(coefficients, place, added, axis=1)
    )


def _moved(coefficients: FloatArray, by: float) -> FloatArray:
    """Rewrite polynomials (order + 1, n) in powers of the time since `by` (s)."""
    order = len(coefficients)
    shift = np.array(
        [
            [math.comb(i, k) * by ** (i - k) if i >= k else 0.0 for i in range(order)]
            for k in range(order)
        ]
    )
    return shift @ coefficients
