"""Calibration of a sensor on the hand or beside the robot, and its hypotheses (section 2.7).

Poses are 4 x 4 matrices.  Each part is loaded on first use: the refinement is compiled.
"""

from typing import TYPE_CHECKING

from robomech_ros.lazy_import import lazy_exports

if TYPE_CHECKING:
    from robomech_ros.calibration.estimation import MOUNTS, hand_eye, robot_world
    from robomech_ros.calibration.next_pose import NextPose, next_best_pose
    from robomech_ros.calibration.redundant_sensing import MotionAgreement, motion_agreement
    from robomech_ros.calibration.relative import relative_hand_eye
    from robomech_ros.calibration.result import HandEyeNoise, HandEyeResult

__all__ = [
    "MOUNTS",
    "HandEyeNoise",
    "HandEyeResult",
    "MotionAgreement",
    "NextPose",
    "hand_eye",
    "motion_agreement",
    "next_best_pose",
    "relative_hand_eye",
    "robot_world",
]

_MODULES = {
    "MOUNTS": "estimation",
    "HandEyeNoise": "result",
    "HandEyeResult": "result",
    "MotionAgreement": "redundant_sensing",
    "NextPose": "next_pose",
    "hand_eye": "estimation",
    "motion_agreement": "redundant_sensing",
    "next_best_pose": "next_pose",
    "relative_hand_eye": "relative",
    "robot_world": "estimation",
}

__getattr__ = lazy_exports(__name__, _MODULES, globals())
