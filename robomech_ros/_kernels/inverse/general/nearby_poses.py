"""Poses beside a pose, from which solutions are followed back to it."""

from robomech_ros._kernels.compiling.jit import inline
from robomech_ros._kernels.inverse.general import layout as at

# Rotation (rad), and translation over the size.  Each is used both ways; the first stays near
# all solutions, the others are sure to leave a degenerate pose.
_NUDGES = (
    (-0.5e-4, 0.8e-4, 0.4e-4, 0.3e-4, -0.9e-4, 0.6e-4),
    (1.1e-3, -0.7e-3, 0.8e-3, 0.9e-3, 0.5e-3, -1.2e-3),
    (1.5e-2, 0.9e-2, -1.2e-2, 0.7e-2, -1.6e-2, 1.0e-2),
)
# The pose itself is number 0.
N_NUDGED = 1 + 2 * len(_NUDGES)


@inline
def nudged(data, T, number, part, near):
    """Write the pose T, moved by a part of a nudge (number 0: not moved), to near (4, 4)."""
    u = _NUDGES[(number - 1) // 2]
    scale = part * (0.0 if number == 0 else 1.0 if number % 2 == 1 else -1.0)
    x, y, z = scale * u[0], scale * u[1], scale * u[2]
    square = x * x + y * y + z * z
    # Cayley's rotation, which needs no case for small angles.
    w = 1.0 / (1.0 + square)
    a, b = 2.0 * w, (1.0 - square) * w
    for j in range(3):
        p, q, r = T[0, j], T[1, j], T[2, j]
        along = a * (x * p + y * q + z * r)
        near[0, j] = b * p + along * x + a * (y * r - z * q)
        near[1, j] = b * q + along * y + a * (z * p - x * r)
        near[2, j] = b * r + along * z + a * (x * q - y * p)
        near[3, j] = 0.0
    scale *= data[at.SIZE]
    for i in range(3):
        near[i, 3] = T[i, 3] + scale * u[3 + i]
    near[3, 3] = 1.0
