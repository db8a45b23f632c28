"""Which arm angles leave every joint where it may be, exactly.

With a spherical shoulder and wrist of axes at right angles the rotations of both, as functions of
the arm angle psi, have elements a + b cos psi + c sin psi.  The first and the last of three joints
are the angle of a vector of two of these, and the cosine of the middle one is one: it follows
Rz(x) Rx(90) Rz(y) Rx(90) Rz(z).  So a joint is within a range where one or two such forms have one
sign, which is an arc of the circle of psi; the arcs that all joints leave are what is left.
"""

import math

from robomech_ros._kernels.compiling.jit import inline, lean
from robomech_ros._kernels.inverse.redundant.arm_angle import (
    arm_triad,
    base_triad,
    elbows,
    left_for_wrist,
    parts_of,
    product_of,
    rows_of,
    to_wrist,
    upper_arm,
)

__all__ = ["ARCS_ROOM", "FORMS", "JOINT", "forms_of", "joint_4_fits", "keep_joints", "value_of"]

# Rows of the forms of one elbow: for the shoulder sin y times cos x, sin x, cos z and sin z, for
# positive sin y, -cos y, and the first two of the first column of the rotation; the same for the
# wrist; then the value of joint 4.
JOINT = 7
FORMS = 2 * JOINT + 1
# Arcs that are kept at most.
ARCS_ROOM = 24

_TURN = 2.0 * math.pi
# What rounding makes of a form.
_ROUNDING = 1e-14


@inline
def _write_column(shoulder, wrist, column, forms):
    """Write the elements of both rotations at one psi."""
    for k in range(2):
        Q = shoulder if k == 0 else wrist
        row = JOINT * k
        forms[row, column], forms[row + 1, column], forms[row + 4, column] = Q[2], Q[5], Q[8]
        forms[row + 2, column], forms[row + 3, column] = Q[6], -Q[7]
        forms[row + 5, column], forms[row + 6, column] = Q[0], Q[3]


@inline
def forms_of(data, T, forms):
    """Write the forms (2, FORMS, 3) of both elbows; return how many elbows there are."""
    packed, parts = parts_of(data)
    roots, (c1, s1, c2, s2), d = elbows(data, T)
    if roots == 0:
        return 0
    base = base_triad(parts, d)
    for root in range(roots):
        c, s = (c1, s1) if root == 0 else (c2, s2)
        arm = arm_triad(packed, parts, to_wrist(packed, parts, c, s))
        own = forms[root]
        for column in range(3):
            # At psi = 0, 90 and 180 degrees.
            cosine, sine = 1.0 - column, column % 2 * 1.0
            R = upper_arm(base, arm, cosine, sine)
            shoulder = product_of(rows_of(packed, 0), R)
            _write_column(shoulder, left_for_wrist(packed, T, R, c, s), column, own)
        for row in range(FORMS - 1):
            middle = 0.5 * (own[row, 0] + own[row, 2])
            own[row, 1], own[row, 2], own[row, 0] = (
                0.5 * (own[row, 0] - own[row, 2]),
                own[row, 1] - middle,
                middle,
            )
        own[FORMS - 1, 0] = math.atan2(s, c)
    return roots


@inline
def value_of(form, cosine, sine):
    """Give the value of a form (3,)."""
    return form[0] + form[1] * cosine + form[2] * sine


@lean
def _keep(arcs, count, middle, half, kept, n):
    """Append to ``kept`` what arcs have within half of a middle; return how many there are."""
    for k in range(count):
        if half >= math.pi:
            if n < ARCS_ROOM:
                kept[n, 0], kept[n, 1] = arcs[k, 0], arcs[k, 1]
                n += 1
            continue
        away = middle - arcs[k, 0]
        away -= _TURN * math.floor(away / _TURN + 0.5)
        for turns in range(-1, 2):
            low = max(-arcs[k, 1], away + turns * _TURN - half)
            high = min(arcs[k, 1], away + turns * _TURN + half)
            if low <= high and n < ARCS_ROOM:
                kept[n, 0] = arcs[k, 0] + 0.5 * (low + high)
                kept[n, 1] = 0.5 * (high - low)
                n += 1
    return n


@lean
def _keep_positive(arcs, count, a, b, c, kept, n):
    """Append what arcs have where a + b cos psi + c sin psi is not negative."""
    size, level = math.sqrt(b * b + c * c), a + _ROUNDING
    if level < -size:
        return n
    half = math.pi if level >= size else math.acos(-level / size)
    return _keep(arcs, count, math.atan2(c, b), half, kept, n)


@lean
def _keep_angle(x, y, sign, ends, arcs, count, spare, kept):
    """Keep of arcs where the angle of sign (x, y), two forms, is between two ends."""
    low, high = ends
    if high - low >= _TURN:
        return _keep(arcs, count, 0.0, math.pi, kept, 0)
    c, s = sign * math.cos(low), sign * math.sin(low)
    a1, b1, c1 = c * y[0] - s * x[0], c * y[1] - s * x[1], c * y[2] - s * x[2]
    c, s = sign * math.cos(high), sign * math.sin(high)
    a2, b2, c2 = s * x[0] - c * y[0], s * x[1] - c * y[1], s * x[2] - c * y[2]
    if high - low <= math.pi:
        n = _keep_positive(arcs, count, a1, b1, c1, spare, 0)
        return _keep_positive(spare, n, a2, b2, c2, kept, 0)
    # One or the other: the first, and where that is not the second.
    n = _keep_positive(arcs, count, a1, b1, c1, kept, 0)
    m = _keep_positive(arcs, count, -a1, -b1, -c1, spare, 0)
    return _keep_positive(spare, m, a2, b2, c2, kept, n)


@lean
def _keep_bend(cosine, sign, ends, arcs, count, spare, kept):
    """Keep of arcs where an angle of this sign, with the form as -cosine, is between two ends."""
    low, high = ends
    if high - low >= _TURN:
        return _keep(arcs, count, 0.0, math.pi, kept, 0)
    first, last = (low, high) if sign > 0.0 else (-high, -low)
    turns = _TURN * math.floor(first / _TURN)
    first, last = first - turns, last - turns
    n = 0
    for k in range(2):
        least, most = max(first - k * _TURN, 0.0), min(last - k * _TURN, math.pi)
        if least > most:
            continue
        m = _keep_positive(
            arcs,
            count,
            -math.cos(most) - cosine[0],
            -cosine[1],
            -cosine[2],
            spare,
            0,
        )
        n = _keep_positive(spare, m, math.cos(least) + cosine[0], cosine[1], cosine[2], kept, n)
    return n


@lean
def keep_joints(forms, angles, box, first, sign, arcs, count, rows):
    """Leave of arcs (n, 2), middles and halves of them, what three joints have in their ranges.

    They are those from ``first`` on, 0 or 4; ``box`` (14,) has their lower and upper ends, and
    ``sign`` is that of the sine of the middle one.  ``rows`` (3, ARCS_ROOM, 2) is working space;
    ``rows[0]`` has the arcs then.  Returns how many there are; as many as there is room for if
    they may not be all.
    """
    spare, kept, found = rows[1], rows[2], rows[0]
    row = JOINT * (first // 4)
    ends = box[first + 1] + angles[1], box[first + 8] + angles[1]
    n = _keep_bend(forms[row + 4], sign, ends, arcs, count, spare, kept)
    if n == 0:
        return 0
    ends = box[first] + angles[0], box[first + 7] + angles[0]
    n = _keep_angle(forms[row], forms[row + 1], sign, ends, kept, n, spare, found)
    if n == 0:
        return 0
    ends = box[first + 2] + angles[2], box[first + 9] + angles[2]
    n = _keep_angle(forms[row + 2], forms[row + 3], sign, ends, found, n, spare, kept)
    for k in range(n):
        found[k, 0], found[k, 1] = kept[k, 0], kept[k, 1]
    return n


@lean
def joint_4_fits(forms, box):
    """Tell whether joint 4 is in the box."""
    if box[10] - box[3] >= _TURN:
        return True
    away = forms[FORMS - 1, 0] - 0.5 * (box[3] + box[10])
    away -= _TURN * math.floor(away / _TURN + 0.5)
    return abs(away) <= 0.5 * (box[10] - box[3])
