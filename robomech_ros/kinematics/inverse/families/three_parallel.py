"""Arms with three parallel axes next to each other: their constants."""

import math

import numpy as np

from robomech_ros._kernels.inverse.parallel import layout as at
from robomech_ros.kinematics.inverse.families.parallel_axes import (
    PARALLEL_ANGLE,
    AxisLine,
    ParallelAxes,
    find_parallel_axes,
    sine_between,
)
from robomech_ros.robots.chain import SerialChain
from robomech_ros.spatial.poses import rigid_inverse
from robomech_ros.typing import Array

# Largest distance (of the arm's size) between axes 5 and 6 taken as meeting; beyond, the general
# equations are accurate although nearly separate.
PARALLEL_MEETING = 1e-10
# Up to here the same deviations are rounding, and algebraic residuals need no second look.
PARALLEL_EXACT = 1e-14
# A target beyond a boundary by no more than this (of the arm's size, or a cosine) counts as on
# it at first: where double roots follow each other, the rounding of one is the square root of
# the other's, and its root again.  The polish then decides by the error of the pose.
PARALLEL_SLACK = 1e-6


def match(chain: SerialChain) -> Array | None:
    """Recognise an arm with three parallel axes next to each other.

    Returns the constants that ``_kernels.inverse.parallel`` reads; None where there are no three
    such axes, or the arm cannot move in all directions.
    """
    arm = find_parallel_axes(chain)
    return None if arm is None else _constants(chain, arm)


def _frame(z: Array, x: Array, origin: Array) -> Array:
    """Make the pose with this origin and z, and x as near to the given one as that allows."""
    z = z / np.linalg.norm(z)
    x = x - (x @ z) * z
    if np.linalg.norm(x) < PARALLEL_ANGLE:
        x = np.eye(3)[np.argmin(np.abs(z))]
        x = x - (x @ z) * z
    x = x / np.linalg.norm(x)
    pose = np.eye(4)
    pose[:3, 0], pose[:3, 1], pose[:3, 2], pose[:3, 3] = x, np.cross(z, x), z, origin
    return pose


def _last_frames(arm: ParallelAxes) -> tuple[int, float, Array, Array]:
    """Frames 5 and 6 at the feet of the common normal; how the axes stand, and their distance."""
    w5, w6 = arm.axes[4].direction, arm.axes[5].direction
    p5, p6 = arm.axes[4].point, arm.axes[5].point
    between = p6 - p5
    cross = np.cross(w5, w6)
    sine = float(np.linalg.norm(cross))
    if sine < PARALLEL_ANGLE:
        apart = between - (between @ w5) * w5
        # Axes on one line have no normal; any direction will do.
        normal = _frame(w5, apart, p5)[:3, 0]
        kind, foot5, foot6 = at.PARALLEL, p5, p5 + (apart @ normal) * normal
    else:
        normal = cross / sine
        foot5 = p5 + (np.cross(between, w6) @ cross) / sine**2 * w5
        foot6 = p6 + (np.cross(between, w5) @ cross) / sine**2 * w6
        meets = abs(float(between @ normal)) < PARALLEL_MEETING * arm.size
        kind = at.INTERSECTING if meets else at.SKEW
    offset = 0.0 if kind == at.INTERSECTING else float(normal @ (foot6 - foot5))
    return kind, offset, _frame(w5, np.cross(normal, w5), foot5), _frame(w6, normal, foot6)


def _constants(chain: SerialChain, arm: ParallelAxes) -> Array:
    """Lay out the constants as the kernel reads them."""
    a = arm.axes[0]
    triple = arm.triple
    before = arm.order == at.AXIS_BEFORE
    z = triple[0].direction
    kind, offset, frame5, frame6 = _last_frames(arm)
    base = _frame(z, triple[1].point - triple[0].point, triple[0].point)
    frame_a = _frame(a.direction, z, a.point)

    data = np.zeros(at.LENGTH)
    data[at.ORDER], data[at.FROM_TIP], data[at.KIND] = arm.order, arm.from_tip, kind
    data[at.SIZE] = arm.size
    data[at.JOINTS : at.JOINTS + 6] = arm.joints
    data[at.SENSES : at.SENSES + 3] = [np.sign(z @ line.direction) for line in triple]
    for index, slide in ((0, at.SLIDE_A), (4, at.SLIDE_5), (5, at.SLIDE_6)):
        if arm.axes[index].slides:
            data[at.SLIDING] = slide
    data[at.NAMED] = before and kind != at.SKEW and data[at.SLIDING] == at.SLIDE_NONE
    _planar_part(data, base, triple)

    r_a = frame_a[:3, :3].T @ z
    data[at.SIN_A], data[at.COS_A] = r_a[0], r_a[2]
    r56 = frame5[:3, :3].T @ frame6[:3, 2]
    data[at.COS_56] = r56[2]
    data[at.SIN_56] = 0.0 if kind == at.PARALLEL else r56[0]
    data[at.NORMAL_56] = offset
    _direction_part(data, base, frame5, frame_a)

    third = base.copy()
    third[:3, 3] = triple[2].point - z * (z @ (triple[2].point - base[:3, 3]))
    third = rigid_inverse(frame5 if before else frame_a) @ third
    data[at.POINT : at.POINT + 3] = third[:3, 3]
    data[at.HEADING : at.HEADING + 3] = third[:3, 0]
    middle = rigid_inverse(base if before else frame5) @ frame_a
    data[at.MIDDLE : at.MIDDLE + 12] = middle[:3].ravel()
    left = rigid_inverse(frame_a if before else base)
    right = frame6
    if arm.from_tip:
        left = left @ arm.home
    else:
        right = rigid_inverse(arm.home) @ right
    data[at.LEFT : at.LEFT + 12] = left[:3].ravel()
    data[at.RIGHT : at.RIGHT + 12] = right[:3].ravel()
    data[at.PACKED :] = chain.packed.ravel()
    neglected = _neglected(arm, kind)
    data[at.EXACT] = neglected < PARALLEL_EXACT
    data[at.SLACK] = PARALLEL_SLACK
    if not data[at.EXACT]:
        data[at.SLACK] += 10.0 * neglected
        data[at.ROOT_SPLIT] = math.sqrt(neglected)
    data.setflags(write=False)
    return data


def _planar_part(data: Array, base: Array, triple: tuple[AxisLine, ...]) -> None:
    """Enter the lengths and the bend of the planar arm of the parallel axes."""
    x, y = base[:3, 0], base[:3, 1]
    p = [
        np.array([x @ (line.point - base[:3, 3]), y @ (line.point - base[:3, 3])])
        for line in triple
    ]
    data[at.LINK_1] = np.linalg.norm(p[1])
    link = p[2] - p[1]
    data[at.LINK_2] = np.linalg.norm(link)
    data[at.BEND] = np.arctan2(link[1], link[0])


def _direction_part(data: Array, base: Array, frame5: Array, frame_a: Array) -> None:
    """Enter the components of z_F along frame 5 and the constant part of the height."""
    z = base[:3, 2]
    sin_a, cos_a = data[at.SIN_A], data[at.COS_A]
    if data[at.ORDER] == at.AXIS_BEFORE:
        seen = frame5[:3, :3].T @ z
        data[at.GAMMA], data[at.FIRST], data[at.SECOND] = seen[2], seen[0], seen[1]
        data[at.HEIGHT] = z @ (frame_a[:3, 3] - frame5[:3, 3])
        angle = np.arctan2(data[at.SIN_56], data[at.COS_56])
        other = np.arctan2(np.hypot(seen[0], seen[1]), seen[2])
        same = 2.0 * np.sin(0.5 * (angle - other)) ** 2
        mirror = 2.0 * np.cos(0.5 * (angle + other)) ** 2
        data[at.DEFECT_SAME] = 0.0 if same < 1e-30 else same
        data[at.DEFECT_MIRROR] = 0.0 if mirror < 1e-30 else mirror
        return
    # R_a^T z = (sin_a cos q, -sin_a sin q, cos_a) in frame a; its components along frame 5.
    axes5 = frame_a[:3, :3].T @ frame5[:3, :3]
    for index, column in ((at.GAMMA, 2), (at.FIRST, 0), (at.SECOND, 1)):
        u = axes5[:, column]
        data[index : index + 3] = cos_a * u[2], sin_a * u[0], -sin_a * u[1]
    d = frame_a[:3, :3].T @ (frame5[:3, 3] - frame_a[:3, 3])
    height = float(z @ (frame_a[:3, 3] - base[:3, 3]))
    data[at.HEIGHT : at.HEIGHT + 3] = -height - cos_a * d[2], -sin_a * d[0], sin_a * d[1]


def _neglected(arm: ParallelAxes, kind: int) -> float:
    """Deviation (sine, or distance over size) of the constants from the true geometry.

    That is what counts as parallel or meeting without being so, and the digits that feet of a
    common normal far away cost.
    """
    w = arm.triple[0].direction
    worst = max(sine_between(w, line.direction) for line in arm.triple)
    five, six = arm.axes[4:]
    sine = sine_between(five.direction, six.direction)
    if kind == at.PARALLEL:
        return max(worst, sine)
    if kind == at.INTERSECTING:
        cross = np.cross(five.direction, six.direction)
        apart = abs(float(cross @ (six.point - five.point))) / sine
        worst = max(worst, apart / arm.size)
    return max(worst, np.finfo(float).eps / sine)
