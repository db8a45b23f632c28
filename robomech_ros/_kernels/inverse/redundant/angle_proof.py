"""The nearest posture of an arm with an arm angle, with a proof that there is no nearer one.

Each joint leaves some arcs of the arm angle, exactly, in which it may be near enough to the seed
and inside its limits.  By the largest move of a joint, the nearest posture known is the nearest of
all where nothing is left; by the root of squares, what is left is halved until the rates of the
joints, and by how much they can change in an interval, exclude it.
"""

import math

from numba import types

from robomech_ros._kernels.algebra.angles import wrapped
from robomech_ros._kernels.compiling.jit import (
    IN1,
    IN2,
    OUT1,
    b1,
    f8,
    i8,
    lean,
    part,
    scratch,
)
from robomech_ros._kernels.inverse.ranking import LINF, distance_from, place
from robomech_ros._kernels.inverse.redundant import layout as at
from robomech_ros._kernels.inverse.redundant.angle_cuts import (
    ARCS_ROOM,
    FORMS,
    JOINT,
    forms_of,
    joint_4_fits,
    keep_joints,
    value_of,
)
from robomech_ros._kernels.inverse.redundant.arc_layout import ARC, RATE, REACH, SPREAD, Q
from robomech_ros._kernels.inverse.redundant.arm_angle import parts_of
from robomech_ros._kernels.inverse.redundant.narrowing import (
    NEARER_BY,
    enclose,
    narrow_squares,
    whole,
)
from robomech_ros._kernels.inverse.redundant.nearest import best_step

__all__ = ["prove_by_angle"]

# So often a nearer posture is looked for.
ANGLE_TRIES = 60
# Steps along a self-motion from a posture that is nearer than any before, and the shortest (rad).
ANGLE_STEPS = 12
ANGLE_SHORTEST = 1e-9
# The sine of joint 2 or 6 below which that is nearly singular.
ANGLE_NEARLY = 1e-3
# Intervals that are looked at, and that wait, at most.
ANGLE_INTERVALS = 600
ANGLE_WAITING = 160


@lean
def _three(form, angles, first, sign, c, s, h, arc):
    """Write three joints of a spherical one, their rates and how much these change, at psi.

    ``c`` and ``s`` are its cosine and sine; ``form`` (JOINT, 3) as `forms_of` has it.  Returns
    False where the rates have no bound within h.
    """
    x0, y0 = value_of(form[0], c, s), value_of(form[1], c, s)
    x2, y2 = value_of(form[2], c, s), value_of(form[3], c, s)
    across = math.sqrt(x0 * x0 + y0 * y0)
    cosine = -value_of(form[4], c, s)
    x, z = math.atan2(sign * y0, sign * x0), math.atan2(sign * y2, sign * x2)
    if across < ANGLE_NEARLY:
        # Where x is badly determined z follows from it, so that both make up the rotation.
        u, w = value_of(form[5], c, s), value_of(form[6], c, s)
        cx, sx = math.cos(x), math.sin(x)
        z = math.atan2(sx * u - cx * w, cosine * (cx * u + sx * w) + sign * across * x2)
    arc[Q + first] = wrapped(x - angles[0])
    arc[Q + first + 1] = wrapped(sign * math.atan2(across, cosine) - angles[1])
    arc[Q + first + 2] = wrapped(z - angles[2])
    if across <= 0.0:
        return False
    inverse = 1.0 / (across * across)
    regular = True
    for k in range(2):
        x, y = (x0, y0) if k == 0 else (x2, y2)
        a, b = form[2 * k], form[2 * k + 1]
        dx, dy = a[2] * c - a[1] * s, b[2] * c - b[1] * s
        # The largest rate of the vector, which is also that of its rate, and that within h.
        half = 0.5 * (a[1] * a[1] + a[2] * a[2] + b[1] * b[1] + b[2] * b[2])
        area = a[1] * b[2] - a[2] * b[1]
        largest = math.sqrt(half + math.sqrt(max(half * half - area * area, 0.0)))
        fastest = min(largest, math.sqrt(dx * dx + dy * dy) + largest * h)
        least = across - fastest * h
        if least <= 0.0:
            regular = False
            continue
        i = first + 2 * k
        share = fastest / least
        arc[RATE + i] = (x * dy - y * dx) * inverse
        arc[SPREAD + i] = (largest / least + share * share) * h
        arc[REACH + i] = (abs(arc[RATE + i]) + 0.5 * arc[SPREAD + i]) * h
        if k == 0:
            d = form[4, 2] * c - form[4, 1] * s
            size = math.sqrt(form[4, 1] * form[4, 1] + form[4, 2] * form[4, 2])
            arc[RATE + first + 1] = sign * d / across
            share = min(size / least, 1.0)
            arc[SPREAD + first + 1] = (size + share * share) / least * h
            arc[REACH + first + 1] = (
                abs(arc[RATE + first + 1]) + 0.5 * arc[SPREAD + first + 1]
            ) * h
    return regular


@lean
def _posture(parts, form, signs, psi, h, arc):
    """Write a posture, its rates and how much these change within h; False without bounds."""
    c, s = math.cos(psi), math.sin(psi)
    arc[Q + 3] = form[FORMS - 1, 0]
    arc[RATE + 3] = arc[SPREAD + 3] = arc[REACH + 3] = 0.0
    shoulder = _three(form[:JOINT], parts[at.SHOULDER :], 0, signs[0], c, s, h, arc)
    wrist = _three(form[JOINT:], parts[at.WRIST :], 4, signs[1], c, s, h, arc)
    return shoulder and wrist


@lean
def _placed(request, arc, placed):
    """Write the winding of a posture that is nearest; return its distance from the seed."""
    turns, lower, upper, seed, metric, bounded = request
    if not place(turns, lower, upper, seed, bounded, arc[:7], placed):
        return math.inf
    return distance_from(placed, seed, metric)


@lean
def _improve(bench, request, k, psi, longest, distance):
    """Go down from psi to a posture nearer than ``distance``, which is ``nearest`` then."""
    parts, forms, signs, arc, placed, nearest = bench
    _set_signs(k, signs)
    step = 0.0
    start = psi
    for _ in range(ANGLE_STEPS):
        regular = _posture(parts, forms[k // 4], signs, start + step, 0.0, arc)
        here = _placed(request, arc, placed)
        if here < distance:
            distance = here
            start += step
            for i in range(7):
                nearest[i] = placed[i]
            if not regular:
                break
            step = best_step(request, placed, arc[RATE : RATE + 7], longest)
        else:
            step *= 0.25
        if abs(step) < ANGLE_SHORTEST:
            break
    return distance


@lean
def _set_signs(k, signs):
    signs[0] = 1.0 - 2.0 * (k // 2 % 2)
    signs[1] = 1.0 - 2.0 * (k % 2)


@lean
def _waiting_arcs(bench, elbows, box, space, waiting):
    """Write what the box leaves of all eight circles; return how many arcs, -1 if too many."""
    parts, forms, signs, _, _, _ = bench
    circle, shoulder, rows = space
    circle[0, 0], circle[0, 1] = 0.0, math.pi
    count = 0
    for k in range(0, 4 * elbows, 2):
        form = forms[k // 4]
        if not joint_4_fits(form, box):
            continue
        _set_signs(k, signs)
        n = keep_joints(form, parts[at.SHOULDER :], box, 0, signs[0], circle, 1, rows)
        if n >= ARCS_ROOM:
            return -1
        for i in range(n):
            shoulder[i, 0], shoulder[i, 1] = rows[0, i, 0], rows[0, i, 1]
        for side in range(2 if n > 0 else 0):
            sign = 1.0 - 2.0 * side
            m = keep_joints(form, parts[at.WRIST :], box, 4, sign, shoulder, n, rows)
            if m >= ARCS_ROOM or count + m > ANGLE_WAITING:
                return -1
            for i in range(m):
                waiting[count, 0], waiting[count, 1] = rows[0, i, 0], rows[0, i, 1]
                waiting[count, 2] = k + side
                count += 1
    return count


@lean
def _by_largest(bench, request, elbows, box, space, waiting, distance):
    """Find the least largest move; return it and whether it is proved."""
    for _ in range(ANGLE_TRIES):
        if not enclose(request, distance - NEARER_BY, box):
            return distance, True
        count = _waiting_arcs(bench, elbows, box, space, waiting)
        if count <= 0:
            return distance, count == 0
        before = distance
        for i in range(count):
            psi, half, k = waiting[i, 0], waiting[i, 1], int(waiting[i, 2])
            distance = _improve(bench, request, k, psi, half, distance)
        if distance == before:
            break
    return distance, False


@lean
def _by_squares(bench, request, elbows, box, space, waiting, distance):
    """Find the least root of squares; return it and whether it is proved."""
    parts, forms, signs, arc, placed, _ = bench
    seed, sides, proved = request[3], scratch(4), True
    if not enclose(request, distance - NEARER_BY, box):
        return distance, True
    count = _waiting_arcs(bench, elbows, box, space, waiting)
    if count < 0:
        return distance, False
    for _ in range(ANGLE_INTERVALS):
        if count == 0:
            return distance, proved
        count -= 1
        psi, h, k = waiting[count, 0], waiting[count, 1], int(waiting[count, 2])
        _set_signs(k, signs)
        regular = _posture(parts, forms[k // 4], signs, psi, h, arc)
        if _placed(request, arc, placed) < distance:
            distance = _improve(bench, request, k, psi, h, distance)
            _set_signs(k, signs)
            regular = _posture(parts, forms[k // 4], signs, psi, h, arc)
        whole(h, sides)
        if regular and not narrow_squares(0, arc, True, h, seed, distance - NEARER_BY, box, sides):
            continue
        if h < ANGLE_SHORTEST:
            proved = False
            continue
        if count + 2 > ANGLE_WAITING:
            break
        for side in range(2):
            first, last = sides[2 * side], sides[2 * side + 1]
            if first <= last:
                middle = 0.5 * (first + last)
                waiting[count, 0] = psi + middle if side == 0 else psi - middle
                waiting[count, 1], waiting[count, 2] = 0.5 * (last - first), k
                count += 1
    return distance, False


@part(types.Tuple((f8, b1))(IN1, IN2, IN2, i8, b1, f8, OUT1))
def prove_by_angle(data, T, joints, metric, bounded, distance, best):
    """Do what :func:`.nearest_proof.prove_nearest` does, for axes at right angles."""
    own, nearest = scratch(4, 7), scratch(7)
    for i in range(7):
        nearest[i] = best[i]
        own[0, i], own[3, i] = joints[0, i], joints[3, i]
        # Else windings inside the limits would stand for nearer ones outside.
        own[1, i] = joints[1, i] if bounded else -math.inf
        own[2, i] = joints[2, i] if bounded else math.inf
    request = own[0], own[1], own[2], own[3], metric, bounded
    _, parts = parts_of(data)
    forms, signs, arc, placed = scratch(2, FORMS, 3), scratch(2), scratch(ARC), scratch(7)
    box, waiting = scratch(14), scratch(ANGLE_WAITING, 3)
    space = scratch(1, 2), scratch(ARCS_ROOM, 2), scratch(3, ARCS_ROOM, 2)
    bench = parts, forms, signs, arc, placed, nearest
    elbows = forms_of(data, T, forms)
    if elbows == 0:
        return distance, False
    if metric == LINF:
        distance, proved = _by_largest(bench, request, elbows, box, space, waiting, distance)
    else:
        distance, proved = _by_squares(bench, request, elbows, box, space, waiting, distance)
    for i in range(7):
        best[i] = nearest[i]
    return distance, proved
