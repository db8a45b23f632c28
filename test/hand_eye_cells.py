"""Hand-eye samples with noise: what tests and benchmarks of calibrations share."""

from __future__ import annotations

import numpy as np

from robomech_ros import spatial

__all__ = ["KINDS", "noisy", "samples"]

KINDS = ("generic", "near half turns", "axes within 2 degrees")


def noisy(rng, poses, rotation, position):
    """Turn poses and move their origins by noise of these deviations of each coordinate."""
    out = poses.copy()
    turns = spatial.matrix_from_rotation_vector(rotation * rng.normal(size=(len(poses), 3)))
    out[:, :3, :3] = poses[:, :3, :3] @ turns
    out[:, :3, 3] += position * rng.normal(size=(len(poses), 3))
    return out


def _turns(rng, count, kind):
    if kind == "generic":
        axes, angles = rng.normal(size=(count, 3)), rng.uniform(0.3, 1.5, count)
    elif kind == "near half turns":
        axes, angles = rng.normal(size=(count, 3)), np.pi - rng.uniform(0.0, 0.02, count)
        angles[::2] *= 0.005
    else:
        tilt = np.radians(2.0) * rng.uniform(-1.0, 1.0, size=(count, 2))
        axes, angles = np.column_stack((tilt, np.ones(count))), rng.uniform(-1.5, 1.5, count)
    return axes / np.linalg.norm(axes, axis=1)[:, None] * angles[:, None]


def samples(rng, count, kind="generic", *, camera=(0.0, 0.0), robot=(0.0, 0.0), mount=None):
    """Robot poses, sensor poses, and the true poses of sensor and target."""
    X = spatial.pose_exponential(np.append(rng.normal(size=3), rng.uniform(-0.1, 0.1, 3)))
    Z = spatial.pose_exponential(np.append(rng.normal(size=3), rng.uniform(-1.0, 1.0, 3)))
    turns = spatial.matrix_from_rotation_vector(_turns(rng, count, kind))
    A = spatial.pose_from_matrix(turns, rng.uniform(-0.5, 0.5, (count, 3)))
    moved = spatial.inverse_pose(A) if mount == "eye-to-hand" else A
    S = spatial.inverse_pose(moved @ X) @ Z
    return noisy(rng, A, *robot), noisy(rng, S, *camera), X, Z
