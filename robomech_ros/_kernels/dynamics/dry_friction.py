"""Rates that dry friction and stops leave to joints, in steps of time.

Each step gives the joints the rates v at its end that minimise ``v . A v / 2 - b . v`` and ``h c
|v|`` of each joint between the stops, with the mass matrix and viscous friction in A and the
momentum and impulses in b: then dry friction c lets a joint stick and break away, and a stop hold
it, however long the step h.  Source: Stewart, Trinkle, An implicit time-stepping scheme for rigid
body dynamics with inelastic collisions and Coulomb friction, Int. J. Numerical Methods in
Engineering 39, 1996.
"""

import math

from robomech_ros._kernels.algebra.dense import cholesky_solve
from robomech_ros._kernels.compiling.jit import lean, scratch
from robomech_ros._kernels.tolerances import LARGEST_SERVO_RATE

# Matrices of their numbers stand on the stack.
MOST_SERVO_JOINTS = 32

# Most rounds of the search for sticking joints; one or two are the rule.
_ROUNDS = 40

# How near to a stop a joint is at it, rad or m.
AT_STOP = 1e-9


@lean
def dry_friction(friction, i, rate):
    """Return the Coulomb friction of joint i with the rest of its static friction."""
    x = abs(rate) * friction[3, i]
    return friction[1, i] + friction[2, i] * math.exp(-min(x * x, 700.0))


@lean
def _sweep(A, b, dry, low, high, v, count):
    """Improve the rates one after the other, each the best with the others as they are."""
    for i in range(count):
        value = b[i]
        for j in range(count):
            if j != i:
                value -= A[i, j] * v[j]
        if value > dry[i]:
            value -= dry[i]
        elif value < -dry[i]:
            value += dry[i]
        else:
            value = 0.0
        v[i] = min(max(value / A[i, i], low[i]), high[i])


@lean
def _is_held(dry, low, high, v, i):
    """Return whether joint i sticks, or is at a bound of its rate."""
    return (v[i] == 0.0 and dry[i] > 0.0) or v[i] <= low[i] or v[i] >= high[i]


@lean
def _settle(A, b, dry, low, high, v, count):
    """Solve for the rates with the held joints; return whether the held set is consistent."""
    F = scratch(MOST_SERVO_JOINTS, MOST_SERVO_JOINTS)
    x = scratch(MOST_SERVO_JOINTS)
    for i in range(count):
        for j in range(count):
            F[i, j] = 0.0
        if _is_held(dry, low, high, v, i):
            x[i] = v[i]
            F[i, i] = 1.0
            continue
        x[i] = b[i] - math.copysign(dry[i], v[i])
        for j in range(count):
            if _is_held(dry, low, high, v, j):
                x[i] -= A[i, j] * v[j]
            else:
                F[i, j] = A[i, j]
    if not cholesky_solve(F, x, count):
        return False
    for i in range(count):
        if not _is_held(dry, low, high, v, i):
            # Through rest, or beyond a stop: another joint is held than was thought.
            if (dry[i] > 0.0 and x[i] * v[i] < 0.0) or x[i] < low[i] or x[i] > high[i]:
                return False
            continue
        pull = b[i]
        for j in range(count):
            pull -= A[i, j] * x[j]
        slack = 1e-9 * (dry[i] + abs(b[i]))
        # At a bound the joint must be pulled against it, by more than the friction where it moves.
        least, most = -dry[i], dry[i]
        if v[i] >= high[i]:
            least, most = (dry[i] if v[i] > 0.0 else least), math.inf
        if v[i] <= low[i]:
            least, most = -math.inf, (-dry[i] if v[i] < 0.0 else most)
        if pull < least - slack or pull > most + slack:
            return False
    for i in range(count):
        v[i] = x[i]
    return True


@lean
def settled_rates(A, b, dry, low, high, v, count):
    """Write the rates v (count,) from the last ones; return whether they are finite and bounded."""
    for _ in range(_ROUNDS):
        _sweep(A, b, dry, low, high, v, count)
        if _settle(A, b, dry, low, high, v, count):
            break
    for i in range(count):
        if not abs(v[i]) <= LARGEST_SERVO_RATE:
            return False
    return True
