"""Denavit-Hartenberg parameters from the constant transforms of a chain.

References
----------
Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 4.2.
"""

import numpy as np

from robomech_ros.robots.chain_layout import PRISMATIC, unpack_chain
from robomech_ros.robots.dh_table import DHTable
from robomech_ros.spatial.poses import rigid_inverse
from robomech_ros.typing import Array, IntArray

# Below this sine two axes count as parallel: the foot of their common normal would lie so far
# away (distance / sine) that rounding spoils more digits than the neglected angle does.
PARALLEL_SINE = 1e-8
# Axes that pass each other by less than this (m) meet: it is rounding for an arm of metre size.
INTERSECTING = 1e-12


def recover_dh(packed: Array) -> DHTable:
    """Recover the table of a chain of at least one joint, revolute or prismatic.

    - ``packed``: the chain as :func:`pack_chain` lays it out, shape (n + 1, 13).

    Returns the table that :func:`dh_from_chain` describes.
    """
    return table_of_axes(*_axes_at_zero(packed), packed[:-1, 0].astype(np.int64))


def table_of_axes(axes: Array, origins: Array, tip: Array | None, types: IntArray) -> DHTable:
    """Make the table of joint axes; without a pose of the tip it ends in the frame of the last.

    - ``axes``, ``origins``: unit vectors and points (m) of the axes, in the base, at the joint
      values 0, shape (n, 3).
    - ``tip``: in the base (m), shape (4, 4) or None.
    - ``types``: 0 revolute, 1 prismatic, shape (n,).
    """
    frame = _first_frame(axes[0], origins[0])
    base = frame.copy()
    n = len(types)
    parameters = np.zeros((4, n))
    for i in range(n):
        if i + 1 < n:
            point = frame[:3, 3] if types[i + 1] == PRISMATIC else origins[i + 1]
            after = _next_frame(frame, axes[i + 1], point)
        elif tip is None:
            after = tip = frame
        else:
            after = _next_frame(frame, tip[:3, 2], tip[:3, 3], tip)
        parameters[:, i] = _between(frame, after)
        frame = after
    a, b, alpha, theta = parameters
    assert tip is not None
    return DHTable(a, b, alpha, theta, base, rigid_inverse(frame) @ tip, types)


def _axes_at_zero(packed: Array) -> tuple[Array, Array, Array]:
    """Directions and points of all joint axes, and the tip's pose, at q = 0 in the base."""
    T = np.eye(4)
    frames = []
    for C in unpack_chain(packed):
        T = T @ C
        frames.append(T)
    stacked = np.array(frames)
    return stacked[:-1, :3, 2], stacked[:-1, :3, 3], stacked[-1]


def _frame(x: Array, z: Array, origin: Array) -> Array:
    """Build an orthonormal frame from z, from x made normal to it, and from an origin."""
    z = z / np.linalg.norm(z)
    x = x - (x @ z) * z
    x = x / np.linalg.norm(x)
    T = np.eye(4)
    T[:3, 0], T[:3, 1], T[:3, 2], T[:3, 3] = x, np.cross(z, x), z, origin
    return T


def _first_frame(z: Array, point: Array) -> Array:
    """Place frame 1 at the point of axis 1 nearest the base's origin, x along the base's."""
    origin = point - (point @ z) * z
    x = np.array([1.0, 0.0, 0.0])
    if abs(z[0]) > 0.9:
        x = np.array([0.0, 1.0, 0.0])
    return _frame(x, z, origin)


def _next_frame(frame: Array, z: Array, point: Array, tip: Array | None = None) -> Array:
    """Place the next frame on the line (z, point), x along its common normal with frame's z.

    ``tip`` is the tip's pose where the line is the tip's z axis: it settles what is free.
    """
    z_before, origin = frame[:3, 2], frame[:3, 3]
    normal = np.cross(z_before, z)
    sine = np.linalg.norm(normal)
    gap = point - origin
    if sine < PARALLEL_SINE:
        return _next_parallel(frame, z, point, tip)
    normal = normal / sine
    # Along the axis from its point to the foot of the common normal.
    along = np.cross(gap, z_before) @ normal / sine
    foot = point + along * z
    length = gap @ normal
    reference = frame[:3, 0] if tip is None else tip[:3, 0]
    if abs(length) > INTERSECTING:
        sign = 1.0 if length > 0 else -1.0
    else:
        sign = -1.0 if normal @ reference < -1e-9 else 1.0
    return _frame(sign * normal, z, foot)


def _next_parallel(frame: Array, z: Array, point: Array, tip: Array | None) -> Array:
    z_before, origin = frame[:3, 2], frame[:3, 3]
    gap = point - origin
    across = gap - (gap @ z_before) * z_before
    # Without a tip the common normal passes through the origin before: b = 0.
    foot = origin + across if tip is None else point
    if np.linalg.norm(across) > INTERSECTING:
        return _frame(across, z, foot)
    x = frame[:3, 0] if tip is None else tip[:3, 0]
    return _frame(x, z, foot)


def _between(frame: Array, after: Array) -> tuple[float, float, float, float]:
    """DH parameters a, b, alpha, theta from one frame to the next."""
    T = rigid_inverse(frame) @ after
    theta = np.arctan2(T[1, 0], T[0, 0])
    alpha = np.arctan2(T[2, 1], T[2, 2])
    a = T[0, 3] * T[0, 0] + T[1, 3] * T[1, 0]
    return float(a), float(T[2, 3]), float(alpha), float(theta)
