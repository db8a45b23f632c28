"""Mass matrix by composite bodies, Coriolis matrix, momentum and kinetic energy of a chain.

Sources: Walker, Orin, Efficient dynamic computer simulation of robotic mechanisms, ASME J. Dynamic
Systems, Measurement and Control 104, 1982; Echeandia, Wensing, Numerical methods to compute the
Coriolis matrix and Christoffel symbols for rigid-body systems, ASME J. Computational and Nonlinear
Dynamics 16, 2021.
"""

import math

from robomech_ros._kernels.chain.coupling import collect_square, expand, is_coupled
from robomech_ros._kernels.chain.serial import NOT_FINITE, OK
from robomech_ros._kernels.compiling.jit import fused, kernel, lean, lean_part, scratch
from robomech_ros._kernels.compiling.types import IN1, IN2, OUT2, OUT3, i8
from robomech_ros._kernels.dynamics.base_frame import (
    dot,
    inertia_times,
    joined,
    motion_cross,
    place_frames,
    placed_axis,
    placed_body,
    plus,
    six,
    write_six,
)
from robomech_ros._kernels.dynamics.layout import MOST_JOINTS

NO_MOTION = (0.0,) * 6
NO_BODY = (0.0,) * 10
NO_RATE = (0.0,) * 12


@fused
def _joint_masses(model, q, M):
    """Write the mass matrix (m, m) of all joints, mimic joints uncoupled, to M."""
    frames = scratch(MOST_JOINTS, 12)
    axes = scratch(MOST_JOINTS, 6)
    status, point, _ = place_frames(model, q, frames)
    count = model.shape[0] - 1
    for i in range(count):
        write_six(axes[i], placed_axis(model, frames, i, point))
    whole = NO_BODY
    for i in range(count - 1, -1, -1):
        whole = joined(whole, placed_body(model, frames, i, point))
        force = inertia_times(whole, axes[i])
        for j in range(i + 1):
            value = dot(axes[j], force)
            M[i, j] = value
            M[j, i] = value
        M[i, i] += model[i, 23]
        if not math.isfinite(M[i, i]):
            status = NOT_FINITE
    return status


@lean_part(i8(IN2, IN1, OUT2))
def _coupled_masses(model, q, M):
    values, masses = scratch(MOST_JOINTS), scratch(MOST_JOINTS, MOST_JOINTS)
    expand(model, q, True, values)
    status = _joint_masses(model, values, masses)
    collect_square(model, masses, M)
    return status


@lean
def mass_body(model, q, M):
    """Write the mass matrix (n, n) to M; return the status."""
    if is_coupled(model):
        return _coupled_masses(model, q, M)
    return _joint_masses(model, q, M)


@lean
def momentum_rate(body, motion):
    """Return the matrix B with ``B v = v x* I v`` for the velocity v of a body.

    B is [[K, 0], [-[p]x, 0]], returned as K row by row (9), then the linear momentum p (3).  The
    rate of the inertia less 2 B is skew-symmetric.
    """
    m, hx, hy, hz = body[0], body[1], body[2], body[3]
    xx, xy, xz, yy, yz, zz = body[4], body[5], body[6], body[7], body[8], body[9]
    wx, wy, wz = motion[0], motion[1], motion[2]
    vx, vy, vz = motion[3], motion[4], motion[5]
    # Half the angular momentum (l), and half the rate of the moments of inertia (s).
    lx = 0.5 * (xx * wx + xy * wy + xz * wz + hy * vz - hz * vy)
    ly = 0.5 * (xy * wx + yy * wy + yz * wz + hz * vx - hx * vz)
    lz = 0.5 * (xz * wx + yz * wy + zz * wz + hx * vy - hy * vx)
    trace = vx * hx + vy * hy + vz * hz
    sxx = wy * xz - wz * xy - vx * hx + trace
    syy = wz * xy - wx * yz - vy * hy + trace
    szz = wx * yz - wy * xz - vz * hz + trace
    sxy = 0.5 * (wy * yz - wz * yy + wz * xx - wx * xz - vx * hy - hx * vy)
    sxz = 0.5 * (wy * zz - wz * yz + wx * xy - wy * xx - vx * hz - hx * vz)
    syz = 0.5 * (wz * xz - wx * zz + wx * yy - wy * xy - vy * hz - hy * vz)
    return (
        sxx,
        sxy + lz,
        sxz - ly,
        sxy - lz,
        syy,
        syz + lx,
        sxz + ly,
        syz - lx,
        szz,
        m * vx + wy * hz - wz * hy,
        m * vy + wz * hx - wx * hz,
        m * vz + wx * hy - wy * hx,
    )


@lean
def rates_joined(a, b):
    """Return the sum of two matrices (12) of :func:`momentum_rate`."""
    return plus(a[:6], b[:6], 1.0) + plus(a[6:], b[6:], 1.0)


@lean
def rate_times(B, S):
    """Return the force (6) that is a matrix B (12) times a motion (6)."""
    x, y, z = S[0], S[1], S[2]
    return (
        B[0] * x + B[1] * y + B[2] * z,
        B[3] * x + B[4] * y + B[5] * z,
        B[6] * x + B[7] * y + B[8] * z,
        B[11] * y - B[10] * z,
        B[9] * z - B[11] * x,
        B[10] * x - B[9] * y,
    )


@lean
def times_rate(S, B):
    """Return the first half (3) of S^T B for a motion S (6) and a matrix B (12); the rest is 0."""
    return (
        B[0] * S[0] + B[3] * S[1] + B[6] * S[2] + B[10] * S[5] - B[11] * S[4],
        B[1] * S[0] + B[4] * S[1] + B[7] * S[2] + B[11] * S[3] - B[9] * S[5],
        B[2] * S[0] + B[5] * S[1] + B[8] * S[2] + B[9] * S[4] - B[10] * S[3],
    )


@lean
def _coriolis_body(model, q, qd, C):
    frames = scratch(MOST_JOINTS, 12)
    axes = scratch(MOST_JOINTS, 6)
    rates = scratch(MOST_JOINTS, 6)
    velocities = scratch(MOST_JOINTS, 6)
    status, point, _ = place_frames(model, q, frames)
    count = model.shape[0] - 1
    velocity = NO_MOTION
    for i in range(count):
        S = placed_axis(model, frames, i, point)
        velocity = plus(velocity, S, qd[i])
        write_six(axes[i], S)
        write_six(velocities[i], velocity)
        write_six(rates[i], motion_cross(velocity, S))
    whole, B = NO_BODY, NO_RATE
    for i in range(count - 1, -1, -1):
        body = placed_body(model, frames, i, point)
        whole = joined(whole, body)
        B = rates_joined(B, momentum_rate(body, velocities[i]))
        S = six(axes[i])
        above = plus(inertia_times(whole, rates[i]), rate_times(B, S), 1.0)
        inert = inertia_times(whole, S)
        left = times_rate(S, B)
        C[i, i] = dot(S, above)
        for j in range(i):
            C[j, i] = dot(axes[j], above)
            C[i, j] = (
                dot(rates[j], inert)
                + axes[j, 0] * left[0]
                + axes[j, 1] * left[1]
                + axes[j, 2] * left[2]
            )
    for i in range(count):
        for j in range(count):
            if not math.isfinite(C[i, j]):
                status = NOT_FINITE
    return status


@lean
def _totals_body(model, q, qd, out):
    """Write mass, first moment, angular and linear momentum, and kinetic energy to out (11,).

    The first moment and the angular momentum are about the base's origin, in its axes; the energy
    includes the rotors.
    """
    frames = scratch(MOST_JOINTS, 12)
    status, point, _ = place_frames(model, q, frames)
    velocity, momentum, whole = NO_MOTION, NO_MOTION, NO_BODY
    energy = 0.0
    for i in range(model.shape[0] - 1):
        velocity = plus(velocity, placed_axis(model, frames, i, point), qd[i])
        body = placed_body(model, frames, i, point)
        force = inertia_times(body, velocity)
        whole = joined(whole, body)
        momentum = plus(momentum, force, 1.0)
        energy += 0.5 * (dot(velocity, force) + model[i, 23] * qd[i] * qd[i])
    x, y, z = point
    px, py, pz = momentum[3], momentum[4], momentum[5]
    out[0] = whole[0]
    out[1] = whole[1] + whole[0] * x
    out[2] = whole[2] + whole[0] * y
    out[3] = whole[3] + whole[0] * z
    out[4] = momentum[0] + y * pz - z * py
    out[5] = momentum[1] + z * px - x * pz
    out[6] = momentum[2] + x * py - y * px
    out[7], out[8], out[9] = px, py, pz
    out[10] = energy
    for j in range(11):
        if not math.isfinite(out[j]):
            status = NOT_FINITE
    return status


@kernel(i8(IN2, IN1, OUT2))
def mass_matrix_one(model, q, out):
    """Write the mass matrix at one q (n,) to out (n, n)."""
    return mass_body(model, q, out)


@kernel(i8(IN2, IN2, OUT3))
def mass_matrix(model, q, out):
    """Write mass matrices at q (m, n) to out (m, n, n)."""
    status = OK
    for k in range(q.shape[0]):
        status |= mass_body(model, q[k], out[k])
    return status


@kernel(i8(IN2, IN2, IN2, OUT3))
def coriolis_matrix(model, q, qd, out):
    """Write Coriolis matrices for q, qd (m, n) to out (m, n, n)."""
    status = OK
    for k in range(q.shape[0]):
        status |= _coriolis_body(model, q[k], qd[k], out[k])
    return status


@kernel(i8(IN2, IN2, IN2, OUT2))
def totals(model, q, qd, out):
    """Write mass, momentum and kinetic energy for q, qd (m, n) to out (m, 11)."""
    status = OK
    for k in range(q.shape[0]):
        status |= _totals_body(model, q[k], qd[k], out[k])
    return status
