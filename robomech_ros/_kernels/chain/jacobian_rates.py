"""Derivatives of the Jacobian with respect to the joint variables.

With columns [a; m], angular part first (a = 0 for a prismatic joint), joint k rotates the columns
from its own on with its link, and moves the tip for the columns before it:

``dJ_i / dq_k = [a_k x a_i; a_k x m_i]`` for k <= i, ``[0; a_i x m_k]`` for k > i.
"""

import math

import numpy as np

from robomech_ros._kernels.chain.coupling import collect, collect_columns, expand, is_coupled
from robomech_ros._kernels.chain.layout import MOST_JOINTS
from robomech_ros._kernels.chain.serial import NOT_FINITE, OK, jacobian_body, joint_jacobian
from robomech_ros._kernels.compiling.jit import kernel, lean, lean_part, scratch
from robomech_ros._kernels.compiling.types import IN1, IN2, OUT1, OUT2, OUT3, i8
from robomech_ros._kernels.spatial.vectors import combined, cross, dot, lower, upper


@lean
def rate_body(J, qd, out):
    """Write the time derivative of J (6, n) at joint rates qd (n,) to out (6, n)."""
    n = J.shape[1]
    w = v = (0.0, 0.0, 0.0)
    for i in range(n):
        v = combined(v, lower(J, i), qd[i])
    for i in range(n):
        a, m = upper(J, i), lower(J, i)
        w, v = combined(w, a, qd[i]), combined(v, m, -qd[i])
        out[0, i], out[1, i], out[2, i] = cross(w, a)
        out[3, i], out[4, i], out[5, i] = combined(cross(w, m), cross(a, v), 1.0)


@lean
def gradient_body(J, G, out):
    """Write the gradient (n,) of a function of J to out, from its derivative G (6, n) by J.

    Entry k is the sum of G * dJ / dq_k: ``a_k . sum_(i >= k) (a_i x g_i + m_i x h_i) + m_k .
    sum_(i < k) h_i x a_i`` with columns [g; h] of G.
    """
    n = J.shape[1]
    s = (0.0, 0.0, 0.0)
    for k in range(n - 1, -1, -1):
        s = combined(s, cross(upper(J, k), upper(G, k)), 1.0)
        s = combined(s, cross(lower(J, k), lower(G, k)), 1.0)
        out[k] = dot(upper(J, k), s)
    s = (0.0, 0.0, 0.0)
    for k in range(n):
        out[k] += dot(lower(J, k), s)
        s = combined(s, cross(lower(G, k), upper(J, k)), 1.0)


@lean_part(i8(IN2, IN1, OUT2, OUT1))
def _coupled_gradient(packed, q, G, out):
    """Write the gradient (n,) for the drives from G (6, n), the derivative by their Jacobian."""
    m = packed.shape[0] - 1
    values, taken = scratch(MOST_JOINTS), scratch(MOST_JOINTS)
    columns, derivative, pose = scratch(6, MOST_JOINTS), scratch(6, MOST_JOINTS), scratch(4, 4)
    expand(packed, q, True, values)
    status = joint_jacobian(packed, values, columns, pose)
    for row in range(6):
        expand(packed, G[row], False, derivative[row])
    gradient_body(columns[:, :m], derivative[:, :m], taken)
    collect(packed, taken, out)
    return status


@lean
def chain_gradient(packed, q, J, G, out):
    """Write the result of :func:`gradient_body` for a chain at q (n,) with Jacobian J (6, n)."""
    if is_coupled(packed):
        _coupled_gradient(packed, q, G, out)
    else:
        gradient_body(J, G, out)


@lean_part(i8(IN2, IN1, IN1, OUT2))
def _coupled_rate(packed, q, qd, out):
    """Write the derivative for a chain with mimic joints; return the status."""
    m = packed.shape[0] - 1
    values, rates = scratch(MOST_JOINTS), scratch(MOST_JOINTS)
    columns, changes, pose = scratch(6, MOST_JOINTS), scratch(6, MOST_JOINTS), scratch(4, 4)
    expand(packed, q, True, values)
    expand(packed, qd, False, rates)
    status = joint_jacobian(packed, values, columns, pose)
    rate_body(columns[:, :m], rates, changes)
    collect_columns(packed, changes, out)
    return status


@lean
def _rate(packed, q, qd, J, pose, out):
    """Write the derivative for one q, qd (n,) to out (6, n); return the status."""
    for value in qd:
        if not math.isfinite(value):
            return NOT_FINITE
    if is_coupled(packed):
        return _coupled_rate(packed, q, qd, out)
    if jacobian_body(packed, q, J, pose) != OK:
        return NOT_FINITE
    rate_body(J, qd, out)
    return OK


@kernel(i8(IN2, IN1, IN1, OUT2))
def jacobian_rate_one(packed, q, qd, out):
    """Write the time derivative of the Jacobian for one q, qd (n,) to out (6, n)."""
    return _rate(packed, q, qd, np.empty((6, q.size)), np.empty((4, 4)), out)


@kernel(i8(IN2, IN2, IN2, OUT3))
def jacobian_rate(packed, q, qd, out):
    """Write time derivatives of the Jacobian for q, qd (m, n) to out (m, 6, n)."""
    J, pose = np.empty((6, q.shape[1])), np.empty((4, 4))
    status = 0
    for k in range(q.shape[0]):
        status |= _rate(packed, q[k], qd[k], J, pose, out[k])
    return status
