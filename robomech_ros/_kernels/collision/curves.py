"""Curves of n drives as Bernstein coefficients (d + 1, n), with a parameter from 0 to 1.

References
----------
G. Farin, "Curves and Surfaces for CAGD", 5th edition, 2002, chapters 4 and 5.
"""

from robomech_ros._kernels.collision.shapes import DRIVE, GAIN
from robomech_ros._kernels.compiling.jit import lean


@lean
def drive_travel(curve, middle, k):
    """Return a bound of the distance of drive k from its middle position on a curve."""
    most = 0.0
    for d in range(curve.shape[0]):
        most = max(most, abs(curve[d, k] - middle[k]))
    return most


@lean
def joint_travels(joints, curve, middle, travels):
    """Write bounds of the distances of joints from their middle positions to travels (m,)."""
    for i in range(joints.shape[0]):
        travels[i] = abs(joints[i, GAIN]) * drive_travel(curve, middle, int(joints[i, DRIVE]))


@lean
def halve(curve, left, right):
    """Write both halves of a curve by de Casteljau's algorithm."""
    size = curve.shape[0]
    for k in range(curve.shape[1]):
        for d in range(size):
            right[d, k] = curve[d, k]
        for d in range(size):
            left[d, k] = right[0, k]
            for e in range(size - 1 - d):
                right[e, k] = 0.5 * (right[e, k] + right[e + 1, k])


@lean
def cut(curve, begin, end):
    """Replace a curve by its part from begin to end."""
    size = curve.shape[0]
    for k in range(curve.shape[1]):
        for d in range(size - 1):
            for e in range(size - 1, d, -1):
                curve[e, k] += (1.0 - end) * (curve[e - 1, k] - curve[e, k])
        share = begin / end if end > 0.0 else 0.0
        for d in range(size - 1):
            for e in range(size - 1 - d):
                curve[e, k] += share * (curve[e + 1, k] - curve[e, k])
