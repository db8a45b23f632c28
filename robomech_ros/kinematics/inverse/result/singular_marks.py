"""Singular postures of arms that are searched: the edge of what can be reached, or a continuum."""

from collections.abc import Sequence

import numpy as np

from robomech_ros._kernels.chain.serial import jacobian_one
from robomech_ros._kernels.inverse import branch_bits as bit
from robomech_ros._kernels.tolerances import ACCEPTED, CONTINUUM_STEP
from robomech_ros.kinematics.mobility import arm_size
from robomech_ros.robots.chain import SerialChain
from robomech_ros.typing import Array, IntArray

# Ratio of singular values below which a posture has lost a direction: where two solutions have
# become one, both are found to about the root of what a pose is accepted with.
LOST = 1e-4
# Corrections after a step away from it: each squares the error, where the arm can go there at all.
_CORRECTIONS = 8


def singular_marks(chain: SerialChain, T: Array, task: Sequence[bool], q: Array) -> IntArray:
    """Tell of postures q (k, n) if joints can move while the task stays, or two solutions meet.

    All reach the pose T (4, 4) of the tip (m), as far as the task counts: which of x, y, z, rx, ry,
    rz, along and about the axes of T. Returns bits of ``branch_bits`` (k,): SELF_MOTION for a
    continuum, BOUNDARY where solutions meet, 0 for a regular posture, and for all of an arm with
    more joints than conditions.
    """
    marks = np.zeros(len(q), np.int64)
    if 0 < chain.n <= sum(task):
        for k, posture in enumerate(q):
            marks[k] = _mark(chain, T, task, posture)
    return marks


def _mark(chain: SerialChain, T: Array, task: Sequence[bool], q: Array) -> int:
    J, _ = task_jacobian(chain, T, task, q)
    _, values, rows = np.linalg.svd(J)
    if values[-1] > LOST * values[0]:
        return 0
    step = CONTINUUM_STEP * rows[-1] / np.abs(rows[-1]).max()
    moved = q + step
    for _ in range(_CORRECTIONS):
        J, error = task_jacobian(chain, T, task, moved)
        moved = moved - np.linalg.lstsq(J, error, rcond=LOST)[0]
    _, error = task_jacobian(chain, T, task, moved)
    stays_away = np.abs(moved - q).max() > 0.5 * CONTINUUM_STEP
    return bit.SELF_MOTION if stays_away and np.abs(error).max() < ACCEPTED else bit.BOUNDARY


def task_jacobian(
    chain: SerialChain, T: Array, task: Sequence[bool], q: Array
) -> tuple[Array, Array]:
    """Return derivative and error of what counts, along the axes of T; lengths over the arm's size.

    Rows are those of x, y, z, rx, ry, rz that the task counts.
    """
    size, counts = arm_size(chain), np.array(task)
    J, pose = np.empty((6, chain.n)), np.empty((4, 4))
    jacobian_one(chain.packed, q, J, pose)
    axes = T[:3, :3]
    turn = axes.T @ pose[:3, :3]
    odd = 0.5 * (turn - turn.T)
    angles = np.array([odd[2, 1], odd[0, 2], odd[1, 0]])
    shift = axes.T @ (pose[:3, 3] - T[:3, 3]) / size
    rows = np.concatenate((axes.T @ J[3:] / size, axes.T @ J[:3]))
    return rows[counts], np.concatenate((shift, angles))[counts]
