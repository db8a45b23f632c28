"""Simulation of a chain under a torque controller, in fixed time steps.

Positions follow from the new rates of each step, which :mod:`.dry_friction` computes with friction
and stops, so that the motion neither gains energy nor chatters.

The controller may have a disturbance observer: it adds the torques that its model, with friction,
does not explain by the motion of the last period.  Sources: Ohnishi, Shibata, Murakami, Motion
control for advanced mechatronics, IEEE/ASME Trans. Mechatronics 1(1), 1996; with the share 1 it is
the time delay control of Youcef-Toumi, Ito, ASME J. Dynamic Systems, Measurement, and Control
112(1), 1990.
"""

import math

from robomech_ros._kernels.chain.coupling import drive_count
from robomech_ros._kernels.chain.serial import OK
from robomech_ros._kernels.compiling.jit import kernel, lean, scratch
from robomech_ros._kernels.compiling.types import IN1, IN2, IN3, OUT2, OUT3, f8, i8
from robomech_ros._kernels.dynamics.dry_friction import (
    AT_STOP,
    MOST_SERVO_JOINTS as MOST_SERVO_JOINTS,
    dry_friction,
    settled_rates,
)
from robomech_ros._kernels.dynamics.inverse import gravity_body, inverse_body
from robomech_ros._kernels.dynamics.mass import mass_body

COMPUTED_TORQUE = 0
PD_WITH_GRAVITY = 1

RUNS_AWAY = 4

# Rows after the four of friction, for the plant (STOPS) and for the controller.
STOPS = 4
GAINS = 4
EFFORT = 6


@lean
def _command(model, friction, gains, mode, around, q, qd, wanted, tau):
    """Write the controller's torques (n,); wanted is [q, qd, qdd] (3, n)."""
    asked = scratch(MOST_SERVO_JOINTS)
    count = drive_count(model)
    for i in range(count):
        asked[i] = gains[0, i] * (wanted[0, i] - q[i]) + gains[1, i] * (wanted[1, i] - qd[i])
        if mode == COMPUTED_TORQUE:
            asked[i] += wanted[2, i]
    if mode == COMPUTED_TORQUE:
        status = inverse_body(model, q, qd, asked[:count], around, tau)
    else:
        status = gravity_body(model, q, around, tau)
    for i in range(count):
        if mode == PD_WITH_GRAVITY:
            tau[i] += asked[i]
        rate = wanted[1, i]
        tau[i] += friction[0, i] * rate
        if rate != 0.0:
            tau[i] += math.copysign(dry_friction(friction, i, rate), rate)
    return status


@lean
def _observe(model, friction, stops, around, tau, limit, share, period, before, state, seen):
    """Add a share of the torques that the model does not explain to the observed ones.

    ``before`` and ``state`` are positions and rates (2, n) at both ends of the period of tau.
    A value is constant while its joint rests with dry friction, and 0 while it is at a stop.
    """
    rates = scratch(MOST_SERVO_JOINTS)
    explained = scratch(MOST_SERVO_JOINTS)
    count = drive_count(model)
    for i in range(count):
        rates[i] = (state[1, i] - before[1, i]) / period
    status = inverse_body(model, before[0], before[1], rates[:count], around, explained)
    for i in range(count):
        rate = state[1, i]
        if state[0, i] - stops[0, i] <= AT_STOP or stops[1, i] - state[0, i] <= AT_STOP:
            seen[i] = 0.0
        elif rate != 0.0 or friction[1, i] + friction[2, i] == 0.0:
            rest = tau[i] - explained[i] - friction[0, i] * rate
            if rate != 0.0:
                rest -= math.copysign(dry_friction(friction, i, before[1, i]), rate)
            value = seen[i] + share * (rest - seen[i])
            seen[i] = min(max(value, -limit[i]), limit[i])
    return status


@lean
def _plant_step(model, friction, stops, around, tau, step, q, qd):
    """Move the chain by one time step; if it would diverge, its state does not change."""
    A = scratch(MOST_SERVO_JOINTS, MOST_SERVO_JOINTS)
    bias = scratch(MOST_SERVO_JOINTS)
    none = scratch(MOST_SERVO_JOINTS)
    b = scratch(MOST_SERVO_JOINTS)
    dry = scratch(MOST_SERVO_JOINTS)
    low = scratch(MOST_SERVO_JOINTS)
    high = scratch(MOST_SERVO_JOINTS)
    v = scratch(MOST_SERVO_JOINTS)
    count = drive_count(model)
    for i in range(count):
        none[i] = 0.0
        v[i] = qd[i]
    status = mass_body(model, q, A)
    status |= inverse_body(model, q, qd, none[:count], around, bias)
    if status != OK:
        return status
    for i in range(count):
        value = step * (tau[i] - bias[i])
        for j in range(count):
            value += A[i, j] * qd[j]
        b[i] = value
        dry[i] = step * dry_friction(friction, i, qd[i])
        low[i] = (stops[0, i] - q[i]) / step
        high[i] = (stops[1, i] - q[i]) / step
    for i in range(count):
        A[i, i] += step * friction[0, i]
    if not settled_rates(A, b, dry, low, high, v, count):
        return RUNS_AWAY
    for i in range(count):
        qd[i] = v[i]
        q[i] += step * v[i]
    return OK


@kernel(i8(IN2, IN2, IN2, IN2, i8, f8, IN1, IN3, f8, i8, OUT2, OUT3))
def servo_steps(
    plant, joints, model, controller, mode, share, around, wanted, period, substeps, state, out
):
    """Simulate a controller along a desired motion of a chain; return the number of periods.

    ``plant`` and ``model`` (n + 1, 24) are the simulated chain and the controller's model of it.
    ``joints`` (6, n) of the plant are viscous friction, Coulomb friction, the excess of static
    friction, and the inverse of the rate at which this decays; from STOPS on the smallest and
    largest positions, infinite without stops.  ``controller`` (7, n) has the friction of the model;
    from GAINS on the gains of errors and of their rates, in accelerations or, for PD_WITH_GRAVITY,
    torques; at EFFORT the largest torques, infinite without limits.  The ``mode`` is
    COMPUTED_TORQUE or PD_WITH_GRAVITY.  The ``share`` is the fraction of unexplained torques that
    the observer adds in a period.  For ``around`` (15,) see ``dynamics.layout``.

    ``wanted`` (m, 3, n) are positions, rates and accelerations at the start of each ``period`` (s),
    in which the plant moves in ``substeps``.  The ``state`` (3, n), positions, rates and observed
    torques, is advanced to the end.  ``out`` (m, 3, n) receives positions and rates at the end of
    each period, and its torques.
    """
    tau = scratch(MOST_SERVO_JOINTS)
    before = scratch(2, MOST_SERVO_JOINTS)
    count = drive_count(plant)
    q, qd, seen = state[0], state[1], state[2]
    friction, stops = joints[:STOPS], joints[STOPS:]
    known, gains, effort = controller[:GAINS], controller[GAINS:EFFORT], controller[EFFORT]
    for k in range(wanted.shape[0]):
        if _command(model, known, gains, mode, around, q, qd, wanted[k], tau) != OK:
            return k
        for i in range(count):
            before[0, i], before[1, i] = q[i], qd[i]
            tau[i] = min(max(tau[i] + seen[i], -effort[i]), effort[i])
        for _ in range(substeps):
            step = period / substeps
            if _plant_step(plant, friction, stops, around, tau, step, q, qd) != OK:
                return k
        if share > 0.0:
            status = _observe(
                model, known, stops, around, tau, effort, share, period, before, state, seen
            )
            if status != OK:
                return k
        for i in range(count):
            out[k, 0, i], out[k, 1, i], out[k, 2, i] = q[i], qd[i], tau[i]
    return wanted.shape[0]
