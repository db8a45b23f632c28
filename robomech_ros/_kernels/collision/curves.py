"""Curves of drives of Bernstein type: d + 1 coefficients (d + 1, n), with parameters from 0 to 1.

References
----------
G. Farin, "Curves and Surfaces for CAGD", 5th edition, 2002, chapters 4 and 5.
"""

from robomech_ros._kernels.collision.shapes import DRIVE, GAIN
from robomech_ros._kernels.compiling.jit import lean


@lean
def drive_rate(curve, middle, k):
    """Bound the distance of drive k from its middle on a curve."""
    most = 0.0
    for d in range(curve.shape[0]):
        most = max(most, abs(curve[d, k] - middle[k]))
    return most


@lean
def joint_rates(joints, curve, middle, rates):
    """Write bounds of the distance of each joint from its middle on a curve to rates (m,)."""
    for i in range(joints.shape[0]):
        rates[i] = abs(joints[i, GAIN]) * drive_rate(curve, middle, int(joints[i, DRIVE]))


@lean
def halve(curve, left, right):
    """Write both halves of a curve, by de Casteljau's method."""
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
