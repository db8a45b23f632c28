"""Parameters of the walker."""

import math
from dataclasses import dataclass

from robomech_ros.nodes.common.joints.tracking_monitor import StreamSettings
from robomech_ros.nodes.common.parameters import parameter
from robomech_ros.walking import GAITS, LeggedRobot, Walker


@dataclass(frozen=True)
class WalkerSettings(StreamSettings):
    """Parameters of the node."""

    robot_description: str = parameter(
        "", "Name of a walking machine, such as phantomx, or path or text of its YAML"
    )
    frame_prefix: str = parameter(
        "",
        "Prefix of this robot's frames in headers and on /tf, odom_frame_id included, such as "
        "left/",
    )
    gait: str = parameter(
        "", "Initial gait; empty = tripod, or crawl on four legs", choices=("", *GAITS)
    )
    update_rate: float = parameter(
        100.0, "Rate of feet and joints: points of the trajectory", (20.0, 1000.0, "Hz")
    )
    publish_rate: float = parameter(
        50.0, "Rate of trajectory, odometry and contact messages", (1.0, 1000.0, "Hz")
    )
    lead: float = parameter(
        0.2,
        "Time by which the walk is computed ahead. A message to the controller may be this late "
        "without disturbing the walk; commands take effect that much later",
        (0.1, 1.0, "s"),
    )
    cmd_vel_timeout: float = parameter(
        0.5, "Command timeout; the robot then stops, all feet down", (0.01, 3600.0, "s")
    )
    cycle: float = parameter(
        0.0,
        "Duration of a gait cycle; 0 = chosen for robot and gait: joints stay below 60 % of their "
        "speed limits at the longest stride",
        (0.0, 60.0, "s"),
    )
    lift: float = parameter(0.03, "Height to which feet are lifted", (1e-4, 10.0, "m"))
    stability_bound: float = parameter(
        math.nan,
        "Smallest allowed stability margin; NaN = 0.01, or -0.04 for the trot, which is supported "
        "on lines",
        (-10.0, 10.0, "m"),
    )
    max_linear_acceleration: float = parameter(
        0.5, "Largest acceleration of the walk, forward and sideways", (1e-3, 1e3, "m/s^2")
    )
    max_angular_acceleration: float = parameter(
        1.0, "Largest angular acceleration of the walk, about the vertical", (1e-3, 1e3, "rad/s^2")
    )
    joint_speed: float = parameter(
        0.95,
        "Fraction of the joint speed limits to use; the controller is slightly faster between two "
        "points",
        (0.01, 1.0),
    )
    body_pose_duration: float = parameter(
        1.0,
        "Duration of a trunk motion to a new body_pose; longer if its acceleration would tip the "
        "robot",
        (0.01, 3600.0, "s"),
    )
    rising_speed: float = parameter(
        0.2,
        "Fraction of the joint speed limits at which a robot that is not standing rises at the "
        "first command",
        (0.01, 1.0),
    )
    foot_slip: float = parameter(
        1e-4,
        "Variance of foot slip per metre of trunk travel, for the covariance of odometry",
        (0.0, 1.0, "m^2/m"),
    )
    foot_friction: float = parameter(
        0.6, "Friction coefficient of the feet, for their forces on ~/foot_forces", (0.0, 1e3)
    )
    odom_frame_id: str = parameter("odom", "Frame of odometry")
    enable_odom_tf: bool = parameter(True, "Publish the frame of the trunk on tf")


def walker_of(robot: LeggedRobot, settings: WalkerSettings) -> Walker:
    """Make the walker.

    Raises RobomechError: the gait is for other robots, or keeps no such margin; limits of speed are
    missing.
    """
    linear = settings.max_linear_acceleration
    return Walker(
        robot,
        gait=settings.gait or None,
        period=1.0 / settings.update_rate,
        cycle=settings.cycle or None,
        lift=settings.lift,
        bound=None if math.isnan(settings.stability_bound) else settings.stability_bound,
        timeout=settings.cmd_vel_timeout,
        acceleration=(settings.max_angular_acceleration, linear, linear),
        speed=settings.joint_speed,
    )
