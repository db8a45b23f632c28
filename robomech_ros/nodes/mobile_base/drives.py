"""Robots made from the parameters of the controllers of ros2_control, and their interfaces."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from robomech_ros.errors.formatting import counted
from robomech_ros.nodes.common.parameters import ParameterError
from robomech_ros.nodes.mobile_base.settings import MobileBaseSettings
from robomech_ros.rolling import (
    MotionLimits,
    RollingBase,
    RollingRobot,
    Wheel,
    WheelJoints,
    mecanum,
    omnidirectional,
    rolling_robot,
)

# Default limit of steering: at a right angle a car would turn on the spot.
_STEERING = 1.57


@dataclass(frozen=True)
class Interface:
    """Topics of a drive, and how it takes time-outs and twists.

    - ``command``, ``odometry``, ``frames``: topics.
    """

    command: str
    odometry: str
    frames: str
    timeout_name: str  #: Parameter of the time-out.
    timeout: float  #: Default time-out (s).
    at_zero: str  #: What a time-out of 0 means: commands count ``for ever``, ``once`` or ``never``.
    mean: bool  #: Whether the published twist is a rolling mean.
    forget_at_stale: bool = False  #: Whether a stale command also ends the one before.


_DIFF = Interface(
    "~/cmd_vel", "~/odom", "/tf", "cmd_vel_timeout", 0.5, at_zero="for ever", mean=True
)
_OMNI = replace(_DIFF, at_zero="never", mean=False)
_STEERED = Interface(
    "~/reference", "~/odometry", "~/tf_odometry", "reference_timeout", 1.0, "once", mean=True
)
INTERFACES = {
    "diff": _DIFF,
    "omni": _OMNI,
    "mecanum": replace(_STEERED, timeout=0.0, mean=False, forget_at_stale=True),
    "bicycle": _STEERED,
    "tricycle": _STEERED,
    "ackermann": _STEERED,
    "swerve": replace(_DIFF, mean=False),
}


def chosen_robot(settings: MobileBaseSettings) -> tuple[RollingRobot, WheelJoints]:
    """Make the robot of the parameters with its limits; RobomechError if it is impossible."""
    if settings.robot_description:
        robot = rolling_robot(settings.robot_description)
        if settings.drive not in ("", robot.drive):
            raise ParameterError("drive", settings.drive, f"'{robot.drive}', that of the robot")
        base, joints = robot.base, _checked(WheelJoints.of(robot.base))
    elif settings.drive in _MAKERS:
        base, joints = _MAKERS[settings.drive](settings)
        robot = RollingRobot(base, settings.drive, MotionLimits(), None, "parameters")
    else:
        allowed = f"one of {', '.join(_MAKERS)}, or a robot_description"
        raise ParameterError("drive", settings.drive, allowed)
    base = _with_wheel_limits(base, settings)
    return replace(robot, base=base, limits=_limits(robot.limits, settings)), joints


def _limits(known: MotionLimits, settings: MobileBaseSettings) -> MotionLimits:
    """Replace limits by those that are given; what is not given follows from what is."""
    names = {
        "velocity": ("max_velocity",),
        "backward_velocity": ("min_velocity", "max_velocity"),
        "acceleration": ("max_acceleration",),
        "deceleration": ("max_deceleration", "max_acceleration"),
        "backward_acceleration": ("max_acceleration_reverse", "max_acceleration"),
        "backward_deceleration": (
            "max_deceleration_reverse",
            "max_acceleration_reverse",
            "max_deceleration",
            "max_acceleration",
        ),
        "jerk": ("max_jerk",),
    }
    made = {}
    for name, sources in names.items():
        row = np.array(getattr(known, name))
        kind = sources[-1].removeprefix("max_")
        for i, axis in enumerate(("angular__z", "linear__x", "linear__y")):
            if not getattr(settings, f"{axis}__has_{kind}_limits", True):
                continue
            given = (abs(getattr(settings, f"{axis}__{source}")) for source in sources)
            row[i] = next((value for value in given if not math.isnan(value)), row[i])
            if name == "jerk":
                row[i] = np.fmin(row[i], abs(getattr(settings, f"{axis}__min_jerk")))
        made[name] = row
    return MotionLimits(**made)


def _with_wheel_limits(base: RollingBase, settings: MobileBaseSettings) -> RollingBase:
    rate, turn = settings.max_wheel_rate, settings.max_steering_rate
    if math.isnan(rate) and math.isnan(turn):
        return base
    wheels = []
    for wheel in base.wheels:
        if wheel.driven and not math.isnan(rate):
            wheel = replace(wheel, max_rate=rate)
        if wheel.kind == "steered" and not math.isnan(turn):
            wheel = replace(wheel, max_steering_rate=turn)
        wheels.append(wheel)
    return RollingBase(wheels, name=base.name)


def _diff(settings: MobileBaseSettings) -> tuple[RollingBase, WheelJoints]:
    sides = (settings.left_wheel_names, settings.right_wheel_names)
    for name, given in zip(("left_wheel_names", "right_wheel_names"), sides, strict=True):
        _count(name, given, len(sides[0]) or 1)
    half = 0.5 * _length(settings, "wheel_separation") * settings.wheel_separation_multiplier
    radius = _length(settings, "wheel_radius")
    multipliers = (settings.left_wheel_radius_multiplier, settings.right_wheel_radius_multiplier)
    wheels = [
        Wheel(kind="fixed", position=np.array([0.0, y]), radius=radius * factor, name=name)
        for name, y, factor in zip(("left", "right"), (half, -half), multipliers, strict=True)
    ]
    rolling = [(name, side) for side, joints in enumerate(sides) for name in joints]
    return RollingBase(wheels, name="diff"), _joints(rolling)


def _omni(settings: MobileBaseSettings) -> tuple[RollingBase, WheelJoints]:
    joints = settings.wheel_names
    radius, far = _length(settings, "wheel_radius"), _length(settings, "robot_radius")
    base = omnidirectional(len(joints), radius, far, offset=settings.wheel_offset)
    return base, _joints([(name, i) for i, name in enumerate(joints)])


def _mecanum(settings: MobileBaseSettings) -> tuple[RollingBase, WheelJoints]:
    # Only the sum of both lengths counts, with rollers of 45 degrees.
    reach = _length(settings, "kinematics__sum_of_robot_center_projection_on_X_Y_axis")
    centred = mecanum(_length(settings, "kinematics__wheels_radius"), reach, reach)
    turn = settings.kinematics__base_frame_offset__theta
    c, s = math.cos(turn), math.sin(turn)
    centre = (settings.kinematics__base_frame_offset__x, settings.kinematics__base_frame_offset__y)
    wheels = [
        replace(
            wheel,
            position=np.array(centre) + np.array([[c, -s], [s, c]]) @ wheel.position,
            heading=wheel.heading + turn,
        )
        for wheel in centred.wheels
    ]
    corners = ("front_left", "front_right", "rear_right", "rear_left")
    names = [f"{corner}_wheel_command_joint_name" for corner in corners]
    for name in names:
        if not getattr(settings, name):
            raise ParameterError(name, "", "the name of a joint")
    rolling = [(getattr(settings, name), i) for i, name in enumerate(names)]
    return RollingBase(wheels, name="mecanum"), _joints(rolling)


def _steered(rear: int, front: int) -> Callable[..., tuple[RollingBase, WheelJoints]]:
    """Return what makes a base with so many rear and front wheels."""

    def make(settings: MobileBaseSettings) -> tuple[RollingBase, WheelJoints]:
        traction, steering = settings.traction_joints_names, settings.steering_joints_names
        _count("traction_joints_names", traction, rear)
        _count("steering_joints_names", steering, front)
        radius = _length(settings, "traction_wheels_radius", "traction_wheel_radius")
        wheelbase = _length(settings, "wheelbase")
        tracks = [0.0, 0.0]
        if rear == 2:
            tracks[0] = _length(settings, "traction_track_width", "wheel_track")
        if front == 2:
            tracks[1] = settings.steering_track_width or tracks[0]
        driven = [
            Wheel(kind="fixed", position=np.array([0.0, y]), radius=radius, name=name)
            for name, y in zip(traction, _across(rear, tracks[0]), strict=True)
        ]
        turned = [
            Wheel(
                kind="steered",
                position=np.array([wheelbase, y]),
                radius=radius,
                driven=False,
                name=f"{name}_wheel",
                steering_limits=(-_STEERING, _STEERING),
            )
            for name, y in zip(steering, _across(front, tracks[1]), strict=True)
        ]
        base = RollingBase([*driven, *turned], name=settings.drive)
        return base, _joints([(name, i) for i, name in enumerate(traction)], steering)

    return make


def _across(count: int, track: float) -> tuple[float, ...]:
    """Return where the wheels of an axle are, the right one first (m)."""
    return (0.0,) if count == 1 else (-0.5 * track, 0.5 * track)


def _length(settings: MobileBaseSettings, *names: str) -> float:
    """Return the first of these parameters that is a length (m)."""
    given = (float(getattr(settings, name)) for name in names)
    found = next((value for value in given if value > 0.0), None)
    if found is None:
        raise ParameterError(names[0].replace("__", "."), 0.0, "a length above 0 m")
    return found


def _joints(rolling: Sequence[tuple[str, int]], steering: Sequence[str] = ()) -> WheelJoints:
    return _checked(WheelJoints(tuple(rolling), tuple(steering)))


def _checked(joints: WheelJoints) -> WheelJoints:
    """Refuse names that come twice: joint_states could not tell them apart."""
    twice = next((name for name in joints.names if joints.names.count(name) > 1), None)
    if twice is not None:
        raise ParameterError("names of joints", twice, "each joint once")
    return joints


def _count(name: str, given: Sequence[str], expected: int) -> None:
    if len(given) != expected:
        raise ParameterError(name, list(given), f"a list of {counted(expected, 'name')}")


_MAKERS = {
    "diff": _diff,
    "omni": _omni,
    "mecanum": _mecanum,
    "bicycle": _steered(1, 1),
    "tricycle": _steered(2, 1),
    "ackermann": _steered(2, 2),
}
