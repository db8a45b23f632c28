"""Additions to a curve: a step at its start fades out, speed at its end is braked."""

import numpy as np

from robomech_ros.execution.controller.curve_parts import chained, pieces_of, rebased
from robomech_ros.execution.joints import Joints
from robomech_ros.trajectory.curves.interpolation import interpolant
from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial
from robomech_ros.typing import Array

# Shortest time in which a step at the start is smoothed out, s.
SHORTEST_BLEND = 0.05
# Shortest time in which speed at the end is braked, s; slower than REST (rad/s, m/s) is at rest.
SHORTEST_BRAKING = 0.02
REST = 1e-6
# Peak second derivatives of the smoothing quintic over one unit of time, per unit of step in
# position and in velocity.
_PEAK_OF_POSITION, _PEAK_OF_VELOCITY = 5.7736, 3.941
# Its largest third derivatives, per unit of step in position, velocity and acceleration, and which
# root of a quotient by the limit is a time.
_JERKS, _ROOTS = np.array([60.0, 36.0, 9.0]), np.array([1.0 / 3.0, 0.5, 1.0])


def fading_time(step: Array, kick: Array, push: Array, joints: Joints) -> float:
    """Return the smoothing time for half the limits of the worst joint."""
    half, jerk = 0.5 * joints.acceleration, joints.limits.jerk
    linear = _PEAK_OF_VELOCITY * np.abs(kick)
    square = 4.0 * half * _PEAK_OF_POSITION * np.abs(step)
    times = (linear + np.sqrt(linear * linear + square)) / (2.0 * half)
    by_jerk = (6.0 * _JERKS[:, None] * np.abs((step, kick, push)) / jerk) ** _ROOTS[:, None]
    return max(float(np.max(times)), float(np.max(by_jerk)), SHORTEST_BLEND)


def with_fading(
    curve: PiecewisePolynomial, offset: tuple[Array, Array, Array], time: float
) -> PiecewisePolynomial:
    """Add a quintic that begins with an offset and has faded out after `time` (s).

    The offset (n,), (n,), (n,) is one of position, velocity and acceleration.
    """
    still = np.zeros(curve.joints)
    fading = interpolant([0.0, time], *(np.vstack([rate, still]) for rate in offset))
    curve = _with_break(curve, time)
    missing = 6 - len(curve.coefficients)
    coefficients = np.pad(curve.coefficients, ((0, missing), (0, 0), (0, 0)))
    begins = curve.breaks[:-1][curve.breaks[:-1] < time]
    added = rebased(fading.coefficients[:, 0], begins)
    coefficients[:, : len(begins)] += added.transpose(1, 0, 2)
    return PiecewisePolynomial(curve.breaks, coefficients)


def delayed(curve: PiecewisePolynomial, time: float) -> PiecewisePolynomial:
    """Delay a curve by `time` (s) at rest at its start."""
    start = curve.sample(curve.breaks[0]).position
    breaks = np.append(curve.breaks[0], curve.breaks + time)
    return chained(breaks, start[None, None], pieces_of(curve))


def braking_time(velocity: Array, joints: Joints) -> float:
    """Return the time (s) in which all joints brake together; NaN velocities are at rest."""
    speed = np.nan_to_num(np.abs(velocity))
    if np.max(speed) <= REST:
        return 0.0
    return max(float(np.max(speed / joints.acceleration)), SHORTEST_BRAKING)


def with_braking(
    curve: PiecewisePolynomial, velocity: Array, joints: Joints
) -> PiecewisePolynomial:
    """Add a segment in which the velocity at the end (n,), rad/s or m/s, falls to 0 linearly."""
    time = braking_time(velocity, joints)
    if not time:
        return curve
    end = curve.sample(curve.breaks[-1]).position
    braking = np.stack((end, velocity, -velocity / (2.0 * time)))[:, None]
    breaks = np.append(curve.breaks, curve.breaks[-1] + time)
    return chained(breaks, pieces_of(curve), braking)


def _with_break(curve: PiecewisePolynomial, time: float) -> PiecewisePolynomial:
    """Cut the segment at `time` in two, or let the curve rest at its end until then."""
    breaks, coefficients = curve.breaks, curve.coefficients
    if time in breaks:
        return curve
    segment = int(np.searchsorted(breaks, time)) - 1
    if time < breaks[-1]:
        added = rebased(coefficients[:, segment], float(time - breaks[segment]))
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
