"""Calibration of a sensor on the hand or beside the robot, and its hypotheses (section 2.7).

Poses are 4 x 4 matrices.  Each part is loaded on first use: the refinement is compiled.
"""

from typing import TYPE_CHECKING

from robomech_ros.lazy_import import lazy_exports

if TYPE_CHECKING:
    from robomech_ros.calibration.estimation import (
        MOUNTS as MOUNTS,
        hand_eye as hand_eye,
        robot_world as robot_world,
    )
    from robomech_ros.calibration.next_pose import (
        NextPose as NextPose,
        next_best_pose as next_best_pose,
    )
    from robomech_ros.calibration.redundant_sensing import (
        MotionAgreement as MotionAgreement,
        motion_agreement as motion_agreement,
    )
    from robomech_ros.calibration.relative import relative_hand_eye as relative_hand_eye
    from robomech_ros.calibration.result import (
        HandEyeNoise as HandEyeNoise,
        HandEyeResult as HandEyeResult,
    )

__getattr__, __all__ = lazy_exports(__name__, globals())
