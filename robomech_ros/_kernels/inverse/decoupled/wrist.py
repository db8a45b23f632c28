"""Solution of spherical wrists: three revolute axes through one point.

``Rz(x) Rx(A) Rz(y) Rx(B) Rz(z) = Q`` with A and B in (0, pi).  The third column of Q, axis 6
in the frame before axis 4, gives cos y; the sign of sin y is free, hence two solutions.
Then x follows from that column and z from the first one, so that the product is Q up to rounding
even if x and z are ill-conditioned.

References
----------
Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 4.4.2.
"""

import math

from robomech_ros._kernels.algebra.angles import angle_of
from robomech_ros._kernels.compiling.jit import lean
from robomech_ros._kernels.inverse.decoupled import layout as at
from robomech_ros._kernels.tolerances import POLISH_ABOVE

WRIST_FREE = 1  # axes 4 and 6 are parallel: x is the requested value, z follows
WRIST_BOUNDARY = 2  # the two solutions have become one
WRIST_OPPOSED = 4  # with WRIST_FREE: the parallel axes point in opposite directions


@lean
def _last_angle(data, Q, cosx, sinx, cosy, siny):
    """Return z from the first column of Q turned back by x."""
    v0 = cosx * Q[0] + sinx * Q[3]
    v1 = cosx * Q[3] - sinx * Q[0]
    v2 = Q[6]
    ca, sa = data[at.COS4], data[at.SIN4]
    cb, sb = data[at.COS5], data[at.SIN5]
    first = cosy * v0 + siny * (ca * v1 + sa * v2)
    second = (ca * cb * cosy - sa * sb) * v1 + (sa * cb * cosy + ca * sb) * v2 - cb * siny * v0
    return angle_of(second, first)


@lean
def _write(data, Q, cosy, siny, found):
    """Write the solution with the angle y to ``found`` (3,)."""
    ca, sa = data[at.COS4], data[at.SIN4]
    cb, sb = data[at.COS5], data[at.SIN5]
    gx = sb * siny
    gy = -(ca * sb * cosy + sa * cb)
    cosx = gx * Q[2] + gy * Q[5]
    sinx = gx * Q[5] - gy * Q[2]
    inverse = 1.0 / math.sqrt(cosx * cosx + sinx * sinx)
    cosx *= inverse
    sinx *= inverse
    found[0] = angle_of(sinx, cosx)
    found[1] = angle_of(siny, cosy)
    found[2] = _last_angle(data, Q, cosx, sinx, cosy, siny)


@lean
def spherical_wrist(data, Q, free_angle, slack, parallel, found):
    """Write the angles (x, y, z) of up to two solutions to ``found``; return (count, flags).

    Q is the rotation as nine numbers, row by row.  ``free_angle`` is the value of x if axes 4 and 6
    are parallel, with a sine up to ``parallel``.  An orientation out of reach by up to ``slack``
    (rad) is accepted.
    """
    across = math.sqrt(Q[2] * Q[2] + Q[5] * Q[5])
    if across > parallel and data[at.COS4] == 0.0 and data[at.COS5] == 0.0:
        _write(data, Q, -Q[8], across, found[0])
        found[1, 0] = found[0, 0] - math.copysign(math.pi, found[0, 0])
        found[1, 1] = -found[0, 1]
        found[1, 2] = found[0, 2] - math.copysign(math.pi, found[0, 2])
        return 2, 0
    angle = angle_of(across, Q[8])
    if angle < data[at.NEAREST] - slack or angle > data[at.FARTHEST] + slack:
        return 0, 0
    if across <= parallel:
        cosy = -1.0 if Q[8] > 0.0 else 1.0
        found[0, 0] = free_angle
        found[0, 1] = math.pi if Q[8] > 0.0 else 0.0
        cosx, sinx = math.cos(free_angle), math.sin(free_angle)
        found[0, 2] = _last_angle(data, Q, cosx, sinx, cosy, 0.0)
        return 1, WRIST_FREE if Q[8] > 0.0 else WRIST_FREE | WRIST_OPPOSED
    sines = data[at.SIN4] * data[at.SIN5]
    cosy = (data[at.COS4] * data[at.COS5] - Q[8]) / sines
    near, far = data[at.NEAREST], data[at.FARTHEST]
    if min(angle - near, far - angle) <= POLISH_ABOVE:
        _write(data, Q, math.copysign(1.0, cosy), 0.0, found[0])
        return 1, WRIST_BOUNDARY
    product = math.sin(0.5 * (angle - near)) * math.sin(0.5 * (far - angle))
    product *= math.sin(0.5 * (angle + near)) * math.sin(0.5 * (far + angle))
    siny = 2.0 * math.sqrt(product) / sines
    _write(data, Q, cosy, siny, found[0])
    _write(data, Q, cosy, -siny, found[1])
    return 2, 0
