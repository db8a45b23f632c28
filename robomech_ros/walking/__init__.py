"""Walking machines: legs, static stability, gaits and a walker (section 10.4)."""

from typing import TYPE_CHECKING

from robomech_ros.lazy_import import lazy_exports

if TYPE_CHECKING:
    from robomech_ros.walking.dynamics import (
        PlantedMotion as PlantedMotion,
        WalkingDynamics as WalkingDynamics,
    )
    from robomech_ros.walking.gait_loads import (
        GaitTorques as GaitTorques,
        gait_torques as gait_torques,
    )
    from robomech_ros.walking.gaits import GAITS as GAITS, Gait as Gait
    from robomech_ros.walking.ground_forces import (
        FootForces as FootForces,
        foot_forces as foot_forces,
    )
    from robomech_ros.walking.library import list_legged as list_legged, load_legged as load_legged
    from robomech_ros.walking.odometry import leg_odometry as leg_odometry
    from robomech_ros.walking.pantograph import PantographLeg as PantographLeg
    from robomech_ros.walking.robot import LeggedRobot as LeggedRobot
    from robomech_ros.walking.stride import TrunkPoseCheck as TrunkPoseCheck
    from robomech_ros.walking.support import (
        stability_margin as stability_margin,
        support_polygon as support_polygon,
    )
    from robomech_ros.walking.walker import Walker as Walker, WalkUpdate as WalkUpdate

__getattr__, __all__ = lazy_exports(__name__, globals())
