"""Ends of joint paths at a singular posture: which part of the arm it is, and where to stop."""

import numpy as np

from robomech_ros.cartesian.path_models import PathModel
from robomech_ros.numerics.nonlinear import bisected
from robomech_ros.trajectory import JointPath, Limits, PathCut, PathTracking, PathTrackingStatus
from robomech_ros.trajectory.paths.path_cuts import PLACES
from robomech_ros.typing import Array

# Below this speed along the path (m/s) the way to a dead end is pointless: it takes minutes for
# less than a tenth of a millimetre.  Of an arm that is slow everywhere, this part of its fastest.
SLOWEST, _PART_OF_FASTEST = 0.01, 0.05
# Halvings until the place of a speed is found.
_HALVINGS = 50
_BY_ITSELF = (PathTrackingStatus.LOST, PathTrackingStatus.JUMP, PathTrackingStatus.SINGULAR)


def dead_end(tracking: PathTracking, robot: PathModel, limits: Limits) -> PathCut | None:
    """End a path that cannot go on beyond a singular posture before it is pointlessly slow.

    Returns where to end, with the part of the robot in words; None where the path is complete, does
    not begin, or ends at a joint limit.
    """
    joints = tracking.path
    if joints is None or tracking.status not in _BY_ITSELF:
        return None
    places = np.linspace(0.0, joints.length, PLACES + 1)
    speeds = _speeds(joints, places, limits)
    slowest = min(SLOWEST, _PART_OF_FASTEST * float(speeds.max()))

    def is_fast(s: float) -> bool:
        return bool(_speeds(joints, np.array([s]), limits)[0] >= slowest)

    fast, s, left_out = np.flatnonzero(speeds >= slowest), joints.length, ""
    if len(fast) and fast[-1] < PLACES:
        s = float(bisected(places[fast[-1]], s, is_fast, _HALVINGS)[0])
    if s < joints.length:
        left_out = (
            f"; the last {joints.length - s:.2g} m, on which the joints allow less than "
            f"{slowest:.2g} m/s, are left out"
        )
    text = _beyond(tracking, robot.limits, robot.singular_part(joints)) + left_out
    return PathCut(s, tracking.status, text, tracking.joint)


def _beyond(tracking: PathTracking, limits: Limits, part: str) -> str:
    """Say what is beyond the end of a path."""
    because = f"{part}: " if part else ""
    if tracking.status is PathTrackingStatus.LOST:
        beyond = "out of reach beyond" if part else "the arm has no posture beyond"
        return because + beyond
    if tracking.joint is None:
        return f"{because}the joint values change too fast, too near to a singularity"
    name, unit = limits.joint_names[tracking.joint], limits.units[tracking.joint]
    jump = f"joint '{name}' would have to jump by {tracking.move:.3g} {unit}"
    return f"{because}out of reach beyond on this branch; to reach it, {jump}" if part else jump


def _speeds(joints: JointPath, places: Array, limits: Limits) -> Array:
    """Return the speeds along a path (m/s) that joint velocities allow at places (m)."""
    rates = np.abs(joints.derivatives(places)[1])
    with np.errstate(divide="ignore"):
        fastest: Array = np.min(limits.velocity / rates, axis=-1)
    return fastest
