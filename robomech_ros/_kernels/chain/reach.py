"""Least distance of a chain's tip from a point, with or without joint limits."""

import math

import numpy as np
from numba import types

from robomech_ros._kernels.algebra.dense import cholesky_solve
from robomech_ros._kernels.chain.coupling import (
    collect,
    collect_square,
    drive_count,
    drive_kind,
    expand,
    is_coupled,
)
from robomech_ros._kernels.chain.layout import SLIDE, TURN
from robomech_ros._kernels.chain.serial import joint_jacobian
from robomech_ros._kernels.compiling.jit import inline, kernel
from robomech_ros._kernels.compiling.types import IN1, IN2, OUT1, f8, i8
from robomech_ros._kernels.spatial.vectors import cross, dot, upper

# A point this near (m) is reached.  Error messages do not show smaller distances; at the boundary
# of the workspace the search converges slowly, but to less than this.
REACHED = 1e-7


@inline
def _offset(current, point, weights, r):
    """Write the weighted vector from the point to the tip; return half its square."""
    square = 0.0
    for k in range(3):
        r[k] = weights[k] * (current[k, 3] - point[k])
        square += r[k] * r[k]
    return 0.5 * square


@inline
def _update_kinematics(packed, q, joints):
    """Write the Jacobian of all joints and the pose of the tip at q (n,)."""
    values, J, current = joints[:3]
    if is_coupled(packed):
        expand(packed, q, True, values)
        joint_jacobian(packed, values, J, current)
    else:
        joint_jacobian(packed, q, J, current)


@inline
def _gradient_and_hessian(packed, weights, joints, r, g, H):
    """Write the exact gradient and Hessian of half the squared distance for the drives."""
    _, J, _, slopes, curves = joints
    if not is_coupled(packed):
        _by_joints(packed, weights, J, r, g, H)
        return
    _by_joints(packed, weights, J, r, slopes, curves)
    for j in range(slopes.shape[0]):
        for i in range(j):
            curves[i, j] = curves[j, i]
    collect(packed, slopes, g)
    collect_square(packed, curves, H)


@inline
def _by_joints(packed, weights, J, r, g, H):
    """Write the gradient and the lower triangle of the Hessian for all joints.

    The second derivative of the tip's position by q_i and q_j, i <= j, is e_i x J_j for a
    revolute joint i and zero for a prismatic one.
    """
    n = g.shape[0]
    for j in range(n):
        u, v, w = J[3, j], J[4, j], J[5, j]
        g[j] = dot((u, v, w), r)
        for i in range(j + 1):
            value = weights[0] * u * J[3, i] + weights[1] * v * J[4, i] + weights[2] * w * J[5, i]
            if packed[i, 0] == 0.0:
                value += dot(r, cross(upper(J, i), (u, v, w)))
            H[j, i] = value


@inline
def _fix_at_limits(bounds, q, g, scale, A, b, n):
    """Fix joints that are at a limit and would exceed it."""
    for i in range(n):
        if (q[i] <= bounds[0, i] and g[i] > 0.0) or (q[i] >= bounds[1, i] and g[i] < 0.0):
            b[i], A[i, i] = 0.0, scale
            for j in range(i):
                A[i, j] = 0.0
            for j in range(i + 1, n):
                A[j, i] = 0.0


@inline
def _descend(packed, wanted, bounds, q, bench, iterations):
    """Find a local minimum by damped Newton steps; return half the squared distance.

    ``wanted`` holds the point and the weights of its components, ``bench`` is working space.
    """
    point, weights = wanted
    joints, r, g, H, A, b = bench
    current = joints[2]
    n = q.shape[0]
    damping = 1.0
    _update_kinematics(packed, q, joints)
    value = _offset(current, point, weights, r)
    _gradient_and_hessian(packed, weights, joints, r, g, H)
    scale = 1e-300
    for _ in range(iterations):
        if value < 0.5 * REACHED * REACHED:
            break
        scale = 1e-300
        slope = 0.0
        for i in range(n):
            scale = max(scale, abs(H[i, i]))
            # At limits, the step that they allow measures convergence.
            there = min(max(q[i] - g[i], bounds[0, i]), bounds[1, i])
            slope = max(slope, min(abs(g[i]), abs(there - q[i])))
        if slope < 1e-13 * scale:
            break
        for i in range(n):
            b[i] = -g[i]
            for j in range(i + 1):
                A[i, j] = H[i, j]
            A[i, i] += damping * scale
        _fix_at_limits(bounds, q, g, scale, A, b, n)
        if not cholesky_solve(A, b, n):
            damping = max(4.0 * damping, 1e-3)
            continue
        # Steps are at most 1 rad; a prismatic joint moves the tip linearly at any length.
        longest = 0.0
        for i in range(n):
            if drive_kind(packed, i) != SLIDE:
                longest = max(longest, abs(b[i]))
        shrink = 1.0 if longest < 1.0 else 1.0 / longest
        for i in range(n):
            b[i] = min(max(q[i] + shrink * b[i], bounds[0, i]), bounds[1, i])
        _update_kinematics(packed, b, joints)
        found = _offset(current, point, weights, r)
        if found < value:
            value = found
            for i in range(n):
                q[i] = b[i]
            _gradient_and_hessian(packed, weights, joints, r, g, H)
            damping = 0.2 * damping if damping > 1e-14 else 0.0
        else:
            if damping > 1e12:
                break
            damping = max(8.0 * damping, 1e-3)
    return value


@kernel(f8(IN2, IN2, IN2, IN1, types.UniTuple(i8, 3), f8, f8, OUT1))
def least_distance(packed, wanted, bounds, strides, counts, enough, least, best):
    """Search for the least distance (m) of the tip from a point within bounds (2, n).

    ``wanted`` (2, 3) holds the point, and the weights, 1 or 0, of its components in base axes.
    ``strides`` (n,) separate successive starts, in turns or metres.  ``counts`` are the number of
    the first start, the number of starts, and the largest number of steps of each.  ``best`` (n,)
    receives joint values that are nearer than ``least`` (m), the result of an earlier search or
    infinite.  The search ends once the distance is at most ``enough`` (m).
    """
    point, weights = wanted[0], wanted[1]
    first, starts, iterations = counts
    n, m = drive_count(packed), packed.shape[0] - 1
    q = np.empty(n)
    b = np.empty(n)
    g = np.empty(n)
    r = np.empty(3)
    H = np.empty((n, n))
    A = np.empty((n, n))
    joints = np.empty(m), np.empty((6, m)), np.empty((4, 4)), np.empty(m), np.empty((m, m))
    bench = joints, r, g, H, A, b
    least = 0.5 * least * least
    for number in range(first, first + starts):
        if least < 0.5 * enough * enough:
            break
        for i in range(n):
            part = (number + 1) * strides[i]
            part -= math.floor(part) + 0.5
            width = bounds[1, i] - bounds[0, i]
            turns = drive_kind(packed, i) == TURN
            if width < 2.0 * math.pi or (not turns and width < math.inf):
                q[i] = bounds[0, i] + (part + 0.5) * width
            else:
                q[i] = part if drive_kind(packed, i) == SLIDE else 2.0 * math.pi * part
                q[i] = min(max(q[i], bounds[0, i]), bounds[1, i])
        value = _descend(packed, (point, weights), bounds, q, bench, iterations)
        if value < least:
            least = value
            for i in range(n):
                best[i] = q[i]
    return math.sqrt(2.0 * least)
