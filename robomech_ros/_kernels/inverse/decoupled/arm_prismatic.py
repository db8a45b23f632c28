"""The first three joints of a decoupled arm with prismatic joints among them.

In the direction of solution ``c = J_1(x) A J_2(y) B J_3(z) w``; J is a rotation about z or a
translation along it, A and B are constant.  Each kind has one function; the reverse of a kind is
solved from the tip.  Notation as in :mod:`.arm_revolute`; p = B J_3(z) w.
"""

import math

from robomech_ros._kernels.algebra.polynomials import (
    order_one_roots,
    quadratic_roots,
    square,
    value,
)
from robomech_ros._kernels.compiling.jit import lean, lean_part, scratch
from robomech_ros._kernels.compiling.types import F3, IN1, OUT2, i8
from robomech_ros._kernels.inverse.decoupled import layout as at
from robomech_ros._kernels.inverse.decoupled.arm_revolute import (
    across,
    circle,
    squared_length,
    third_angle,
    turn_to,
)
from robomech_ros._kernels.inverse.decoupled.arm_rows import (
    FREE,
    FREE_1,
    FREE_2,
    FREE_3,
    enter_slide,
    enter_turn,
)
from robomech_ros._kernels.spatial.vectors import mixed, rotated, rotated_back


@lean
def through(data, k, x, y, z):
    """Apply the 3x4 transform at k to a point."""
    x, y, z = rotated(data, k, (x, y, z))
    return x + data[k + 3], y + data[k + 7], z + data[k + 11]


@lean
def _back(data, k, x, y, z):
    """Apply the inverse of the 3x4 transform at k to a point."""
    return rotated_back(data, k, (x - data[k + 3], y - data[k + 7], z - data[k + 11]))


@lean
def _slide_and_angle(data, beta, gamma, delta, kappa, seed, roots):
    """Solve x^2 + 2 beta x + gamma = 0 and kappa x + delta = 0 for the angles z, x a slide.

    The forms beta, gamma and delta have a constant, a cosine and a sine part.  With h = x + beta,
    kappa h = kappa beta - delta and h^2 = beta^2 - gamma.  Returns the form of kappa h, then the
    results of :func:`third_angle`.
    """
    e = (kappa * beta[0] - delta[0], kappa * beta[1] - delta[1], kappa * beta[2] - delta[2])
    b0, b1, b2, b3, b4 = square(beta)
    room = (b0 - gamma[0], b1 - gamma[1], b2 - gamma[2], b3, b4)
    found, free = third_angle(data, data[at.EQUATIONS] == 1.0, e, room, kappa, seed, roots)
    return e, found, free


@lean
def _slide_turn_turn(data, c, w, seed, arms):
    """Solve PRR: with g = A^-1 c and n = R^T e_z, g - x n is p turned by y about z."""
    p = circle(data, w)
    k = at.FIRST
    nx, ny, nz = data[k + 8], data[k + 9], data[k + 10]
    gx, gy, gz = _back(data, k, c[0], c[1], c[2])
    beta = -(gx * nx + gy * ny + gz * nz)
    q = squared_length(p[0], p[1], p[2])
    gamma = (gx * gx + gy * gy + gz * gz - q[0], -q[1], -q[2])
    delta = (gz - p[2][0], -p[2][1], -p[2][2])
    roots = scratch(7, 2)
    e, found, is_free = _slide_and_angle(data, (beta, 0.0, 0.0), gamma, delta, -nz, seed[2], roots)
    split = data[at.EQUATIONS] == 1.0
    aside = abs(nx * gy - ny * gx)
    count = 0
    for i in range(found):
        cosz, sinz = roots[i, 0], roots[i, 1]
        px, py = value(p[0], cosz, sinz), value(p[1], cosz, sinz)
        room = beta * beta - value(gamma, cosz, sinz)
        radius = math.sqrt(px * px + py * py)
        if split:
            room = (radius - aside) * (radius + aside)
        signs, h = across(data, split, value(e, cosz, sinz), -nz, room, radius * radius)
        for _ in range(signs):
            x = h - beta
            cosy, siny, any_y = turn_to(px, py, gx - x * nx, gy - x * ny, seed[1])
            enter_slide(arms[count], 0, x)
            enter_turn(arms[count], 1, cosy, siny)
            enter_turn(arms[count], 2, cosz, sinz)
            arms[count, FREE] = (FREE_2 if any_y else 0) + (FREE_3 if is_free else 0)
            count += 1
            h = -h
    return count


@lean
def _turned(data, j, p):
    """Return the component of A p whose row of A starts at j, as a form."""
    constant, cosine, sine = mixed((data[j], data[j + 1], data[j + 2]), p[0], p[1], p[2])
    return constant + data[j + 3], cosine, sine


@lean
def _turn_slide_turn(data, c, w, seed, arms):
    """Solve RPR: with v = A p and m = R e_z, v + y m turned by x about z is c."""
    p = circle(data, w)
    k = at.FIRST
    mx, my, mz = data[k + 2], data[k + 6], data[k + 10]
    vx, vy, vz = _turned(data, k, p), _turned(data, k + 4, p), _turned(data, k + 8, p)
    beta = mixed((mx, my, mz), vx, vy, vz)
    q = squared_length(vx, vy, vz)
    gamma = (q[0] - c[0] * c[0] - c[1] * c[1] - c[2] * c[2], q[1], q[2])
    roots = scratch(7, 2)
    e, found, is_free = _slide_and_angle(
        data, beta, gamma, (vz[0] - c[2], vz[1], vz[2]), mz, seed[2], roots
    )
    split = data[at.EQUATIONS] == 1.0
    radius = math.sqrt(c[0] * c[0] + c[1] * c[1])
    count = 0
    for i in range(found):
        cosz, sinz = roots[i, 0], roots[i, 1]
        ux, uy = value(vx, cosz, sinz), value(vy, cosz, sinz)
        b = value(beta, cosz, sinz)
        room = b * b - value(gamma, cosz, sinz)
        if split:
            aside = abs(mx * uy - my * ux)
            room = (radius - aside) * (radius + aside)
        signs, h = across(data, split, value(e, cosz, sinz), mz, room, radius * radius)
        for _ in range(signs):
            y = h - b
            cosx, sinx, any_x = turn_to(ux + y * mx, uy + y * my, c[0], c[1], seed[0])
            enter_turn(arms[count], 0, cosx, sinx)
            enter_slide(arms[count], 1, y)
            enter_turn(arms[count], 2, cosz, sinz)
            arms[count, FREE] = (FREE_1 if any_x else 0) + (FREE_3 if is_free else 0)
            count += 1
            h = -h
    return count


@lean
def _second_slide(data):
    """Return the direction of the third joint's slide in the frame of joint 1."""
    slide = data[at.SECOND + 2], data[at.SECOND + 6], data[at.SECOND + 10]
    return rotated(data, at.FIRST, slide)


@lean
def _turn_slide_slide(data, c, w, seed, arms):
    """Solve RPP: c turned back by x lies in the plane that the slides span."""
    k = at.FIRST
    ax, ay, az = data[k + 2], data[k + 6], data[k + 10]
    bx, by, bz = _second_slide(data)
    nx, ny, nz = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
    x0, y0, z0 = through(data, at.SECOND, w[0], w[1], w[2])
    x0, y0, z0 = through(data, k, x0, y0, z0)
    constant = nz * (c[2] - z0) - nx * x0 - ny * y0
    found, c1, s1, c2, s2 = order_one_roots(
        constant, nx * c[0] + ny * c[1], nx * c[1] - ny * c[0], data[at.SLACK]
    )
    free = found < 0
    if free:
        found, c1, s1 = 1, math.cos(seed[0]), math.sin(seed[0])
    inverse = 1.0 / (nx * nx + ny * ny + nz * nz)
    for i in range(found):
        cosx = c1 if i == 0 else c2
        sinx = s1 if i == 0 else s2
        dx = cosx * c[0] + sinx * c[1] - x0
        dy = cosx * c[1] - sinx * c[0] - y0
        dz = c[2] - z0
        # Components along the slides a and b by the cross products with the normal.
        ex, ey, ez = (dy * nz - dz * ny), (dz * nx - dx * nz), (dx * ny - dy * nx)
        enter_turn(arms[i], 0, cosx, sinx)
        enter_slide(arms[i], 1, -(bx * ex + by * ey + bz * ez) * inverse)
        enter_slide(arms[i], 2, (ax * ex + ay * ey + az * ez) * inverse)
        arms[i, FREE] = FREE_1 if free else 0
    return found


@lean
def _slide_turn_slide(data, c, w, seed, arms):
    """Solve PRP: g - x n and p + z m have the same height and the same length."""
    k = at.FIRST
    nx, ny, nz = data[k + 8], data[k + 9], data[k + 10]
    gx, gy, gz = _back(data, k, c[0], c[1], c[2])
    mx, my, mz = data[at.SECOND + 2], data[at.SECOND + 6], data[at.SECOND + 10]
    px, py, pz = through(data, at.SECOND, w[0], w[1], w[2])
    # The heights: a line in the plane of (x, z), through (x0, z0) along (u, v).
    norm = nz * nz + mz * mz
    x0, z0 = (gz - pz) * nz / norm, (gz - pz) * mz / norm
    root = math.sqrt(norm)
    u, v = -mz / root, nz / root
    gn = gx * nx + gy * ny + gz * nz
    pm = px * mx + py * my + pz * mz
    constant = gx * gx + gy * gy + gz * gz - px * px - py * py - pz * pz
    constant += x0 * x0 - z0 * z0 - 2.0 * (x0 * gn + z0 * pm)
    found, t1, t2 = quadratic_roots(
        u * u - v * v, u * (x0 - gn) - v * (z0 + pm), constant, data[at.SLACK]
    )
    free = found < 0
    if free:
        found = 1
        t1 = (seed[0] - x0) / u if abs(u) > abs(v) else (seed[2] - z0) / v
    for i in range(found):
        t = t1 if i == 0 else t2
        x = x0 + u * t
        z = z0 + v * t
        cosy, siny, any_y = turn_to(px + z * mx, py + z * my, gx - x * nx, gy - x * ny, seed[1])
        enter_slide(arms[i], 0, x)
        enter_turn(arms[i], 1, cosy, siny)
        enter_slide(arms[i], 2, z)
        arms[i, FREE] = (FREE_2 if any_y else 0) + (FREE_1 if free else 0)
    return found


@lean
def _slides(data, c, w, arms):
    """Solve PPP: three linear equations."""
    x, y, z = through(data, at.SECOND, w[0], w[1], w[2])
    x, y, z = through(data, at.FIRST, x, y, z)
    x, y, z = c[0] - x, c[1] - y, c[2] - z
    for i in range(3):
        k = at.SLIDE_INVERSE + 3 * i
        enter_slide(arms[0], i, data[k] * x + data[k + 1] * y + data[k + 2] * z)
    arms[0, FREE] = 0
    return 1


@lean_part(i8(IN1, F3, F3, F3, OUT2))
def prismatic_arm(data, c, w, seed, arms):
    """Write candidates for the three joints to ``arms``; return their number.

    Arguments are those of :func:`arm_revolute.revolute_arm`; slides are in units of SIZE.
    """
    kind = data[at.KIND]
    if kind == at.SLIDE_TURN_TURN:
        return _slide_turn_turn(data, c, w, seed, arms)
    if kind == at.TURN_SLIDE_TURN:
        return _turn_slide_turn(data, c, w, seed, arms)
    if kind == at.TURN_SLIDE_SLIDE:
        return _turn_slide_slide(data, c, w, seed, arms)
    if kind == at.SLIDE_TURN_SLIDE:
        return _slide_turn_slide(data, c, w, seed, arms)
    return _slides(data, c, w, arms)
