"""Inverse dynamics by the Newton-Euler recursion in the frames of the links.

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
from robomech_ros._kernels.dynamics.layout import MOST_JOINTS, SURROUNDINGS, TIP_WRENCH
from robomech_ros._kernels.spatial.vectors import combined, cross, mixed, scaled, triple


@fused
def step_between(model, i, q):
    """Return the transform (12) from the frame of link i to that of the link before."""
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
def into(E, v):
    """Return a vector in the axes of the next link."""
    return mixed(v, E[:3], E[3:6], E[6:9])


@lean
def _out_of(E, v):
    """Return a vector of the axes of the next link in those of the link before."""
    x, y, z = v
    return (
        E[0] * x + E[1] * y + E[2] * z,
        E[3] * x + E[4] * y + E[5] * z,
        E[6] * x + E[7] * y + E[8] * z,
    )


@lean
def three(row, i):
    """Read three numbers of a row from index i on."""
    return row[i], row[i + 1], row[i + 2]


@lean
def next_motion(motion, E, slides, rate, gain):
    """Return the motion (omega, alpha, a of the origin) of the next link from that of a link."""
    w, b, a = motion
    step = three(E, 9)
    a = combined(combined(a, cross(b, step), 1.0), triple(w, step), 1.0)
    w, b, a = into(E, w), into(E, b), into(E, a)
    aside = w[1] * rate, -w[0] * rate, gain
    if slides:
        return w, b, (a[0] + 2.0 * aside[0], a[1] + 2.0 * aside[1], a[2] + gain)
    return (w[0], w[1], w[2] + rate), combined(b, aside, 1.0), a


@lean
def _store(room, i, E, n, f):
    """Store the transform in front of link i, and its moment and force."""
    for j in range(12):
        room[i, j] = E[j]
    for j in range(3):
        room[i, 12 + j] = n[j]
        room[i, 15 + j] = f[j]


@lean
def _collect(model, room, tip, out):
    """Add moments and forces from the tip to the base; write joint efforts, return the status.

    ``tip`` holds moment and force on the tip, in the axes of the last link.
    """
    count = model.shape[0] - 1
    # The last link balances the wrench on the tip.
    moment, force = tip
    f = scaled(force, -1.0)
    n = combined(cross(three(model[count], 10), f), moment, -1.0)
    status = OK
    for i in range(count - 1, -1, -1):
        row = room[i]
        n, f = combined(n, three(row, 12), 1.0), combined(f, three(row, 15), 1.0)
        out[i] = n[2] if model[i, 0] == 0.0 else f[2]
        if not math.isfinite(out[i]):
            status = NOT_FINITE
        f = _out_of(row, f)
        n = combined(_out_of(row, n), cross(three(row, 9), f), 1.0)
    return status


@lean
def _is_loaded(around):
    """Return whether there is a wrench on the tip."""
    for k in range(TIP_WRENCH, SURROUNDINGS):
        if around[k] != 0.0:
            return True
    return False


@lean
def _joint_torques(model, q, qd, qdd, around, out):
    """Write the torques (m,) of all joints, mimic joints uncoupled, for accelerations to out."""
    room = scratch(MOST_JOINTS, 18)
    count = model.shape[0] - 1
    motion = three(around, 0), three(around, 3), three(around, 6)
    moment, force = three(around, 9), three(around, 12)
    loaded = _is_loaded(around)
    status = OK
    for i in range(count):
        if not math.isfinite(q[i]):
            status = NOT_FINITE
        E = step_between(model, i, q[i])
        motion = next_motion(motion, E, model[i, 0] != 0.0, qd[i], qdd[i])
        w, b, a = motion
        m, h = model[i, 13], three(model[i], 14)
        xx, xy, xz = three(model[i], 17)
        yy, yz, zz = three(model[i], 20)
        x, y, z = (xx, xy, xz), (xy, yy, yz), (xz, yz, zz)
        f = combined(combined(scaled(a, m), cross(b, h), 1.0), triple(w, h), 1.0)
        n = combined(mixed(b, x, y, z), cross(w, mixed(w, x, y, z)), 1.0)
        if loaded:
            moment, force = into(E, moment), into(E, force)
        _store(room, i, E, combined(n, cross(h, a), 1.0), f)
    status |= _collect(model, room, (moment, force), out)
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
    """Write the torques (n,) for accelerations qdd to out; return the status."""
    if is_coupled(model):
        return _coupled_torques(model, q, qd, qdd, around, out)
    return _joint_torques(model, q, qd, qdd, around, out)


@lean
def _joint_gravity(model, q, around, out):
    """Write the static torques (m,) of all joints, mimic joints uncoupled, to out."""
    room = scratch(MOST_JOINTS, 18)
    a, moment, force = three(around, 6), three(around, 9), three(around, 12)
    loaded = _is_loaded(around)
    status = OK
    for i in range(model.shape[0] - 1):
        if not math.isfinite(q[i]):
            status = NOT_FINITE
        E = step_between(model, i, q[i])
        a = into(E, a)
        if loaded:
            moment, force = into(E, moment), into(E, force)
        _store(room, i, E, cross(three(model[i], 14), a), scaled(a, model[i, 13]))
    return status | _collect(model, room, (moment, force), out)


@lean_part(i8(IN2, IN1, IN1, OUT1))
def _coupled_gravity(model, q, around, out):
    values, torques = scratch(MOST_JOINTS), scratch(MOST_JOINTS)
    expand(model, q, True, values)
    status = _joint_gravity(model, values, around, torques)
    collect(model, torques, out)
    return status


@lean
def gravity_body(model, q, around, out):
    """Write the torques (n,) that hold the chain at rest at q to out; return the status.

    Only the acceleration of the base's origin and the tip wrench of ``around`` are used.
    """
    if is_coupled(model):
        return _coupled_gravity(model, q, around, out)
    return _joint_gravity(model, q, around, out)


@kernel(i8(IN2, IN1, IN1, IN1, IN2, OUT1))
def inverse_dynamics_one(model, q, qd, qdd, around, out):
    """Write torques for one state (n,), with the one row of ``around``, to out (n,)."""
    return inverse_body(model, q, qd, qdd, around[0], out)


@kernel(i8(IN2, IN2, IN2, IN2, IN2, OUT2))
def inverse_dynamics(model, q, qd, qdd, around, out):
    """Write torques for states (m, n) to out (m, n); ``around`` has m rows, or one for all."""
    status = OK
    last = around.shape[0] - 1
    for k in range(q.shape[0]):
        status |= inverse_body(model, q[k], qd[k], qdd[k], around[min(k, last)], out[k])
    return status


@kernel(i8(IN2, IN1, IN2, OUT1))
def gravity_torque_one(model, q, around, out):
    """Write static torques at one q (n,), with the one row of ``around``, to out (n,)."""
    return gravity_body(model, q, around[0], out)


@kernel(i8(IN2, IN2, IN2, OUT2))
def gravity_torque(model, q, around, out):
    """Write static torques at q (m, n) to out (m, n)."""
    status = OK
    last = around.shape[0] - 1
    for k in range(q.shape[0]):
        status |= gravity_body(model, q[k], around[min(k, last)], out[k])
    return status
