"""Simulation: the motion of a chain or another system under given or computed torques."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from robomech_ros.dynamics.model import GRAVITY, positive_number
from robomech_ros.dynamics.simulation.equations_of_motion import EquationsOfMotion, Torque
from robomech_ros.dynamics.simulation.event_detection import Event
from robomech_ros.dynamics.simulation.integration import (
    FINISHED,
    MOST_STEPS,
    Integration,
    Record,
    SolverChoice,
)
from robomech_ros.dynamics.systems import DynamicSystem, dynamic_system
from robomech_ros.errors import BadValueError, NonFiniteError, WrongSizeError
from robomech_ros.robots.chain import SerialChain
from robomech_ros.spatial.arrays import as_choice, as_finite, listed, real_array, real_within
from robomech_ros.typing import Array, ArrayLike

SOLVERS = ("DOP853", "RK45", "RK23", "LSODA", "Radau", "BDF", "midpoint")
AT_LIMITS = ("ignore", "end", "bounce")

# The longest duration (s), and the least relative tolerance that scipy's solvers take as it is.
_LONGEST = 1e6
_LEAST_RTOL = 100.0 * float(np.finfo(np.float64).eps)


@dataclass(frozen=True, eq=False)
class Simulation:
    """Simulated motion of a chain or of another system of n joints.

    Attributes
    ----------
    t : ndarray, shape (m,)
        The times asked for, or those of the integrator's steps (s), as far as it came; where it
        ended before, its end is the last of them.
    q, qd : ndarray, shape (m, n)
        Joint values (rad or m) and rates (rad/s or m/s).
    kinetic, potential : ndarray, shape (m,)
        Energies (J).
    work, heat : ndarray, shape (m,)
        What drives and tip wrench have put in, and friction and bounces have taken (J).
    drift : float
        Largest magnitude of what the energy balance leaves (J).
    events : tuple of (float, int)
        Time and number of each of the user's events, in order.
    reason : str
        ``"finished"``, or why it ended before: at which limit, by which event, because the
        numbers ran away, or because the assembly mode of a parallel robot ended in a singular
        posture.  The last state is the last that was good.
    """

    t: Array
    q: Array
    qd: Array
    kinetic: Array
    potential: Array
    work: Array
    heat: Array
    drift: float
    events: tuple[tuple[float, int], ...]
    reason: str


def simulate(
    chain: SerialChain | DynamicSystem,
    q0: ArrayLike,
    qd0: ArrayLike,
    torque: ArrayLike | Torque | None,
    duration: float,
    *,
    gravity: ArrayLike = GRAVITY,
    tip_wrench: ArrayLike | None = None,
    method: str = "DOP853",
    rtol: float = 1e-10,
    atol: float = 1e-12,
    step: float | None = None,
    rest_rate: float = 1e-2,
    at_limits: str = "ignore",
    restitution: float = 0.5,
    events: Sequence[Event] = (),
    times: ArrayLike | None = None,
) -> Simulation:
    r"""Integrate the motion of a chain or a parallel robot, with the friction of its joints.

    .. math:: I(q)\, \ddot q = \tau - C(q, \dot q)\, \dot q - \gamma(q) - \delta(\dot q)

    Parameters
    ----------
    chain : SerialChain or DynamicSystem
        Of n joints, with the bodies that they move; m of them have drives, all of a chain.  Loops
        of a parallel robot (``ParallelDynamics``) are closed in every state.
    q0 : array_like, shape (n,)
        Joint values (rad or m) at the start.
    qd0 : array_like, shape (m,)
        Rates of the drives (rad/s or m/s) at the start.
    torque : array_like of shape (m,), callable, or None
        Torque of the drives (N m or N): constant, ``torque(t, q, qd)`` with all joints, or none.
    duration : float
        In s, up to 1e6; no more than 200,000 steps are done.
    gravity, tip_wrench
        As for :func:`inverse_dynamics`; the wrench keeps its direction and goes with the tip.
    method : str, optional
        One of SOLVERS: those of scipy's solve_ivp, with a step that keeps the tolerances, or
        ``"midpoint"``, the implicit midpoint rule in joint values and momenta with a fixed
        step, which is symplectic: without friction the energy does not drift, however long.
    rtol, atol : float, optional
        Relative (at least 2.3e-14) and absolute tolerance of a step; not for ``"midpoint"``.
    step : float, optional
        Longest step (s), or the step of ``"midpoint"``, 1e-3 unless given.
    rest_rate : float, optional
        Rate (rad/s or m/s) within which dry friction goes over from one direction to the other,
        as ``tanh(rate / rest_rate)``: joints that it holds creep.  :class:`ControlledArm` has
        friction that holds.
    at_limits : str, optional
        What happens where a joint comes to a position limit: ``"ignore"``, ``"end"`` of the
        simulation, or ``"bounce"``.
    restitution : float, optional
        Part of its rate with which a joint bounces, from 0 to 1.
    events : sequence of callable, optional
        ``event(t, q, qd)``; its zeros are noted, and end the simulation where the attribute
        ``terminal`` is true.
    times : array_like, shape (m,), optional
        When the state is recorded (s), increasing; default after each step.

    Raises
    ------
    MissingInertiaError, BadValueError, WrongSizeError
        As for :func:`forward_dynamics`, for the start; or a number or a function is not what it has
        to be. Motions that run away, with rates above 1e6 rad/s or m/s, raise nothing.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 7.6.3; Hairer, Lubich,
    Wanner, Geometric Numerical Integration, 2nd ed., Springer 2006, section II.1, for the rule.

    Examples
    --------
    >>> from robomech_ros.dynamics import simulate
    >>> from robomech_ros.robots import load_robot
    >>> arm = load_robot("planar3r")
    >>> down = [0.0, -9.81, 0.0]
    >>> run = simulate(arm, [0.3, -0.7, 1.1], [0.0, 0.0, 0.0], None, 0.5, gravity=down)
    >>> round(float(run.t[-1]), 6), run.reason, run.drift < 1e-4
    (0.5, 'finished', True)
    """
    system = dynamic_system(chain)
    q, rates = system.checked_posture(q0, "q0"), _of_drives(system, qd0, "qd0")
    duration = positive_number("duration", duration)
    if duration > _LONGEST:
        raise BadValueError("duration", duration, f"at most {_LONGEST:g} s")
    choice = _choice(method, step, duration, rtol, atol)
    limits = as_choice("at_limits", at_limits, AT_LIMITS)
    part = real_within("restitution", restitution, "a number from 0 to 1", 0.0, 1.0)
    wrench = None if tip_wrench is None else as_finite("tip_wrench", tip_wrench, (6,))
    drives, slow = _as_torque(system, torque), positive_number("rest_rate", rest_rate)
    motion = EquationsOfMotion(system, q, drives, gravity, wrench, slow)
    # A wrong start is refused; what goes wrong later is the reason of the end.
    first = motion.requested_torque(0.0, q, rates)
    system.forward(q, rates, first, gravity=gravity, tip_wrench=wrench)
    watched = _watched(events)
    record = Record(as_times(times, duration))
    integration = Integration(motion, choice, limits, part, watched, record)
    state = np.concatenate((q[system.drives_at], rates, [0.0, 0.0]))
    # The states themselves show an overflow.
    with np.errstate(over="ignore", invalid="ignore"), warnings.catch_warnings():
        # LSODA warns of what the reason says.
        warnings.filterwarnings("ignore", "lsoda", UserWarning)
        reason = integration.run(state, duration)
    if reason != FINISHED:
        record.close()
    return _simulation(motion, record, integration, reason)


def _simulation(
    motion: EquationsOfMotion, record: Record, integration: Integration, reason: str
) -> Simulation:
    seen = tuple(integration.seen)
    system, n = motion.system, len(motion.start)
    rows = np.array(record.states).reshape(-1, 2 * n + 2)
    q, qd = rows[:, :n].copy(), rows[:, n : 2 * n].copy()
    work, heat = rows[:, -2].copy(), rows[:, -1].copy()
    kinetic = system.kinetic_energy(q, qd[:, system.drives_at])
    potential = system.potential_energy(q, gravity=motion.gravity)
    left = kinetic + potential - work + heat
    drift = float(np.abs(left - left[0]).max()) if len(left) else 0.0
    return Simulation(
        np.array(record.t), q, qd, kinetic, potential, work, heat, drift, seen, reason
    )


def _choice(method: str, step: object, duration: float, rtol: object, atol: object) -> SolverChoice:
    kind = as_choice("method", method, SOLVERS)
    longest = _as_step(kind, step, duration)
    relative, absolute = positive_number("rtol", rtol), positive_number("atol", atol)
    if relative < _LEAST_RTOL:
        raise BadValueError("rtol", rtol, f"at least {_LEAST_RTOL:.2g}")
    return SolverChoice(kind, longest, relative, absolute)


def _of_drives(system: DynamicSystem, value: ArrayLike, what: str) -> Array:
    m = len(system.drive_names)
    array = np.ascontiguousarray(real_array(what, value))
    if array.shape != (m,):
        raise WrongSizeError(what, array.shape, f"({m},)")
    for joint, number in zip(system.drive_names, array.tolist(), strict=True):
        if not np.isfinite(number):
            raise NonFiniteError(f"{what} of joint '{joint}'", number)
    return array


def _as_torque(system: DynamicSystem, torque: ArrayLike | Torque | None) -> Torque:
    if isinstance(torque, type):
        raise BadValueError("torque", torque, "an array of real numbers, or a function")
    if callable(torque):
        return torque
    constant = np.zeros(len(system.drive_names))
    if torque is not None:
        constant = _of_drives(system, torque, "torque")
    return lambda t, q, qd: constant


def _as_step(method: str, step: object, duration: float) -> float | None:
    """Return the longest step, or the one of the midpoint rule, that comes to the end."""
    if step is None and method != "midpoint":
        return None
    length = 1e-3 if step is None else positive_number("step", step)
    least = duration / MOST_STEPS
    if length < least:
        raise BadValueError("step", length, f"at least {least:.3g} s, or a shorter duration")
    return length


def _watched(events: Sequence[Event]) -> list[Event]:
    watched = list(listed("events", events, "a list of functions of t, q and qd"))
    for event in watched:
        if not callable(event) or isinstance(event, type):
            raise BadValueError("one of events", event, "a function of t, q and qd")
    return watched


def as_times(times: ArrayLike | None, duration: float) -> Array | None:
    """Return the increasing times (m,) at which states are recorded (s); None stays."""
    if times is None:
        return None
    array = as_finite("times", times, ())
    if array.ndim != 1:
        raise WrongSizeError("times", array.shape, "(m,)")
    if len(array) and (array[0] < 0.0 or array[-1] > duration or (np.diff(array) < 0.0).any()):
        raise BadValueError("times", array.tolist(), f"increasing times from 0 to {duration:g} s")
    return array
