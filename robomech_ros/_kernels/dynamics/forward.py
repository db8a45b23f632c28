"""Forward dynamics by articulated bodies, or by the Cholesky factor of the mass matrix.

Source: Featherstone, Rigid Body Dynamics Algorithms, Springer 2008, ch. 7, here about one reference
point, so that articulated inertias are added without transformations.
"""

import math

from robomech_ros._kernels.algebra.dense import cholesky_solve
from robomech_ros._kernels.chain.coupling import drive_count, is_coupled
from robomech_ros._kernels.chain.serial import NOT_FINITE, OK
from robomech_ros._kernels.compiling.jit import kernel, lean, lean_part, scratch
from robomech_ros._kernels.compiling.types import IN1, IN2, OUT1, OUT2, i8
from robomech_ros._kernels.dynamics.base_frame import (
    base_motion,
    dot,
    force_cross,
    inertia_times,
    motion_cross,
    place_frames,
    placed_axis,
    placed_body,
    plus,
    six,
    wrench_about,
    write_six,
)
from robomech_ros._kernels.dynamics.inverse import inverse_body
from robomech_ros._kernels.dynamics.layout import MOST_JOINTS
from robomech_ros._kernels.dynamics.mass import NO_MOTION, mass_body

# Status: the mass matrix is not positive definite, so a motion has no inertia.
SINGULAR = 2
_NOTHING = (0.0,) * 21


@lean
def _with_body(A, body):
    """Return the sum of an inertia, as its upper triangle (21) row by row, and a body (10)."""
    m, x, y, z = body[0], body[1], body[2], body[3]
    return (
        A[0] + body[4],
        A[1] + body[5],
        A[2] + body[6],
        A[3],
        A[4] - z,
        A[5] + y,
        A[6] + body[7],
        A[7] + body[8],
        A[8] + z,
        A[9],
        A[10] - x,
        A[11] + body[9],
        A[12] - y,
        A[13] + x,
        A[14],
        A[15] + m,
        A[16],
        A[17],
        A[18] + m,
        A[19],
        A[20] + m,
    )


@lean
def _times(A, x):
    """Return the force (6) that is an inertia (21) times a motion (6)."""
    a, b, c, d, e, f = x[0], x[1], x[2], x[3], x[4], x[5]
    return (
        A[0] * a + A[1] * b + A[2] * c + A[3] * d + A[4] * e + A[5] * f,
        A[1] * a + A[6] * b + A[7] * c + A[8] * d + A[9] * e + A[10] * f,
        A[2] * a + A[7] * b + A[11] * c + A[12] * d + A[13] * e + A[14] * f,
        A[3] * a + A[8] * b + A[12] * c + A[15] * d + A[16] * e + A[17] * f,
        A[4] * a + A[9] * b + A[13] * c + A[16] * d + A[18] * e + A[19] * f,
        A[5] * a + A[10] * b + A[14] * c + A[17] * d + A[19] * e + A[20] * f,
    )


@lean
def _less_joint(A, U, inverse):
    """Return an inertia (21) less U U^T / D, which a free joint does not transmit."""
    a, b, c = U[0] * inverse, U[1] * inverse, U[2] * inverse
    d, e, f = U[3] * inverse, U[4] * inverse, U[5] * inverse
    return (
        A[0] - a * U[0],
        A[1] - a * U[1],
        A[2] - a * U[2],
        A[3] - a * U[3],
        A[4] - a * U[4],
        A[5] - a * U[5],
        A[6] - b * U[1],
        A[7] - b * U[2],
        A[8] - b * U[3],
        A[9] - b * U[4],
        A[10] - b * U[5],
        A[11] - c * U[2],
        A[12] - c * U[3],
        A[13] - c * U[4],
        A[14] - c * U[5],
        A[15] - d * U[3],
        A[16] - d * U[4],
        A[17] - d * U[5],
        A[18] - e * U[4],
        A[19] - e * U[5],
        A[20] - f * U[5],
    )


@lean
def _articulated_body(model, q, qd, tau, around, out):
    """Write the accelerations (n,) of a chain without mimic joints to out."""
    frames = scratch(MOST_JOINTS, 12)
    axes = scratch(MOST_JOINTS, 6)
    drifts = scratch(MOST_JOINTS, 6)
    velocities = scratch(MOST_JOINTS, 6)
    resisted = scratch(MOST_JOINTS, 6)
    spare = scratch(MOST_JOINTS, 2)
    status, point, tip = place_frames(model, q, frames)
    velocity, acceleration = base_motion(around, point)
    count = model.shape[0] - 1
    for i in range(count):
        S = placed_axis(model, frames, i, point)
        velocity = plus(velocity, S, qd[i])
        write_six(axes[i], S)
        write_six(velocities[i], velocity)
        write_six(drifts[i], motion_cross(velocity, plus(NO_MOTION, S, qd[i])))
    # The articulated inertia beyond a joint, and its bias force.
    A = _NOTHING
    p = plus(NO_MOTION, wrench_about(around, tip), -1.0)
    for i in range(count - 1, -1, -1):
        body = placed_body(model, frames, i, point)
        velocity = six(velocities[i])
        p = plus(p, force_cross(velocity, inertia_times(body, velocity)), 1.0)
        A = _with_body(A, body)
        S = six(axes[i])
        U = _times(A, S)
        D = dot(S, U) + model[i, 23]
        if not D > 0.0:
            status |= SINGULAR
        p = plus(p, _times(A, drifts[i]), 1.0)
        inverse = 1.0 / D
        u = (tau[i] - dot(S, p)) * inverse
        p = plus(p, U, u)
        A = _less_joint(A, U, inverse)
        write_six(resisted[i], U)
        spare[i, 0], spare[i, 1] = u, inverse
    for i in range(count):
        value = spare[i, 0] - dot(resisted[i], acceleration) * spare[i, 1]
        out[i] = value
        if not math.isfinite(value):
            status |= NOT_FINITE
        acceleration = plus(plus(acceleration, drifts[i], 1.0), axes[i], value)
    return status


@lean
def _cholesky_body(model, q, qd, tau, around, M, none, out):
    status = inverse_body(model, q, qd, none, around, out) | mass_body(model, q, M)
    count = drive_count(model)
    for i in range(count):
        out[i] = tau[i] - out[i]
    if not cholesky_solve(M, out, count):
        return status | SINGULAR
    for i in range(count):
        if not math.isfinite(out[i]):
            status |= NOT_FINITE
    return status


@lean_part(i8(IN2, IN1, IN1, IN1, IN1, OUT1))
def _coupled_body(model, q, qd, tau, around, out):
    M, none = scratch(MOST_JOINTS, MOST_JOINTS), scratch(MOST_JOINTS)
    for i in range(drive_count(model)):
        none[i] = 0.0
    return _cholesky_body(model, q, qd, tau, around, M, none, out)


@lean
def forward_body(model, q, qd, tau, around, out):
    """Write the accelerations (n,) caused by torques to out; return the status."""
    if is_coupled(model):
        return _coupled_body(model, q, qd, tau, around, out)
    return _articulated_body(model, q, qd, tau, around, out)


@kernel(i8(IN2, IN1, IN1, IN1, IN2, OUT1))
def forward_dynamics_one(model, q, qd, tau, around, out):
    """Write accelerations for one state (n,), with the one row of ``around``, to out (n,)."""
    return forward_body(model, q, qd, tau, around[0], out)


@kernel(i8(IN2, IN2, IN2, IN2, IN2, OUT2))
def forward_dynamics(model, q, qd, tau, around, out):
    """Write accelerations for states (m, n) to out (m, n); ``around`` has m rows, or one."""
    status = OK
    last = around.shape[0] - 1
    for k in range(q.shape[0]):
        status |= forward_body(model, q[k], qd[k], tau[k], around[min(k, last)], out[k])
    return status


@kernel(i8(IN2, IN2, IN2, IN2, IN2, OUT2, OUT2))
def forward_dynamics_cholesky(model, q, qd, tau, around, M, out):
    """Write accelerations to out (m, n) by the mass matrix; M (n + 1, n) is working space."""
    status = OK
    last = around.shape[0] - 1
    none = M[q.shape[1]]
    for j in range(q.shape[1]):
        none[j] = 0.0
    for k in range(q.shape[0]):
        status |= _cholesky_body(model, q[k], qd[k], tau[k], around[min(k, last)], M, none, out[k])
    return status
