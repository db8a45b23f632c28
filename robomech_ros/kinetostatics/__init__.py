"""Kinetostatics of serial chains."""

from robomech_ros.kinetostatics.jacobian import jacobian
from robomech_ros.kinetostatics.point_jacobian import point_jacobian

__all__ = ["jacobian", "point_jacobian"]
