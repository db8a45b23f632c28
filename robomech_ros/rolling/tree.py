"""The tree of links and joints of a rolling robot, with bodies to be seen."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from robomech_ros.errors import BadValueError
from robomech_ros.robots import RobotDescription
from robomech_ros.robots.urdf.document import description_from_urdf
from robomech_ros.robots.urdf.elements import element
from robomech_ros.rolling.base import RollingBase
from robomech_ros.rolling.wheels import Wheel

__all__ = ["BASE_JOINTS", "rolling_description"]

# Joints that place the base in the frame of odometry: x, y (m) and heading (rad).
BASE_JOINTS = ("base_x", "base_y", "base_heading")

# How far the base may go (m).
_FAR = 1e4
# Width and hub of a wheel, in its radius; rollers on its rim.
_WIDTH, _HUB, _ROLLERS = 0.6, 0.35, 10
# The platform: thickness and height of its middle, in the largest radius.
_THICKNESS, _MIDDLE = 0.8, 1.6
_TYRE, _RIM = (0.13, 0.14, 0.16, 1.0), (0.85, 0.87, 0.89, 1.0)
_ROLLER, _BODY = (0.93, 0.55, 0.14, 1.0), (0.20, 0.47, 0.70, 1.0)


def rolling_description(base: RollingBase) -> RobotDescription:
    """Describe a rolling robot as a URDF does, with planar joints that place it.

    The root is ``odom``; ``base_x``, ``base_y`` and ``base_heading`` place ``base_link`` in it.
    Joints of wheels have the names of the wheels and turn forward where they are positive; those of
    steered wheels are ``<name>_steering``, of casters ``<name>_bracket``.

    Parameters
    ----------
    base : RollingBase

    Returns
    -------
    RobotDescription
        Its ``document`` is the URDF.

    Raises
    ------
    BadValueError
        No RollingBase.
    RobotDescriptionError
        A wheel has the name of another joint.

    Examples
    --------
    >>> from robomech_ros.rolling import load_rolling, rolling_description
    >>> tree = rolling_description(load_rolling("tricycle"))
    >>> [joint.name for joint in tree.joints][2:5]
    ['base_heading', 'front_steering', 'front']
    """
    if not isinstance(base, RollingBase):
        raise BadValueError("base", base, "a RollingBase")
    parts = [*_placing(0.3 * float(base.radii.max())), _platform(base)]
    for name, wheel in zip(base.names, base.wheels, strict=True):
        parts += _wheel(name, wheel)
    document = element("robot", {"name": base.name}, parts)
    return description_from_urdf(document, base.name)


def _placing(radius: float) -> list[str]:
    """Write the joints that place the base; a disc marks where it begins."""
    # Links without bodies would get some along the way of their slides.
    nothing = _visual("sphere", {"radius": 1e-4}, (0, 0, 0), (0, 0, 0, 0))
    disc = _visual("cylinder", {"radius": radius, "length": 1e-3}, (0, 0, 0), _ROLLER)
    far = {"lower": -_FAR, "upper": _FAR, "effort": 0.0, "velocity": 0.0}
    x, y, heading = BASE_JOINTS
    return [
        _link("odom", disc),
        _joint(x, "prismatic", ("odom", f"{x}_link"), (1, 0, 0), limits=far),
        _link(f"{x}_link", nothing),
        _joint(y, "prismatic", (f"{x}_link", f"{y}_link"), (0, 1, 0), limits=far),
        _link(f"{y}_link", nothing),
        _joint(heading, "continuous", (f"{y}_link", "base_link"), (0, 0, 1)),
    ]


def _platform(base: RollingBase) -> str:
    """Write a plate over all wheels, with a nose where forward is."""
    places = np.array([wheel.position for wheel in base.wheels])
    radius = float(base.radii.max())
    margin = max(0.5 * radius, 0.02)
    low, high = places.min(axis=0) - margin, places.max(axis=0) + margin
    size, middle = high - low, 0.5 * (low + high)
    z = _MIDDLE * 1.5 * radius
    plate = _visual("box", {"size": (*size, _THICKNESS * radius)}, (*middle, z), _BODY)
    nose = (high[0] - 0.2 * size[0], middle[1], z + 0.5 * _THICKNESS * radius)
    arrow = _visual("box", {"size": (0.3 * size[0], 0.08 * size[1], 0.1 * radius)}, nose, _ROLLER)
    return _link("base_link", plate, arrow)


def _wheel(name: str, wheel: Wheel) -> list[str]:
    """Write a wheel, and what it turns in."""
    x, y = wheel.position.tolist()
    turned, holder, parts = (0.0, 0.0, wheel.heading), "base_link", []
    place = (x, y, wheel.radius)
    if wheel.kind in ("steered", "caster"):
        joint = f"{name}_steering" if wheel.kind == "steered" else f"{name}_bracket"
        low, high = wheel.steering_limits
        limits = None
        if math.isfinite(low) and math.isfinite(high):
            limits = {"lower": low, "upper": high, "effort": 0.0, "velocity": 0.0}
        holder = f"{name}_holder"
        kind = "continuous" if limits is None else "revolute"
        ends = ("base_link", holder)
        parts.append(_joint(joint, kind, ends, (0, 0, 1), (x, y, 0.0), turned, limits))
        post = {"radius": 0.15 * wheel.radius, "length": 0.8 * wheel.radius}
        parts.append(_link(holder, _visual("cylinder", post, (0, 0, 2.2 * wheel.radius), _RIM)))
        place, turned = (-wheel.trail, 0.0, wheel.radius), (0.0, 0.0, 0.0)
    ends = (holder, f"{name}_link")
    parts.append(_joint(name, "continuous", ends, (0, 1, 0), place, turned))
    parts.append(_link(f"{name}_link", *_rolling_bodies(wheel)))
    return parts


def _rolling_bodies(wheel: Wheel) -> list[str]:
    """Write a tyre with a bar across, by which it is seen to turn; of an omni wheel its rollers."""
    r, width = wheel.radius, _WIDTH * wheel.radius
    sideways = (0.5 * math.pi, 0.0, 0.0)
    hub = {"radius": _HUB * r, "length": 1.1 * width}
    bar = {"size": (1.5 * r, 1.15 * width, 0.2 * r)}
    bodies = [
        _visual("cylinder", hub, (0, 0, 0), _RIM, sideways),
        _visual("box", bar, (0, 0, 0), _RIM),
    ]
    if wheel.kind != "omni":
        tyre = {"radius": r, "length": width}
        return [_visual("cylinder", tyre, (0, 0, 0), _TYRE, sideways), *bodies]
    core = {"radius": 0.75 * r, "length": 0.7 * width}
    bodies.append(_visual("cylinder", core, (0, 0, 0), _TYRE, sideways))
    thick = 0.14 * r
    along = 2.0 * math.pi * r / _ROLLERS / max(abs(math.cos(wheel.roller)), 0.5)
    for angle in np.arange(_ROLLERS) * 2.0 * math.pi / _ROLLERS:
        c, s = math.cos(angle), math.sin(angle)
        place = (-s * (r - thick), 0.0, -c * (r - thick))
        # At the ground its axis is turned from the rolling direction by the angle of the roller.
        turn = (0.0, 0.5 * math.pi + angle, 0.0)
        roller = {"radius": thick, "length": 0.85 * along}
        bodies.append(_visual("cylinder", roller, place, _ROLLER, _then(wheel.roller, turn)))
    return bodies


def _then(roller: float, turn: tuple[float, float, float]) -> tuple[float, float, float]:
    """Give roll, pitch and yaw of z along an axis in the wheel that leans by an angle."""
    from robomech_ros.spatial import matrix_from_roll_pitch_yaw, roll_pitch_yaw_from_matrix

    # Pitch is about the wheel's axle: z lies along the rim, then it leans towards the axle.
    R = matrix_from_roll_pitch_yaw(turn) @ matrix_from_roll_pitch_yaw((-roller, 0.0, 0.0))
    roll, pitch, yaw = roll_pitch_yaw_from_matrix(R).tolist()
    return roll, pitch, yaw


def _link(name: str, *visuals: str) -> str:
    return element("link", {"name": name}, visuals)


def _joint(
    name: str,
    kind: str,
    ends: tuple[str, str],
    axis: tuple[float, ...],
    place: tuple[float, ...] = (0.0, 0.0, 0.0),
    turned: tuple[float, ...] = (0.0, 0.0, 0.0),
    limits: Mapping[str, object] | None = None,
) -> str:
    parts = [
        element("parent", {"link": ends[0]}),
        element("child", {"link": ends[1]}),
        element("origin", {"xyz": place, "rpy": turned}),
        element("axis", {"xyz": axis}),
    ]
    if limits is not None:
        parts.append(element("limit", limits))
    return element("joint", {"name": name, "type": kind}, parts)


def _visual(
    shape: str,
    measures: Mapping[str, object],
    place: tuple[float, ...],
    colour: tuple[float, ...],
    turned: tuple[float, ...] = (0.0, 0.0, 0.0),
) -> str:
    origin = element("origin", {"xyz": place, "rpy": turned})
    material = element("material", {"name": ""}, [element("color", {"rgba": colour})])
    geometry = element("geometry", {}, [element(shape, measures)])
    return element("visual", {}, [origin, geometry, material])
