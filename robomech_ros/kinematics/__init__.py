"""Kinematics of serial chains.

Each part is loaded when first asked for: compiled kernels take memory and time to load, and who
needs poses only, such as a planner, does without most of them or all.
"""

from typing import TYPE_CHECKING

from robomech_ros.lazy import lazy_exports

if TYPE_CHECKING:
    from robomech_ros.kinematics.forward import forward_kinematics, link_poses
    from robomech_ros.kinematics.inverse import inverse_kinematics, inverse_kinematics_batch
    from robomech_ros.kinematics.optimal import optimal_posture
    from robomech_ros.kinematics.redundancy import SelfMotion, SelfMotionBranch, self_motion
    from robomech_ros.kinematics.result import InverseKinematicsResult
    from robomech_ros.kinematics.status import Status
    from robomech_ros.kinematics.tracking import Jump, TrackResult, track
    from robomech_ros.kinematics.uncompiled import tip_poses

__all__ = [
    "InverseKinematicsResult",
    "Jump",
    "SelfMotion",
    "SelfMotionBranch",
    "Status",
    "TrackResult",
    "forward_kinematics",
    "inverse_kinematics",
    "inverse_kinematics_batch",
    "link_poses",
    "optimal_posture",
    "self_motion",
    "tip_poses",
    "track",
]

_MODULES = {
    "InverseKinematicsResult": "result",
    "Jump": "tracking",
    "SelfMotion": "redundancy",
    "SelfMotionBranch": "redundancy",
    "Status": "status",
    "forward_kinematics": "forward",
    "inverse_kinematics": "inverse",
    "inverse_kinematics_batch": "inverse",
    "link_poses": "forward",
    "optimal_posture": "optimal",
    "self_motion": "redundancy",
    "TrackResult": "tracking",
    "tip_poses": "uncompiled",
    "track": "tracking",
}

__getattr__ = lazy_exports(__name__, _MODULES, globals())
