"""Parallel robots: poses of the platform from the drives, and back (book: section 10.2).

Each part is loaded on first use: the solvers are compiled.
"""

from typing import TYPE_CHECKING

from robomech_ros.lazy_import import lazy_exports

if TYPE_CHECKING:
    from robomech_ros.parallel.delta import Delta
    from robomech_ros.parallel.dynamics.complement import JointReactions
    from robomech_ros.parallel.dynamics.parallel_dynamics import ParallelDynamics
    from robomech_ros.parallel.files import list_parallel
    from robomech_ros.parallel.kinetostatics.conditioning import (
        dexterity,
        platform_length,
        singularity_distances,
    )
    from robomech_ros.parallel.kinetostatics.pose_limits import PoseLimits, pose_limits
    from robomech_ros.parallel.kinetostatics.singularities import LoopSingularity, loop_singularity
    from robomech_ros.parallel.kinetostatics.statics import drive_forces, platform_wrench
    from robomech_ros.parallel.kinetostatics.velocity_maps import (
        VelocityMatrices,
        drive_accelerations,
        drive_rates,
        platform_acceleration,
        platform_twist,
        velocity_matrices,
        velocity_matrix_rates,
    )
    from robomech_ros.parallel.kinetostatics.workspace import (
        PlatformWorkspace,
        platform_orientation_workspace,
        platform_position_workspace,
    )
    from robomech_ros.parallel.library import ParallelRobot, load_parallel
    from robomech_ros.parallel.mechanism.limb import Limb
    from robomech_ros.parallel.mechanism.model import Mechanism
    from robomech_ros.parallel.mechanism.parts import LinkBodies
    from robomech_ros.parallel.mechanism.result import (
        AssemblyModes,
        LoopClosure,
        MechanismPostures,
    )
    from robomech_ros.parallel.motion.drive_paths import DrivePath, follow_drives
    from robomech_ros.parallel.motion.path_model import MechanismPathModel
    from robomech_ros.parallel.motion.planning import DrivePlan, plan_drives, plan_platform
    from robomech_ros.parallel.planar import Planar3RPR, Planar3RRR
    from robomech_ros.parallel.result import DirectKinematicsResult, FollowedPose, LimbPostures
    from robomech_ros.parallel.spherical import Spherical3RRR
    from robomech_ros.parallel.stewart_gough import StewartGough
    from robomech_ros.parallel.tree_description import DescribedRobot, load_tree_description

__all__ = [
    "AssemblyModes",
    "Delta",
    "DescribedRobot",
    "DirectKinematicsResult",
    "DrivePath",
    "DrivePlan",
    "FollowedPose",
    "JointReactions",
    "Limb",
    "LimbPostures",
    "LinkBodies",
    "LoopClosure",
    "LoopSingularity",
    "Mechanism",
    "MechanismPathModel",
    "MechanismPostures",
    "ParallelDynamics",
    "ParallelRobot",
    "Planar3RPR",
    "Planar3RRR",
    "PlatformWorkspace",
    "PoseLimits",
    "Spherical3RRR",
    "StewartGough",
    "VelocityMatrices",
    "dexterity",
    "drive_accelerations",
    "drive_forces",
    "drive_rates",
    "follow_drives",
    "list_parallel",
    "load_parallel",
    "load_tree_description",
    "loop_singularity",
    "plan_drives",
    "plan_platform",
    "platform_acceleration",
    "platform_length",
    "platform_orientation_workspace",
    "platform_position_workspace",
    "platform_twist",
    "platform_wrench",
    "pose_limits",
    "singularity_distances",
    "velocity_matrices",
    "velocity_matrix_rates",
]

_MODULES = {
    "PoseLimits": "kinetostatics.pose_limits",
    "pose_limits": "kinetostatics.pose_limits",
    "PlatformWorkspace": "kinetostatics.workspace",
    "platform_orientation_workspace": "kinetostatics.workspace",
    "platform_position_workspace": "kinetostatics.workspace",
    "AssemblyModes": "mechanism.result",
    "LoopClosure": "mechanism.result",
    "VelocityMatrices": "kinetostatics.velocity_maps",
    "velocity_matrices": "kinetostatics.velocity_maps",
    "velocity_matrix_rates": "kinetostatics.velocity_maps",
    "drive_rates": "kinetostatics.velocity_maps",
    "platform_twist": "kinetostatics.velocity_maps",
    "drive_accelerations": "kinetostatics.velocity_maps",
    "platform_acceleration": "kinetostatics.velocity_maps",
    "drive_forces": "kinetostatics.statics",
    "platform_wrench": "kinetostatics.statics",
    "platform_length": "kinetostatics.conditioning",
    "singularity_distances": "kinetostatics.conditioning",
    "dexterity": "kinetostatics.conditioning",
    "LoopSingularity": "kinetostatics.singularities",
    "loop_singularity": "kinetostatics.singularities",
    "Delta": "delta",
    "DescribedRobot": "tree_description",
    "DirectKinematicsResult": "result",
    "DrivePath": "motion.drive_paths",
    "DrivePlan": "motion.planning",
    "FollowedPose": "result",
    "JointReactions": "dynamics.complement",
    "Limb": "mechanism.limb",
    "LimbPostures": "result",
    "Mechanism": "mechanism.model",
    "MechanismPostures": "mechanism.result",
    "MechanismPathModel": "motion.path_model",
    "ParallelDynamics": "dynamics.parallel_dynamics",
    "ParallelRobot": "library",
    "LinkBodies": "mechanism.parts",
    "Planar3RPR": "planar",
    "Planar3RRR": "planar",
    "Spherical3RRR": "spherical",
    "StewartGough": "stewart_gough",
    "follow_drives": "motion.drive_paths",
    "list_parallel": "files",
    "load_tree_description": "tree_description",
    "load_parallel": "library",
    "plan_drives": "motion.planning",
    "plan_platform": "motion.planning",
}

__getattr__ = lazy_exports(__name__, _MODULES, globals())
