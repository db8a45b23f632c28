"""Mechanisms with limits of the drives' rates, whatever their files say."""

import numpy as np

from robomech_ros.spatial import matrix_from_rotation_vector
from robomech_ros.trajectory import Limits

__all__ = ["OPTIONS", "moved", "rated"]

# Of `plan_drives`.
OPTIONS = {"wanted_period": 0.0, "usual_period": 0.01, "max_points": 10_000, "max_duration": 600.0}


def rated(mechanism, **others):
    """Limits of all joints: 1, 5 and 50 per s, s^2 and s^3 at the drives."""

    def at_drives(value):
        values = np.full(mechanism.n, np.inf)
        values[mechanism.drive_index] = value
        return values

    fields = {
        "velocity": at_drives(1.0),
        "acceleration": at_drives(5.0),
        "jerk": at_drives(50.0),
        "lower": mechanism.lower,
        "upper": mechanism.upper,
    }
    return Limits(mechanism.joint_names, **{**fields, **others}, units=mechanism.units)


def moved(T, turn=(0.0, 0.0, 0.0), way=(0.0, 0.0, 0.0)):
    """A pose turned about its own origin and moved (rad, m)."""
    there = T.copy()
    there[:3, :3] = T[:3, :3] @ matrix_from_rotation_vector(turn)
    there[:3, 3] += way
    return there
