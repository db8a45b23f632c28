"""Rolling robots: wheels of all kinds, their base, odometry and limits (book: section 10.5).

Each part is loaded on first use.
"""

from typing import TYPE_CHECKING

from robomech_ros.lazy import lazy_exports

if TYPE_CHECKING:
    from robomech_ros.rolling.base import RollingBase
    from robomech_ros.rolling.bodies import PlatformBody, WheelBody
    from robomech_ros.rolling.constraints import Mobility
    from robomech_ros.rolling.evenness import Isotropy, isotropy
    from robomech_ros.rolling.joints import WheelJoints
    from robomech_ros.rolling.library import RollingRobot, list_rolling, load_rolling, rolling_robot
    from robomech_ros.rolling.limiter import BaseMotion, CommandLimiter
    from robomech_ros.rolling.limits import MotionLimits
    from robomech_ros.rolling.moving import RollingDynamics
    from robomech_ros.rolling.named import (
        ackermann,
        mecanum,
        omnidirectional,
        swerve,
        tricycle,
        two_wheeled,
    )
    from robomech_ros.rolling.odometry import Odometry, OdometryNoise, advance_odometry
    from robomech_ros.rolling.runs import RollingRun, simulate_rolling
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
    "RollingRun",
    "Wheel",
    "WheelBody",
    "WheelJoints",
    "ackermann",
    "advance_odometry",
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
    "two_wheeled",
]

_MODULES = {
    "BaseMotion": "limiter",
    "CommandLimiter": "limiter",
    "Isotropy": "evenness",
    "Mobility": "constraints",
    "MotionLimits": "limits",
    "Odometry": "odometry",
    "OdometryNoise": "odometry",
    "PlatformBody": "bodies",
    "RollingBase": "base",
    "RollingDynamics": "moving",
    "RollingRobot": "library",
    "RollingRun": "runs",
    "Wheel": "wheels",
    "WheelBody": "bodies",
    "WheelJoints": "joints",
    "ackermann": "named",
    "advance_odometry": "odometry",
    "isotropy": "evenness",
    "list_rolling": "library",
    "load_rolling": "library",
    "mecanum": "named",
    "omnidirectional": "named",
    "rolling_robot": "library",
    "simulate_rolling": "runs",
    "swerve": "named",
    "tricycle": "named",
    "rolling_description": "tree",
    "two_wheeled": "named",
}

__getattr__ = lazy_exports(__name__, _MODULES, globals())
