"""Parameters of the mobile base, with the names of the controllers of ros2_control."""

import math
from dataclasses import dataclass, make_dataclass
from typing import Any

from robomech_ros.nodes.common.parameters import ParameterError, parameter
from robomech_ros.nodes.display.robot_display import ALWAYS, AUTO, NEVER

KINEMATIC, DYNAMIC = "kinematic", "dynamic"
_DRIVES = ("", "diff", "omni", "mecanum", "bicycle", "tricycle", "ackermann", "swerve")
_OFF = math.nan
# For each axis: the limits with negative sign, as in ros2_controllers.
_NEGATIVE = ("min_velocity", "max_deceleration", "max_acceleration_reverse", "min_jerk")
_POSITIVE = ("max_velocity", "max_acceleration", "max_deceleration_reverse", "max_jerk")
_AXES = ("linear__x", "linear__y", "angular__z")
# Names of Humble's steering controllers, whose driven wheels are not steered.
_DRIVEN, _STEERED = "'traction_joints_names'", "'steering_joints_names'"
FORMER_NAMES = {
    "rear_wheels_names": f"{_DRIVEN}, or {_STEERED} where the rear wheels are steered",
    "front_wheels_names": f"{_STEERED}, or {_DRIVEN} where the rear wheels are steered",
    "rear_wheels_state_names": f"{_DRIVEN}, which also names the states",
    "front_wheels_state_names": f"{_STEERED}, which also names the states",
    "front_steering": f"{_STEERED}, the names of the wheels that are steered",
    "rear_wheel_track": "'traction_track_width'",
    "front_wheel_track": "'steering_track_width'",
    "rear_wheels_radius": "'traction_wheels_radius'",
    "rear_wheel_radius": "'traction_wheels_radius'",
    "front_wheels_radius": "'traction_wheels_radius', that of the driven wheels alone",
    "front_wheel_radius": "'traction_wheels_radius', that of the driven wheels alone",
}


def _rows_of(axis: str, turns: str, unit: str) -> dict[str, Any]:
    """Make the parameters with the limits of an axis, and what its other direction is called."""
    bounds = {
        "max_velocity": f"Largest velocity ({unit}/s)",
        "min_velocity": f"Smallest velocity, at most 0 ({unit}/s)",
        "max_acceleration": f"Acceleration ({unit}/s^2)",
        "max_deceleration": f"Deceleration, below 0 ({unit}/s^2)",
        "max_acceleration_reverse": f"Acceleration {turns}, below 0 ({unit}/s^2)",
        "max_deceleration_reverse": f"Deceleration {turns} ({unit}/s^2)",
        "max_jerk": f"Jerk ({unit}/s^3)",
        "min_jerk": f"Jerk, below 0 ({unit}/s^3)",
    }
    rows = {
        f"has_{kind}_limits": parameter(
            True, f"False: ignore {kind} limits of {axis}; exists in older ros2_controllers"
        )
        for kind in ("velocity", "acceleration", "jerk")
        if axis != "linear.y"
    }
    text = f"of {axis}; NaN = that of the robot, else none"
    return rows | {name: parameter(_OFF, f"{what} {text}") for name, what in bounds.items()}


_LimitsOfAxes: Any = make_dataclass(
    "LimitsOfAxes",
    [
        (f"{axis.replace('.', '__')}__{name}", type(row.default), row)
        for axis, turns, unit in (
            ("linear.x", "backward", "m"),
            ("linear.y", "to the right", "m"),
            ("angular.z", "clockwise", "rad"),
        )
        for name, row in _rows_of(axis, turns, unit).items()
    ],
    frozen=True,
)


def _length(description: str) -> Any:
    return parameter(0.0, description, (0.0, 1e3, "m"))


def _variances(description: str) -> Any:
    return parameter((), description, (0.0, 1e9))


@dataclass(frozen=True)
class MobileBaseSettings(_LimitsOfAxes):
    """Parameters of the node."""

    robot_description: str = parameter(
        "", "Name of a rolling robot, or path or text of its YAML; empty = the parameters below"
    )
    drive: str = parameter("", "Kind of drive; empty = that of the robot", choices=_DRIVES)
    simulation: str = parameter(
        KINEMATIC,
        "Motion of the base: kinematic = as commanded, dynamic = by the torques of its motors, of "
        "driven wheels and of those that steer",
        choices=(KINEMATIC, DYNAMIC),
    )
    update_rate: float = parameter(
        100.0, "Rate at which limits are applied and wheels are commanded", (1.0, 1000.0, "Hz")
    )
    publish_rate: float = parameter(50.0, "Rate of odometry and joint states", (0.1, 1000.0, "Hz"))
    cmd_vel_timeout: float = parameter(
        0.5,
        "diff, omni, swerve: command timeout; the base then brakes. 0: no timeout for diff and "
        "swerve, omni always brakes",
        (0.0, 3600.0, "s"),
    )
    reference_timeout: float = parameter(
        _OFF,
        "mecanum, bicycle, tricycle, ackermann: command timeout. 0 = a command lasts for one "
        "update, NaN = 0 for mecanum, else 1",
        (0.0, 3600.0, "s"),
    )
    left_wheel_names: tuple[str, ...] = parameter((), "diff: joints of the left wheels")
    right_wheel_names: tuple[str, ...] = parameter((), "diff: joints of the right wheels")
    wheel_separation: float = _length("diff: distance between the wheels")
    wheel_radius: float = _length("diff, omni: wheel radius")
    wheel_separation_multiplier: float = parameter(
        1.0, "diff: factor of the separation", (0.0, 1e3)
    )
    left_wheel_radius_multiplier: float = parameter(1.0, "diff: left radius factor", (0.0, 1e3))
    right_wheel_radius_multiplier: float = parameter(1.0, "diff: right radius factor", (0.0, 1e3))
    wheel_names: tuple[str, ...] = parameter((), "omni: joints, counter-clockwise, evenly spaced")
    wheel_offset: float = parameter(0.0, "omni: angle x to first wheel", (-10.0, 10.0, "rad"))
    robot_radius: float = _length("omni: centre to wheel distance")
    front_left_wheel_command_joint_name: str = parameter("", "mecanum: front left wheel joint")
    front_right_wheel_command_joint_name: str = parameter("", "mecanum: front right wheel joint")
    rear_right_wheel_command_joint_name: str = parameter("", "mecanum: rear right wheel joint")
    rear_left_wheel_command_joint_name: str = parameter("", "mecanum: rear left wheel joint")
    kinematics__base_frame_offset__x: float = parameter(
        0.0, "mecanum: x of the centre of the wheels in the base", (-1e3, 1e3, "m")
    )
    kinematics__base_frame_offset__y: float = parameter(
        0.0, "mecanum: y of the centre of the wheels in the base", (-1e3, 1e3, "m")
    )
    kinematics__base_frame_offset__theta: float = parameter(
        0.0, "mecanum: heading of the wheels in the base", (-10.0, 10.0, "rad")
    )
    kinematics__wheels_radius: float = _length("mecanum: wheel radius")
    kinematics__sum_of_robot_center_projection_on_X_Y_axis: float = _length(
        "mecanum: x plus y of the front left wheel, from the centre of the wheels"
    )
    traction_joints_names: tuple[str, ...] = parameter(
        (), "bicycle, tricycle, ackermann: joints of the driven rear wheels, right one first"
    )
    steering_joints_names: tuple[str, ...] = parameter(
        (), "bicycle, tricycle, ackermann: joints of the front wheels, right one first"
    )
    wheelbase: float = _length("bicycle, tricycle, ackermann: axle to axle")
    traction_track_width: float = _length("tricycle, ackermann: distance between the rear wheels")
    steering_track_width: float = _length(
        "ackermann: distance between the front wheels; 0 = as at the rear"
    )
    traction_wheels_radius: float = _length("bicycle, tricycle, ackermann: wheel radius")
    traction_wheel_radius: float = _length("bicycle: the same, under its name for that drive")
    wheel_track: float = _length("tricycle: old name of traction_track_width")
    max_wheel_rate: float = parameter(
        _OFF,
        "Rate limit of each driven wheel; the curvature is kept. NaN = that of the robot",
        (0.0, 1e6, "rad/s"),
    )
    max_steering_rate: float = parameter(
        _OFF, "Rate limit of each steered wheel; NaN = that of the robot", (0.0, 1e6, "rad/s")
    )
    open_loop: bool = parameter(False, "Odometry from limited commands, not wheels")
    position_feedback: bool = parameter(True, "Odometry from wheel positions, not velocities")
    velocity_rolling_window_size: int = parameter(
        10, "Number of twists whose mean is published; not for omni, mecanum and swerve", (1, 10000)
    )
    publish_limited_velocity: bool = parameter(False, "Publish ~/cmd_vel_out")
    odom_frame_id: str = parameter("odom", "Frame of odometry")
    base_frame_id: str = parameter("base_link", "Frame of the base")
    enable_odom_tf: bool = parameter(True, "Publish the frame of the base on tf")
    publish_frames: str = parameter(
        AUTO,
        "Publication of wheel frames on /tf, if tf2_msgs is installed; auto = frames without "
        "another publisher, and none if enable_odom_tf is false",
        choices=(AUTO, ALWAYS, NEVER),
    )
    frame_rate: float = parameter(
        20.0, "Rate of the wheel frames; at most publish_rate", (0.1, 1000.0, "Hz")
    )
    publish_description: bool = parameter(
        True,
        "Publish the robot as a URDF on the latched topic robot_description, unless another node "
        "publishes one",
    )
    tf_frame_prefix_enable: bool = parameter(True, "Add a prefix to all frames")
    tf_frame_prefix: str = parameter("", "Prefix of all frames; empty or '~' = the namespace")
    pose_covariance_diagonal: tuple[float, ...] = _variances(
        "Pose: x, y, z, roll, pitch, yaw; empty = grows with distance and slip"
    )
    twist_covariance_diagonal: tuple[float, ...] = _variances(
        "Twist variances in the same order; empty = those of the wheels"
    )
    diagonal_covariance__pose: tuple[float, ...] = _variances(
        "omni: same as pose_covariance_diagonal"
    )
    diagonal_covariance__twist: tuple[float, ...] = _variances(
        "omni: same as twist_covariance_diagonal"
    )
    initial_wheel_position: float = parameter(
        0.0, "Initial position of the simulated wheels", (-1e6, 1e6, "rad")
    )


def check_settings(settings: MobileBaseSettings) -> None:
    """Raise ParameterError for what does not fit together."""
    for axis in _AXES:
        for names, sign, allowed in (
            (_NEGATIVE, -1.0, "a number of at most 0, or NaN"),
            (_POSITIVE, 1.0, "a number of at least 0, or NaN"),
        ):
            for name in names:
                value = getattr(settings, f"{axis}__{name}")
                if sign * value < 0.0:
                    raise ParameterError(f"{axis.replace('__', '.')}.{name}", value, allowed)
    for name in ("pose_covariance_diagonal", "twist_covariance_diagonal"):
        for of in (name, f"diagonal_covariance__{name.partition('_')[0]}"):
            if len(getattr(settings, of)) not in (0, 6):
                allowed = "six numbers of at least 0, or none"
                raise ParameterError(of.replace("__", "."), getattr(settings, of), allowed)
