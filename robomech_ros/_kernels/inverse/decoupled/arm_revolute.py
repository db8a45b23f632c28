"""The first three joints of a decoupled arm, all revolute, that put the wrist centre at c.

In the direction of solution ``c = Rz(x) A Rz(y) B Rz(z) w``, with A = (R, t) and B constant.  Let
p = B Rz(z) w, a circle in the frame of joint 2, and r = Rz(y) p.  The third component of c and
its length do not depend on x:

    n . r = c_z - t_z,     s . r = (|c|^2 - |t|^2 - |p|^2) / 2,     n = R^T e_z,  s = R^T t.

The third component of r is that of p.  So these are two linear equations in r_x and r_y whose
right sides M and N are linear in cos z and sin z.  Two combinations of them give the components
of (r_x, r_y) along a unit vector g and perpendicular to it,

    r_g = G,     eta r_h = E,     r_h^2 = |p|^2 - p_z^2 - G^2,

so that E^2 = eta^2 (|p|^2 - p_z^2 - G^2): the quartic for z.  If the first two axes are parallel
or intersect, eta = 0: E = 0 alone gives z, and r_h has either sign.

References
----------
Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 4.4.1; it eliminates the
second joint first, with the same quartic.
"""

import math

from robomech_ros._kernels.algebra.polynomials import (
    DOUBLE_ROOT,
    order_one_roots,
    order_two_roots,
    square,
    value,
)
from robomech_ros._kernels.compiling.jit import lean, lean_part, scratch
from robomech_ros._kernels.compiling.types import F3, IN1, OUT2, i8
from robomech_ros._kernels.inverse.decoupled import layout as at
from robomech_ros._kernels.inverse.decoupled.arm_rows import (
    FREE,
    FREE_1,
    FREE_2,
    FREE_3,
    enter_turn,
)
from robomech_ros._kernels.tolerances import ON_AXIS


@lean
def _row(data, k, w):
    x, y, z = w
    return (
        data[k + 2] * z + data[k + 3],
        data[k] * x + data[k + 1] * y,
        data[k + 1] * x - data[k] * y,
    )


@lean
def circle(data, w):
    """Return p(z) = B Rz(z) w: constant, cosine and sine part of each of its three components."""
    k = at.SECOND
    return _row(data, k, w), _row(data, k + 4, w), _row(data, k + 8, w)


@lean
def squared_length(u, v, w):
    """Return the squared length of a circle's points, a first-order form as the radii are equal."""
    return (
        u[0] * u[0] + v[0] * v[0] + w[0] * w[0] + u[1] * u[1] + v[1] * v[1] + w[1] * w[1],
        2.0 * (u[0] * u[1] + v[0] * v[1] + w[0] * w[1]),
        2.0 * (u[0] * u[2] + v[0] * v[2] + w[0] * w[2]),
    )


@lean
def turn_to(fx, fy, tx, ty, seed):
    """Return cosine and sine of the angle about z from (fx, fy) to (tx, ty), and if it is free.

    It is free, and the angle ``seed``, if one of the two vectors is zero.
    """
    if fx * fx + fy * fy <= ON_AXIS * ON_AXIS or tx * tx + ty * ty <= ON_AXIS * ON_AXIS:
        return math.cos(seed), math.sin(seed), True
    c = fx * tx + fy * ty
    s = fx * ty - fy * tx
    inverse = 1.0 / math.sqrt(c * c + s * s)
    return c * inverse, s * inverse, False


@lean
def third_angle(data, split, e, room, eta, seed, roots):
    """Solve E(z) = eta h, h^2 = H(z) for the angle z.

    E is of first, H of second order; with ``split`` the first equation is E = 0.  Rows
    [cos z, sin z] go to ``roots`` (7, 2).  Returns their number, and whether z is free (``seed``).
    """
    if split:
        found, c1, s1, c2, s2 = order_one_roots(e[0], e[1], e[2], data[at.SLACK])
        roots[0, 0], roots[0, 1], roots[1, 0], roots[1, 1] = c1, s1, c2, s2
    else:
        f0, f1, g1, f2, g2 = square(e)
        h0, h1, k1, h2, k2 = room
        m = eta * eta
        size = e[0] * e[0] + e[1] * e[1] + e[2] * e[2]
        size += m * (abs(h0) + abs(h1) + abs(k1) + abs(h2) + abs(k2))
        unit = 1.0 / size if size > 0.0 else 1.0
        found = order_two_roots(
            (f0 - m * h0) * unit,
            (f1 - m * h1) * unit,
            (g1 - m * k1) * unit,
            (f2 - m * h2) * unit,
            (g2 - m * k2) * unit,
            data[at.SLACK],
            roots,
        )
    if found < 0:
        roots[0, 0], roots[0, 1] = math.cos(seed), math.sin(seed)
        return 1, True
    return found, False


@lean
def across(data, split, e, eta, room, scale):
    """Solve E = eta h, h^2 = H at one angle; return the number of solutions h, -h, and h.

    E / eta is the better value unless eta is small.  If both equations disagree, a multiple root
    is near, and even the sign of E is uncertain.
    """
    if split:
        if room <= DOUBLE_ROOT * scale:
            # The component along g may exceed the radius by up to the slack.
            beyond = data[at.SLACK] * (2.0 * math.sqrt(scale) + data[at.SLACK])
            return (0 if room < -beyond - ON_AXIS * ON_AXIS else 1), 0.0
        return 2, math.sqrt(room)
    direct = e / eta
    if room <= eta * eta:
        return 1, direct
    other = math.copysign(math.sqrt(room), direct)
    return 1 if abs(direct) > 0.5 * abs(other) else 2, other


@lean
def _right_sides(data, c, p):
    """Return the constant, cosine and sine parts of M and N."""
    px, py, pz = p
    k = at.FIRST
    tx, ty, tz = data[k + 3], data[k + 7], data[k + 11]
    nz = data[k + 10]
    sz = data[k + 2] * tx + data[k + 6] * ty + data[k + 10] * tz
    q = squared_length(px, py, pz)
    x, y, z = c
    n0 = 0.5 * (x * x + y * y + z * z - tx * tx - ty * ty - tz * tz - q[0]) - sz * pz[0]
    return (
        (z - tz - nz * pz[0], -nz * pz[1], -nz * pz[2]),
        (n0, -0.5 * q[1] - sz * pz[1], -0.5 * q[2] - sz * pz[2]),
    )


@lean
def _combination(a, u, b, v):
    return a * u[0] + b * v[0], a * u[1] + b * v[1], a * u[2] + b * v[2]


@lean
def _complete(data, c, px, py, pz, rx, ry, seed, arm):
    """Enter the first two angles of a candidate; return the flags of free ones."""
    cosy, siny, any_y = turn_to(px, py, rx, ry, seed[1])
    rx = cosy * px - siny * py
    ry = siny * px + cosy * py
    k = at.FIRST
    ux = data[k] * rx + data[k + 1] * ry + data[k + 2] * pz + data[k + 3]
    uy = data[k + 4] * rx + data[k + 5] * ry + data[k + 6] * pz + data[k + 7]
    cosx, sinx, any_x = turn_to(ux, uy, c[0], c[1], seed[0])
    enter_turn(arm, 0, cosx, sinx)
    enter_turn(arm, 1, cosy, siny)
    return (FREE_1 if any_x else 0) + (FREE_2 if any_y else 0)


@lean_part(i8(IN1, F3, F3, F3, OUT2))
def revolute_arm(data, c, w, seed, arms):
    """Write candidates for the three joints to ``arms``, rows as in :mod:`arm_rows`.

    The points c and w are in units of SIZE, ``seed`` has the angles of free joints, and ``arms``
    has 16 rows.  Returns the number of candidates.
    """
    p = circle(data, w)
    m, n = _right_sides(data, c, p)
    k = at.EQUATIONS
    e = _combination(data[k], m, data[k + 1], n)
    g = _combination(data[k + 2], m, data[k + 3], n)
    gx, gy, eta = data[k + 4], data[k + 5], data[k + 6]
    split = data[at.KIND] == at.REVOLUTE_SPLIT
    x2, y2, g2 = square(p[0]), square(p[1]), square(g)
    room = (
        x2[0] + y2[0] - g2[0],
        x2[1] + y2[1] - g2[1],
        x2[2] + y2[2] - g2[2],
        x2[3] + y2[3] - g2[3],
        x2[4] + y2[4] - g2[4],
    )
    roots = scratch(7, 2)
    found, is_free = third_angle(data, split, e, room, eta, seed[2], roots)
    count = 0
    for i in range(found):
        cosz, sinz = roots[i, 0], roots[i, 1]
        px, py, pz = value(p[0], cosz, sinz), value(p[1], cosz, sinz), value(p[2], cosz, sinz)
        along = value(g, cosz, sinz)
        radius = math.sqrt(px * px + py * py)
        h2 = (radius - along) * (radius + along)
        signs, h = across(data, split, value(e, cosz, sinz), eta, h2, radius * radius)
        for _ in range(signs):
            rx = gx * along - gy * h
            ry = gy * along + gx * h
            free = _complete(data, c, px, py, pz, rx, ry, seed, arms[count])
            enter_turn(arms[count], 2, cosz, sinz)
            arms[count, FREE] = free + (FREE_3 if is_free else 0)
            count += 1
            h = -h
    return count
