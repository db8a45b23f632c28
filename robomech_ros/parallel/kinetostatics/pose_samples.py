"""Poses all over the workspace of a parallel robot, with drives that hold them."""

import numpy as np

from robomech_ros.kinematics.posture_samples import low_discrepancy_strides
from robomech_ros.parallel.argument_checks import pose_about_z
from robomech_ros.parallel.delta import Delta
from robomech_ros.parallel.kinetostatics.limb_geometry import leg_lengths
from robomech_ros.parallel.library import ParallelRobot
from robomech_ros.parallel.planar import Planar3RPR, Planar3RRR
from robomech_ros.parallel.spherical import Spherical3RRR
from robomech_ros.parallel.stewart_gough import StewartGough
from robomech_ros.spatial.poses import assembled
from robomech_ros.spatial.rotations.axis_angle import matrix_from_rotation_vector
from robomech_ros.typing import Array

# Most poses, and points of the cube for each, as many have legs outside their strokes.
_POSES, _TRIES = 2048, 64


def size_of(robot: ParallelRobot) -> float:
    """Return how far from the base's middle the platform's can be (m); its size without strokes."""
    if isinstance(robot, Delta):
        return robot.base_radius + robot.platform_radius + robot.arm + robot.forearm
    if isinstance(robot, Spherical3RRR):
        return 1.0
    points = (robot.base_points, robot.platform_points)
    spread = [float(np.linalg.norm(own - own.mean(axis=0), axis=1).max()) for own in points]
    if isinstance(robot, Planar3RRR):
        return float((robot.proximal + robot.distal).max()) + sum(spread)
    if robot.strokes is not None:
        return float(robot.strokes[:, 1].max()) + sum(spread)
    return 2.0 * max(spread)


def held_poses(robot: ParallelRobot) -> tuple[Array, Array]:
    """Spread 2,048 poses (k, 4, 4) at most evenly, always the same ones, with their drives (k, m).

    The poses are within strokes and cones, and the drives within limits.
    """
    if isinstance(robot, StewartGough | Planar3RPR):
        return _on_legs(robot)
    low, high = robot.limits.T
    cube = (0.5 + np.arange(_POSES)[:, None] * low_discrepancy_strides(3)) % 1.0
    poses, values = [], []
    for q in low + cube * (high - low):
        found = robot.direct(q).poses
        poses += list(found)
        values += [q] * len(found)
    kept = slice(0, _POSES)
    return np.array(poses[kept]).reshape(-1, 4, 4), np.array(values[kept]).reshape(-1, 3)


def _on_legs(robot: StewartGough | Planar3RPR) -> tuple[Array, Array]:
    planar = isinstance(robot, Planar3RPR)
    turns = 1 if planar else 3
    dimension = robot.base_points.shape[1] + turns
    strides = low_discrepancy_strides(dimension)
    cube = 2.0 * ((0.5 + np.arange(_POSES * _TRIES)[:, None] * strides) % 1.0) - 1.0
    centre = robot.base_points.mean(axis=0) + size_of(robot) * cube[:, turns:]
    if planar:
        T = pose_about_z(np.column_stack((centre, np.pi * cube[:, 0])))
    else:
        T = assembled(matrix_from_rotation_vector(np.pi * cube[:, :3]), centre)
    middle = robot.platform_points.mean(axis=0)
    n = len(middle)
    T[:, :n, 3] -= T[:, :n, :n] @ middle
    lengths = leg_lengths(robot, T)
    inside = (lengths > 0.0).all(axis=1)
    if robot.strokes is not None:
        low, high = robot.strokes.T
        inside &= ((lengths >= low) & (lengths <= high)).all(axis=1)
    if isinstance(robot, StewartGough):
        inside &= (robot.cone_margins(T) <= 0.0).all(axis=(1, 2))
    kept = np.flatnonzero(inside)[:_POSES]
    return T[kept], lengths[kept]
