"""Angles modulo a turn."""

import math

from robomech_ros._kernels._jit import inline

__all__ = ["wrapped"]

_TURN = 2.0 * math.pi


@inline
def wrapped(angle):
    """Give the same angle in (-pi, pi], unchanged where it is there already."""
    if angle > math.pi or angle <= -math.pi:
        angle -= _TURN * math.ceil(angle / _TURN - 0.5)
        if angle <= -math.pi:
            angle = math.pi
    return angle
