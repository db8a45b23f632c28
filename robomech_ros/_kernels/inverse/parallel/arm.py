"""The remaining joints of an arm with three parallel axes, given the angles of axes a and 5."""

import math

from robomech_ros._kernels.algebra.angles import angle_of, wrapped
from robomech_ros._kernels.algebra.polynomials import DOUBLE_ROOT
from robomech_ros._kernels.compiling.jit import lean
from robomech_ros._kernels.inverse import branch_bits as bit
from robomech_ros._kernels.inverse.parallel import layout as at
from robomech_ros._kernels.inverse.parallel.pairs import z_in_frame_6
from robomech_ros._kernels.spatial.vectors import rotated
from robomech_ros._kernels.tolerances import NEAR_DOUBLE

# Below this (sine, or distance over size) a direction is only rounding, and the joint is free.
PARALLEL_FREE = 1e-10
# The same at a double root with skew axes 5 and 6, which has half of the digits.
PARALLEL_FREE_AT_FOLD = 1e-7

MAX_SOLUTIONS = 16


@lean
def _through_wrist(data, G, x, y, z, far, turns):
    """Transform a point (far = 1) or direction (far = 0) of frame 5 back through axes 5 and 6."""
    _, _, _, c5, s5, d5, c6, s6, d6 = turns
    x, y, z = c5 * x + s5 * y, c5 * y - s5 * x, z - far * d5
    cos56 = data[at.COS_56]
    sin56 = data[at.SIN_56]
    x, y, z = y - far * data[at.NORMAL_56], sin56 * z - cos56 * x, cos56 * z + sin56 * x
    x, y, z = c6 * x + s6 * y, c6 * y - s6 * x, z - far * d6
    return (
        G[0] * x + G[1] * y + G[2] * z + far * G[9],
        G[3] * x + G[4] * y + G[5] * z + far * G[10],
        G[6] * x + G[7] * y + G[8] * z + far * G[11],
    )


@lean
def in_frame_f(data, G, k, far, turns):
    """Return the point or direction at ``k`` of the data after the motion of the parallel axes.

    It is in F; ``k`` is POINT with far = 1, HEADING with far = 0.  ``turns`` are cosine, sine and
    displacement of axes a, 5 and 6.
    """
    x = data[k]
    y = data[k + 1]
    z = data[k + 2]
    ca, sa, da = turns[0], turns[1], turns[2]
    m = at.MIDDLE
    if data[at.ORDER] == at.AXIS_BEFORE:
        x, y, z = _through_wrist(data, G, x, y, z, far, turns)
        x, y, z = ca * x + sa * y, ca * y - sa * x, z - far * da
        x, y, z = rotated(data, m, (x, y, z))
        return x + far * data[m + 3], y + far * data[m + 7], z + far * data[m + 11]
    x, y, z = ca * x + sa * y, ca * y - sa * x, z - far * da
    x, y, z = rotated(data, m, (x, y, z))
    x, y, z = x + far * data[m + 3], y + far * data[m + 7], z + far * data[m + 11]
    return _through_wrist(data, G, x, y, z, far, turns)


@lean
def nearest_in_reach(data, circle, seed):
    """Choose the free angle nearest to ``seed`` within reach of the planar arm.

    The target point moves on a circle, given by its points (x, y) at 0, 90 and 180 degrees.
    Returns whether there is such an angle, and the angle.
    """
    c0x, c0y, c1x, c1y, c2x, c2y = circle
    mx = 0.5 * (c0x + c2x)
    my = 0.5 * (c0y + c2y)
    ax = c0x - mx
    ay = c0y - my
    bx = c1x - mx
    by = c1y - my
    level = mx * mx + my * my + 0.5 * (ax * ax + ay * ay + bx * bx + by * by)
    u = 2.0 * (mx * ax + my * ay)
    v = 2.0 * (mx * bx + my * by)
    l1 = data[at.LINK_1]
    l2 = data[at.LINK_2]
    most = (l1 + l2) * (l1 + l2)
    least = (l1 - l2) * (l1 - l2)
    slack = data[at.SLACK] * data[at.SIZE] * (l1 + l2)
    here = level + u * math.cos(seed) + v * math.sin(seed)
    if least - slack <= here <= most + slack:
        return True, seed
    bound = most if here > most else least
    amplitude = math.hypot(u, v)
    ratio = bound - level
    if abs(ratio) > amplitude:
        if abs(ratio) > amplitude + slack:
            return False, seed
        ratio = amplitude if ratio > 0.0 else -amplitude
    middle = math.atan2(v, u)
    half = math.acos(ratio / amplitude)
    one = wrapped(middle + half - seed)
    two = wrapped(middle - half - seed)
    return True, seed + (one if abs(one) <= abs(two) else two)


@lean
def arm_angles(data, px, py, heading, seed2, elbow):
    """Solve the planar arm for its last axis at (px, py) and x of F turned to ``heading``.

    Returns bits, the three angles about z and the remaining distance (m).  The bits are -1 if the
    point is out of reach or has no second solution.
    """
    l1 = data[at.LINK_1]
    l2 = data[at.LINK_2]
    slack = data[at.SLACK] * data[at.SIZE]
    reach = math.sqrt(px * px + py * py)
    beyond = max(reach - (l1 + l2), abs(l1 - l2) - reach)
    if beyond > slack:
        return -1, 0.0, 0.0, 0.0, beyond
    double = 2.0 * l1 * l2
    cosine = (reach * reach - l1 * l1 - l2 * l2) / double
    square = (l1 + l2 - reach) * (l1 + l2 + reach) * (reach - l1 + l2) * (reach + l1 - l2)
    # Near its fold the elbow is set on the fold, where its two solutions coincide: at half a turn
    # from a limit the square root of a rounding would put it outside.
    sine = math.sqrt(square) / double if square > DOUBLE_ROOT * double * double else 0.0
    bits = 0
    if sine < NEAR_DOUBLE:
        bits = bit.BOUNDARY
    sine = max(sine, data[at.ROOT_SPLIT])
    if elbow == 1 and sine == 0.0:
        return -1, 0.0, 0.0, 0.0, 0.0
    if elbow == 1:
        sine = -sine
    bend = angle_of(sine, cosine)
    if reach < slack:
        if elbow == 1:
            return -1, 0.0, 0.0, 0.0, 0.0
        bits = bit.ELBOW_SINGULAR
        first = seed2
    else:
        x = l1 + l2 * cosine
        y = l2 * sine
        first = angle_of(py * x - px * y, px * x + py * y)
    second = bend - data[at.BEND]
    third = heading - first - second
    return bits, first, second, third, max(beyond, 0.0)


@lean
def _turn_in_reach(data, G, seed, turns, six_free):
    """Choose the angle of axis 5 or 6 if it is free, parallel to the three axes."""
    ca, sa, da, c5, s5, d5, c6, s6, d6 = turns
    circle = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    for k in range(4):
        if k < 3:
            c = 1.0 - k
            s = k * (2.0 - k)
        else:
            joint = int(data[at.JOINTS + 5]) if six_free else int(data[at.JOINTS + 4])
            reached, angle = nearest_in_reach(data, circle, seed[joint])
            c = math.cos(angle)
            s = math.sin(angle)
        if six_free:
            turns = (ca, sa, da, c5, s5, d5, c, s, d6)
        else:
            turns = (ca, sa, da, c, s, d5, c6, s6, d6)
        x, y, _ = in_frame_f(data, G, at.POINT, 1.0, turns)
        circle = (circle[2], circle[3], circle[4], circle[5], x, y)
    return reached, turns


@lean
def wrist_turns(data, G, seed, pair):
    """Return the bits (-1: none) of a pair, the turns of axes a, 5 and 6, and the pair's error."""
    gamma = pair[2]
    v1 = pair[3]
    v2 = pair[4]
    bits = int(pair[7])
    sliding = data[at.SLIDING]
    # z required by the target (a) and z turned by axis 5 (b) must differ by a turn of axis 6 only.
    a1, a2, a3 = z_in_frame_6(data, G, pair[0], pair[1])
    b1 = v2
    b2 = data[at.SIN_56] * gamma - data[at.COS_56] * v1
    b3 = data[at.COS_56] * gamma + data[at.SIN_56] * v1
    na = math.sqrt(a1 * a1 + a2 * a2)
    nb = math.sqrt(b1 * b1 + b2 * b2)
    error = max(abs(na - nb), abs(a3 - b3))
    c6 = a1 * b1 + a2 * b2
    s6 = a1 * b2 - a2 * b1
    length = math.sqrt(c6 * c6 + s6 * s6)
    fold = bits & bit.BOUNDARY != 0 and data[at.KIND] == at.SKEW
    rounding = PARALLEL_FREE_AT_FOLD if fold else PARALLEL_FREE
    six_free = na < rounding or length == 0.0
    if six_free or sliding == at.SLIDE_6:
        c6, s6 = 1.0, 0.0
        six_free = sliding != at.SLIDE_6
    else:
        c6, s6 = c6 / length, s6 / length
    c5 = pair[5] * v1 + pair[6] * v2
    s5 = pair[6] * v1 - pair[5] * v2
    length = math.sqrt(c5 * c5 + s5 * s5)
    five_free = length < rounding * rounding
    if five_free or sliding == at.SLIDE_5:
        c5, s5 = 1.0, 0.0
        five_free = sliding != at.SLIDE_5
    else:
        c5, s5 = c5 / length, s5 / length
    da = pair[8] if sliding == at.SLIDE_A else 0.0
    d5 = pair[8] if sliding == at.SLIDE_5 else 0.0
    d6 = pair[8] if sliding == at.SLIDE_6 else 0.0
    turns = (pair[0], pair[1], da, c5, s5, d5, c6, s6, d6)
    if six_free or five_free:
        reached, turns = _turn_in_reach(data, G, seed, turns, six_free)
        bits = (bits & ~bit.BOUNDARY) | bit.WRIST_SINGULAR if reached else -1
    return bits, turns, error


@lean
def lack_of_reach(data, G, seed, pair):
    """Return the distance (m) of the planar arm from its target for a pair."""
    bits, turns, _ = wrist_turns(data, G, seed, pair)
    if bits < 0:
        return data[at.SIZE]
    px, py, _ = in_frame_f(data, G, at.POINT, 1.0, turns)
    reach = math.sqrt(px * px + py * py)
    l1 = data[at.LINK_1]
    l2 = data[at.LINK_2]
    return max(0.0, max(reach - (l1 + l2), abs(l1 - l2) - reach))


@lean
def _wrist_values(data, turns):
    """Return the joint values of axes a, 5 and 6."""
    ca, sa, da, c5, s5, d5, c6, s6, d6 = turns
    sliding = data[at.SLIDING]
    return (
        da if sliding == at.SLIDE_A else angle_of(sa, ca),
        d5 if sliding == at.SLIDE_5 else angle_of(s5, c5),
        d6 if sliding == at.SLIDE_6 else angle_of(s6, c6),
    )


@lean
def _enter(data, q, wrist, first, second, third):
    """Write the six joint values in the order of the joints."""
    q[int(data[at.JOINTS])] = wrist[0]
    q[int(data[at.JOINTS + 1])] = wrapped(first * data[at.SENSES])
    q[int(data[at.JOINTS + 2])] = wrapped(second * data[at.SENSES + 1])
    q[int(data[at.JOINTS + 3])] = wrapped(third * data[at.SENSES + 2])
    q[int(data[at.JOINTS + 4])] = wrist[1]
    q[int(data[at.JOINTS + 5])] = wrist[2]


@lean
def finish_pair(data, G, seed, pair, named, q, branch, errors, count):
    """Add the solutions of one pair (q_a, q_5) to q; return the number of solutions."""
    bits, turns, error = wrist_turns(data, G, seed, pair)
    if bits < 0:
        return count
    px, py, pz = in_frame_f(data, G, at.POINT, 1.0, turns)
    hx, hy, _ = in_frame_f(data, G, at.HEADING, 0.0, turns)
    error = max(error, abs(pz))
    heading = angle_of(hy, hx)
    wrist = _wrist_values(data, turns)
    seed2 = seed[int(data[at.JOINTS + 1])] * data[at.SENSES]
    for elbow in range(2):
        more, first, second, third, left = arm_angles(data, px, py, heading, seed2, elbow)
        if more < 0 or count >= MAX_SOLUTIONS:
            break
        _enter(data, q[count], wrist, first, second, third)
        if not named:
            branch[count] = bits | more | bit.ARM_NUMBERED | (count << bit.ARM_SHIFT)
        elif (elbow == 1) != (bits & bit.SHOULDER_RIGHT != 0):
            branch[count] = bits | more | bit.ELBOW_DOWN
        else:
            branch[count] = bits | more
        errors[count] = max(error, left)
        count += 1
    return count
