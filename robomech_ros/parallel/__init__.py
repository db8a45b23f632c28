"""Parallel robots: poses of the platform from the drives, and back (book: section 10.2).

Each part is loaded on first use: the solvers are compiled.
"""

from typing import TYPE_CHECKING

from robomech_ros.lazy_import import lazy_exports

if TYPE_CHECKING:
    from robomech_ros.parallel.delta import Delta as Delta
    from robomech_ros.parallel.dynamics.complement import JointReactions as JointReactions
    from robomech_ros.parallel.dynamics.parallel_dynamics import (
        ParallelDynamics as ParallelDynamics,
    )
    from robomech_ros.parallel.files import list_parallel as list_parallel
    from robomech_ros.parallel.kinetostatics.conditioning import (
        dexterity as dexterity,
        platform_length as platform_length,
        singularity_distances as singularity_distances,
    )
    from robomech_ros.parallel.kinetostatics.pose_limits import (
        PoseLimits as PoseLimits,
        pose_limits as pose_limits,
    )
    from robomech_ros.parallel.kinetostatics.singularities import (
        LoopSingularity as LoopSingularity,
        loop_singularity as loop_singularity,
    )
    from robomech_ros.parallel.kinetostatics.statics import (
        drive_forces as drive_forces,
        platform_wrench as platform_wrench,
    )
    from robomech_ros.parallel.kinetostatics.velocity_maps import (
        VelocityMatrices as VelocityMatrices,
        drive_accelerations as drive_accelerations,
        drive_rates as drive_rates,
        platform_acceleration as platform_acceleration,
        platform_twist as platform_twist,
        velocity_matrices as velocity_matrices,
        velocity_matrix_rates as velocity_matrix_rates,
    )
    from robomech_ros.parallel.kinetostatics.workspace import (
        PlatformWorkspace as PlatformWorkspace,
        platform_orientation_workspace as platform_orientation_workspace,
        platform_position_workspace as platform_position_workspace,
    )
    from robomech_ros.parallel.library import (
        ParallelRobot as ParallelRobot,
        load_parallel as load_parallel,
    )
    from robomech_ros.parallel.mechanism.limb import Limb as Limb
    from robomech_ros.parallel.mechanism.model import Mechanism as Mechanism
    from robomech_ros.parallel.mechanism.parts import LinkBodies as LinkBodies
    from robomech_ros.parallel.motion.drive_paths import (
        DrivePath as DrivePath,
        follow_drives as follow_drives,
    )
    from robomech_ros.parallel.motion.path_model import MechanismPathModel as MechanismPathModel
    from robomech_ros.parallel.motion.planning import (
        DrivePlan as DrivePlan,
        plan_drives as plan_drives,
        plan_platform as plan_platform,
    )
    from robomech_ros.parallel.planar import Planar3RPR as Planar3RPR, Planar3RRR as Planar3RRR
    from robomech_ros.parallel.result import (
        AssemblyModes as AssemblyModes,
        DirectKinematicsResult as DirectKinematicsResult,
        FollowedPose as FollowedPose,
        LimbPostures as LimbPostures,
        LoopClosure as LoopClosure,
        MechanismPostures as MechanismPostures,
    )
    from robomech_ros.parallel.spherical import Spherical3RRR as Spherical3RRR
    from robomech_ros.parallel.stewart_gough import StewartGough as StewartGough
    from robomech_ros.parallel.tree_description import (
        DescribedRobot as DescribedRobot,
        load_tree_description as load_tree_description,
    )

__getattr__, __all__ = lazy_exports(__name__, globals())
