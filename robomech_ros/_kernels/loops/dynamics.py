"""Dynamics of chains that carry one platform, by the natural orthogonal complement of their loops.

The rates of all joints of the open chains are ``N u`` with the rates u of the drives.  So torques
tau by Newton and Euler and mass matrices M of the single chains give the efforts ``N' tau`` and the
generalised inertia ``N' M N`` of the mechanism; the platform is the last body of the first chain.
Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 12.4.

``model`` has the chains one after another, n_i + 1 rows each, in the layout of ``dynamics.layout``.
``starts``, ``drives``, ``scale`` and status are those of :mod:`.factors`; further statuses are
below.  ``around`` has one row for all states or one for each; the wrench is on the platform.
"""

import math
from collections import namedtuple

import numpy as np

from robomech_ros._kernels.chain.jacobian_rates import rate_body
from robomech_ros._kernels.compiling.jit import inline, kernel, lean
from robomech_ros._kernels.compiling.types import IIN1, IN2, OUT2, OUT3, f8, i8
from robomech_ros._kernels.dynamics.inverse import inverse_body
from robomech_ros._kernels.dynamics.layout import SURROUNDINGS, TIP_WRENCH
from robomech_ros._kernels.dynamics.mass import mass_body
from robomech_ros._kernels.loops.factors import (
    NOT_FINITE,
    REGULAR,
    Chains,
    factors,
    loop_errors,
    room_for_factors,
    solve,
    widest,
)

# Statuses: a motion has no inertia; loops are open by more than _OPEN (rad, m over the size).
NO_MASS, OPEN = 4, 5
_OPEN = 1e-6

# Factors, work space of the solver, the complement and twists, and the unit matrix.
Room = namedtuple("Room", ("found", "D", "N", "t", "unit", "change", "own", "t_one"))


@inline
def room_for(starts, dof):
    return Room(
        room_for_factors(starts, dof),
        np.empty((starts.size - 1, 6, dof)),
        np.empty((starts[starts.size - 1], dof)),
        np.empty((6, dof)),
        np.eye(dof),
        np.empty((6, widest(starts))),
        np.zeros(widest(starts)),
        np.empty((6, 1)),
    )


@lean
def write_complement(chains, q, room):
    """Write the complement N (n, m) of the loops to ``room.N``; return a status."""
    status = factors(chains, q, room.found)
    if status != REGULAR:
        return status
    if not loop_errors(room.found.T, chains.scale, room.D) <= _OPEN:
        return OPEN
    for i in range(room.D.shape[0]):
        for r in range(6):
            for c in range(room.D.shape[2]):
                room.D[i, r, c] = 0.0
    return solve(chains, room.found, room.unit, room.D, room.N, room.t)


@lean
def write_rates(N, rates, qd):
    """Write the rates of all joints (n,) for those of the drives (m,)."""
    for j in range(N.shape[0]):
        total = 0.0
        for a in range(N.shape[1]):
            total += N[j, a] * rates[a]
        qd[j] = total


@lean
def write_turning(chains, qd, V, room):
    """Write ``dJ/dt V`` of each chain, which rotating axes cause, for columns V (n, c)."""
    starts = chains.starts
    for i in range(starts.size - 1):
        s, e = starts[i], starts[i + 1]
        for j in range(room.own.size):
            room.own[j] = qd[s + j] if j < e - s else 0.0
        rate_body(room.found.J[i], room.own, room.change)
        for r in range(6):
            unit = 1.0 if r < 3 else 1.0 / chains.scale
            for c in range(V.shape[1]):
                total = 0.0
                for j in range(e - s):
                    total += room.change[r, j] * V[s + j, c]
                room.D[i, r, c] = total * unit


@lean
def write_efforts(chains, q, qd, qdd, around, free, N, tau, out):
    """Write the efforts of the drives (m,); return a status."""
    model, starts = chains.packed, chains.starts
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
def write_inertia(chains, q, N, M, P, out):
    """Write the generalised inertia (m, m); M and P are working space."""
    model, starts, dof = chains.packed, chains.starts, out.shape[0]
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
    """Overwrite x with G^-1 x by Cholesky factors, which overwrite G; return a status."""
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
    chains, room = Chains(model, starts, drives, scale), room_for(starts, rates.shape[1])
    still = np.zeros((rates.shape[1], rates.shape[1]))
    for b in range(q.shape[0]):
        status = write_complement(chains, q[b], room)
        if status != REGULAR:
            return status
        write_rates(room.N, rates[b], qd[b])
        write_turning(chains, qd[b], room.N, room)
        N[b] = room.N
        status = solve(chains, room.found, still, room.D, N_dot[b], room.t)
        if status != REGULAR:
            return status
    return REGULAR


@lean
def _efforts_of(chains, q, rates, given, around, rows, room, out):
    """Write the efforts of the drives (m,) for their rates and accelerations; return a status."""
    qd, qdd, tau, free = rows
    status = write_complement(chains, q, room)
    if status == REGULAR:
        write_rates(room.N, rates, qd)
        write_turning(chains, qd, qd.reshape(-1, 1), room)
        status = solve(chains, room.found, given, room.D, qdd.reshape(-1, 1), room.t_one)
    if status == REGULAR:
        status = write_efforts(chains, q, qd, qdd, around, free, room.N, tau, out)
    return status


@kernel(i8(IN2, IIN1, IIN1, f8, IN2, IN2, IN2, IN2, OUT2))
def inverse(model, starts, drives, scale, q, rates, accelerations, around, out):
    """Write the efforts of the drives (b, m) for their rates and accelerations (b, m)."""
    dof, last = rates.shape[1], around.shape[0] - 1
    chains, room = Chains(model, starts, drives, scale), room_for(starts, dof)
    qd, qdd, tau = np.empty(q.shape[1]), np.empty(q.shape[1]), np.empty(q.shape[1])
    given, rows = np.empty((dof, 1)), (qd, qdd, tau, np.zeros(SURROUNDINGS))
    for b in range(q.shape[0]):
        for a in range(dof):
            given[a, 0] = accelerations[b, a]
        surrounded = around[min(b, last)]
        status = _efforts_of(chains, q[b], rates[b], given, surrounded, rows, room, out[b])
        if status != REGULAR:
            return status
    return REGULAR


@kernel(i8(IN2, IIN1, IIN1, f8, IN2, IN2, IN2, IN2, OUT2))
def forward(model, starts, drives, scale, q, rates, efforts, around, out):
    """Write the accelerations of the drives (b, m) for their rates and efforts (b, m)."""
    dof, last = rates.shape[1], around.shape[0] - 1
    chains, room = Chains(model, starts, drives, scale), room_for(starts, dof)
    qd, qdd, tau = np.empty(q.shape[1]), np.empty(q.shape[1]), np.empty(q.shape[1])
    still, rows = np.zeros((dof, 1)), (qd, qdd, tau, np.zeros(SURROUNDINGS))
    widest = room.own.size
    M, P, G = np.empty((widest, widest)), np.empty((widest, dof)), np.empty((dof, dof))
    for b in range(q.shape[0]):
        surrounded = around[min(b, last)]
        status = _efforts_of(chains, q[b], rates[b], still, surrounded, rows, room, out[b])
        if status == REGULAR:
            status = write_inertia(chains, q[b], room.N, M, P, G)
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
    chains, room = Chains(model, starts, drives, scale), room_for(starts, dof)
    widest = room.own.size
    M, P = np.empty((widest, widest)), np.empty((widest, dof))
    for b in range(q.shape[0]):
        status = write_complement(chains, q[b], room)
        if status == REGULAR:
            status = write_inertia(chains, q[b], room.N, M, P, out[b])
        if status != REGULAR:
            return status
    return REGULAR
