"""Arcs of the self-motion of an arm with a spherical shoulder, and how far they go within a step.

Axes 1 to 3 meet in the shoulder, axes 5 and 6 in another point, which joint 7, the parameter t,
moves along a circle.  With v(t) from that point to the shoulder, in the axes of the link between
joints 6 and 7, and u(q_4) the same in the axes of the link between joints 4 and 5,

    Rz(q_5) R_5 Rz(q_6) v(t) = u(q_4)

gives q_4 from the length, q_6 from the component along axis 5, and q_5; the rotation that is left
gives joints 1 to 3.  That makes up to eight postures, and eight arcs where none of the roots
vanishes.  The rates of all joints along an arc follow from the same vectors.  How much each of
these can change in an interval of t is known, hence how much the rates can, and the joints.
"""

import math

from robomech_ros._kernels.algebra.angles import angle_of
from robomech_ros._kernels.compiling.jit import flat, inline, lean
from robomech_ros._kernels.inverse.redundant import layout as at
from robomech_ros._kernels.inverse.redundant.arc_layout import (
    ACROSS,
    ANGLE,
    BEND,
    BEND_REACH,
    BEYOND,
    BEYOND_BOW,
    BEYOND_RATE,
    COSINE,
    COSINE_6,
    COSINE_6_REACH,
    COSINES,
    DU,
    DV,
    DV_ACROSS,
    DV_CHANGE,
    EMPTY,
    FAR,
    FAR_OFF,
    FAR_OFF_BOW,
    FAR_OFF_RATE,
    IRREGULAR,
    LENGTH2,
    MOVED,
    NEAREST,
    RADIUS,
    RATE,
    RATE2,
    RATE_4,
    RATE_6,
    REACH,
    REGULAR,
    SHOULDER,
    SINE,
    SINES,
    SPREAD,
    SPREAD_4,
    SQUARE,
    TURNED,
    Q,
    U,
    V,
)
from robomech_ros._kernels.inverse.redundant.narrowing import is_beyond
from robomech_ros._kernels.inverse.redundant.vectors import about_z, back, dot, turned

_TURN = 2.0 * math.pi

__all__ = ["bend_elbow", "last_joints", "prepare", "start_level"]


@lean
def prepare(arm, T, pose):
    """Write what stays the same for the pose T (4, 4) to ``pose`` (POSE,)."""
    packed, parts = arm
    d = (
        parts[at.ARC_SHOULDER] - T[0, 3],
        parts[at.ARC_SHOULDER + 1] - T[1, 3],
        parts[at.ARC_SHOULDER + 2] - T[2, 3],
    )
    d = (
        T[0, 0] * d[0] + T[1, 0] * d[1] + T[2, 0] * d[2],
        T[0, 1] * d[0] + T[1, 1] * d[1] + T[2, 1] * d[2],
        T[0, 2] * d[0] + T[1, 2] * d[1] + T[2, 2] * d[2],
    )
    m = turned(packed, 7, d)
    m = m[0] + packed[7, 10], m[1] + packed[7, 11], m[2] + packed[7, 12]
    for i in range(3):
        pose[SHOULDER + i] = m[i]
        column = turned(packed, 7, (T[i, 0], T[i, 1], T[i, 2]))
        for j in range(3):
            pose[TURNED + 3 * j + i] = column[j]
    # v = R_6 Rz(t) m + o, with o from the point on axis 6 to the origin of joint 7.
    o = packed[6, 10], packed[6, 11], packed[6, 12] - parts[at.ARC_HEIGHT_6]
    x, y, z = back(packed, 6, o)
    pose[SQUARE] = dot(o, o) + dot(m, m) + 2.0 * z * m[2]
    pose[SQUARE + 1] = 2.0 * (x * m[0] + y * m[1])
    pose[SQUARE + 2] = 2.0 * (y * m[0] - x * m[1])
    pose[RADIUS] = math.sqrt(m[0] * m[0] + m[1] * m[1])


@lean
def start_level(arm, pose, t, h, level):
    """Write v and its derivative at t, and what joint 4 does within h, to ``level`` (LEVEL,).

    Returns whether there may be postures.
    """
    packed, parts = arm
    c, s = math.cos(t), math.sin(t)
    m = pose[SHOULDER], pose[SHOULDER + 1], pose[SHOULDER + 2]
    v = turned(packed, 6, about_z(c, s, m))
    v = (
        v[0] + packed[6, 10],
        v[1] + packed[6, 11],
        v[2] + packed[6, 12] - parts[at.ARC_HEIGHT_6],
    )
    e = turned(packed, 6, (-s * m[0] - c * m[1], c * m[0] - s * m[1], 0.0))
    for i in range(3):
        level[V + i], level[DV + i] = v[i], e[i]
    level[LENGTH2] = dot(v, v)
    level[RATE2] = dot(v, e)
    level[ACROSS] = math.sqrt(v[0] * v[0] + v[1] * v[1])
    level[ANGLE] = angle_of(v[1], v[0])
    level[DV_ACROSS] = math.sqrt(e[0] * e[0] + e[1] * e[1])
    level[DV_CHANGE] = pose[RADIUS] * h
    level[COSINE], level[SINE] = c, s
    # The length gives joint 4.
    amplitude = parts[at.ARC_AMPLITUDE]
    change = 0.5 * math.sqrt(pose[SQUARE + 1] ** 2 + pose[SQUARE + 2] ** 2)
    x = (level[LENGTH2] - parts[at.ARC_CONSTANT]) / amplitude
    dx = (2.0 * abs(level[RATE2]) + change * h) * h / amplitude
    level[FAR_OFF], level[FAR_OFF_BOW] = abs(x) - 1.0, change / amplitude
    level[FAR_OFF_RATE] = math.copysign(2.0, x) * level[RATE2] / amplitude
    level[BEND], level[BEND_REACH] = _around(x, dx)
    return abs(x) - dx <= 1.0


@inline
def _least_cosine(x):
    return math.acos(min(max(x, -1.0), 1.0))


@inline
def _around(x, dx):
    """Angle whose cosine is x, and how far it can be from that where x is off by dx at most."""
    middle = _least_cosine(x)
    if abs(x) + dx < 1.0:
        # It goes farther on the side of the nearer end.
        return middle, abs(_least_cosine(x + math.copysign(dx, x)) - middle)
    return middle, max(_least_cosine(x - dx) - middle, middle - _least_cosine(x + dx))


@lean
def bend_elbow(arm, pose, level, h, elbow, fold, arc):
    """Write joint 4, and what it does within h, to ``arc`` (ARC,).

    What follows for both arcs with this bend goes to ``fold`` (FOLD,); ``elbow`` is 1.0 or -1.0.
    """
    packed, parts = arm
    q4 = parts[at.ARC_PHASE] + elbow * level[BEND]
    c, s = math.cos(q4), math.sin(q4)
    arc[COSINES], arc[SINES] = c, s
    k = parts[at.ARC_ELBOW], parts[at.ARC_ELBOW + 1], parts[at.ARC_ELBOW + 2]
    x4 = about_z(c, -s, k)
    u = back(packed, 4, (x4[0] - packed[4, 10], x4[1] - packed[4, 11], x4[2] - packed[4, 12]))
    f = back(packed, 4, (x4[1], -x4[0], 0.0))
    u = u[0], u[1], u[2] - parts[at.ARC_HEIGHT_5]
    fold[U], fold[U + 1], fold[U + 2] = u
    fold[DU], fold[DU + 1], fold[DU + 2] = f
    slope, half, d4 = dot(u, f), 0.5 * parts[at.ARC_AMPLITUDE], level[BEND_REACH]
    room = abs(slope) - half * d4
    fold[SPREAD_4] = -1.0
    if room > 0.0:
        rate = level[RATE2] / slope
        bend = 0.5 * math.sqrt(pose[SQUARE + 1] ** 2 + pose[SQUARE + 2] ** 2)
        spread = (bend * h + abs(rate) * half * d4) / room
        d4 = min(d4, (abs(rate) + 0.5 * spread) * h)
        fold[RATE_4], fold[SPREAD_4] = rate, spread
        arc[RATE + 3], arc[SPREAD + 3] = rate, spread
    arc[Q + 3], arc[REACH + 3] = q4, d4
    _bound_sixth(arm, pose, level, h, d4, fold)


@flat
def _bound_sixth(arm, pose, level, h, d4, fold):
    """Write the cosine that gives joint 6, from the component along axis 5, and what it does."""
    packed, parts = arm
    x, y, z = packed[5, 7], packed[5, 8], packed[5, 9]
    sine, across = math.sqrt(x * x + y * y), level[ACROSS]
    moved = (level[DV_ACROSS] + level[DV_CHANGE]) * h
    least = across - moved
    fold[MOVED], fold[NEAREST] = moved, least
    along = fold[U + 2] - z * level[V + 2]
    y = along / (sine * across)
    height = abs(fold[DU + 2])
    change = (height + 0.5 * parts[at.ARC_RADIUS] * d4) * d4
    change += abs(z) * (abs(level[DV + 2]) + 0.5 * level[DV_CHANGE]) * h
    dy = (change / sine + abs(y) * moved) / least
    fold[BEYOND], fold[BEYOND_RATE] = abs(along) - sine * across, 0.0
    fold[BEYOND_BOW], fold[RATE_6] = math.inf, 0.0
    if fold[SPREAD_4] >= 0.0 and least > 0.0:
        rate = fold[RATE_4] * fold[DU + 2] - z * level[DV + 2]
        aside = (level[V] * level[DV] + level[V + 1] * level[DV + 1]) / across
        # How much the rates of both change, over the time, and half of that.
        spread = fold[SPREAD_4] * height + abs(z) * level[DV_CHANGE]
        spread += (abs(fold[RATE_4]) + fold[SPREAD_4]) * parts[at.ARC_RADIUS] * d4
        fastest = level[DV_ACROSS] + level[DV_CHANGE]
        bow = 0.5 * (fastest * fastest / least + pose[RADIUS])
        own = 0.5 * spread / h if h > 0.0 else 0.0
        fold[BEYOND_RATE] = math.copysign(rate, rate * along) - sine * aside
        fold[BEYOND_BOW] = own + sine * bow
        rate -= y * sine * aside
        fold[RATE_6] = rate / (sine * across)
        dy = min(dy, (abs(rate) + (own + abs(y) * sine * bow) * h) * h / (sine * least))
    elif abs(along) - change > sine * (across + moved):
        # It is nowhere.
        fold[BEYOND_BOW] = -1.0
    fold[COSINE_6], fold[COSINE_6_REACH] = y, dy


@lean
def last_joints(arm, pose, level, t, h, side, fold, box, arc):
    """Write joints 5 to 7 of an arc at t, and what they do within h, to ``arc`` (ARC,).

    ``side`` is 1.0 or -1.0.  Returns EMPTY where there is no arc.
    """
    packed, _ = arm
    arc[Q + 6], arc[RATE + 6], arc[SPREAD + 6], arc[REACH + 6] = t, 1.0, 0.0, h
    across, y, dy = fold[NEAREST], fold[COSINE_6], fold[COSINE_6_REACH]
    if across <= 0.0:
        return _anywhere(arc)
    if abs(y) - dy > 1.0:
        return EMPTY
    row = packed[5, 7], packed[5, 8]
    angle, d6 = _around(y, dy)
    q6, d6 = angle_of(row[1], row[0]) - level[ANGLE] + side * angle, d6 + fold[MOVED] / across
    arc[COSINES + 3], arc[SINES + 3] = level[COSINE], level[SINE]
    arc[Q + 5], arc[REACH + 5] = q6, d6
    if is_beyond(5, arc, box):
        return EMPTY
    if abs(y) + dy < 1.0:
        _enter_fifth(packed, level, fold, arc)
        if _last_rates(arm, pose, level, h, fold, arc):
            return REGULAR
    arc[Q + 5], arc[REACH + 5] = _left_by(box, q6, d6)
    if arc[REACH + 5] < 0.0:
        return EMPTY
    across = _enter_fifth(packed, level, fold, arc)
    return _last_reach(arm, level, fold, across, arc)


@flat
def _left_by(box, q6, d6):
    """Give the middle of what the box leaves of joint 6, and half of that, less than 0 if none."""
    middle, half = 0.5 * (box[5] + box[12]), 0.5 * (box[12] - box[5])
    if half + d6 >= math.pi:
        return q6, d6
    x = q6 - middle
    x -= _TURN * math.floor(x / _TURN + 0.5)
    low, high = max(x - d6, -half), min(x + d6, half)
    return middle + 0.5 * (low + high), 0.5 * (high - low)


@flat
def _enter_fifth(packed, level, fold, arc):
    """Write joint 5, from what joint 6 leaves; return how far the shoulder is from its axis."""
    v = level[V], level[V + 1], level[V + 2]
    c, s = math.cos(arc[Q + 5]), math.sin(arc[Q + 5])
    arc[COSINES + 2], arc[SINES + 2] = c, s
    w = turned(packed, 5, about_z(c, s, v))
    # Cosine and sine of the angle from w to u about axis 5.
    c, s = fold[U] * w[0] + fold[U + 1] * w[1], fold[U + 1] * w[0] - fold[U] * w[1]
    arc[Q + 4] = angle_of(s, c)
    size = math.sqrt(c * c + s * s)
    inverse = 1.0 / size if size > 0.0 else 0.0
    arc[COSINES + 1], arc[SINES + 1] = c * inverse, s * inverse
    return math.sqrt(w[0] * w[0] + w[1] * w[1])


@inline
def _anywhere(arc):
    """Give up: joints 5 and 6 may be anywhere."""
    arc[Q + 4] = arc[Q + 5] = 0.0
    arc[REACH + 4] = arc[REACH + 5] = FAR
    return IRREGULAR


@flat
def _last_reach(arm, level, fold, across, arc):
    """Write how far joint 5 goes where rates have no bound."""
    _, parts = arm
    off = parts[at.ARC_RADIUS] * arc[REACH + 3]
    away = level[DV_CHANGE] + level[ACROSS] * arc[REACH + 5]
    aside = math.sqrt(fold[U] * fold[U] + fold[U + 1] * fold[U + 1])
    arc[REACH + 4] = FAR
    if off < aside and away < across:
        arc[REACH + 4] = math.asin(off / aside) + math.asin(away / across)
    return IRREGULAR


@flat
def _last_rates(arm, pose, level, h, fold, arc):
    """Write the rates of joints 4 to 6 and their spread; False where they have no bound."""
    packed, parts = arm
    f = fold[DU], fold[DU + 1], fold[DU + 2]
    d4, rate4, spread4 = arc[REACH + 3], fold[RATE_4], fold[SPREAD_4]
    if spread4 < 0.0:
        return False
    # Axis 5 in the axes of the link before joint 7, axis 6 in those behind joint 4.
    c, s = arc[COSINES + 2], arc[SINES + 2]
    z5 = about_z(c, -s, (packed[5, 7], packed[5, 8], packed[5, 9]))
    c, s = arc[COSINES + 1], arc[SINES + 1]
    z6 = about_z(c, s, (packed[5, 3], packed[5, 6], packed[5, 9]))
    v = level[V], level[V + 1], level[V + 2]
    e = level[DV], level[DV + 1], level[DV + 2]
    determinant = z5[1] * v[0] - z5[0] * v[1]
    sine = math.sqrt(z5[0] * z5[0] + z5[1] * z5[1])
    radius, circle = parts[at.ARC_RADIUS], pose[RADIUS]
    rate6 = (rate4 * f[2] - dot(z5, e)) / determinant
    along = dot(z6, f)
    rate5 = (e[2] - rate4 * along) / determinant
    d6 = arc[REACH + 5]
    spread6 = 0.0
    for _ in range(2):
        change = sine * (level[ACROSS] * d6 + fold[MOVED])
        room = abs(determinant) - change
        if room <= 0.0:
            return False
        spread6 = (
            sine * level[DV_ACROSS] * d6
            + circle * h
            + spread4 * abs(f[2])
            + (abs(rate4) + spread4) * radius * d4
        )
        spread6 = (spread6 + abs(rate6) * change) / room
        d6 = min(d6, (abs(rate6) + 0.5 * spread6) * h)
    change = sine * (level[ACROSS] * d6 + fold[MOVED])
    room = abs(determinant) - change
    # The spread of joint 5's rate grows with how far it goes, which is its rate times h.
    fixed = circle * h + spread4 * abs(along) + (abs(rate4) + spread4) * radius * d4
    fixed = (fixed + abs(rate5) * change) / room
    growing = (abs(rate4) + spread4) * radius * sine / room
    if growing * h >= 1.8:
        return False
    d5 = h * (abs(rate5) + 0.5 * fixed) / (1.0 - 0.5 * growing * h)
    arc[RATE + 4], arc[SPREAD + 4], arc[REACH + 4] = rate5, fixed + growing * d5, d5
    arc[RATE + 5], arc[SPREAD + 5], arc[REACH + 5] = rate6, spread6, d6
    return True
