"""Vectors as three numbers, and the rotations of constant transforms, for kernels."""

import math

from robomech_ros._kernels.compiling.jit import inline


@inline
def turned(packed, row, v):
    """Rotation of the constant transform ``row``, times v."""
    return (
        packed[row, 1] * v[0] + packed[row, 2] * v[1] + packed[row, 3] * v[2],
        packed[row, 4] * v[0] + packed[row, 5] * v[1] + packed[row, 6] * v[2],
        packed[row, 7] * v[0] + packed[row, 8] * v[1] + packed[row, 9] * v[2],
    )


@inline
def back(packed, row, v):
    """Rotation of the constant transform ``row``, transposed, times v."""
    return (
        packed[row, 1] * v[0] + packed[row, 4] * v[1] + packed[row, 7] * v[2],
        packed[row, 2] * v[0] + packed[row, 5] * v[1] + packed[row, 8] * v[2],
        packed[row, 3] * v[0] + packed[row, 6] * v[1] + packed[row, 9] * v[2],
    )


@inline
def dot(u, v):
    """Return the scalar product."""
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2]


@inline
def cross(u, v):
    """Return the vector product."""
    return (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])


@inline
def norm(v):
    """Return the length."""
    return math.sqrt(dot(v, v))
