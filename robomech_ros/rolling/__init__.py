"""Rolling robots: wheels of all kinds, their base, odometry and limits (book: section 10.5).

Each part is loaded on first use.
"""

from typing import TYPE_CHECKING

from robomech_ros.lazy_import import lazy_exports

if TYPE_CHECKING:
    from robomech_ros.rolling.base import RollingBase
    from robomech_ros.rolling.bodies import PlatformBody, WheelBody
    from robomech_ros.rolling.conditioning import Isotropy, isotropy
    from robomech_ros.rolling.constraints import Mobility
    from robomech_ros.rolling.dynamics import RollingDynamics
    from robomech_ros.rolling.joints import WheelJoints
    from robomech_ros.rolling.library import RollingRobot, list_rolling, load_rolling, rolling_robot
    from robomech_ros.rolling.limiter import BaseMotion, CommandLimiter
    from robomech_ros.rolling.limits import MotionLimits
    from robomech_ros.rolling.odometry import Odometry, OdometryNoise, advance_odometry
    from robomech_ros.rolling.simulation import RollingSimulation, simulate_rolling
    from robomech_ros.rolling.standard_bases import (
        ackermann,
        differential_drive,
        mecanum,
        omnidirectional,
        swerve,
        tricycle,
    )
    from robomech_ros.rolling.tree import rolling_description
    from robomech_ros.rolling.wheels import Wheel

__all__ = [
    "BaseMotion",
    "CommandLimiter",
    "Isotropy",
    "Mobility",
    "MotionLimits",
    "Odometry",
    "OdometryNoise",
    "PlatformBody",
    "RollingBase",
    "RollingDynamics",
    "RollingRobot",
    "RollingSimulation",
    "Wheel",
    "WheelBody",
    "WheelJoints",
    "ackermann",
    "advance_odometry",
    "differential_drive",
    "isotropy",
    "list_rolling",
    "load_rolling",
    "mecanum",
    "omnidirectional",
    "rolling_description",
    "rolling_robot",
    "simulate_rolling",
    "swerve",
    "tricycle",
]

_MODULES = {
    "BaseMotion": "limiter",
    "CommandLimiter": "limiter",
    "Isotropy": "conditioning",
    "Mobility": "constraints",
    "MotionLimits": "limits",
    "Odometry": "odometry",
    "OdometryNoise": "odometry",
    "PlatformBody": "bodies",
    "RollingBase": "base",
    "RollingDynamics": "dynamics",
    "RollingRobot": "library",
    "RollingSimulation": "simulation",
    "Wheel": "wheels",
    "WheelBody": "bodies",
    "WheelJoints": "joints",
    "ackermann": "standard_bases",
    "advance_odometry": "odometry",
    "isotropy": "conditioning",
    "list_rolling": "library",
    "load_rolling": "library",
    "mecanum": "standard_bases",
    "omnidirectional": "standard_bases",
    "rolling_robot": "library",
    "simulate_rolling": "simulation",
    "swerve": "standard_bases",
    "tricycle": "standard_bases",
    "rolling_description": "tree",
    "differential_drive": "standard_bases",
}

__getattr__ = lazy_exports(__name__, _MODULES, globals())
