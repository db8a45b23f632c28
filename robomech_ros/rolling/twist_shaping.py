"""Twists of platform, wheels and brackets from the motion of a base.

The frame is at rest and has the axes of the base at this moment.  Rates are the twist (3,) of the
base and the steering rates (s,).
"""

from collections.abc import Sequence

import numpy as np

from robomech_ros.rolling.bodies import PlatformBody, WheelBody
from robomech_ros.rolling.constraints import direction_rows
from robomech_ros.rolling.steering_motion import SteeringMotion
from robomech_ros.rolling.wheels import Wheel
from robomech_ros.typing import Array

# Masses, inertias (r, 3, 3), twist-shaping matrix (6 r, 3 + s) and its rate.
Shaped = tuple[Array, Array, Array, Array]
# The same of one body.
_Body = tuple[float, Array, Array, Array]

_UP = np.array([0.0, 0.0, 1.0])
# Quarter turn about the vertical axis, of twists [omega; v].
_QUARTER = np.zeros((6, 6))
_QUARTER[0, 1] = _QUARTER[3, 4] = -1.0
_QUARTER[1, 0] = _QUARTER[4, 3] = 1.0


def shaped_twists(
    platform: PlatformBody,
    wheels: Sequence[tuple[Wheel, WheelBody]],
    twist: Array,
    steering: SteeringMotion,
    brackets: Array,
) -> Shaped:
    """Return masses, inertias and matrices from rates (3 + s,) to the twists of all bodies.

    ``brackets`` (c,) are angles of the casters (rad).
    """
    units = np.eye(3 + len(steering.angles))
    found = [_carried(platform.centre, platform.mass, platform.inertia * np.outer(_UP, _UP), units)]
    angles = iter(brackets.tolist())
    steered = iter(zip(steering.angles, steering.rates, units[3:], strict=True))
    for wheel, body in wheels:
        if wheel.kind == "caster":
            angle = wheel.heading + next(angles)
            rolls, sides = _rows(wheel, angle, units)
            turns = sides / wheel.trail, -rolls / wheel.trail
            rate = turns[0][:3] @ twist - twist[0]
            found += _pivoted(wheel, body, (angle, rate), turns, units)
        elif wheel.kind == "steered":
            angle, rate, turn = next(steered)
            turns = units[0] + turn, np.zeros(len(units))
            found += _pivoted(wheel, body, (wheel.heading + angle, rate), turns, units)
        else:
            found.append(_wheel(wheel, body, units))
    T = np.concatenate([matrix for _, _, matrix, _ in found])
    relative = np.concatenate([rate for _, _, _, rate in found])
    # All is carried round by the base; brackets turn besides.
    turning = np.kron(np.eye(len(found)), _QUARTER) @ T * twist[0]
    masses = np.array([mass for mass, _, _, _ in found])
    return masses, np.array([inertia for _, inertia, _, _ in found]), T, turning + relative


def _rows(wheel: Wheel, angle: float, units: Array) -> tuple[Array, Array]:
    """Return the rows (3 + s,) of velocities at a wheel's place in a direction, and across."""
    both = np.array([angle, angle + 0.5 * np.pi])
    rolls, sides = direction_rows(np.array([wheel.position] * 2), both) @ units[:3]
    return rolls, sides


def _carried(point: Array, mass: float, inertia: Array, units: Array) -> _Body:
    """Return a body that the base carries at a point."""
    T = np.zeros((6, len(units)))
    T[2] = units[0]
    T[3:5, :3] = direction_rows(np.array([point, point]), np.array([0.0, 0.5 * np.pi]))
    return mass, inertia, T, np.zeros_like(T)


def _axes(angle: float) -> tuple[Array, Array]:
    """Return the rolling direction and the axle."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([c, s, 0.0]), np.array([-s, c, 0.0])


def _inertia(body: WheelBody, axle: Array) -> Array:
    return np.asarray(body.turn * np.eye(3) + (body.spin - body.turn) * np.outer(axle, axle))


def _wheel(wheel: Wheel, body: WheelBody, units: Array) -> _Body:
    """Return a wheel without a pivot: it turns about its axle, besides."""
    _, axle = _axes(wheel.heading)
    mass, inertia, T, rate = _carried(wheel.position, body.mass, _inertia(body, axle), units)
    rolls, _ = _rows(wheel, wheel.heading + wheel.roller, units)
    T[:3] += np.outer(axle, rolls / np.cos(wheel.roller) / wheel.radius)
    return mass, inertia, T, rate


def _pivoted(
    wheel: Wheel,
    body: WheelBody,
    turned: tuple[float, float],
    turns: tuple[Array, Array],
    units: Array,
) -> list[_Body]:
    """Return the wheel of a caster or a steered one, and its bracket.

    ``turned`` is the bracket's angle in the base and its rate, ``turns`` the row (3 + s,) of how
    fast it turns over the ground, and the derivative of this row by the angle.
    """
    angle, rate = turned
    forward, axle = _axes(angle)
    rolls, sides = _rows(wheel, angle, units)
    mass, inertia, T, slope = _carried(wheel.position, body.mass, _inertia(body, axle), units)
    behind = np.outer(axle, turns[0])
    behind_slope = np.outer(axle, turns[1]) - np.outer(forward, turns[0])
    T[:3] = np.outer(axle, rolls / wheel.radius) + np.outer(_UP, turns[0])
    T[3:] -= wheel.trail * behind
    slope[:3] = (np.outer(axle, sides) - np.outer(forward, rolls)) / wheel.radius
    slope[:3] += np.outer(_UP, turns[1])
    slope[3:] -= wheel.trail * behind_slope
    bracket_inertia = body.bracket_inertia * np.outer(_UP, _UP)
    held = _carried(wheel.position, body.bracket_mass, bracket_inertia, units)
    held[2][2] = turns[0]
    held[2][3:] -= body.bracket_centre * behind
    held[3][2] = turns[1]
    held[3][3:] -= body.bracket_centre * behind_slope
    return [(mass, inertia, T, rate * slope), (*held[:3], rate * held[3])]
