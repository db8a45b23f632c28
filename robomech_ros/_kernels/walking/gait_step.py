"""One step of a gait: trunk and feet move, and the joints follow.

The walking frame is on the ground below the trunk in its neutral pose, and moves with the command.

A :class:`Pattern` holds constants of robot and gait.  Its ``geometry`` has a row for each leg:
neutral position of the foot in that frame (x, y), phase offset, and sway of the trunk before the
foot is lifted (x, y).  Its ``settings`` are cycle (s), duty factor, height of the swing (m), radius
of the circle around the neutral position in which a foot may stand (m), fraction of the cycle in
which the trunk sways (0 for none), and 1 if the phase advances.

In a :class:`State`, ``body`` is x, y, yaw of the walking frame over the ground, phase (cycles),
sway x, y, its start x, y and its goal x, y, its leg (-1 for none), 1 if that leg may be lifted,
and the filtered twist (3) that sets landing positions.  A row of ``feet`` is the position on the
ground (x, y, z), position of the last lift (x, y), landing position relative to the neutral one
(x, y), and 1 in the air.

The ``pose`` of a :class:`Step` is that of the trunk in the walking frame without sway: rotation row
by row, origin, then the mass centre in the trunk.
"""

import math
from typing import Any, NamedTuple

from numba import types

from robomech_ros._kernels.compiling.jit import kernel, lean, scratch
from robomech_ros._kernels.compiling.types import IN1, IN2, IN3, OUT1, OUT2, b1, f8, i8
from robomech_ros._kernels.walking.legs import FOLLOWED, follow_foot
from robomech_ros._kernels.walking.support import signed_margin

# Largest number of legs.
MOST_LEGS = 16
_NEUTRAL = 1e-6
# Fractions of a swing between which the landing position becomes fixed.
_FREE, _FIXED = 0.5, 0.8
# Time constant (s) with which landing positions follow the twist.
_FOLLOWING = 0.05
# Fraction of the radius for landing positions.
LANDING = 0.95
# Fraction of the radius that is used with a look-ahead.
_INNER = 0.999


class Pattern(NamedTuple):
    """Foothold geometry and timing: ``geometry`` (k, 5) and ``settings`` (6,)."""

    geometry: Any
    settings: Any


class State(NamedTuple):
    """State of the gait: ``body`` (15,), ``feet`` (k, 8) and joints ``q`` (k, 3)."""

    body: Any
    feet: Any
    q: Any


class Step(NamedTuple):
    """Command of one step: ``twist`` (3,), ``pose`` (15,), ``time`` and ``period`` (s)."""

    twist: Any
    pose: Any
    time: Any
    period: Any


class StepReport(NamedTuple):
    """Result of one step.

    ``rates`` (k, 3) are those of the joints over the whole period, ``trunk`` (4, 4) is its pose
    over the ground.  ``report`` (4,) has the margin (m), the largest ratio of a joint rate to its
    limit, the joint with the largest excess over a position limit, and this excess.
    """

    rates: Any
    trunk: Any
    report: Any


_PATTERN = types.NamedTuple((IN2, IN1), Pattern)
_STEP = types.NamedTuple((IN1, IN1, f8, f8), Step)
_OLD = types.NamedTuple((IN1, IN2, IN2), State)
_NEW = types.NamedTuple((OUT1, OUT2, OUT2), State)
_REPORT = types.NamedTuple((OUT2, OUT2, OUT1), StepReport)


@lean
def _smooth(part):
    """Return a quintic from 0 to 1 with first and second derivatives zero at both ends."""
    return part * part * part * (10.0 + part * (6.0 * part - 15.0))


@lean
def _in_frame(body, x, y):
    """Return a point on the ground in the walking frame."""
    c, s = math.cos(body[2]), math.sin(body[2])
    dx, dy = x - body[0], y - body[1]
    return c * dx + s * dy, c * dy - s * dx


@lean
def _along(x, y, yaw, w, vx, vy, time):
    """Return a planar pose after an exact motion with a constant twist in its own axes."""
    turn = w * time
    if abs(turn) > 1e-6:
        a, b = math.sin(turn) / w, (1.0 - math.cos(turn)) / w
    else:
        a, b = time * (1.0 - turn * turn / 6.0), 0.5 * turn * time
    dx, dy = a * vx - b * vy, b * vx + a * vy
    c, s = math.cos(yaw), math.sin(yaw)
    return x + c * dx - s * dy, y + s * dx + c * dy, yaw + turn


@kernel(f8(_PATTERN, IN1))
def sustained_part(pattern, twist):
    """Return the fraction of a twist whose strides fit into the circles of the feet."""
    geometry, settings = pattern
    half, longest = 0.5 * settings[1] * settings[0], LANDING * settings[3]
    part = 1.0
    for k in range(geometry.shape[0]):
        x, y = twist[1] - twist[0] * geometry[k, 1], twist[2] + twist[0] * geometry[k, 0]
        stride = half * math.hypot(x, y)
        if stride > longest:
            part = min(part, longest / stride)
    return part


@kernel(f8(_PATTERN, _OLD, IN1, f8, b1))
def possible_part(pattern, state, twist, period, ahead):
    """Return the fraction of a twist that keeps every foot in its circle until it is lifted.

    Feet on the ground and those that land in the next period are considered; with ``ahead``, also
    all others, for a whole stance from their landing positions.  Circles are then slightly smaller,
    since the paths of feet, straight here, are curved in a turn.
    """
    geometry, settings = pattern
    body, feet = state.body, state.feet
    cycle, duty, radius = settings[0], settings[1], settings[3]
    if ahead:
        radius *= _INNER
    w, vx, vy = twist[0], twist[1], twist[2]
    part = 1.0
    for k in range(geometry.shape[0]):
        phase = body[3] + geometry[k, 2]
        if feet[k, 7] == 0.0:
            x, y = _in_frame(body, feet[k, 0], feet[k, 1])
            dx, dy = x - geometry[k, 0], y - geometry[k, 1]
            time = (duty - phase - math.floor(duty - phase)) * cycle
        elif ahead or math.floor(phase + period / cycle) > math.floor(phase):
            dx, dy = feet[k, 5], feet[k, 6]
            x, y = geometry[k, 0] + dx, geometry[k, 1] + dy
            time = duty * cycle
        else:
            continue
        ux, uy = (w * y - vx) * time, -(w * x + vy) * time
        a, b = ux * ux + uy * uy, dx * ux + dy * uy
        c = dx * dx + dy * dy - radius * radius
        if a == 0.0:
            continue
        root = b * b - a * c
        most = (-b + math.sqrt(root)) / a if root > 0.0 else 0.0
        part = min(part, max(0.0, most))
    return part


@lean
def _sway(geometry, settings, body, feet, wants):
    """Move the sway of the trunk towards that for the lift of the next leg."""
    length, duty = settings[4], settings[1]
    for k in range(geometry.shape[0]):
        lift = duty - geometry[k, 2]
        to_lift = lift - body[3] - math.floor(lift - body[3])
        if to_lift > length and to_lift < duty:
            continue
        if to_lift <= length:
            if int(body[10]) != k:
                body[10] = k
                body[6], body[7] = body[4], body[5]
                here = wants or not _is_neutral(geometry, body, feet, k)
                body[8] = geometry[k, 3] if here else 0.0
                body[9] = geometry[k, 4] if here else 0.0
                body[11] = 1.0 if here else 0.0
            part = _smooth(1.0 - to_lift / length) if length > 0.0 else 1.0
            body[4] = body[6] + part * (body[8] - body[6])
            body[5] = body[7] + part * (body[9] - body[7])
        elif int(body[10]) == k:
            body[4], body[5] = body[8], body[9]


@lean
def _is_neutral(geometry, body, feet, k):
    x, y = _in_frame(body, feet[k, 0], feet[k, 1])
    return math.hypot(x - geometry[k, 0], y - geometry[k, 1]) < _NEUTRAL


@lean
def _landing(geometry, settings, body, k):
    """Return the landing offset of a foot: half of its next stride, within the circle."""
    radius, half = settings[3], 0.5 * settings[1] * settings[0]
    ox = half * (body[13] - body[12] * geometry[k, 1])
    oy = half * (body[14] + body[12] * geometry[k, 0])
    far = math.hypot(ox, oy)
    if far > LANDING * radius:
        ox, oy = ox * LANDING * radius / far, oy * LANDING * radius / far
    return ox, oy


@lean
def _swing(geometry, settings, body, time, feet, k, phase):
    """Move a foot in the air; the twist sets its landing position until it becomes fixed."""
    cycle, duty = settings[0], settings[1]
    w, vx, vy = body[12], body[13], body[14]
    nx, ny = geometry[k, 0], geometry[k, 1]
    part = min(1.0, max(0.0, (phase - math.floor(phase) - duty) / (1.0 - duty)))
    ox, oy = _landing(geometry, settings, body, k)
    weight = 1.0 - _smooth(min(1.0, max(0.0, (part - _FREE) / (_FIXED - _FREE))))
    weight *= min(1.0, time / _FOLLOWING)
    feet[k, 5] += weight * (ox - feet[k, 5])
    feet[k, 6] += weight * (oy - feet[k, 6])
    left = (1.0 - part) * (1.0 - duty) * cycle
    x, y, yaw = _along(body[0], body[1], body[2], w, vx, vy, left)
    c, s = math.cos(yaw), math.sin(yaw)
    px, py = nx + feet[k, 5], ny + feet[k, 6]
    h = _smooth(part)
    feet[k, 0] = feet[k, 3] + h * (x + c * px - s * py - feet[k, 3])
    feet[k, 1] = feet[k, 4] + h * (y + s * px + c * py - feet[k, 4])
    feet[k, 2] = settings[2] * 64.0 * (part * (1.0 - part)) ** 3


@lean
def _land(geometry, body, twist, passed, feet, k):
    """Set a foot down where its swing ended, the time `passed` before the end of the period."""
    x, y, yaw = _along(body[0], body[1], body[2], twist[0], twist[1], twist[2], -passed)
    c, s = math.cos(yaw), math.sin(yaw)
    px, py = geometry[k, 0] + feet[k, 5], geometry[k, 1] + feet[k, 6]
    feet[k, 0] = x + c * px - s * py
    feet[k, 1] = y + s * px + c * py
    feet[k, 2] = 0.0
    feet[k, 7] = 0.0


@lean
def _move_feet(geometry, settings, old, body, twist, time, feet):
    """Lift, move and set down feet."""
    cycle, duty = settings[0], settings[1]
    wants = twist[0] != 0.0 or twist[1] != 0.0 or twist[2] != 0.0
    for k in range(geometry.shape[0]):
        before, after = old[3] + geometry[k, 2], body[3] + geometry[k, 2]
        if feet[k, 7] != 0.0 and math.floor(after) > math.floor(before):
            passed = min(time, (after - math.floor(after)) * cycle)
            _land(geometry, body, twist, passed, feet, k)
        elif feet[k, 7] == 0.0 and math.floor(after - duty) > math.floor(before - duty):
            allowed = wants or not _is_neutral(geometry, body, feet, k)
            if settings[4] > 0.0:
                allowed = int(body[10]) == k and body[11] != 0.0
            if allowed:
                feet[k, 7] = 1.0
                feet[k, 3], feet[k, 4] = feet[k, 0], feet[k, 1]
                feet[k, 5], feet[k, 6] = _landing(geometry, settings, body, k)
        if feet[k, 7] != 0.0:
            _swing(geometry, settings, body, time, feet, k, after)


@kernel(i8(IN3, IN3, _PATTERN, _STEP, _OLD, _NEW, _REPORT))
def advance(packed, limits, pattern, step, old, new, results):
    """Advance a state by a step; return -1, or the first leg whose foot is out of reach."""
    geometry, settings = pattern
    twist, pose, time, period = step
    body, feet, q = new
    rates, trunk, report = results
    count = geometry.shape[0]
    for i in range(body.shape[0]):
        body[i] = old.body[i]
    for k in range(count):
        for i in range(8):
            feet[k, i] = old.feet[k, i]
        for i in range(3):
            q[k, i] = old.q[k, i]
    wants = twist[0] != 0.0 or twist[1] != 0.0 or twist[2] != 0.0
    body[0], body[1], body[2] = _along(
        body[0], body[1], body[2], twist[0], twist[1], twist[2], time
    )
    for i in range(3):
        body[12 + i] += min(1.0, time / _FOLLOWING) * (twist[i] - body[12 + i])
    if settings[5] != 0.0:
        body[3] += time / settings[0]
        if settings[4] > 0.0:
            _sway(geometry, settings, body, feet, wants)
        _move_feet(geometry, settings, old.body, body, twist, time, feet)
    px, py, pz = pose[9] + body[4], pose[10] + body[5], pose[11]
    J, T, standing = scratch(6, 3), scratch(4, 4), scratch(MOST_LEGS, 2)
    down = 0
    report[1], report[2], report[3] = 0.0, -1.0, 0.0
    for k in range(count):
        x, y = _in_frame(body, feet[k, 0], feet[k, 1])
        if feet[k, 7] == 0.0:
            standing[down, 0], standing[down, 1] = x, y
            down += 1
        x, y, z = x - px, y - py, feet[k, 2] - pz
        tx = pose[0] * x + pose[3] * y + pose[6] * z
        ty = pose[1] * x + pose[4] * y + pose[7] * z
        tz = pose[2] * x + pose[5] * y + pose[8] * z
        if follow_foot(packed[k], tx, ty, tz, q[k], J, T) != FOLLOWED:
            return k
        for i in range(3):
            rates[k, i] = (q[k, i] - old.q[k, i]) / period
            report[1] = max(report[1], abs(rates[k, i]) / limits[k, 2, i])
            excess = max(limits[k, 0, i] - q[k, i], q[k, i] - limits[k, 1, i])
            if excess > report[3]:
                report[2], report[3] = 3 * k + i, excess
    cx = px + pose[0] * pose[12] + pose[1] * pose[13] + pose[2] * pose[14]
    cy = py + pose[3] * pose[12] + pose[4] * pose[13] + pose[5] * pose[14]
    c, s = math.cos(body[2]), math.sin(body[2])
    for j in range(3):
        trunk[0, j] = c * pose[j] - s * pose[3 + j]
        trunk[1, j] = s * pose[j] + c * pose[3 + j]
        trunk[2, j] = pose[6 + j]
        trunk[3, j] = 0.0
    trunk[0, 3] = body[0] + c * px - s * py
    trunk[1, 3] = body[1] + s * px + c * py
    trunk[2, 3], trunk[3, 3] = pz, 1.0
    report[0] = signed_margin(cx, cy, standing, down)
    return -1
