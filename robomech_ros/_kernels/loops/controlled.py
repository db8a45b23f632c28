"""Simulation of chains that carry one platform, under a controller of their drives.

It is like :mod:`..dynamics.controlled_chain`, but over the drives: with the complement N of the
loops, new rates of the drives come from the generalised inertia ``N' M N`` and the efforts of
gravity and motion, with dry friction and stops of the drives.  Friction of passive joints is
implicit, too: dry friction c at the last rate r acts as viscous friction ``c / |r|``, which is
exact while they move, and lets them creep at rest.  After each step, loops are closed from the last
posture; a step that would leave the assembly mode is not done.
"""

import math
from collections import namedtuple

import numpy as np

from robomech_ros._kernels.compiling.jit import inline, kernel, lean, linked
from robomech_ros._kernels.compiling.types import IIN1, IN1, IN2, IN3, IOUT1, OUT1, OUT2, i8
from robomech_ros._kernels.dynamics.controlled_chain import COMPUTED_TORQUE, RUNS_AWAY
from robomech_ros._kernels.dynamics.dry_friction import AT_STOP, dry_friction, settled_rates
from robomech_ros._kernels.dynamics.layout import SURROUNDINGS
from robomech_ros._kernels.loops.dynamics import (
    room_for,
    write_complement,
    write_efforts,
    write_inertia,
    write_rates,
    write_turning,
)
from robomech_ros._kernels.loops.factors import REGULAR, Chains, solve
from robomech_ros._kernels.loops.loop_closure import close

_call_close = linked(close)

# Rate of a passive joint below which its dry friction no longer grows (rad/s, m/s).
_CREEP = 1e-4

# For all joints: rates, accelerations without and with those of the drives, torques, a posture,
# zeros.  For the drives: equations of the rates, efforts of the controller and its model, and more.
Work = namedtuple(
    "Work",
    "qd drift qdd tau trial none M P A b dry low high v asked effort explained before target"
    " free report",
)


@inline
def _work_for(n, m, widest):
    return Work(
        np.empty(n),
        np.empty(n),
        np.empty(n),
        np.empty(n),
        np.empty(n),
        np.zeros(n),
        np.empty((widest, widest)),
        np.empty((widest, m)),
        np.empty((m, m)),
        np.empty(m),
        np.empty(m),
        np.empty(m),
        np.empty(m),
        np.empty(m),
        np.empty(m),
        np.empty(m),
        np.empty(m),
        np.empty(m),
        np.empty(m),
        np.zeros(SURROUNDINGS),
        np.empty(2),
    )


@lean
def _update_rates(chains, q, rates, room, work):
    """Write the complement N, the rates of all joints, and accelerations ``dN/dt u``."""
    status = write_complement(chains, q, room)
    if status != REGULAR:
        return status
    write_rates(room.N, rates, work.qd)
    write_turning(chains, work.qd, work.qd.reshape(-1, 1), room)
    still, drift = work.none[: rates.size].reshape(-1, 1), work.drift.reshape(-1, 1)
    return solve(chains, room.found, still, room.D, drift, room.t_one)


@lean
def _model_efforts(chains, q, qdd, around, room, work, out):
    """Write the efforts (m,) of a model for accelerations of the drives (m,); return a status."""
    for j in range(q.size):
        total = work.drift[j]
        for a in range(qdd.size):
            total += room.N[j, a] * qdd[a]
        work.qdd[j] = total
    free, N = work.free, room.N
    return write_efforts(chains, q, work.qd, work.qdd, around, free, N, work.tau, out)


@lean
def _add_friction(friction, N, rates, before, sign, out):
    """Add the friction of all joints at rates of the drives (m,), times a sign, to out (m,).

    The magnitude of dry friction is that at the rates `before`.
    """
    for j in range(N.shape[0]):
        rate, was = 0.0, 0.0
        for a in range(rates.size):
            rate += N[j, a] * rates[a]
            was += N[j, a] * before[a]
        if rate == 0.0:
            continue
        lost = friction[0, j] * rate + math.copysign(dry_friction(friction, j, was), rate)
        for a in range(rates.size):
            out[a] += sign * N[j, a] * lost


@lean
def _command(chains, tables, mode, around, q, rates, wanted, room, work):
    """Write the efforts (m,) of the controller; wanted is [position, rate, acceleration] (3, m)."""
    for j in range(q.size):
        a = chains.drives[j]
        if a >= 0:
            error = tables[4, j] * (wanted[0, a] - q[j])
            work.asked[a] = error + tables[5, j] * (wanted[1, a] - rates[a])
            if mode == COMPUTED_TORQUE:
                work.asked[a] += wanted[2, a]
    if mode == COMPUTED_TORQUE:
        status = _model_efforts(chains, q, work.asked, around, room, work, work.effort)
    else:
        none, free, N, effort = work.none, work.free, room.N, work.effort
        status = write_efforts(chains, q, none, none, around, free, N, work.tau, effort)
        for a in range(rates.size):
            work.effort[a] += work.asked[a]
    _add_friction(tables[:4], room.N, wanted[1], wanted[1], 1.0, work.effort)
    return status


@lean
def _set_up(chains, tables, around, step, q, rates, room, work):
    """Write the equations for the rates at the end of a step; return a status."""
    m = rates.size
    status = _model_efforts(chains, q, work.none[:m], around, room, work, work.explained)
    status |= write_inertia(chains, q, room.N, work.M, work.P, work.A)
    for a in range(m):
        value = step * (work.effort[a] - work.explained[a])
        for c in range(m):
            value += work.A[a, c] * rates[c]
        work.b[a], work.v[a] = value, rates[a]
    for j in range(q.size):
        viscous, a = step * tables[0, j], chains.drives[j]
        dry = step * dry_friction(tables, j, work.qd[j])
        if a >= 0:
            work.A[a, a] += viscous
            work.dry[a] = dry
            work.low[a] = (tables[4, j] - q[j]) / step
            work.high[a] = (tables[5, j] - q[j]) / step
            continue
        viscous += dry / max(abs(work.qd[j]), _CREEP)
        if viscous > 0.0:
            for a in range(m):
                for c in range(m):
                    work.A[a, c] += viscous * room.N[j, a] * room.N[j, c]
    return status


@lean
def _observe(chains, tables, around, share, period, state, room, work):
    """Add a share of the efforts that the model does not explain to the observed ones.

    ``state`` (2, m) has the rates at the end of the period, and the observed efforts.  ``room`` and
    the posture ``work.trial`` are those at its start.
    """
    rates, seen = state[0], state[1]
    for a in range(rates.size):
        work.asked[a] = (rates[a] - work.before[a]) / period
    status = _model_efforts(chains, work.trial, work.asked, around, room, work, work.explained)
    _add_friction(tables[:4], room.N, rates, work.before, 1.0, work.explained)
    for j in range(chains.drives.size):
        a = chains.drives[j]
        if a >= 0:
            if work.low[a] >= -AT_STOP or work.high[a] <= AT_STOP:
                seen[a] = 0.0
            elif rates[a] != 0.0 or tables[1, j] + tables[2, j] == 0.0:
                value = seen[a] + share * (work.effort[a] - work.explained[a] - seen[a])
                seen[a] = min(max(value, -tables[6, j]), tables[6, j])
    return status


@inline
def _move(chains, weights, step, q, rates, work):
    """Solve for the rates and move by one step; if the status is not 0, nothing changes."""
    if not settled_rates(work.A, work.b, work.dry, work.low, work.high, work.v, rates.size):
        return RUNS_AWAY
    work.trial[:] = q
    for j in range(chains.drives.size):
        a = chains.drives[j]
        if a >= 0:
            work.target[a] = q[j] + step * work.v[a]
    packed, starts, drives, scale = chains
    target, trial, report = work.target, work.trial, work.report
    status = _call_close(packed, starts, drives, scale, weights, target, trial, report)
    if status == REGULAR:
        q[:], rates[:] = work.trial, work.v
    return status


@lean
def _remaining_travel(tables, drives, q, work):
    """Write the remaining travel of drives to both stops."""
    for j in range(drives.size):
        a = drives[j]
        if a >= 0:
            work.low[a], work.high[a] = tables[4, j] - q[j], tables[5, j] - q[j]


@kernel(i8(IN2, IIN1, IIN1, IN1, IN3, IN3, IN1, IN1, IN3, OUT1, OUT2, IOUT1))
def servo_steps(
    packed, starts, drives, weights, models, tables, settings, around, wanted, state, out, report
):
    """Simulate a controller of the m drives along a desired motion; return a status.

    ``packed``, ``starts``, ``drives`` and ``weights`` are as for :func:`.loop_closure.close`.
    ``models`` (2, n + limbs, 24) are the simulated chains and the controller's model of them, as
    for :mod:`.dynamics`.  ``tables`` (2, 7, n) belong to the simulated chains and to the
    controller.  The first four rows are the friction of all joints, as for ``controlled_chain``;
    then, of the former, smallest and largest positions; of the latter, gains of errors and of
    rates, and largest efforts.  ``settings`` (5,) are the scale of :mod:`.factors`, mode and
    share of ``controlled_chain``, period (s) and its number of steps.  For ``around`` (15,)
    see ``dynamics.layout``.

    ``wanted`` (k, 3, m) are positions, rates and accelerations of the drives at the start of each
    period.  The ``state`` (n + 2 m,), positions of all joints, rates and observed efforts of the
    drives, is advanced to the end; if the status is not 0, to the last valid state.  ``out``
    (k, n + 2 m) receives positions and rates at the end of each period, and its efforts, and
    ``report`` (1,) the number of periods.
    """
    n, m, scale, share, period = drives.size, wanted.shape[2], settings[0], settings[2], settings[3]
    mode, substeps = int(settings[1]), int(settings[4])
    step = period / substeps
    room = room_for(starts, m)
    work = _work_for(n, m, room.own.size)
    q, rates, both = state[:n], state[n : n + m], state[n:].reshape(2, m)
    loops = Chains(packed, starts, drives, scale)
    plant = Chains(models[0], starts, drives, scale)
    model = Chains(models[1], starts, drives, scale)
    joints, known = tables[0], tables[1]
    initial = np.empty(n)
    for k in range(wanted.shape[0]):
        report[0] = k
        status = _update_rates(plant, q, rates, room, work)
        if status == REGULAR:
            status = _command(model, known, mode, around, q, rates, wanted[k], room, work)
        if status != REGULAR:
            return status
        initial[:] = q
        for j in range(n):
            a = drives[j]
            if a >= 0:
                work.before[a], limit = rates[a], known[6, j]
                work.effort[a] = min(max(work.effort[a] + both[1, a], -limit), limit)
        for substep in range(substeps):
            if substep > 0:
                status = _update_rates(plant, q, rates, room, work)
            if status == REGULAR:
                status = _set_up(plant, joints, around, step, q, rates, room, work)
            if status == REGULAR:
                status = _move(loops, weights, step, q, rates, work)
            if status != REGULAR:
                return status
        if share > 0.0:
            _remaining_travel(joints, drives, q, work)
            if substeps > 1:
                status = _update_rates(plant, initial, work.before, room, work)
            work.trial[:] = initial
            if status == REGULAR:
                status = _observe(model, known, around, share, period, both, room, work)
            if status != REGULAR:
                return status
        out[k, :n], out[k, n : n + m], out[k, n + m :] = q, rates, work.effort
        report[0] = k + 1
    return REGULAR
