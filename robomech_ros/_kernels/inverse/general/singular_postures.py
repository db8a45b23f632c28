"""Newton steps to singular postures of a six-joint arm, and a test for continua.

If m solutions have become one, Newton steps shrink by the factor 1 - 1/m only, all in the same
direction, and the error may grow meanwhile.  So the error need not decrease at every step, and
steps of such a geometric sequence are replaced by its sum.

References
----------
Decker, Keller and Kelley, Convergence rates for Newton's method at singular points, SIAM J.
Numerical Analysis 20 (1983), pp. 296-314.
"""

import math

import numpy as np

from robomech_ros._kernels.algebra.angles import wrapped
from robomech_ros._kernels.chain.serial import jacobian_body
from robomech_ros._kernels.compiling.jit import inline, part
from robomech_ros._kernels.compiling.types import IN1, IN2, OUT1, b1, f8
from robomech_ros._kernels.inverse.general import layout as at
from robomech_ros._kernels.inverse.general.determinant import null_space
from robomech_ros._kernels.inverse.polishing import largest_error, pose_difference
from robomech_ros._kernels.tolerances import CONTINUUM_STEP, GENERAL_CORANK

# Largest numbers of steps, in general and towards a continuum (quadratic convergence), and of
# steps, twice as many below NEAR, without a decrease of the squared error by the factor GAIN.
SETTLING_STEPS = 80
SETTLING_CALM_STEPS = 10
SETTLING_PATIENCE = 12
SETTLING_NEAR = 1e-12
SETTLING_GAIN = 0.25
# Damping over the squared error (towards a continuum: over the error), and least damping: the
# squared rounding of a Jacobian.
SETTLING_DAMPING = 1e-2
SETTLING_ROUNDING = 1e-31
# Longest step of a joint (rad).
SETTLING_STEP = 0.3
# Steps are replaced by their sum if they shrink by a factor between these, 1/2 at a fold, and are
# parallel but for the fraction ASIDE (squared).
SETTLING_MIN_FACTOR = 0.3
SETTLING_MAX_FACTOR = 0.95
SETTLING_ASIDE = 0.04
# Squared error (rad, and lengths over the size) of a pose known to rounding.
SETTLED = 1e-30
# A continuum is found if a step of CONTINUUM_STEP settles with at most this error (as above) at
# least this far (rad) from its start.
CONTINUUM_ERROR = 1e-14
CONTINUUM_KEPT = 3e-2
# Step of one joint alone, for rank four or less, and the same least distance.
CONTINUUM_FAR_STEP = 0.3
CONTINUUM_FAR_KEPT = 6e-2

# Number of directions in a pencil tried for a continuum.
_DIRECTIONS = 4


@inline
def distance(data, a, b):
    """Return the largest difference of two postures (rad, for a slide over the size)."""
    apart = 0.0
    for j in range(6):
        if data[at.PACKED + 13 * j] == 0.0:
            apart = max(apart, abs(wrapped(a[j] - b[j])))
        else:
            apart = max(apart, abs(a[j] - b[j]) / data[at.SIZE])
    return apart


@inline
def _unit(data, j):
    """Return the motion of joint j in a step of 1: 1 rad, or the size (m)."""
    return 1.0 if data[at.PACKED + 13 * j] == 0.0 else data[at.SIZE]


@inline
def _jacobian(data, packed, q, J, pose):
    """Write the Jacobian to J (6, 6), with slides in units of the size, and the pose."""
    jacobian_body(packed, q, J, pose)
    for j in range(6):
        if packed[j, 0] != 0.0:
            for i in range(3, 6):
                J[i, j] *= data[at.SIZE]


@inline
def _square(e, unit):
    angular = e[0] * e[0] + e[1] * e[1] + e[2] * e[2]
    return angular + unit * unit * (e[3] * e[3] + e[4] * e[4] + e[5] * e[5])


@inline
def _newton_step(J, e, unit, damping, A, step):
    """Write the least-squares solution of J step = e, damped, to step (6,).

    Lengths are multiplied by ``unit``.  Householder reflections of A (12, 7), J above a multiple of
    1, preserve digits that the normal equations would lose near a singular posture.
    """
    root = math.sqrt(damping)
    for i in range(6):
        factor = 1.0 if i < 3 else unit
        for j in range(6):
            A[i, j] = factor * J[i, j]
            A[6 + i, j] = 0.0
        A[6 + i, i] = root
        A[i, 6] = factor * e[i]
        A[6 + i, 6] = 0.0
    for k in range(6):
        # Below row 6 + k column k is still zero.
        square = 0.0
        for i in range(k, 7 + k):
            square += A[i, k] * A[i, k]
        length = math.sqrt(square)
        if A[k, k] > 0.0:
            length = -length
        head = A[k, k] - length
        factor = 1.0 / (length * head) if length * head != 0.0 else 0.0
        for j in range(k + 1, 7):
            value = head * A[k, j]
            for i in range(k + 1, 7 + k):
                value += A[i, k] * A[i, j]
            value *= factor
            A[k, j] += value * head
            for i in range(k + 1, 7 + k):
                A[i, j] += value * A[i, k]
        A[k, k] = length
    for i in range(5, -1, -1):
        value = A[i, 6]
        for j in range(i + 1, 6):
            value -= A[i, j] * step[j]
        step[i] = value / A[i, i] if A[i, i] != 0.0 else 0.0


@inline
def _lengthening(step, last):
    """Return the sum of a geometric sequence of steps over the first; 1 if it is not geometric."""
    square, along, before = 0.0, 0.0, 0.0
    for i in range(6):
        square += step[i] * step[i]
        along += step[i] * last[i]
        before += last[i] * last[i]
    if before == 0.0:
        return 1.0
    factor = along / before
    aside = square - factor * along
    if not SETTLING_MIN_FACTOR < factor < SETTLING_MAX_FACTOR or aside > SETTLING_ASIDE * square:
        return 1.0
    return 1.0 / (1.0 - factor)


@part(f8(IN1, IN2, OUT1, b1))
def settle(data, T, q, calm):
    """Improve q (6,) in place towards the pose T, even if the Jacobian is singular.

    Damping is proportional to the squared error (lengths over the size), which slows no step.
    ``calm`` steps lead to the nearest posture of a continuum: their damping is proportional to the
    error, which is slow without a continuum.  Returns the remaining error, the larger of rad and m.
    """
    packed = data[at.PACKED : at.HEAD].reshape(7, 13)
    unit = 1.0 / data[at.SIZE]
    J = np.empty((6, 6))
    current = np.empty((4, 4))
    A = np.empty((12, 7))
    step = np.empty(6)
    last = np.zeros(6)
    e = np.empty(6)
    x = np.empty(6)
    for i in range(6):
        x[i] = q[i]
    least = math.inf
    remaining = math.inf
    idle = 0
    for _ in range(SETTLING_CALM_STEPS if calm else SETTLING_STEPS):
        _jacobian(data, packed, x, J, current)
        pose_difference(T, current, e)
        error = _square(e, unit)
        if not error < math.inf:
            break
        idle = 0 if error < SETTLING_GAIN * least else idle + 1
        if error < least:
            least = error
            remaining = largest_error(e)
            for i in range(6):
                q[i] = x[i]
        patience = SETTLING_PATIENCE if least > SETTLING_NEAR else 2 * SETTLING_PATIENCE
        if least <= SETTLED or idle > patience:
            break
        damping = SETTLING_DAMPING * (math.sqrt(error) if calm else error)
        _newton_step(J, e, unit, damping + SETTLING_ROUNDING, A, step)
        scale = _lengthening(step, last)
        longest = 0.0
        for i in range(6):
            longest = max(longest, abs(step[i]))
        whole = scale == 1.0
        if scale * longest > SETTLING_STEP:
            scale = SETTLING_STEP / longest
            whole = False
        for i in range(6):
            x[i] += scale * step[i] * _unit(data, i)
            # Only whole steps show the rate of shrinking.
            last[i] = step[i] if whole else 0.0
    return remaining


@inline
def regularity(data, packed, q, u, v):
    """Return the last two pivots of the Jacobian (lengths over the size) over the first.

    u (6,) becomes its null vector; if both pivots are small, u and v (6,) span its null space.
    """
    J = np.empty((6, 6))
    pose = np.empty((4, 4))
    _jacobian(data, packed, q, J, pose)
    inverse = 1.0 / data[at.SIZE]
    for i in range(3, 6):
        for j in range(6):
            J[i, j] *= inverse
    order = np.empty(6, np.int64)
    along = np.empty(6)
    _, fifth, last = null_space(J, along, u, v, order)
    if fifth > GENERAL_CORANK:
        for j in range(6):
            u[j] = along[j]
    return fifth, last


@inline
def is_between(data, T, p, q, trial):
    """Return whether another posture exists about halfway from p (6,) to q (6,)."""
    for j in range(6):
        difference = q[j] - p[j]
        if data[at.PACKED + 13 * j] == 0.0:
            difference = wrapped(difference)
        trial[j] = p[j] + 0.5 * difference
    if not settle(data, T, trial, True) <= CONTINUUM_ERROR * max(1.0, data[at.SIZE]):
        return False
    apart = distance(data, p, q)
    return 0.2 * apart < min(distance(data, trial, p), distance(data, trial, q)) < 0.8 * apart


@inline
def _settled_distance(data, T, q, direction, length, trial):
    """Step by ``length`` (rad) and settle; return the distance of the result from q, 0 if none."""
    largest = 0.0
    for j in range(6):
        largest = max(largest, abs(direction[j]))
    for j in range(6):
        trial[j] = q[j] + length / largest * direction[j] * _unit(data, j)
    if not settle(data, T, trial, True) <= CONTINUUM_ERROR * max(1.0, data[at.SIZE]):
        return 0.0
    return distance(data, trial, q)


@inline
def _settles_on_continuum(data, T, q, direction, step, kept, trial):
    """Return whether ``step`` (rad) and half of it settle on a continuum through q."""
    far = _settled_distance(data, T, q, direction, step, trial)
    if far < kept:
        return False
    near = _settled_distance(data, T, q, direction, 0.5 * step, trial)
    return 0.3 * far < near < 0.8 * far


@part(b1(IN1, IN2, IN1, OUT1, OUT1, f8))
def is_in_continuum(data, T, q, u, v, fifth):
    """Return whether the joints can move from a singular posture q (6,) while the tip is fixed.

    u, v and ``fifth`` are those of :func:`regularity`.  Near an isolated posture of any
    multiplicity, steps settle back to it; on a continuum they do not, and half the step ends half
    as far away.  For rank four or less the direction need not be in the span of u and v; then each
    joint is moved alone, by more, since it is only one component of that direction.
    """
    trial = np.empty(6)
    direction = np.empty(6)
    pencil = fifth <= GENERAL_CORANK
    count = _DIRECTIONS if pencil else 1
    for k in range(count):
        a, b = math.cos(math.pi * k / count), math.sin(math.pi * k / count)
        for j in range(6):
            direction[j] = a * u[j] + b * v[j]
        if _settles_on_continuum(data, T, q, direction, CONTINUUM_STEP, CONTINUUM_KEPT, trial):
            return True
    for k in range(6 if pencil else 0):
        for j in range(6):
            direction[j] = 1.0 if j == k else 0.0
        if _settles_on_continuum(
            data, T, q, direction, CONTINUUM_FAR_STEP, CONTINUUM_FAR_KEPT, trial
        ):
            return True
    return False
