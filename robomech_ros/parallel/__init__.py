"""Parallel robots: poses of the platform from the drives, and back (book: section 10.2).

Each part is loaded on first use: the solvers are compiled.
"""

from typing import TYPE_CHECKING

from robomech_ros.lazy import lazy_exports

if TYPE_CHECKING:
    from robomech_ros.parallel.delta import Delta
    from robomech_ros.parallel.library import ParallelRobot, list_parallel, load_parallel
    from robomech_ros.parallel.mechanism.limb import Limb
    from robomech_ros.parallel.mechanism.model import Mechanism
    from robomech_ros.parallel.mechanism.result import (
        AssemblyModes,
        ClosedPosture,
        MechanismPostures,
    )
    from robomech_ros.parallel.planar import Planar3RPR, Planar3RRR
    from robomech_ros.parallel.result import DirectKinematicsResult, FollowedPose, LimbPostures
    from robomech_ros.parallel.spherical import Spherical3RRR
    from robomech_ros.parallel.stewart_gough import StewartGough

__all__ = [
    "AssemblyModes",
    "ClosedPosture",
    "Delta",
    "DirectKinematicsResult",
    "FollowedPose",
    "Limb",
    "LimbPostures",
    "Mechanism",
    "MechanismPostures",
    "ParallelRobot",
    "Planar3RPR",
    "Planar3RRR",
    "Spherical3RRR",
    "StewartGough",
    "list_parallel",
    "load_parallel",
]

_MODULES = {
    "AssemblyModes": "mechanism.result",
    "ClosedPosture": "mechanism.result",
    "Delta": "delta",
    "DirectKinematicsResult": "result",
    "FollowedPose": "result",
    "Limb": "mechanism.limb",
    "LimbPostures": "result",
    "Mechanism": "mechanism.model",
    "MechanismPostures": "mechanism.result",
    "ParallelRobot": "library",
    "Planar3RPR": "planar",
    "Planar3RRR": "planar",
    "Spherical3RRR": "spherical",
    "StewartGough": "stewart_gough",
    "list_parallel": "library",
    "load_parallel": "library",
}

__getattr__ = lazy_exports(__name__, _MODULES, globals())
