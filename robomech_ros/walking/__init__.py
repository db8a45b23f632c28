"""Walking machines: legs, static stability, gaits and a walker (book: section 10.4).

Each part is loaded on first use: the kernels are compiled.
"""

from typing import TYPE_CHECKING

from robomech_ros.lazy_import import lazy_exports

if TYPE_CHECKING:
    from robomech_ros.walking.gaits import GAITS, Gait
    from robomech_ros.walking.library import list_legged, load_legged
    from robomech_ros.walking.odometry import leg_odometry
    from robomech_ros.walking.pantograph import PantographLeg
    from robomech_ros.walking.robot import LeggedRobot
    from robomech_ros.walking.stride import TrunkPoseCheck
    from robomech_ros.walking.support import stability_margin, support_polygon
    from robomech_ros.walking.update import WalkUpdate
    from robomech_ros.walking.walker import Walker

__all__ = [
    "GAITS",
    "Gait",
    "LeggedRobot",
    "PantographLeg",
    "TrunkPoseCheck",
    "WalkUpdate",
    "Walker",
    "leg_odometry",
    "list_legged",
    "load_legged",
    "stability_margin",
    "support_polygon",
]

_MODULES = {
    "GAITS": "gaits",
    "Gait": "gaits",
    "LeggedRobot": "robot",
    "PantographLeg": "pantograph",
    "TrunkPoseCheck": "stride",
    "WalkUpdate": "update",
    "Walker": "walker",
    "leg_odometry": "odometry",
    "list_legged": "library",
    "load_legged": "library",
    "stability_margin": "support",
    "support_polygon": "support",
}

__getattr__ = lazy_exports(__name__, _MODULES, globals())
