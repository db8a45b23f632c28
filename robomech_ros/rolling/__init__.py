"""Rolling robots: wheels of all kinds, their base, odometry and limits (section 10.5)."""

from typing import TYPE_CHECKING

from robomech_ros.lazy_import import lazy_exports

if TYPE_CHECKING:
    from robomech_ros.rolling.base import RollingBase as RollingBase
    from robomech_ros.rolling.bodies import PlatformBody as PlatformBody, WheelBody as WheelBody
    from robomech_ros.rolling.conditioning import Isotropy as Isotropy, isotropy as isotropy
    from robomech_ros.rolling.constraints import Mobility as Mobility
    from robomech_ros.rolling.dynamics import RollingDynamics as RollingDynamics
    from robomech_ros.rolling.library import (
        RollingRobot as RollingRobot,
        list_rolling as list_rolling,
        load_rolling as load_rolling,
        rolling_robot as rolling_robot,
    )
    from robomech_ros.rolling.limiter import (
        BaseMotion as BaseMotion,
        CommandLimiter as CommandLimiter,
    )
    from robomech_ros.rolling.limits import MotionLimits as MotionLimits
    from robomech_ros.rolling.odometry import (
        Odometry as Odometry,
        OdometryNoise as OdometryNoise,
        advance_odometry as advance_odometry,
    )
    from robomech_ros.rolling.simulation import (
        RollingSimulation as RollingSimulation,
        simulate_rolling as simulate_rolling,
    )
    from robomech_ros.rolling.standard_bases import (
        ackermann as ackermann,
        differential_drive as differential_drive,
        mecanum as mecanum,
        omnidirectional as omnidirectional,
        swerve as swerve,
        tricycle as tricycle,
    )
    from robomech_ros.rolling.steering_motion import (
        SteeringMotion as SteeringMotion,
        steering_along as steering_along,
    )
    from robomech_ros.rolling.tree import (
        WheelJoints as WheelJoints,
        rolling_description as rolling_description,
    )
    from robomech_ros.rolling.wheels import Wheel as Wheel

__getattr__, __all__ = lazy_exports(__name__, globals())
