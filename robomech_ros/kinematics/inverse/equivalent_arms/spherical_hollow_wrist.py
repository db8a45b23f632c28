"""Solve hollow wrists whose four axes meet in a point, the two in the middle on one drive.

With three joints in front, the point follows from the pose as that of any spherical wrist.  The
angle between the first axis of the wrist and the last gives a trigonometric polynomial of the
drive, of the second degree where the two in the middle turn alike or oppositely.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from robomech_ros._kernels.tolerances import SAME_POSTURE
from robomech_ros.kinematics.axis_points import nearest_points
from robomech_ros.kinematics.forward import forward_kinematics
from robomech_ros.kinematics.inverse.closed_form import all_postures
from robomech_ros.kinematics.inverse.families.merged_axes import MergedArm
from robomech_ros.kinematics.inverse.families.selection import Family, family_of
from robomech_ros.kinematics.inverse.families.six_joints import chain_of
from robomech_ros.kinematics.mobility import arm_size
from robomech_ros.robots.chain import SerialChain
from robomech_ros.robots.chain_layout import REVOLUTE, shift, turn_about_z, unpack_chain
from robomech_ros.typing import Array

# Axes that miss each other by less than this part of the arm's size meet.
_MEETS = 1e-9
# Roots of the polynomial that are off the unit circle by more are not real: those of a double
# solution are off by the root of rounding.
_OFF_CIRCLE = 1e-4
# Axes of the wrist are on one line where their sine is less.
_ALIGNED = 1e-7
# Greatest degree of the polynomial.
_MOST_DEGREE = 8

# A quarter turn about x, and an orientation in which virtual wrists are regular.
_QUARTER = np.array([[1.0, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]])
_ORIENTATION = turn_about_z(0.7) @ _QUARTER @ turn_about_z(1.9) @ _QUARTER @ turn_about_z(-0.4)


@dataclass(frozen=True, eq=False)
class SphericalHollowWrist:
    """An arm of three joints with a hollow wrist.

    The arm has the first three joints with a virtual wrist of three about the same point, and the
    family is its own. ``front`` are the first three joints, up to the frame of the first of the
    wrist. The turns (4, 3, 3) are the rotations between the axes of the wrist, and from the last to
    the tip, the centre (3,) is the point in the frame of the tip (m). The gains are the turns of
    the two joints in the middle for one of their drive.
    """

    arm: SerialChain
    family: Family
    front: SerialChain
    turns: Array
    centre: Array
    gains: tuple[int, int]


@lru_cache(maxsize=64)
def spherical_hollow_wrist(merged: MergedArm) -> SphericalHollowWrist | None:
    """Return the wrist of an arm that ends with one, else None."""
    C, types = unpack_chain(merged.chain.packed), merged.chain.types
    middle = merged.rows[4:6]
    if len(types) != 7 or types[3:].any() or np.linalg.matrix_rank(middle) != 1:
        return None
    drives = np.flatnonzero(np.abs(middle).max(axis=0))
    gains = np.round(middle[:, drives[0]])
    if len(drives) != 1 or (gains != middle[:, drives[0]]).any():
        return None
    if not gains.all() or np.abs(gains).sum() > _MOST_DEGREE:
        return None
    # The centre in the frame of each joint of the wrist, whose axes all go through it.
    meeting = nearest_points(C[4])
    if meeting is None:
        return None
    centre, size = np.array([0.0, 0.0, meeting[0], 1.0]), arm_size(merged.chain)
    for constant in C[4:7]:
        if np.hypot(*centre[:2]) > _MEETS * size:
            return None
        centre = np.linalg.inv(constant) @ centre
    if np.hypot(*centre[:2]) > _MEETS * size:
        return None
    links = [
        *C[:3],
        C[3] @ shift(np.array([0.0, 0.0, meeting[0]])),
        _QUARTER,
        _QUARTER.T,
        np.eye(4),
    ]
    arm = chain_of(np.array(links), [*types[:3], REVOLUTE, REVOLUTE, REVOLUTE])
    family = family_of(arm)
    if not family.lists_all:
        return None
    tip = np.linalg.inv(C[7]) @ centre
    front = chain_of(C[:4], types[:3].tolist())
    return SphericalHollowWrist(
        arm, family, front, C[4:, :3, :3], tip[:3], (int(gains[0]), int(gains[1]))
    )


def spherical_wrist_postures(wrist: SphericalHollowWrist, T: Array) -> tuple[Array, bool]:
    """List joint values (k, 7) that give a pose T (4, 4), and tell if they are provably all."""
    target = _ORIENTATION.copy()
    target[:3, 3] = T[:3, :3] @ wrist.centre + T[:3, 3]
    reached, complete = all_postures(wrist.arm, target, wrist.family)
    postures: list[Array] = []
    kept: list[Array] = []
    for q in reached[:, :3]:
        if any(np.abs(q - other).max() < SAME_POSTURE for other in kept):
            continue
        kept.append(q)
        front = forward_kinematics(wrist.front, q)
        wanted = front[:3, :3].T @ T[:3, :3] @ wrist.turns[3].T
        angles, regular = _wrist_angles(wrist, wanted)
        complete = complete and regular
        postures.extend(np.concatenate((q, one)) for one in angles)
    return np.array(postures).reshape(-1, 7), complete


def _wrist_angles(wrist: SphericalHollowWrist, W: Array) -> tuple[list[Array], bool]:
    """List the angles (4,) of a wrist in an orientation (3, 3), and whether they are all."""
    found, regular = [], True
    roots = _drive_angles(wrist, float(W[2, 2]))
    for angle in roots or []:
        middle = [gain * angle for gain in wrist.gains]
        first, last, alone = outer_angles(W, between_axes(wrist.turns, middle))
        regular = regular and alone
        found.append(np.array([first, *middle, last]))
    return found, regular and roots is not None


def between_axes(turns: Array, angles: Sequence[float]) -> Array:
    """Return the rotation from the first axis of a wrist to the last, at the middle angles."""
    first, second = (turn_about_z(angle)[:3, :3] for angle in angles)
    return turns[0] @ first @ turns[1] @ second @ turns[2]


def outer_angles(W: Array, V: Array) -> tuple[float, float, bool]:
    """Find the turns with ``W = Rz(first) V Rz(last)``, and whether there are no others.

    There are where first and last axis are on one line, so that only the sum of the turns matters.
    """
    if min(math.hypot(W[0, 2], W[1, 2]), math.hypot(V[0, 2], V[1, 2])) < _ALIGNED:
        U = W @ V.T
        return math.atan2(U[1, 0], U[0, 0]), 0.0, False
    first = math.atan2(W[1, 2], W[0, 2]) - math.atan2(V[1, 2], V[0, 2])
    last = math.atan2(V[2, 1], V[2, 0]) - math.atan2(W[2, 1], W[2, 0])
    return first, last, True


def _drive_angles(wrist: SphericalHollowWrist, cosine: float) -> list[float] | None:
    """List the angles at which first and last axis have a cosine between them; None for all."""
    degree = sum(map(abs, wrist.gains))
    count = 2 * degree + 1
    angles = 2.0 * math.pi * np.arange(count) / count
    middle = np.outer(angles, wrist.gains).tolist()
    values = [between_axes(wrist.turns, pair)[2, 2] for pair in middle]
    coefficients = np.roll(np.fft.fft(values) / count, degree)
    coefficients[degree] -= cosine
    if np.abs(coefficients).max() < _ALIGNED:
        return None
    roots = np.roots(coefficients[::-1])
    return [float(np.angle(root)) for root in roots if abs(abs(root) - 1.0) < _OFF_CIRCLE]
