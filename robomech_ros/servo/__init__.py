"""Servo of an arm by twists or joint rates, within limits and past singularities."""

from typing import TYPE_CHECKING

from robomech_ros.lazy_import import lazy_exports

if TYPE_CHECKING:
    from robomech_ros.servo.commands import (
        JointCommand as JointCommand,
        PoseCommand as PoseCommand,
        TwistCommand as TwistCommand,
    )
    from robomech_ros.servo.report import (
        ServoCondition as ServoCondition,
        ServoReport as ServoReport,
    )
    from robomech_ros.servo.servo import Servo as Servo, ServoSettings as ServoSettings

__getattr__, __all__ = lazy_exports(__name__, globals())
