"""Steering angles that let a base move, and the turns that limits of steering leave."""

import math
from collections.abc import Sequence

import numpy as np

from robomech_ros.errors import BadValueError, LimitExceededError
from robomech_ros.rolling.wheels import Wheel
from robomech_ros.typing import Array

# A pivot that moves slower than this part of the base has no direction.
_STILL = 1e-12
# A twist that wheels cannot give misses by more than this part of itself.
_OFF = 1e-9
# Angles beyond a limit by no more than this (rad) are at the limit.
_AT_LIMIT = 1e-9


def steering_for(wheels: Sequence[Wheel], twists: Array, near: Array) -> Array:
    """Find the steering angles (..., s) at which s steered wheels roll with twists (..., 3).

    A wheel can roll both ways, so that angles differ by half turns: the nearest is taken that is
    within limits. Where a wheel does not move it keeps `near` (..., s). Raises LimitExceededError
    where no angle within its limits lets a wheel roll.
    """
    positions = np.array([wheel.position for wheel in wheels]).reshape(-1, 2)
    lower = np.array([wheel.steering_limits[0] for wheel in wheels])
    upper = np.array([wheel.steering_limits[1] for wheel in wheels])
    heading = np.array([wheel.heading for wheel in wheels])
    w, vx, vy = (twists[..., i, None] for i in range(3))
    x, y = vx - w * positions[:, 1], vy + w * positions[:, 0]
    speed = np.hypot(x, y)
    size = np.hypot(np.hypot(vx, vy), w * (1.0 + np.abs(positions).max(initial=0.0)))
    still = speed <= _STILL * size
    wanted = np.arctan2(y, x) - heading
    half = np.round((near - wanted) / math.pi)
    # The nearest within limits, if there is one: whole half turns from the nearest of all.
    least = np.ceil((lower - wanted - _AT_LIMIT) / math.pi)
    most = np.floor((upper - wanted + _AT_LIMIT) / math.pi)
    turns = np.clip(half, least, np.maximum(most, least))
    angles = np.clip(wanted + turns * math.pi, lower, upper)
    outside = ~still & (most < least)
    if outside.any():
        where = tuple(np.argwhere(outside)[0])
        wheel = wheels[int(where[-1])]
        at_fault = math.remainder(float(wanted[where]), math.pi)
        limit = wheel.steering_limits[int(at_fault > 0.0)]
        raise LimitExceededError("steering angle", wheel.name, at_fault, limit, "rad")
    return np.where(still, near, angles)


def check_span(wheels: Sequence[Wheel]) -> None:
    """Without a fixed axle, a steered wheel has to roll in every direction."""
    for wheel in wheels:
        lower, upper = wheel.steering_limits
        if upper - lower < math.pi - _AT_LIMIT:
            expected = "limits at least pi apart, since there is no fixed axle"
            raise BadValueError(f"steering limits of {wheel.name}", (lower, upper), expected)


def axle_of(wheel: Wheel) -> Array:
    """Return the point of a wheel's axle nearest to the origin (m), and its heading (rad)."""
    along = np.array([-math.sin(wheel.heading), math.cos(wheel.heading)])
    foot = wheel.position - along * float(along @ wheel.position)
    return np.array([*foot, wheel.heading])


def feasible_twists(axle: Array, curvatures: tuple[float, float], twists: Array) -> Array:
    """Return the twists (..., 3) nearest to commands that a base with a fixed axle can have."""
    c, s = math.cos(axle[2]), math.sin(axle[2])
    w = twists[..., 0]
    forward = c * (twists[..., 1] - w * axle[1]) + s * (twists[..., 2] + w * axle[0])
    least, most = curvatures
    turn, way = np.sign(forward) * w, np.abs(forward)
    if math.isfinite(least):
        w = np.where(turn < least * way, least * forward, w)
    if math.isfinite(most):
        w = np.where(turn > most * way, most * forward, w)
    if math.isfinite(least) or math.isfinite(most):
        w = np.where(forward == 0.0, 0.0, w)
    return np.stack([w, c * forward + w * axle[1], s * forward - w * axle[0]], axis=-1)


def require_feasible(what: str, twists: Array, feasible: Array) -> None:
    """Refuse twists that differ from those that the wheels can give."""
    off = np.abs(feasible - twists).max(axis=-1)
    if (off > _OFF * np.abs(twists).max(axis=-1)).any():
        where = np.unravel_index(int(np.argmax(off)), off.shape)
        expected = f"[omega, v_x, v_y] that the wheels can give, such as {feasible[where].tolist()}"
        raise BadValueError(what, twists[where].tolist(), expected)


def free_twists(axle: Array | None) -> Array:
    """Return the twists (3, m) of units of the independent rates.

    They are the turn, and the velocity forward at a fixed axle; the whole twist without one.
    """
    if axle is None:
        return np.eye(3)
    c, s = math.cos(axle[2]), math.sin(axle[2])
    return np.array([[1.0, 0.0], [axle[1], c], [-axle[0], s]])


def curvature_range(wheels: Sequence[Wheel], axle: Array) -> tuple[float, float]:
    """Find the turns per metre (rad/m) that steered wheels allow a base with one fixed axle (3,).

    Returns the least and the most, infinite where the base can turn on the spot.
    """
    least, most = -math.inf, math.inf
    c, s = math.cos(axle[2]), math.sin(axle[2])
    for wheel in wheels:
        dx, dy = (wheel.position - axle[:2]).tolist()
        x, y = c * dx + s * dy, c * dy - s * dx
        offset = wheel.heading - axle[2]
        lower, upper = (one + offset for one in wheel.steering_limits)
        if x < 0.0:  # behind the axle a wheel steers the other way
            x, lower, upper = -x, -upper, -lower
        most = min(most, _curvature(x, y, upper))
        least = max(least, -_curvature(x, -y, -lower))
    return least, most


def _curvature(x: float, y: float, angle: float) -> float:
    """Largest curvature to the left for a wheel at (x, y), x >= 0, that steers so far."""
    if x <= _STILL or angle >= math.atan2(x, -y):
        return math.inf
    return math.tan(angle) / (x + y * math.tan(angle))
