"""The tree of links and joints of a rolling robot, with bodies to be seen."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from robomech_ros.robots import RobotDescription
from robomech_ros.robots.urdf.document import description_from_urdf
from robomech_ros.robots.urdf.elements import element, new_name
from robomech_ros.rolling.base import RollingBase
from robomech_ros.rolling.wheels import Wheel
from robomech_ros.spatial.arrays import check_kind

# Joints that place the base in the frame of odometry: x, y (m) and heading (rad).
BASE_JOINTS = ("base_x", "base_y", "base_heading")

# How far the base may go (m).
_FAR = 1e4
# Width and hub of a wheel, in its radius; rollers on its rim.
_WIDTH, _HUB, _ROLLERS = 0.6, 0.35, 10
# The platform: thickness and height of its middle, in the largest radius.
_THICKNESS, _MIDDLE = 0.8, 1.6
# From wheel to wheel where one stands for several, one behind the other, in its radius.
_SPACING = 2.2
# Red, green, blue and alpha.  Each has a name: RViz gives all bodies of a link without names the
# colour of the first one.
_TYRE, _RIM, _ROLLER, _BODY, _NONE = "tyre", "rim", "roller", "body", "none"
_COLOURS = {
    _TYRE: (0.13, 0.14, 0.16, 1.0),
    _RIM: (0.85, 0.87, 0.89, 1.0),
    _ROLLER: (0.93, 0.55, 0.14, 1.0),
    _BODY: (0.20, 0.47, 0.70, 1.0),
    _NONE: (0.0, 0.0, 0.0, 0.0),
}


@dataclass(frozen=True)
class WheelJoints:
    """Names of the joints of a base.

    Attributes
    ----------
    rolling : tuple of (str, int)
        Joints that roll, each with the number of its wheel.  Several wheels of one side may count
        as one wheel; a wheel without a joint is not told to roll.
    steering : tuple of str
        Of the steered wheels.
    brackets : tuple of str
        Brackets of the casters.

    Examples
    --------
    >>> from robomech_ros.rolling import WheelJoints, load_rolling
    >>> WheelJoints.of(load_rolling("tricycle")).names
    ('front', 'rear_right', 'rear_left', 'front_steering')
    """

    rolling: tuple[tuple[str, int], ...]
    steering: tuple[str, ...]
    brackets: tuple[str, ...] = ()

    @classmethod
    def of(cls, base: RollingBase) -> WheelJoints:
        """Name the joints of a base after its wheels.

        Parameters
        ----------
        base : RollingBase

        Returns
        -------
        WheelJoints
            Wheels roll by their own names; steering is ``<name>_steering``, the bracket of a
            caster ``<name>_bracket``.
        """
        rolling = tuple((name, number) for number, name in enumerate(base.names))
        steering = tuple(f"{name}_steering" for name in base.steered)
        return cls(rolling, steering, tuple(f"{name}_bracket" for name in base.casters))

    @property
    def names(self) -> tuple[str, ...]:
        """All of them: those that roll, steering, brackets."""
        return (*(name for name, _ in self.rolling), *self.steering, *self.brackets)


def rolling_description(
    base: RollingBase,
    joints: WheelJoints | None = None,
    *,
    base_link: str = "base_link",
    placed: bool = True,
) -> RobotDescription:
    """Describe a rolling robot as a URDF does, by default with planar joints that place it.

    The root is ``odom``; ``base_x``, ``base_y`` and ``base_heading`` place the base in it.  Joints
    of wheels turn forward where they are positive.  A link that a wheel rolls with is
    ``<joint>_link``, what holds a steered wheel or a caster ``<wheel>_holder``, each with ``_``
    behind it where another link has that name.

    Parameters
    ----------
    base : RollingBase
    joints : WheelJoints, optional
        Names of the joints; default those of the wheels, with ``_steering`` and ``_bracket``.
        Wheels without a joint that rolls are fixed to what holds them; where several joints roll
        for one wheel, theirs stand one behind the other.
    base_link : str, optional
        Name of the link of the base.
    placed : bool, optional
        Whether planar joints place the base; without them it is the root, for those who know
        from odometry where it is.

    Returns
    -------
    RobotDescription
        Its ``document`` is the URDF.

    Raises
    ------
    RobotDescriptionError
        Two joints have one name, or a name is none that a URDF can have.

    Examples
    --------
    >>> from robomech_ros.rolling import load_rolling, rolling_description
    >>> tree = rolling_description(load_rolling("tricycle"))
    >>> [joint.name for joint in tree.joints][2:5]
    ['base_heading', 'front_steering', 'front']
    >>> rolling_description(load_rolling("tricycle"), placed=False).root
    'base_link'
    """
    check_kind("base", base, RollingBase, "a RollingBase")
    joints = WheelJoints.of(base) if joints is None else joints
    names = _Names(base_link, {base_link}, {*joints.names})
    axles = [_axles(number, wheel, joints) for number, wheel in enumerate(base.wheels)]
    parts = _placing(0.3 * float(base.radii.max()), names) if placed else []
    parts.append(_platform(base, [axle.place for wheel in axles for axle in wheel], base_link))
    turned = iter(joints.steering), iter(joints.brackets)
    for name, wheel, own in zip(base.names, base.wheels, axles, strict=True):
        pivot = ""
        if wheel.kind in ("steered", "caster"):
            pivot = next(turned[wheel.kind == "caster"])
        parts += _wheel(name, wheel, own, pivot, names)
    document = element("robot", {"name": base.name}, parts)
    return description_from_urdf(document, base.name)


class _Axle(NamedTuple):
    """Axle of a wheel: its joint, empty for none; position in the base, offset ahead (m)."""

    joint: str
    place: tuple[float, float]
    ahead: float


class _Names(NamedTuple):
    """The link of the base, and the names of links and joints that are taken."""

    base_link: str
    links: set[str]
    joints: set[str]


def _axles(number: int, wheel: Wheel, joints: WheelJoints) -> list[_Axle]:
    """Return the joints that roll for a wheel, one behind the other, their middle at its place."""
    own = [name for name, of in joints.rolling if of == number] or [""]
    along = np.array([math.cos(wheel.heading), math.sin(wheel.heading)])
    made = []
    for i, name in enumerate(own):
        ahead = (0.5 * (len(own) - 1) - i) * _SPACING * wheel.radius
        x, y = (wheel.position + ahead * along).tolist()
        made.append(_Axle(name, (x, y), ahead))
    return made


def _placing(radius: float, names: _Names) -> list[str]:
    """Write the joints that place the base; a disc marks where it begins."""
    # Links without bodies would get generated ones along their slides.
    nothing = _visual("sphere", {"radius": 1e-4}, (0, 0, 0), _NONE)
    disc = _visual("cylinder", {"radius": radius, "length": 1e-3}, (0, 0, 0), _ROLLER)
    far = {"lower": -_FAR, "upper": _FAR, "effort": 0.0, "velocity": 0.0}
    x, y, heading = BASE_JOINTS
    links = ("odom", f"{x}_link", f"{y}_link")
    odom, x_link, y_link = (new_name(link, names.links) for link in links)
    return [
        _link(odom, disc),
        _joint(x, "prismatic", (odom, x_link), (1, 0, 0), limits=far),
        _link(x_link, nothing),
        _joint(y, "prismatic", (x_link, y_link), (0, 1, 0), limits=far),
        _link(y_link, nothing),
        _joint(heading, "continuous", (y_link, names.base_link), (0, 0, 1)),
    ]


def _platform(base: RollingBase, axles: Sequence[tuple[float, float]], name: str) -> str:
    """Write a plate over all wheels, with a nose where forward is."""
    places = np.array(axles)
    radius = float(base.radii.max())
    margin = max(0.5 * radius, 0.02)
    low, high = places.min(axis=0) - margin, places.max(axis=0) + margin
    size, middle = high - low, 0.5 * (low + high)
    z = _MIDDLE * 1.5 * radius
    plate = _visual("box", {"size": (*size, _THICKNESS * radius)}, (*middle, z), _BODY)
    nose = (high[0] - 0.2 * size[0], middle[1], z + 0.5 * _THICKNESS * radius)
    arrow = _visual("box", {"size": (0.3 * size[0], 0.08 * size[1], 0.1 * radius)}, nose, _ROLLER)
    return _link(name, plate, arrow)


def _wheel(
    name: str, wheel: Wheel, axles: Sequence[_Axle], pivot: str, names: _Names
) -> Iterator[str]:
    """Write a wheel, or several, and what they turn in."""
    turned, holder = (0.0, 0.0, wheel.heading), names.base_link
    if pivot:
        low, high = wheel.steering_limits
        limits = None
        if math.isfinite(low) and math.isfinite(high):
            limits = {"lower": low, "upper": high, "effort": 0.0, "velocity": 0.0}
        holder = new_name(f"{name}_holder", names.links)
        kind = "continuous" if limits is None else "revolute"
        ends, (x, y) = (names.base_link, holder), wheel.position.tolist()
        yield _joint(pivot, kind, ends, (0, 0, 1), (x, y, 0.0), turned, limits)
        post = {"radius": 0.15 * wheel.radius, "length": 0.8 * wheel.radius}
        yield _link(holder, _visual("cylinder", post, (0, 0, 2.2 * wheel.radius), _RIM))
        turned = (0.0, 0.0, 0.0)
    for axle in axles:
        x, y = (axle.ahead - wheel.trail, 0.0) if pivot else axle.place
        place = (x, y, wheel.radius)
        joint = axle.joint or new_name(name, names.joints)
        link = new_name(f"{joint}_link", names.links)
        kind = "continuous" if axle.joint else "fixed"
        yield _joint(joint, kind, (holder, link), (0, 1, 0), place, turned)
        yield _link(link, *_rolling_bodies(wheel))


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
    """Return roll, pitch and yaw of z along an axis in the wheel that leans by an angle."""
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
    colour: str,
    turned: tuple[float, ...] = (0.0, 0.0, 0.0),
) -> str:
    origin = element("origin", {"xyz": place, "rpy": turned})
    rgba = element("color", {"rgba": _COLOURS[colour]})
    material = element("material", {"name": f"robomech_{colour}"}, [rgba])
    geometry = element("geometry", {}, [element(shape, measures)])
    return element("visual", {}, [origin, geometry, material])
