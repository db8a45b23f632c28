"""Streams of twists within limits of velocity, acceleration, jerk and steering.

The state of the base is its twist v, its acceleration a, and the rest point: the twist after the
acceleration is reduced to zero as fast as jerk allows.  In each period, the rest point moves
straight towards the command, as far as jerk and acceleration allow.  Rest point and command are in
a convex set of allowed twists; so are all twists in between, as each is between the one before and
the rest point.  From rest, rest point and twist stay on the ray of the command: the base keeps the
curvature of the command while it accelerates.
"""

import math

from robomech_ros._kernels.compiling.jit import inline, kernel, scratch
from robomech_ros._kernels.compiling.types import IN1, IN2, OUT2, i8

# Rows of axes: acceleration and deceleration forward, both backward, jerk, and a flag: velocity
# passes through 0 only with acceleration 0.
FORTH_UP, FORTH_DOWN, BACK_UP, BACK_DOWN, JERK, STOPS = range(6)
# Columns of pivots: position, largest rotation per period, limits of the angle; then the state:
# angle and direction of the wheel in the base.
X, Y, TURN, LOWER, UPPER, ANGLE, COSINE, SINE = range(8)
PIVOT_COLUMNS = 8

# Allowed relative excess over a limit, for rounding errors of twists over the squared period.
_SLACK = 1e-11
# Bisections in the search for the move of the rest point, without and with steered wheels.
_HALVINGS, _HALVINGS_STEERED = 48, 24
# A rest point that can move by less than this fraction of its path is blocked.
_BLOCKED = 1e-9
# Square of the fraction of the twist below which a slow pivot keeps its direction.
_SLOW = 1e-18
# Angles (rad) this far beyond a limit are at it, and directions this near (rad) are equal.
_AT_LIMIT, _SAME = 1e-9, 1e-12
# Rounding error of a value that decreases to zero, relative to its start.
_ROUNDING = 1e-15
# Largest number of periods of the look-ahead, which ends at the rest point.
_MOST_AHEAD = 100000


@inline
def _relative_acceleration(distance):
    """Return the acceleration (of jerk times period) for a distance (of jerk times period^2)."""
    whole = math.floor(0.5 * (math.sqrt(8.0 * distance + 1.0) - 1.0))
    return (distance + 0.5 * whole * (whole + 1.0)) / (whole + 1.0)


@inline
def _aim(v, a, target, axes, period, out):
    """Write the first acceleration towards a rest point; return whether it is allowed."""
    distance = 0.0
    for i in range(3):
        distance = max(distance, abs(target[i] - v[i]) / (axes[JERK, i] * period * period))
    share = _relative_acceleration(distance) / distance if distance > 0.0 else 1.0
    if distance <= 1.0:
        share = 1.0
    allowed = True
    for i in range(3):
        out[i] = (target[i] - v[i]) / period * share
        if abs(out[i] - a[i]) > axes[JERK, i] * period * (1.0 + _SLACK):
            allowed = False
        forth = v[i] > 0.0 or (v[i] == 0.0 and out[i] > 0.0)
        if forth:
            most = axes[FORTH_UP, i] if out[i] > 0.0 else axes[FORTH_DOWN, i]
        else:
            most = axes[BACK_UP, i] if out[i] < 0.0 else axes[BACK_DOWN, i]
        if abs(out[i]) > most * (1.0 + _SLACK):
            allowed = False
    return allowed


@inline
def _steer(pivots, v, new):
    """Steer wheels along the velocities of their pivots; return whether a period suffices.

    ``new`` (s, 3) has angle, cosine and sine, and is updated.
    """
    size = v[0] * v[0] + v[1] * v[1] + v[2] * v[2]
    for k in range(pivots.shape[0]):
        x, y = v[1] - v[0] * pivots[k, Y], v[2] + v[0] * pivots[k, X]
        square = x * x + y * y
        if square <= _SLOW * size:
            continue
        along = new[k, 1] * x + new[k, 2] * y
        across = new[k, 1] * y - new[k, 2] * x
        if along < 0.0:
            along, across = -along, -across
        turn, length = pivots[k, TURN], math.sqrt(square)
        if turn < 0.5 * math.pi and abs(across) > math.tan(turn) * along + _SAME * length:
            return False
        change = math.atan2(across, along)
        new[k, 0] += change
        if new[k, 0] < pivots[k, LOWER] - _AT_LIMIT or new[k, 0] > pivots[k, UPPER] + _AT_LIMIT:
            return False
        sign = 1.0 if new[k, 1] * x + new[k, 2] * y >= 0.0 else -1.0
        new[k, 1], new[k, 2] = sign * x / length, sign * y / length
    return True


@inline
def _next_twist(v, a, target, axes, period, out):
    """Write the twist after a period: the target itself, if the jerk of one period suffices."""
    distance = 0.0
    for i in range(3):
        distance = max(distance, abs(target[i] - v[i]) / (axes[JERK, i] * period * period))
    for i in range(3):
        out[i] = target[i] if distance <= 1.0 else v[i] + a[i] * period


@inline
def _steering_holds(v, a, target, axes, period, pivots, ahead, twist, gain):
    """Return whether the wheels can follow the motion from acceleration a to the rest point."""
    for k in range(pivots.shape[0]):
        ahead[k, 0], ahead[k, 1], ahead[k, 2] = pivots[k, ANGLE], pivots[k, COSINE], pivots[k, SINE]
    for i in range(3):
        twist[i], gain[i] = v[i], a[i]
    for _ in range(_MOST_AHEAD):
        _next_twist(twist, gain, target, axes, period, twist)
        if not _steer(pivots, twist, ahead):
            return False
        if twist[0] == target[0] and twist[1] == target[1] and twist[2] == target[2]:
            return True
        _aim(twist, gain, target, axes, period, gain)
    return False


@inline
def _align(pivots, command):
    """Steer wheels at rest towards a command; return whether they had its directions already."""
    size = command[0] ** 2 + command[1] ** 2 + command[2] ** 2
    ready = True
    for k in range(pivots.shape[0]):
        x = command[1] - command[0] * pivots[k, Y]
        y = command[2] + command[0] * pivots[k, X]
        if x * x + y * y <= _SLOW * size:
            continue
        change = math.atan2(
            pivots[k, COSINE] * y - pivots[k, SINE] * x, pivots[k, COSINE] * x + pivots[k, SINE] * y
        )
        # Both senses of a wheel are equivalent: use the nearest angle within limits.
        turned = pivots[k, ANGLE] + change
        best = math.inf
        for half in range(-2, 3):
            angle = turned + half * math.pi
            inside = pivots[k, LOWER] - _AT_LIMIT <= angle <= pivots[k, UPPER] + _AT_LIMIT
            if inside and abs(angle - pivots[k, ANGLE]) < abs(best):
                best = angle - pivots[k, ANGLE]
        if best == math.inf:
            continue
        turn = min(max(best, -pivots[k, TURN]), pivots[k, TURN])
        if turn != best:
            ready = False
        elif abs(best) > _SAME:
            ready = False
        pivots[k, ANGLE] += turn
        c, s = math.cos(turn), math.sin(turn)
        cosine, sine = pivots[k, COSINE], pivots[k, SINE]
        pivots[k, COSINE], pivots[k, SINE] = c * cosine - s * sine, s * cosine + c * sine
    return ready


@inline
def _towards(rest, goal, share, target):
    for i in range(3):
        target[i] = goal[i] if share == 1.0 else rest[i] + share * (goal[i] - rest[i])


@inline
def _largest_share(v, a, rest, goal, axes, period, pivots, work):
    """Return the fraction of its path to a goal that the rest point can move in this period."""
    target, gain, ahead = work[0], work[1], work[4:]
    most = 1.0
    for i in range(3):
        if axes[STOPS, i] != 0.0 and (v[i] * goal[i] < 0.0 or rest[i] * goal[i] < 0.0):
            most = min(most, abs(rest[i]) / (abs(rest[i]) + abs(goal[i])))
    low, high, share = 0.0, most, most
    halvings = _HALVINGS if pivots.shape[0] == 0 else _HALVINGS_STEERED
    for _ in range(halvings):
        _towards(rest, goal, share, target)
        allowed = _aim(v, a, target, axes, period, gain)
        if allowed and pivots.shape[0] > 0:
            allowed = _steering_holds(
                v, gain, target, axes, period, pivots, ahead, work[2], work[3]
            )
        if allowed:
            low = share
            if share == most:
                break
        else:
            high = share
        share = 0.5 * (low + high)
    return low


@inline
def _stays_blocked(v, a, rest, goal, axes, period, pivots, work):
    """Return whether steering still blocks the rest point after the base has reached it.

    While the acceleration decreases, jerk may forbid a move that it allows later.
    """
    later, room = scratch(50, PIVOT_COLUMNS)[: pivots.shape[0]], scratch(64, 3)[: work.shape[0]]
    gain, ahead = work[1], work[4:]
    _aim(v, a, rest, axes, period, gain)
    _steering_holds(v, gain, rest, axes, period, pivots, ahead, work[2], work[3])
    for k in range(pivots.shape[0]):
        for i in range(ANGLE):
            later[k, i] = pivots[k, i]
        later[k, ANGLE], later[k, COSINE], later[k, SINE] = ahead[k, 0], ahead[k, 1], ahead[k, 2]
    still = work[3]
    for i in range(3):
        still[i] = 0.0
    return _largest_share(rest, still, rest, goal, axes, period, later, room) <= _BLOCKED


@inline
def _reverses_wheel(v, goal, pivots):
    """Return whether a wheel would be steered by more than a right angle between two twists.

    After a stop, it is faster to reverse its rolling; exactly opposite twists need no steering.
    """
    size = v[0] * v[0] + v[1] * v[1] + v[2] * v[2]
    for k in range(pivots.shape[0]):
        x, y = v[1] - v[0] * pivots[k, Y], v[2] + v[0] * pivots[k, X]
        to_x = goal[1] - goal[0] * pivots[k, Y]
        to_y = goal[2] + goal[0] * pivots[k, X]
        if x * x + y * y <= _SLOW * size:
            continue
        across, along = x * to_y - y * to_x, x * to_x + y * to_y
        if along < 0.0 and abs(across) > -_SAME * along:
            return True
    return False


@inline
def _is_at_rest(v, a):
    for i in range(3):
        if v[i] != 0.0 or a[i] != 0.0:
            return False
    return True


@inline
def _advance(state, command, axes, forward, period, pivots, work):
    """Advance the state by a period."""
    v, a, rest = state[0], state[1], state[2]
    goal = work[work.shape[0] - 1]
    for i in range(3):
        goal[i] = command[i]
    if _is_at_rest(v, a) and pivots.shape[0] > 0:
        if goal[0] == 0.0 and goal[1] == 0.0 and goal[2] == 0.0:
            return
        if not _align(pivots, goal):
            return
    # A base with limited curvature reverses only at rest.
    wanted = forward[0] * goal[0] + forward[1] * goal[1] + forward[2] * goal[2]
    now = forward[0] * v[0] + forward[1] * v[1] + forward[2] * v[2]
    then = forward[0] * rest[0] + forward[1] * rest[1] + forward[2] * rest[2]
    if now * wanted < 0.0 or then * wanted < 0.0:
        for i in range(3):
            goal[i] = 0.0
    share = _largest_share(v, a, rest, goal, axes, period, pivots, work)
    if pivots.shape[0] > 0 and (
        _reverses_wheel(rest, goal, pivots)
        or (share <= _BLOCKED and _stays_blocked(v, a, rest, goal, axes, period, pivots, work))
    ):
        for i in range(3):
            goal[i] = 0.0
        share = _largest_share(v, a, rest, goal, axes, period, pivots, work)
    target, gain, twist = work[0], work[1], work[2]
    _towards(rest, goal, share, target)
    for i in range(3):
        # An axis that must stop before it reverses stops exactly.
        crossing = v[i] * goal[i] < 0.0 or rest[i] * goal[i] < 0.0
        if axes[STOPS, i] != 0.0 and crossing and abs(target[i]) <= _ROUNDING * abs(goal[i]):
            target[i] = 0.0
    _aim(v, a, target, axes, period, gain)
    _next_twist(v, gain, target, axes, period, twist)
    ahead = work[4:]
    for k in range(pivots.shape[0]):
        ahead[k, 0], ahead[k, 1], ahead[k, 2] = pivots[k, ANGLE], pivots[k, COSINE], pivots[k, SINE]
    _steer(pivots, twist, ahead)
    for k in range(pivots.shape[0]):
        pivots[k, ANGLE], pivots[k, COSINE], pivots[k, SINE] = ahead[k, 0], ahead[k, 1], ahead[k, 2]
    for i in range(3):
        v[i], a[i], rest[i] = twist[i], gain[i], target[i]


@kernel(i8(IN2, IN2, IN1, OUT2, OUT2, OUT2, OUT2))
def limited_stream(commands, axes, forward, pivots, state, twists, angles):
    """Follow commands (n, 3), one allowed twist (rad/s, m/s) per period.

    ``axes`` (6, 3) are limits (per s^2 and s^3), and flags.  ``forward`` (4,) has the coefficients
    of the forward velocity of a twist, zero without limited curvature, and the period (s).  The
    state of steered wheels in ``pivots`` (s, PIVOT_COLUMNS) (m, rad) and the ``state`` (3, 3),
    twist, acceleration and rest point, are updated.  ``twists`` (n, 3) and ``angles`` (n, s), the
    steering angles (rad), receive the values after each period.
    """
    work = scratch(64, 3)[: pivots.shape[0] + 5]
    for n in range(commands.shape[0]):
        _advance(state, commands[n], axes, forward, forward[3], pivots, work)
        for i in range(3):
            twists[n, i] = state[0, i]
        for k in range(pivots.shape[0]):
            angles[n, k] = pivots[k, ANGLE]
    return 0
