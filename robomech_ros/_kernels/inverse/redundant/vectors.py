"""Products of vectors and the rotations of a packed chain's constant transforms."""

from robomech_ros._kernels.compiling.jit import inline


@inline
def turned(packed, row, v):
    """Return v rotated by the constant transform ``row``."""
    return (
        packed[row, 1] * v[0] + packed[row, 2] * v[1] + packed[row, 3] * v[2],
        packed[row, 4] * v[0] + packed[row, 5] * v[1] + packed[row, 6] * v[2],
        packed[row, 7] * v[0] + packed[row, 8] * v[1] + packed[row, 9] * v[2],
    )


@inline
def rotated_back_by(packed, row, v):
    """Return v rotated by the inverse of the constant transform ``row``."""
    return (
        packed[row, 1] * v[0] + packed[row, 4] * v[1] + packed[row, 7] * v[2],
        packed[row, 2] * v[0] + packed[row, 5] * v[1] + packed[row, 8] * v[2],
        packed[row, 3] * v[0] + packed[row, 6] * v[1] + packed[row, 9] * v[2],
    )
