"""Inverse dynamics by the recursion of Newton and Euler, in the frames of the links.

Source: Luh, Walker, Paul, On-line computational scheme for mechanical manipulators, ASME J. Dynamic
Systems, Measurement and Control 102, 1980; Angeles, Fundamentals of Robotic Mechanical Systems, 4th
ed., section 7.4.  The equations of a body are taken at the origin of its frame instead of its mass
centre, where they are linear in its mass, first moment and moments of inertia.

The layout of ``model`` and ``around`` is that of ``dynamics.layout``.  Status: 0, or 1 where a
number is not finite, or the result is not.
"""

import math

from robomech_ros._kernels.chain.coupling import collect, expand, is_coupled
from robomech_ros._kernels.chain.serial import NOT_FINITE, OK
from robomech_ros._kernels.compiling.jit import fused, kernel, lean, lean_part, scratch
from robomech_ros._kernels.compiling.types import IN1, IN2, OUT1, OUT2, i8
from robomech_ros._kernels.dynamics.layout import MOST_JOINTS


@fused
def step_between(model, i, q):
    """Return the transform from the frame of link i to that before it, as twelve numbers."""
    a0, a1, a2 = model[i, 1], model[i, 2], model[i, 3]
    b0, b1, b2 = model[i, 4], model[i, 5], model[i, 6]
    c0, c1, c2 = model[i, 7], model[i, 8], model[i, 9]
    x, y, z = model[i, 10], model[i, 11], model[i, 12]
    if model[i, 0] == 0.0:
        c = math.cos(q)
        s = math.sin(q)
        return (
            c * a0 + s * a1,
            c * a1 - s * a0,
            a2,
            c * b0 + s * b1,
            c * b1 - s * b0,
            b2,
            c * c0 + s * c1,
            c * c1 - s * c0,
            c2,
            x,
            y,
            z,
        )
    return (a0, a1, a2, b0, b1, b2, c0, c1, c2, x + q * a2, y + q * b2, z + q * c2)


@lean
def into(E, x, y, z):
    """Turn a vector into the axes of the next link."""
    return (
        E[0] * x + E[3] * y + E[6] * z,
        E[1] * x + E[4] * y + E[7] * z,
        E[2] * x + E[5] * y + E[8] * z,
    )


@lean
def _out_of(E, x, y, z):
    """Turn a vector from the axes of the next link into those before it."""
    return (
        E[0] * x + E[1] * y + E[2] * z,
        E[3] * x + E[4] * y + E[5] * z,
        E[6] * x + E[7] * y + E[8] * z,
    )


@lean
def cross(ax, ay, az, bx, by, bz):
    """Product of vectors a and b."""
    return ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx


@lean
def _keep(room, i, E, n, f):
    """Note the transform in front of link i, and the moment and force that it takes."""
    for j in range(12):
        room[i, j] = E[j]
    for j in range(3):
        room[i, 12 + j] = n[j]
        room[i, 15 + j] = f[j]


@lean
def _collect(model, room, tip, out):
    """Add up moments and forces from the tip inwards, and write what each joint takes.

    ``tip`` is the wrench on the tip, in the axes of the last link.
    """
    count = model.shape[0] - 1
    # The last link passes to the tip what the surroundings do to it, with the other sign.
    fx, fy, fz = -tip[3], -tip[4], -tip[5]
    cx, cy, cz = cross(model[count, 10], model[count, 11], model[count, 12], fx, fy, fz)
    nx, ny, nz = cx - tip[0], cy - tip[1], cz - tip[2]
    status = OK
    for i in range(count - 1, -1, -1):
        nx += room[i, 12]
        ny += room[i, 13]
        nz += room[i, 14]
        fx += room[i, 15]
        fy += room[i, 16]
        fz += room[i, 17]
        out[i] = nz if model[i, 0] == 0.0 else fz
        if not math.isfinite(out[i]):
            status = NOT_FINITE
        fx, fy, fz = _out_of(room[i], fx, fy, fz)
        nx, ny, nz = _out_of(room[i], nx, ny, nz)
        cx, cy, cz = cross(room[i, 9], room[i, 10], room[i, 11], fx, fy, fz)
        nx += cx
        ny += cy
        nz += cz
    return status


@lean
def _joint_torques(model, q, qd, qdd, around, out):
    """Write the torques (m,) that give all joints their accelerations to out."""
    room = scratch(MOST_JOINTS, 18)
    count = model.shape[0] - 1
    wx, wy, wz = around[0], around[1], around[2]
    bx, by, bz = around[3], around[4], around[5]
    ax, ay, az = around[6], around[7], around[8]
    tnx, tny, tnz = around[9], around[10], around[11]
    tfx, tfy, tfz = around[12], around[13], around[14]
    loaded = tnx != 0.0 or tny != 0.0 or tnz != 0.0 or tfx != 0.0 or tfy != 0.0 or tfz != 0.0
    status = OK
    for i in range(count):
        value, rate, gain = q[i], qd[i], qdd[i]
        if not math.isfinite(value):
            status = NOT_FINITE
        E = step_between(model, i, value)
        x, y, z = E[9], E[10], E[11]
        ux, uy, uz = cross(wx, wy, wz, x, y, z)
        cx, cy, cz = cross(wx, wy, wz, ux, uy, uz)
        ux, uy, uz = cross(bx, by, bz, x, y, z)
        ax, ay, az = into(E, ax + ux + cx, ay + uy + cy, az + uz + cz)
        wx, wy, wz = into(E, wx, wy, wz)
        bx, by, bz = into(E, bx, by, bz)
        if model[i, 0] == 0.0:
            bx += wy * rate
            by -= wx * rate
            bz += gain
            wz += rate
        else:
            ax += 2.0 * wy * rate
            ay -= 2.0 * wx * rate
            az += gain
        m, hx, hy, hz = model[i, 13], model[i, 14], model[i, 15], model[i, 16]
        xx, xy, xz = model[i, 17], model[i, 18], model[i, 19]
        yy, yz, zz = model[i, 20], model[i, 21], model[i, 22]
        ux, uy, uz = cross(wx, wy, wz, hx, hy, hz)
        cx, cy, cz = cross(wx, wy, wz, ux, uy, uz)
        ux, uy, uz = cross(bx, by, bz, hx, hy, hz)
        f = (m * ax + ux + cx, m * ay + uy + cy, m * az + uz + cz)
        lx = xx * wx + xy * wy + xz * wz
        ly = xy * wx + yy * wy + yz * wz
        lz = xz * wx + yz * wy + zz * wz
        cx, cy, cz = cross(wx, wy, wz, lx, ly, lz)
        ux, uy, uz = cross(hx, hy, hz, ax, ay, az)
        n = (
            xx * bx + xy * by + xz * bz + cx + ux,
            xy * bx + yy * by + yz * bz + cy + uy,
            xz * bx + yz * by + zz * bz + cz + uz,
        )
        if loaded:
            tnx, tny, tnz = into(E, tnx, tny, tnz)
            tfx, tfy, tfz = into(E, tfx, tfy, tfz)
        _keep(room, i, E, n, f)
    status |= _collect(model, room, (tnx, tny, tnz, tfx, tfy, tfz), out)
    for i in range(count):
        out[i] += model[i, 23] * qdd[i]
        if not math.isfinite(out[i]):
            status = NOT_FINITE
    return status


@lean_part(i8(IN2, IN1, IN1, IN1, IN1, OUT1))
def _coupled_torques(model, q, qd, qdd, around, out):
    values, rates = scratch(MOST_JOINTS), scratch(MOST_JOINTS)
    changes, torques = scratch(MOST_JOINTS), scratch(MOST_JOINTS)
    expand(model, q, True, values)
    expand(model, qd, False, rates)
    expand(model, qdd, False, changes)
    status = _joint_torques(model, values, rates, changes, around, torques)
    collect(model, torques, out)
    return status


@lean
def inverse_body(model, q, qd, qdd, around, out):
    """Write the torques (n,) that give accelerations qdd to out; return the status."""
    if is_coupled(model):
        return _coupled_torques(model, q, qd, qdd, around, out)
    return _joint_torques(model, q, qd, qdd, around, out)


@lean
def _joint_gravity(model, q, around, out):
    """Write the torques (m,) that hold all joints to out."""
    room = scratch(MOST_JOINTS, 18)
    ax, ay, az = around[6], around[7], around[8]
    tnx, tny, tnz = around[9], around[10], around[11]
    tfx, tfy, tfz = around[12], around[13], around[14]
    loaded = tnx != 0.0 or tny != 0.0 or tnz != 0.0 or tfx != 0.0 or tfy != 0.0 or tfz != 0.0
    status = OK
    for i in range(model.shape[0] - 1):
        if not math.isfinite(q[i]):
            status = NOT_FINITE
        E = step_between(model, i, q[i])
        ax, ay, az = into(E, ax, ay, az)
        if loaded:
            tnx, tny, tnz = into(E, tnx, tny, tnz)
            tfx, tfy, tfz = into(E, tfx, tfy, tfz)
        m = model[i, 13]
        n = cross(model[i, 14], model[i, 15], model[i, 16], ax, ay, az)
        _keep(room, i, E, n, (m * ax, m * ay, m * az))
    return status | _collect(model, room, (tnx, tny, tnz, tfx, tfy, tfz), out)


@lean_part(i8(IN2, IN1, IN1, OUT1))
def _coupled_gravity(model, q, around, out):
    values, torques = scratch(MOST_JOINTS), scratch(MOST_JOINTS)
    expand(model, q, True, values)
    status = _joint_gravity(model, values, around, torques)
    collect(model, torques, out)
    return status


@lean
def gravity_body(model, q, around, out):
    """Write the torques (n,) that hold the chain still at q to out; return the status.

    Of what surrounds it only the acceleration of the origin and the wrench count.
    """
    if is_coupled(model):
        return _coupled_gravity(model, q, around, out)
    return _joint_gravity(model, q, around, out)


@kernel(i8(IN2, IN1, IN1, IN1, IN2, OUT1))
def inverse_dynamics_one(model, q, qd, qdd, around, out):
    """Torques for one state (n,), with the one row of ``around``, into out (n,)."""
    return inverse_body(model, q, qd, qdd, around[0], out)


@kernel(i8(IN2, IN2, IN2, IN2, IN2, OUT2))
def inverse_dynamics(model, q, qd, qdd, around, out):
    """Torques for states (m, n) into out (m, n); ``around`` has m rows, or one for all."""
    status = OK
    last = around.shape[0] - 1
    for k in range(q.shape[0]):
        status |= inverse_body(model, q[k], qd[k], qdd[k], around[min(k, last)], out[k])
    return status


@kernel(i8(IN2, IN1, IN2, OUT1))
def gravity_torque_one(model, q, around, out):
    """Torques that hold the chain at one q (n,), with the one row of ``around``, into out (n,)."""
    return gravity_body(model, q, around[0], out)


@kernel(i8(IN2, IN2, IN2, OUT2))
def gravity_torque(model, q, around, out):
    """Torques that hold the chain at q (m, n) into out (m, n)."""
    status = OK
    last = around.shape[0] - 1
    for k in range(q.shape[0]):
        status |= gravity_body(model, q[k], around[min(k, last)], out[k])
    return status
