"""Dynamics of chains that carry one platform, by the natural orthogonal complement of their loops.

The rates of all joints of the open chains are ``N u``, u those of the drives.  So what the chains
take by themselves, torques by Newton and Euler and mass matrices M of one chain each, gives the
efforts ``N' tau`` and the generalised inertia ``N' M N`` of the whole; the platform is the last
body of the first chain.  Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section
12.4.

``model`` has the chains one after another, n_i + 1 rows each, as ``dynamics.layout`` says;
``starts``, ``drives`` and ``scale`` are those of :mod:`.factors`, and so is the status, or one of
those below.
Of what surrounds the chains, one row for all states or one for each, the wrench is on the platform.
"""

import math
from collections import namedtuple

import numpy as np

from robomech_ros._kernels.chain.jacobian_rates import rate_body
from robomech_ros._kernels.compiling.jit import IIN1, IN2, OUT2, OUT3, f8, i8, inline, kernel, lean
from robomech_ros._kernels.dynamics.inverse import inverse_body
from robomech_ros._kernels.dynamics.layout import SURROUNDINGS, TIP_WRENCH
from robomech_ros._kernels.dynamics.mass import mass_body
from robomech_ros._kernels.loops.factors import NOT_FINITE, REGULAR, factors, loop_errors, solve

__all__ = [
    "NO_MASS",
    "OPEN",
    "complements",
    "forward",
    "inertias",
    "inverse",
    "room_for",
    "write_complement",
    "write_efforts",
    "write_inertia",
    "write_joints",
    "write_rates",
    "write_turning",
]

# Nothing resists some motion; loops are open by more than this (rad, m over the size).
NO_MASS, OPEN = 4, 5
_OPEN = 1e-6

# Jacobians and their factors, what solving needs, the complement and twists, and the unit matrix.
Room = namedtuple(
    "Room", ("J", "T", "R", "Q", "A", "B", "D", "N", "t", "unit", "change", "own", "t_one")
)


@inline
def room_for(starts, dof):
    limbs, widest = starts.size - 1, 1
    for i in range(limbs):
        widest = max(widest, starts[i + 1] - starts[i])
    return Room(
        np.zeros((limbs, 6, widest)),
        np.empty((limbs, 4, 4)),
        np.empty((limbs, 6, widest)),
        np.empty((limbs, 6, 6)),
        np.empty((6 * limbs, 6)),
        np.empty((6 * limbs, dof)),
        np.empty((limbs, 6, dof)),
        np.empty((starts[limbs], dof)),
        np.empty((6, dof)),
        np.eye(dof),
        np.empty((6, widest)),
        np.zeros(widest),
        np.empty((6, 1)),
    )


@lean
def write_joints(starts, drives, scale, given, room, twists, out):
    """Solve the loops for all joints (n, c) from the drives (m, c), and from D in the room."""
    J, R, Q, D = room.J, room.R, room.Q, room.D
    return solve(starts, drives, scale, J, R, Q, given, D, room.A, room.B, out, twists)


@lean
def write_complement(model, starts, drives, scale, q, room):
    """Write the complement N (n, m) of the loops to the room; return a status."""
    status = factors(model, starts, drives, q, scale, room.J, room.T, room.R, room.Q)
    if status != REGULAR:
        return status
    if not loop_errors(room.T, scale, room.D) <= _OPEN:
        return OPEN
    for i in range(room.D.shape[0]):
        for r in range(6):
            for c in range(room.D.shape[2]):
                room.D[i, r, c] = 0.0
    return write_joints(starts, drives, scale, room.unit, room, room.t, room.N)


@lean
def write_rates(N, rates, qd):
    """Write the rates of all joints (n,) for those of the drives (m,)."""
    for j in range(N.shape[0]):
        total = 0.0
        for a in range(N.shape[1]):
            total += N[j, a] * rates[a]
        qd[j] = total


@lean
def write_turning(starts, scale, qd, V, room):
    """Write what the turning of the axes does to columns V (n, c): ``d(J)/dt V`` of each chain."""
    for i in range(starts.size - 1):
        s, e = starts[i], starts[i + 1]
        for j in range(room.own.size):
            room.own[j] = qd[s + j] if j < e - s else 0.0
        rate_body(room.J[i], room.own, room.change)
        for r in range(6):
            unit = 1.0 if r < 3 else 1.0 / scale
            for c in range(V.shape[1]):
                total = 0.0
                for j in range(e - s):
                    total += room.change[r, j] * V[s + j, c]
                room.D[i, r, c] = total * unit


@lean
def write_efforts(model, starts, q, qd, qdd, around, free, N, tau, out):
    """Write the efforts of the drives (m,); return a status."""
    for j in range(TIP_WRENCH):
        free[j] = around[j]
    status = 0
    for i in range(starts.size - 1):
        s, e = starts[i], starts[i + 1]
        surrounded = around if i == 0 else free
        chain = model[s + i : e + i + 1]
        status |= inverse_body(chain, q[s:e], qd[s:e], qdd[s:e], surrounded, tau[s:e])
    for a in range(out.size):
        total = 0.0
        for j in range(tau.size):
            total += N[j, a] * tau[j]
        out[a] = total
    return NOT_FINITE if status else REGULAR


@lean
def write_inertia(model, starts, q, N, M, P, out):
    """Write the generalised inertia (m, m); M and P are working space."""
    dof = out.shape[0]
    for a in range(dof):
        for b in range(dof):
            out[a, b] = 0.0
    status = 0
    for i in range(starts.size - 1):
        s, e = starts[i], starts[i + 1]
        status |= mass_body(model[s + i : e + i + 1], q[s:e], M)
        for j in range(e - s):
            for a in range(dof):
                total = 0.0
                for k in range(e - s):
                    total += M[j, k] * N[s + k, a]
                P[j, a] = total
        for a in range(dof):
            for b in range(a + 1):
                total = 0.0
                for j in range(e - s):
                    total += N[s + j, a] * P[j, b]
                out[a, b] += total
                out[b, a] = out[a, b]
    return NOT_FINITE if status else REGULAR


@lean
def _solved(G, x):
    """Solve G x = x in place by Cholesky's factors, which overwrite G; return a status."""
    dof = x.size
    for a in range(dof):
        for b in range(a + 1):
            total = G[a, b]
            for c in range(b):
                total -= G[a, c] * G[b, c]
            if a > b:
                G[a, b] = total / G[b, b]
            elif total > 1e-14 * G[a, a]:
                G[a, a] = math.sqrt(total)
            else:
                return NO_MASS
    for a in range(dof):
        for c in range(a):
            x[a] -= G[a, c] * x[c]
        x[a] /= G[a, a]
    for a in range(dof - 1, -1, -1):
        for c in range(a + 1, dof):
            x[a] -= G[c, a] * x[c]
        x[a] /= G[a, a]
    return REGULAR


@kernel(i8(IN2, IIN1, IIN1, f8, IN2, IN2, OUT3, OUT3, OUT2))
def complements(model, starts, drives, scale, q, rates, N, N_dot, qd):
    """Write N and its rate (b, n, m), and the rates of all joints (b, n)."""
    room = room_for(starts, rates.shape[1])
    still = np.zeros((rates.shape[1], rates.shape[1]))
    for b in range(q.shape[0]):
        status = write_complement(model, starts, drives, scale, q[b], room)
        if status != REGULAR:
            return status
        write_rates(room.N, rates[b], qd[b])
        write_turning(starts, scale, qd[b], room.N, room)
        N[b] = room.N
        status = write_joints(starts, drives, scale, still, room, room.t, N_dot[b])
        if status != REGULAR:
            return status
    return REGULAR


@kernel(i8(IN2, IIN1, IIN1, f8, IN2, IN2, IN2, IN2, OUT2))
def inverse(model, starts, drives, scale, q, rates, accelerations, around, out):
    """Write the efforts of the drives (b, m) for their rates and accelerations (b, m)."""
    dof, last = rates.shape[1], around.shape[0] - 1
    room = room_for(starts, dof)
    qd, qdd, tau = np.empty(q.shape[1]), np.empty(q.shape[1]), np.empty(q.shape[1])
    given, free = np.empty((dof, 1)), np.zeros(SURROUNDINGS)
    status = REGULAR
    for b in range(q.shape[0]):
        status = write_complement(model, starts, drives, scale, q[b], room)
        if status != REGULAR:
            return status
        write_rates(room.N, rates[b], qd)
        write_turning(starts, scale, qd, qd.reshape(-1, 1), room)
        for a in range(dof):
            given[a, 0] = accelerations[b, a]
        status = write_joints(starts, drives, scale, given, room, room.t_one, qdd.reshape(-1, 1))
        if status == REGULAR:
            surrounded, N = around[min(b, last)], room.N
            status = write_efforts(model, starts, q[b], qd, qdd, surrounded, free, N, tau, out[b])
        if status != REGULAR:
            return status
    return REGULAR


@kernel(i8(IN2, IIN1, IIN1, f8, IN2, IN2, IN2, IN2, OUT2))
def forward(model, starts, drives, scale, q, rates, efforts, around, out):
    """Write the accelerations of the drives (b, m) for their rates and efforts (b, m)."""
    dof, last = rates.shape[1], around.shape[0] - 1
    room = room_for(starts, dof)
    qd, qdd, tau = np.empty(q.shape[1]), np.empty(q.shape[1]), np.empty(q.shape[1])
    still, free = np.zeros((dof, 1)), np.zeros(SURROUNDINGS)
    widest = room.own.size
    M, P, G = np.empty((widest, widest)), np.empty((widest, dof)), np.empty((dof, dof))
    status = REGULAR
    for b in range(q.shape[0]):
        status = write_complement(model, starts, drives, scale, q[b], room)
        if status != REGULAR:
            return status
        write_rates(room.N, rates[b], qd)
        write_turning(starts, scale, qd, qd.reshape(-1, 1), room)
        status = write_joints(starts, drives, scale, still, room, room.t_one, qdd.reshape(-1, 1))
        if status == REGULAR:
            surrounded, N = around[min(b, last)], room.N
            status = write_efforts(model, starts, q[b], qd, qdd, surrounded, free, N, tau, out[b])
        if status == REGULAR:
            status = write_inertia(model, starts, q[b], room.N, M, P, G)
        if status == REGULAR:
            for a in range(dof):
                out[b, a] = efforts[b, a] - out[b, a]
            status = _solved(G, out[b])
        if status != REGULAR:
            return status
    return REGULAR


@kernel(i8(IN2, IIN1, IIN1, f8, IN2, OUT3))
def inertias(model, starts, drives, scale, q, out):
    """Write the generalised inertia (b, m, m)."""
    dof = out.shape[1]
    room = room_for(starts, dof)
    widest = room.own.size
    M, P = np.empty((widest, widest)), np.empty((widest, dof))
    for b in range(q.shape[0]):
        status = write_complement(model, starts, drives, scale, q[b], room)
        if status == REGULAR:
            status = write_inertia(model, starts, q[b], room.N, M, P, out[b])
        if status != REGULAR:
            return status
    return REGULAR
