"""Exceeded cone limits of passive joints of a mechanism, along a path of all joints."""

from __future__ import annotations

import numpy as np

from robomech_ros.cartesian import PathCheck
from robomech_ros.parallel.mechanism.model import Mechanism
from robomech_ros.trajectory import JointPath, PathCut, PathTrackingStatus
from robomech_ros.trajectory.paths.path_cuts import last_valid_coordinate
from robomech_ros.trajectory.tolerances import POSITION_SLACK
from robomech_ros.typing import Array

# How far outside its cone a joint may be at the places looked at (rad).
_SLACK = 1e-9
# How far beyond its last good place a path is looked at for the joint to blame, as its part.
_BEYOND = 1e-6


def cone_cut(mechanism: Mechanism) -> PathCheck:
    """End a joint path where a joint bends beyond its cone, which each joint's own limits enclose.

    A start that is outside by no more than the slack of a start may stay where it is.

    Parameters
    ----------
    mechanism : Mechanism
    """
    columns = (mechanism.bent[0][:, None] + [0, 1]).ravel()

    def check(joints: JointPath) -> PathCut | None:
        if not len(columns):
            return None
        first = mechanism.limit_excess(joints.derivatives(0.0)[0])[columns]
        allowed = np.where(first <= POSITION_SLACK, first, 0.0) + _SLACK

        def excess(q: Array) -> Array:
            return np.asarray(mechanism.limit_excess(q)[..., columns] - allowed)

        s = last_valid_coordinate(joints, lambda q: np.asarray((excess(q) > 0.0).any(axis=1)))
        if s is None:
            return None
        beyond = min(s + _BEYOND * joints.length, joints.length)
        joint = int(columns[np.argmax(excess(joints.derivatives(beyond)[0]))])
        text = f"joint '{mechanism.joint_names[joint]}' would leave its limits"
        return PathCut(s, PathTrackingStatus.LIMIT, text, joint)

    return check
