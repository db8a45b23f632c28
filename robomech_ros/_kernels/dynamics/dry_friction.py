"""Joint rates under dry friction and stops, in time steps.

The rates v at the end of a step of length h minimise ``v . A v / 2 - b . v`` plus the sum of
``h c |v_i|`` between the stops.  A holds the mass matrix and viscous friction, b momentum and
impulses.  So joints with dry friction c can stick and break away, and stops hold, for any h.
Source: Stewart, Trinkle, An implicit time-stepping scheme for rigid body dynamics with inelastic
collisions and Coulomb friction, Int. J. Numerical Methods in Engineering 39, 1996.
"""

import math

from robomech_ros._kernels.algebra.dense import cholesky_solve
from robomech_ros._kernels.compiling.jit import lean, scratch
from robomech_ros._kernels.tolerances import LARGEST_SERVO_RATE

# Most joints of a controlled chain, since their matrices are on the stack.
MOST_SERVO_JOINTS = 32

# Largest number of rounds of the search for sticking joints; usually one or two suffice.
_ROUNDS = 40

# Largest distance (rad or m) from a stop of a joint that is at it.
AT_STOP = 1e-9


@lean
def dry_friction(friction, i, rate):
    """Return the dry friction of joint i: Coulomb friction and the decayed static excess."""
    x = abs(rate) * friction[3, i]
    return friction[1, i] + friction[2, i] * math.exp(-min(x * x, 700.0))


@lean
def _sweep(A, b, dry, low, high, v, count):
    """Optimise the rates one after the other, with the others constant."""
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
            # The rate changes its sign, or violates a bound: the held set is wrong.
            if (dry[i] > 0.0 and x[i] * v[i] < 0.0) or x[i] < low[i] or x[i] > high[i]:
                return False
            continue
        pull = b[i]
        for j in range(count):
            pull -= A[i, j] * x[j]
        slack = 1e-9 * (dry[i] + abs(b[i]))
        # Forces must press a joint against its bound, against friction if it moves.
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
    """Update the rates v (count,); return whether they are finite and not too large."""
    for _ in range(_ROUNDS):
        _sweep(A, b, dry, low, high, v, count)
        if _settle(A, b, dry, low, high, v, count):
            break
    for i in range(count):
        if not abs(v[i]) <= LARGEST_SERVO_RATE:
            return False
    return True
