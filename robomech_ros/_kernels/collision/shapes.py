"""Signed distances of points from simple shapes, and frames of a tree of joints.

A tree of m joints is an array (m, TREE_WIDTH).  A row has the frame before the joint (0 is the
base, i + 1 the frame that moves with joint i), 0 for revolute or 1 for prismatic, the drive, gain
and offset, and the constant pose of the joint, with its axis along z, in the frame before it.
Poses are twelve numbers: rotation row by row, then origin.
"""

import math

from robomech_ros._kernels.compiling.jit import lean

# Columns of a tree; the pose fills the rest.
PARENT, KIND, DRIVE, GAIN, OFFSET, POSE = 0, 1, 2, 3, 4, 5
TREE_WIDTH = 17

SPHERES, BOX, BALL, CYLINDER, CAPSULE, HALF_SPACE = -1, 0, 1, 2, 3, 4


@lean
def compose(A, i, B, k, j, out, o):
    """Write the product of pose i of A and the pose in row k of B, from column j, to row o."""
    for r in range(3):
        a0, a1, a2 = A[i, 3 * r], A[i, 3 * r + 1], A[i, 3 * r + 2]
        for c in range(3):
            out[o, 3 * r + c] = a0 * B[k, j + c] + a1 * B[k, j + 3 + c] + a2 * B[k, j + 6 + c]
        out[o, 9 + r] = A[i, 9 + r] + a0 * B[k, j + 9] + a1 * B[k, j + 10] + a2 * B[k, j + 11]


@lean
def place_frames(joints, q, frames):
    """Write the poses (m + 1, 12) of the base and of the frames of all joints at drives q."""
    for k in range(12):
        frames[0, k] = 1.0 if k in (0, 4, 8) else 0.0
    for i in range(joints.shape[0]):
        compose(frames, int(joints[i, PARENT]), joints, i, POSE, frames, i + 1)
        value = joints[i, GAIN] * q[int(joints[i, DRIVE])] + joints[i, OFFSET]
        if joints[i, KIND] == 0.0:
            c, s = math.cos(value), math.sin(value)
            for r in range(3):
                x, y = frames[i + 1, 3 * r], frames[i + 1, 3 * r + 1]
                frames[i + 1, 3 * r], frames[i + 1, 3 * r + 1] = c * x + s * y, c * y - s * x
        else:
            for r in range(3):
                frames[i + 1, 9 + r] += value * frames[i + 1, 3 * r + 2]


@lean
def signed_distance(kind, shapes, k, x, y, z):
    """Return the signed distance of a point to shape k, negative inside."""
    x -= shapes[k, 9]
    y -= shapes[k, 10]
    z -= shapes[k, 11]
    u = abs(shapes[k, 0] * x + shapes[k, 3] * y + shapes[k, 6] * z)
    v = abs(shapes[k, 1] * x + shapes[k, 4] * y + shapes[k, 7] * z)
    w = shapes[k, 2] * x + shapes[k, 5] * y + shapes[k, 8] * z
    a, b, c = shapes[k, 12], shapes[k, 13], shapes[k, 14]
    if kind == HALF_SPACE:
        return w
    w = abs(w)
    if kind == BOX:
        u, v, w = u - a, v - b, w - c
        outside = max(u, 0.0) ** 2 + max(v, 0.0) ** 2 + max(w, 0.0) ** 2
        return math.sqrt(outside) if outside > 0.0 else max(u, v, w)
    if kind == BALL:
        return math.sqrt(u * u + v * v + w * w) - a
    if kind == CAPSULE:
        w = max(w - b, 0.0)
        return math.sqrt(u * u + v * v + w * w) - a
    u, w = math.sqrt(u * u + v * v) - a, w - b
    outside = max(u, 0.0) ** 2 + max(w, 0.0) ** 2
    return math.sqrt(outside) if outside > 0.0 else max(u, w)
