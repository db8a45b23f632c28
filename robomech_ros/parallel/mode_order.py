"""Poses in the order of their distance from a seed."""

import dataclasses

import numpy as np

from robomech_ros.outcomes import Code
from robomech_ros.parallel.result import DirectKinematicsResult
from robomech_ros.spatial.rotations.axis_angle import rotation_vector_from_matrix
from robomech_ros.typing import Array, IntArray


def nearest_first(
    found: DirectKinematicsResult, seed: Array, size: float
) -> DirectKinematicsResult:
    """Order poses by distance from a seed (4, 4), angles multiplied by the size (m)."""
    order = nearest_order(found.poses, seed, size)
    sorted_rows = {key: vars(found)[key][order] for key in ("poses", "multiplicity", "errors")}
    return dataclasses.replace(found, **sorted_rows)


def nearest_order(poses: Array, seed: Array, size: float) -> IntArray:
    """Sort poses (k, 4, 4) by distance from a seed (4, 4), angles multiplied by the size (m)."""
    turns = rotation_vector_from_matrix(seed[:3, :3].T @ poses[:, :3, :3])
    angles = np.linalg.norm(turns.reshape(-1, 3), axis=1)
    shifts = np.linalg.norm(poses[:, :3, 3] - seed[:3, 3], axis=1)
    return np.argsort(np.hypot(shifts, size * angles), kind="stable")


def modes_found(
    poses: Array, multiplicity: IntArray, errors: Array, count: int, family: str
) -> DirectKinematicsResult:
    """Say what a closed form has found: so many poses, or -1 where the platform can move."""
    if count < 0:
        empty = np.empty((0, 4, 4)), np.empty(0, np.int64)
        reason = "the platform can move while its drives are locked"
        return DirectKinematicsResult(*empty, False, family, Code.SINGULAR_CONTINUUM, reason)
    status, reason = Code.NONE, ""
    if count == 0:
        status, reason = Code.OUT_OF_REACH, "no real pose"
    elif multiplicity[:count].max() > 1:
        reason = "one pose or more are singular: assembly modes meet there"
    return DirectKinematicsResult(
        poses, multiplicity[:count].copy(), True, family, status, reason, errors[:count].copy()
    )
