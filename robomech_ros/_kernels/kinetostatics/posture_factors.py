"""Named factors of the Jacobian's determinant in one posture.

All quantities come from the Jacobian: axes, zero for prismatic joints, velocities of its reference
point, and the vector (m) from that to the nearest point of each axis.
"""

import math

from robomech_ros._kernels.algebra.dense import cholesky_solve
from robomech_ros._kernels.compiling.jit import inline, lean, scratch
from robomech_ros._kernels.spatial.vectors import cross, dot, lower, upper

# Kinds of arms: 0 without factors; spherical shoulder and wrist, without or with one joint between
# them; spherical wrist after three joints, without or with parallel axes 2 and 3; three parallel
# axes, alone or as joints 2 to 4 of six, whose last two axes do not or do intersect; spherical
# wrist alone.
SPHERICAL_ENDS = 1
ONE_ELBOW = 2
ARM_AND_WRIST = 3
SHOULDER_ELBOW_WRIST = 4
PARALLEL = 5
PARALLEL_OUTER = 6
PARALLEL_SIX = 7
WRIST = 8
MOST_FACTORS = 3


@lean
def _minus(a, b):
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@lean
def _foot(J, i):
    """Return the vector from the reference point to the nearest point of axis i."""
    return cross(upper(J, i), lower(J, i))


@lean
def _volume(J, i):
    """Return the volume spanned by the directions of axes i, i + 1 and i + 2."""
    return dot(cross(upper(J, i), upper(J, i + 1)), upper(J, i + 2))


@lean
def _velocity(J, i, point, size):
    """Return the velocity of a point per rate of joint i, over the size if it is revolute."""
    x, y, z = upper(J, i)
    if x == 0.0 and y == 0.0 and z == 0.0:
        return lower(J, i)
    vx, vy, vz = cross((x, y, z), _minus(point, _foot(J, i)))
    return vx / size, vy / size, vz / size


@inline
def _meeting(J, first, count):
    """Return the point nearest to `count` axes from `first` on."""
    A, b = scratch(3, 3), scratch(3)
    A[:] = 0.0
    b[:] = 0.0
    for i in range(first, first + count):
        foot = _foot(J, i)
        for row in range(3):
            # A foot is already perpendicular to its axis.
            b[row] += foot[row]
            A[row, row] += 1.0
            for column in range(3):
                A[row, column] -= J[row, i] * J[column, i]
    cholesky_solve(A, b, 3)
    return b[0], b[1], b[2]


@inline
def named_factors(J, parts, size, out):
    """Write the dimensionless factors of J (6, n) to out in the order of their names.

    ``parts`` (6,) is the kind, the first joint of the shoulder, that of the wrist, and three joints
    with parallel axes, all from 0.  ``size`` is that of the arm (m).
    """
    kind = parts[0]
    if kind == SPHERICAL_ENDS or kind == ONE_ELBOW:
        _spherical_ends(J, kind, parts[1], parts[2], size, out)
    elif kind == ARM_AND_WRIST or kind == SHOULDER_ELBOW_WRIST:
        _decoupled(J, kind, parts[2], size, out)
    elif kind == PARALLEL or kind == PARALLEL_OUTER or kind == PARALLEL_SIX:
        _parallel(J, parts, size, out)
    elif kind == WRIST:
        out[0] = _volume(J, parts[2])


@inline
def _spherical_ends(J, kind, first, last, size, out):
    """Write the factors of shoulder, elbow if there is one, and wrist."""
    out[0] = _volume(J, first)
    if kind == SPHERICAL_ENDS:
        out[1] = _volume(J, last)
        return
    shoulder, wrist = _meeting(J, first, 3), _meeting(J, last, 3)
    reach = _minus(wrist, shoulder)
    along = dot(_velocity(J, first + 3, wrist, size), reach)
    out[1] = along / max(math.sqrt(dot(reach, reach)), 1e-300)
    out[2] = _volume(J, last)


@inline
def _decoupled(J, kind, last, size, out):
    """Write the factors of arm, or shoulder and elbow, and of the wrist."""
    centre = _meeting(J, last, 3)
    one = _velocity(J, 0, centre, size)
    two = _velocity(J, 1, centre, size)
    three = _velocity(J, 2, centre, size)
    if kind == ARM_AND_WRIST:
        out[0] = dot(cross(one, two), three)
        out[1] = _volume(J, last)
        return
    axis = upper(J, 1)
    out[0] = dot(one, axis)
    out[1] = dot(cross(two, three), axis)
    out[2] = _volume(J, last)


@inline
def _parallel(J, parts, size, out):
    """Write the factors of elbow, wrist if there are six joints, and shoulder if axes 5, 6 meet."""
    kind = parts[0]
    axis = upper(J, parts[3])
    start = _foot(J, parts[3])
    second, third = _minus(_foot(J, parts[4]), start), _minus(_foot(J, parts[5]), start)
    elbow = dot(cross(second, third), axis) / (size * size)
    if kind == PARALLEL:
        out[0] = elbow
        return
    wrist = dot(cross(upper(J, 4), upper(J, 5)), axis)
    if kind == PARALLEL_OUTER:
        out[0] = elbow
        out[1] = wrist
        return
    out[0] = dot(_velocity(J, 0, _meeting(J, 4, 2), size), axis)
    out[1] = elbow
    out[2] = wrist
