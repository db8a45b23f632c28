"""Kinematics of serial chains.

Each part is loaded on first use: compiled kernels take time and memory, and a planner, say, which
needs only poses, does without most of them.
"""

from typing import TYPE_CHECKING

from robomech_ros.lazy_import import lazy_exports

if TYPE_CHECKING:
    from robomech_ros.kinematics.forward import (
        forward_kinematics as forward_kinematics,
        link_poses as link_poses,
    )
    from robomech_ros.kinematics.forward_uncompiled import tip_poses as tip_poses
    from robomech_ros.kinematics.inverse.batch import (
        inverse_kinematics_batch as inverse_kinematics_batch,
    )
    from robomech_ros.kinematics.inverse.inverse_kinematics import (
        inverse_kinematics as inverse_kinematics,
    )
    from robomech_ros.kinematics.inverse.optimal_posture import optimal_posture as optimal_posture
    from robomech_ros.kinematics.inverse.redundant_arms.self_motion import (
        SelfMotion as SelfMotion,
        SelfMotionBranch as SelfMotionBranch,
        self_motion as self_motion,
    )
    from robomech_ros.kinematics.inverse.result.result import (
        InverseKinematicsResult as InverseKinematicsResult,
    )
    from robomech_ros.kinematics.inverse.result.status import Status as Status
    from robomech_ros.kinematics.joint_jumps import Jump as Jump
    from robomech_ros.kinematics.path_branches import (
        BranchPath as BranchPath,
        branch_path as branch_path,
    )

__getattr__, __all__ = lazy_exports(__name__, globals())
