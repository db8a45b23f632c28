"""Kinematics of serial chains.

Each part is loaded on first use: compiled kernels take time and memory, and a planner, say, which
needs only poses, does without most of them.
"""

from typing import TYPE_CHECKING

from robomech_ros.lazy_import import lazy_exports

if TYPE_CHECKING:
    from robomech_ros.kinematics.forward import forward_kinematics, link_poses
    from robomech_ros.kinematics.forward_uncompiled import tip_poses
    from robomech_ros.kinematics.inverse.batch import inverse_kinematics_batch
    from robomech_ros.kinematics.inverse.inverse_kinematics import inverse_kinematics
    from robomech_ros.kinematics.inverse.optimal_posture import optimal_posture
    from robomech_ros.kinematics.inverse.result import InverseKinematicsResult
    from robomech_ros.kinematics.inverse.self_motion import (
        SelfMotion,
        SelfMotionBranch,
        self_motion,
    )
    from robomech_ros.kinematics.inverse.status import Status
    from robomech_ros.kinematics.joint_jumps import Jump
    from robomech_ros.kinematics.path_branches import BranchPath, branch_path

__all__ = [
    "BranchPath",
    "InverseKinematicsResult",
    "Jump",
    "SelfMotion",
    "SelfMotionBranch",
    "Status",
    "branch_path",
    "forward_kinematics",
    "inverse_kinematics",
    "inverse_kinematics_batch",
    "link_poses",
    "optimal_posture",
    "self_motion",
    "tip_poses",
]

_MODULES = {
    "InverseKinematicsResult": "inverse.result",
    "Jump": "joint_jumps",
    "SelfMotion": "inverse.self_motion",
    "SelfMotionBranch": "inverse.self_motion",
    "Status": "inverse.status",
    "forward_kinematics": "forward",
    "inverse_kinematics": "inverse.inverse_kinematics",
    "inverse_kinematics_batch": "inverse.batch",
    "link_poses": "forward",
    "optimal_posture": "inverse.optimal_posture",
    "self_motion": "inverse.self_motion",
    "tip_poses": "forward_uncompiled",
    "branch_path": "path_branches",
    "BranchPath": "path_branches",
}

__getattr__ = lazy_exports(__name__, _MODULES, globals())
