"""How the motion of a base shapes the twists of its platform, wheels and brackets.

The frame is at rest and has the axes of the base at this moment.  Independent rates are the turn of
the base and its velocity forward at the fixed axle, or its whole twist without one.
"""

from collections.abc import Sequence

import numpy as np

from robomech_ros.rolling.bodies import PlatformBody, WheelBody
from robomech_ros.rolling.constraints import direction_rows
from robomech_ros.rolling.wheels import Wheel
from robomech_ros.typing import Array

# Masses, inertias (r, 3, 3), twist-shaping matrix (6 r, m) and its rate.
Shaped = tuple[Array, Array, Array, Array]

_TURN = np.array([1.0, 0.0, 0.0])
_UP = np.array([0.0, 0.0, 1.0])
# Quarter turn about the vertical axis, of twists [omega; v].
_QUARTER = np.zeros((6, 6))
_QUARTER[0, 1] = _QUARTER[3, 4] = -1.0
_QUARTER[1, 0] = _QUARTER[4, 3] = 1.0


def shaped_twists(
    platform: PlatformBody, wheels: Sequence[tuple[Wheel, WheelBody]], twist: Array, brackets: Array
) -> Shaped:
    """Return masses, inertias and matrices from the twist (3,) of the base to those of all bodies.

    ``brackets`` (c,) are angles of the casters (rad).
    """
    found = [_carried(platform.centre, platform.mass, platform.inertia * np.outer(_UP, _UP))]
    angles = iter(brackets.tolist())
    for wheel, body in wheels:
        if wheel.kind == "caster":
            found += _caster(wheel, body, wheel.heading + next(angles), twist)
        else:
            found.append(_wheel(wheel, body))
    T = np.concatenate([matrix for _, _, matrix, _ in found])
    relative = np.concatenate([rate for _, _, _, rate in found])
    # All is carried round by the base; brackets turn besides.
    turning = np.kron(np.eye(len(found)), _QUARTER) @ T * twist[0]
    masses = np.array([mass for mass, _, _, _ in found])
    return masses, np.array([inertia for _, inertia, _, _ in found]), T, turning + relative


def _carried(point: Array, mass: float, inertia: Array) -> tuple[float, Array, Array, Array]:
    """Return a body that the base carries at a point."""
    T = np.zeros((6, 3))
    T[2] = _TURN
    T[3:5] = direction_rows(np.array([point, point]), np.array([0.0, 0.5 * np.pi]))
    return mass, inertia, T, np.zeros((6, 3))


def _axes(angle: float) -> tuple[Array, Array]:
    """Return the rolling direction and the axle."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([c, s, 0.0]), np.array([-s, c, 0.0])


def _inertia(body: WheelBody, axle: Array) -> Array:
    return np.asarray(body.turn * np.eye(3) + (body.spin - body.turn) * np.outer(axle, axle))


def _wheel(wheel: Wheel, body: WheelBody) -> tuple[float, Array, Array, Array]:
    """Return a wheel that is not a caster: it turns about its axle, besides."""
    _, axle = _axes(wheel.heading)
    mass, inertia, T, rate = _carried(wheel.position, body.mass, _inertia(body, axle))
    towards = np.array([wheel.heading + wheel.roller])
    rolls = direction_rows(wheel.position[None], towards)[0] / np.cos(wheel.roller)
    T[:3] += np.outer(axle, rolls / wheel.radius)
    return mass, inertia, T, rate


def _caster(
    wheel: Wheel, body: WheelBody, angle: float, twist: Array
) -> list[tuple[float, Array, Array, Array]]:
    """Return a caster's wheel, and its bracket."""
    forward, axle = _axes(angle)
    both = np.array([angle, angle + 0.5 * np.pi])
    rolls, sides = direction_rows(np.array([wheel.position] * 2), both)
    turns = sides / wheel.trail
    rate = float(turns @ twist - twist[0])
    T, slope = np.zeros((6, 3)), np.zeros((6, 3))
    T[:3] = np.outer(axle, rolls / wheel.radius) + np.outer(_UP, turns)
    T[3:] = np.outer(forward, rolls)
    slope[:3] = (np.outer(axle, sides) - np.outer(forward, rolls)) / wheel.radius
    slope[:3] -= np.outer(_UP, rolls / wheel.trail)
    slope[3:] = np.outer(axle, rolls) + np.outer(forward, sides)
    share = body.bracket_centre / wheel.trail
    inertia = body.bracket_inertia * np.outer(_UP, _UP)
    mass, inertia, T_bracket, slope_bracket = _carried(wheel.position, body.bracket_mass, inertia)
    T_bracket[2] = turns
    T_bracket[3:] -= share * np.outer(axle, sides)
    slope_bracket[2] = -rolls / wheel.trail
    slope_bracket[3:] += share * (np.outer(forward, sides) + np.outer(axle, rolls))
    return [
        (body.mass, _inertia(body, axle), T, rate * slope),
        (mass, inertia, T_bracket, rate * slope_bracket),
    ]
