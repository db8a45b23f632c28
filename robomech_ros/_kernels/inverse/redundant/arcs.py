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

from robomech_ros._kernels.algebra.angles import angle_of, wrapped
from robomech_ros._kernels.compiling.jit import inline, lean, scratch
from robomech_ros._kernels.inverse.decoupled import layout as wrist_at
from robomech_ros._kernels.inverse.decoupled.wrist import spherical_wrist
from robomech_ros._kernels.inverse.redundant import layout as at
from robomech_ros._kernels.inverse.redundant.vectors import about_z, back, cross, dot, norm, turned
from robomech_ros._kernels.tolerances import ACCEPTED, PARALLEL_AXES

__all__ = [
    "EMPTY",
    "IRREGULAR",
    "REGULAR",
    "UNKNOWN",
    "enter_first",
    "first_joints",
    "last_joints",
    "prepare",
    "start_level",
]

# What is known of an arc in an interval: there is none; there is one with bounded rates; or only
# how far joints go is known.
UNKNOWN = -1
EMPTY = 0
REGULAR = 1
IRREGULAR = 2

# Constants of one pose: the shoulder behind joint 7, the rotation from the base to there.
SHOULDER = 0
TURNED = 3
SQUARE = 12  # of the length of v: constant, cosine and sine parts
RADIUS = 15  # of the circle of the shoulder about axis 7
POSE = 16

# At one t: v, dv/dt, the squared length and its half rate, length across axis 6 and its angle.
V = 0
DV = 3
LENGTH2 = 6
RATE2 = 7
ACROSS = 8
ANGLE = 9
DV_ACROSS = 10
DV_CHANGE = 11  # how far v moves at most
COSINE = 12  # of t
SINE = 13
BEND = 14  # angle of joint 4 from its middle, and how far that goes
BEND_REACH = 15
LEVEL = 16

# Along an arc: the joints, their rates, by how much rates change, and how far joints go.
Q = 0
RATE = 7
SPREAD = 14
REACH = 21
COSINES = 28  # of joints 4 to 7
SINES = 32
TURN = 36  # angular velocity of the upper arm in the base
TURN_CHANGE = 39  # by how much that changes, or where it has no bound, by how much the arm turns
AXIS_3 = 40  # in the base
ARC = 43

_FAR = 1e3


@lean
def prepare(arm, T, pose):
    """Write what stays the same for the pose T (4, 4) to ``pose`` (POSE,)."""
    packed = arm[: at.ARC_SHOULDER].reshape((8, 13))
    d = (
        arm[at.ARC_SHOULDER] - T[0, 3],
        arm[at.ARC_SHOULDER + 1] - T[1, 3],
        arm[at.ARC_SHOULDER + 2] - T[2, 3],
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
    o = packed[6, 10], packed[6, 11], packed[6, 12] - arm[at.ARC_HEIGHT_6]
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
    packed = arm[: at.ARC_SHOULDER].reshape((8, 13))
    c, s = math.cos(t), math.sin(t)
    m = pose[SHOULDER], pose[SHOULDER + 1], pose[SHOULDER + 2]
    v = turned(packed, 6, about_z(c, s, m))
    v = (
        v[0] + packed[6, 10],
        v[1] + packed[6, 11],
        v[2] + packed[6, 12] - arm[at.ARC_HEIGHT_6],
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
    amplitude = arm[at.ARC_AMPLITUDE]
    change = 0.5 * math.sqrt(pose[SQUARE + 1] ** 2 + pose[SQUARE + 2] ** 2)
    x = (level[LENGTH2] - arm[at.ARC_CONSTANT]) / amplitude
    dx = 2.0 * (abs(level[RATE2]) + change * h) * h / amplitude
    level[BEND], level[BEND_REACH] = _around(x, dx)
    return abs(x) - dx <= 1.0


@inline
def _least_cosine(x):
    return math.acos(min(max(x, -1.0), 1.0))


@inline
def _around(x, dx):
    """Angle whose cosine is x, and how far it can be from that where x is off by dx at most."""
    middle = _least_cosine(x)
    return middle, max(_least_cosine(x - dx) - middle, middle - _least_cosine(x + dx))


@lean
def last_joints(arm, pose, level, t, h, elbow, side, arc):
    """Write joints 4 to 7 of an arc at t, and what they do within h, to ``arc`` (ARC,).

    ``elbow`` and ``side`` are 1.0 or -1.0.  Returns EMPTY where there is no arc.
    """
    packed = arm[: at.ARC_SHOULDER].reshape((8, 13))
    d4 = level[BEND_REACH]
    q4 = arm[at.ARC_PHASE] + elbow * level[BEND]
    c, s = math.cos(q4), math.sin(q4)
    arc[COSINES], arc[SINES] = c, s
    k = arm[at.ARC_ELBOW], arm[at.ARC_ELBOW + 1], arm[at.ARC_ELBOW + 2]
    x4 = about_z(c, -s, k)
    u = back(packed, 4, (x4[0] - packed[4, 10], x4[1] - packed[4, 11], x4[2] - packed[4, 12]))
    u = u[0], u[1], u[2] - arm[at.ARC_HEIGHT_5]
    f = back(packed, 4, (x4[1], -x4[0], 0.0))
    arc[Q + 3], arc[REACH + 3] = q4, d4
    # Joint 6, from the component along axis 5.
    row = packed[5, 7], packed[5, 8], packed[5, 9]
    sine = math.sqrt(row[0] * row[0] + row[1] * row[1])
    radius = arm[at.ARC_RADIUS]
    moved = (level[DV_ACROSS] + level[DV_CHANGE]) * h
    across = level[ACROSS] - moved
    if across <= 0.0:
        return _anywhere(arc)
    y = (u[2] - row[2] * level[V + 2]) / (sine * level[ACROSS])
    dy = (abs(f[2]) + radius * d4) * d4
    dy += abs(row[2]) * (abs(level[DV + 2]) + level[DV_CHANGE]) * h
    dy = (dy / sine + abs(y) * moved) / across
    if abs(y) - dy > 1.0:
        return EMPTY
    regular = abs(y) + dy < 1.0
    angle, d6 = _around(y, dy)
    q6 = angle_of(row[1], row[0]) - level[ANGLE] + side * angle
    arc[Q + 5], arc[REACH + 5] = q6, d6 + moved / across
    arc[Q + 6], arc[RATE + 6], arc[SPREAD + 6], arc[REACH + 6] = t, 1.0, 0.0, h
    # Joint 5, from what is left.
    v = level[V], level[V + 1], level[V + 2]
    c, s = math.cos(q6), math.sin(q6)
    arc[COSINES + 2], arc[SINES + 2] = c, s
    arc[COSINES + 3], arc[SINES + 3] = level[COSINE], level[SINE]
    w = turned(packed, 5, about_z(c, s, v))
    # Cosine and sine of the angle from w to u about axis 5.
    c, s = u[0] * w[0] + u[1] * w[1], u[1] * w[0] - u[0] * w[1]
    arc[Q + 4] = angle_of(s, c)
    size = math.sqrt(c * c + s * s)
    inverse = 1.0 / size if size > 0.0 else 0.0
    arc[COSINES + 1], arc[SINES + 1] = c * inverse, s * inverse
    if regular and _last_rates(arm, pose, level, h, u, f, arc):
        return REGULAR
    return _last_reach(arm, level, u, w, arc)


@inline
def _anywhere(arc):
    """Give up: joints 5 and 6 may be anywhere."""
    arc[Q + 4] = arc[Q + 5] = 0.0
    arc[REACH + 4] = arc[REACH + 5] = _FAR
    return IRREGULAR


@lean
def _last_reach(arm, level, u, w, arc):
    """Write how far joint 5 goes where rates have no bound."""
    d4, d6 = arc[REACH + 3], arc[REACH + 5]
    across = math.sqrt(min(u[0] * u[0] + u[1] * u[1], w[0] * w[0] + w[1] * w[1]))
    off = arm[at.ARC_RADIUS] * d4
    away = level[DV_CHANGE] + math.sqrt(level[LENGTH2]) * d6
    arc[REACH + 4] = _FAR
    if max(off, away) < 0.5 * across:
        arc[REACH + 4] = off / (across - off) + away / (across - away)
    return IRREGULAR


@lean
def _last_rates(arm, pose, level, h, u, f, arc):
    """Write the rates of joints 4 to 6 and their spread; False where they have no bound."""
    packed = arm[: at.ARC_SHOULDER].reshape((8, 13))
    d4 = arc[REACH + 3]
    bend = 0.5 * math.sqrt(pose[SQUARE + 1] ** 2 + pose[SQUARE + 2] ** 2)
    half = 0.5 * arm[at.ARC_AMPLITUDE]
    slope = dot(u, f)
    room = abs(slope) - half * d4
    if room <= 0.0:
        return False
    rate4 = level[RATE2] / slope
    spread4 = (bend * h + abs(rate4) * half * d4) / room
    d4 = min(d4, (abs(rate4) + spread4) * h)
    # Axis 5 in the axes of the link before joint 7, axis 6 in those behind joint 4.
    c, s = arc[COSINES + 2], arc[SINES + 2]
    z5 = about_z(c, -s, (packed[5, 7], packed[5, 8], packed[5, 9]))
    c, s = arc[COSINES + 1], arc[SINES + 1]
    z6 = about_z(c, s, (packed[5, 3], packed[5, 6], packed[5, 9]))
    v = level[V], level[V + 1], level[V + 2]
    e = level[DV], level[DV + 1], level[DV + 2]
    determinant = z5[1] * v[0] - z5[0] * v[1]
    sine = math.sqrt(z5[0] * z5[0] + z5[1] * z5[1])
    radius, circle, length = arm[at.ARC_RADIUS], pose[RADIUS], math.sqrt(level[LENGTH2])
    rate6 = (rate4 * f[2] - dot(z5, e)) / determinant
    along = dot(z6, f)
    rate5 = (e[2] - rate4 * along) / determinant
    d6 = arc[REACH + 5]
    spread6 = 0.0
    for _ in range(2):
        change = sine * (length * d6 + circle * h)
        room = abs(determinant) - change
        if room <= 0.0:
            return False
        spread6 = circle * (d6 + h) + spread4 * abs(f[2]) + (abs(rate4) + spread4) * radius * d4
        spread6 = (spread6 + abs(rate6) * change) / room
        d6 = min(d6, (abs(rate6) + spread6) * h)
    change = sine * (length * d6 + circle * h)
    room = abs(determinant) - change
    # The spread of joint 5's rate grows with how far it goes, which is its rate times h.
    fixed = circle * h + spread4 * abs(along) + (abs(rate4) + spread4) * radius * d4
    fixed = (fixed + abs(rate5) * change) / room
    growing = (abs(rate4) + spread4) * radius * sine / room
    if growing * h >= 0.9:
        return False
    d5 = h * (abs(rate5) + fixed) / (1.0 - growing * h)
    arc[RATE + 3], arc[SPREAD + 3], arc[REACH + 3] = rate4, spread4, d4
    arc[RATE + 4], arc[SPREAD + 4], arc[REACH + 4] = rate5, fixed + growing * d5, d5
    arc[RATE + 5], arc[SPREAD + 5], arc[REACH + 5] = rate6, spread6, d6
    return True


@lean
def _upper_arm(arm, pose, arc, axes):
    """Write rotation base to upper arm, and axes 4 to 7 in the base, to ``axes`` (3, 7).

    The first three columns are the rotation.
    """
    packed = arm[: at.ARC_SHOULDER].reshape((8, 13))
    rotation = pose[TURNED : TURNED + 9].reshape((3, 3))
    for i in range(3):
        # The i-th axis of the base in those of the link before joint 7, and on to the upper arm.
        w = rotation[0, i], rotation[1, i], rotation[2, i]
        axes[i, 6] = w[2]
        for j in (6, 5, 4, 3):
            c, s = arc[COSINES + j - 3], arc[SINES + j - 3]
            w = turned(packed, j, about_z(c, s, w))
            axes[i, j - 1] = w[2]
        axes[i, 0], axes[i, 1] = w[0], w[1]
    return 0


@lean
def first_joints(arm, pose, status, h, arc, first):
    """Write joints 1 to 3 of both postures of the shoulder to ``first`` (2, 3).

    Also how the upper arm turns, to ``arc``.  Returns whether there are two postures.
    """
    packed = arm[: at.ARC_SHOULDER].reshape((8, 13))
    axes, turn = scratch(3, 7), scratch(9)
    _upper_arm(arm, pose, arc, axes)
    for i in range(3):
        v = back(packed, 0, (axes[0, i], axes[1, i], axes[2, i]))
        turn[i], turn[3 + i], turn[6 + i] = v
        arc[AXIS_3 + i] = axes[i, 2]
    shoulder = arm[at.ARC_WRIST - wrist_at.ANGLES :]
    count, _ = spherical_wrist(shoulder, turn, 0.0, ACCEPTED, PARALLEL_AXES, first)
    d4, d5, d6 = arc[REACH + 3], arc[REACH + 4], arc[REACH + 5]
    if status == REGULAR:
        r4, r5, r6 = arc[RATE + 3], arc[RATE + 4], arc[RATE + 5]
        for i in range(3):
            known = axes[i, 6] + axes[i, 5] * r6 + axes[i, 4] * r5 + axes[i, 3] * r4
            arc[TURN + i] = -known
        change = arc[SPREAD + 3] + arc[SPREAD + 4] + arc[SPREAD + 5]
        arc[TURN_CHANGE] = change + abs(r6) * h + abs(r5) * (h + d6) + abs(r4) * (h + d6 + d5)
    else:
        arc[TURN_CHANGE] = d4 + d5 + d6 + h
    return count == 2


@lean
def enter_first(arm, status, h, first, arc):
    """Write joints 1 to 3 to ``arc``, as ``first`` (3,) has them, and what they do within h.

    Returns the status, or UNKNOWN where the shoulder is too nearly singular to tell.
    """
    packed = arm[: at.ARC_SHOULDER].reshape((8, 13))
    for j in range(3):
        arc[Q + j] = wrapped(first[j] - arm[at.ARC_WRIST + j])
    turn = arc[TURN_CHANGE]
    if status == REGULAR:
        turn += norm((arc[TURN], arc[TURN + 1], arc[TURN + 2]))
        turn *= h
    arc[REACH] = arc[REACH + 2] = _FAR
    # At right angles, joint 2 turns no more than the arm.
    right = arm[at.ARC_RIGHT] == 0.0 and arm[at.ARC_RIGHT + 2] == 0.0
    arc[REACH + 1] = turn if right else _FAR
    # Axes 1 to 3 in the base.
    z1 = packed[0, 3], packed[0, 6], packed[0, 9]
    w = packed[1, 3], packed[1, 6], packed[1, 9]
    z2 = turned(packed, 0, about_z(math.cos(arc[Q]), math.sin(arc[Q]), w))
    z3 = arc[AXIS_3], arc[AXIS_3 + 1], arc[AXIS_3 + 2]
    return status if _first_rates(z1, z2, z3, status, h, arc) else UNKNOWN


@lean
def _first_rates(z1, z2, z3, status, h, arc):
    """Write rates of joints 1 to 3 and how far they go; False where that has no bound."""
    turn = arc[TURN], arc[TURN + 1], arc[TURN + 2]
    change = arc[TURN_CHANGE]
    n12, n23, n31 = cross(z1, z2), cross(z2, z3), cross(z3, z1)
    s12, s23 = norm(n12), norm(n23)
    determinant = dot(z1, n23)
    size = abs(determinant)
    if status != REGULAR:
        # The whole turn, taken as a rate that lasts for one.
        room = size * size - 4.0 * change
        if room <= 0.0:
            return False
        d2 = 0.5 * (size - math.sqrt(room))
        arc[REACH + 1] = d2
        arc[REACH] = change * s23 / (size - d2)
        arc[REACH + 2] = change * s12 / (size - d2)
        return True
    if determinant == 0.0:
        return False
    r1 = dot(turn, n23) / determinant
    r2 = dot(turn, n31) / determinant
    r3 = dot(turn, n12) / determinant
    speed = norm(turn)
    d1, d2 = 1.2 * abs(r1) * h, 1.2 * abs(r2) * h
    for _ in range(5):
        room = size - d2
        if room <= 0.3 * size:
            return False
        x1 = (change * s23 + speed * (d1 + d2) * s23 + abs(r1) * d2) / room
        x2 = (change + speed * (speed + change) * h + abs(r2) * d2) / room
        x3 = (change * s12 + speed * d1 * s12 + abs(r3) * d2) / room
        e1, e2 = (abs(r1) + x1) * h, (abs(r2) + x2) * h
        if e1 <= d1 and e2 <= d2:
            arc[RATE], arc[SPREAD], arc[REACH] = r1, x1, e1
            arc[RATE + 1], arc[SPREAD + 1], arc[REACH + 1] = r2, x2, e2
            arc[RATE + 2], arc[SPREAD + 2], arc[REACH + 2] = r3, x3, (abs(r3) + x3) * h
            return True
        d1, d2 = 1.1 * max(d1, e1), 1.1 * max(d2, e2)
    return False
