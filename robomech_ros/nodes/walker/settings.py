"""Parameters of the walker."""

from __future__ import annotations

import math
from dataclasses import dataclass

from robomech_ros.nodes.common.parameters import parameter
from robomech_ros.walking import GAITS, LeggedRobot, Walker


@dataclass(frozen=True)
class WalkerSettings:
    """Parameters of the node."""

    robot_description: str = parameter(
        "", "Name of a walking machine, such as phantomx, or path or text of its YAML"
    )
    frame_prefix: str = parameter(
        "",
        "What the names of this robot's frames begin with in headers and on /tf, such as left/, "
        "odom_frame_id included",
    )
    gait: str = parameter(
        "",
        "How it walks to begin with; empty = tripod, or crawl on four legs",
        choices=("", *GAITS),
    )
    update_rate: float = parameter(
        100.0,
        "How often feet and joints are computed: points of the trajectory",
        20.0,
        1000.0,
        "Hz",
    )
    publish_rate: float = parameter(
        50.0, "How often trajectory, odometry and contacts are published", 1.0, 1000.0, "Hz"
    )
    lead: float = parameter(
        0.2,
        "How far the walk is ahead of its time: a message to the controller may be this late "
        "without disturbing the walk; commands take effect that much later",
        0.1,
        1.0,
        "s",
    )
    cmd_vel_timeout: float = parameter(
        0.5,
        "How long a command counts; then the robot stops, all feet down",
        0.01,
        3600.0,
        "s",
    )
    cycle: float = parameter(
        0.0,
        "Duration of a cycle of the gait; 0 = as suits robot and gait: joints keep below 60 % of "
        "their speed limits at the longest stride",
        0.0,
        60.0,
        "s",
    )
    lift: float = parameter(0.03, "How high feet are lifted", 1e-4, 10.0, "m")
    stability_bound: float = parameter(
        math.nan,
        "Stability margin that is kept; NaN = 0.01, and of the trot, which stands on lines, -0.04",
        -10.0,
        10.0,
        "m",
    )
    max_linear_acceleration: float = parameter(
        0.5, "Of the walk, forward and sideways", 1e-3, 1e3, "m/s^2"
    )
    max_angular_acceleration: float = parameter(
        1.0, "Of the walk, about the vertical", 1e-3, 1e3, "rad/s^2"
    )
    joint_speed: float = parameter(
        0.95,
        "Part of the joints' speed limits that is used; the controller goes a little faster "
        "between two points",
        0.01,
        1.0,
    )
    body_pose_duration: float = parameter(
        1.0,
        "Time in which the trunk goes to a new body_pose; longer where its acceleration would tip "
        "the robot",
        0.01,
        3600.0,
        "s",
    )
    command_out_topic: str = parameter(
        "joint_trajectory_controller/joint_trajectory",
        "Where the controller listens (trajectory_msgs/JointTrajectory)",
    )
    tracking_tolerance: float = parameter(
        0.1,
        "How far a joint may be from its commands of the last tracking_delay, rad or m, before "
        "the robot is let go; 0 = any distance",
        0.0,
        10.0,
    )
    tracking_delay: float = parameter(
        0.2,
        "How far the joints may lag behind their commands; the robot is also let go when joint "
        "states stay away for longer than that and 0.5 s",
        0.0,
        5.0,
        "s",
    )
    rising_speed: float = parameter(
        0.2,
        "Part of the joints' speed limits with which a robot that does not stand rises at the "
        "first command",
        0.01,
        1.0,
    )
    foot_slip: float = parameter(
        1e-4,
        "Covariance of odometry: variance of the way of a standing foot for each metre that the "
        "trunk goes",
        0.0,
        1.0,
        "m^2/m",
    )
    odom_frame_id: str = parameter("odom", "Frame of odometry")
    enable_odom_tf: bool = parameter(True, "Publish the frame of the trunk on tf")


def walker_of(robot: LeggedRobot, settings: WalkerSettings) -> Walker:
    """Make the walker.

    Raises
    ------
    RobomechError
        The gait is for other robots, or keeps no such margin; limits of speed are missing.
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
