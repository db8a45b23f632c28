"""Motions of rolling robots in time, under torques."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp

from robomech_ros.errors import BadValueError
from robomech_ros.rolling.argument_checks import duration as checked_duration, one_vector
from robomech_ros.rolling.dynamics import RollingDynamics
from robomech_ros.rolling.steering_motion import SteeringMotion
from robomech_ros.spatial.arrays import check_kind
from robomech_ros.typing import Array, ArrayLike, IntArray

# From the time (s), the twist (3,) and the brackets' angles (c,), and the SteeringMotion of a base
# with steered wheels, to torques (k + s,) (N m).
Torques = Callable[..., ArrayLike]

# Tolerances of the integrator, relative and absolute: energy is constant to 1e-8 in ten seconds.
_RTOL, _ATOL = 1e-11, 1e-12
_LONGEST = 3600.0


@dataclass(frozen=True, eq=False)
class RollingSimulation:
    """Simulated motion of a rolling robot.

    Attributes
    ----------
    t : ndarray, shape (n,)
        Times (s).
    pose : ndarray, shape (n, 3)
        x, y (m) and heading (rad).
    twist : ndarray, shape (n, 3)
        ``[omega, v_x, v_y]`` (rad/s, m/s), in the axes of the base.
    brackets : ndarray, shape (n, c)
        Angles of the casters' brackets (rad).
    steering, steering_rates : ndarray, shape (n, s)
        Of the steered wheels (rad, rad/s).
    kinetic : ndarray, shape (n,)
        Energy (J).
    work : ndarray, shape (n,)
        What the motors put in (J).
    drift : float
        Largest magnitude of what the energy balance leaves (J).
    """

    t: Array
    pose: Array
    twist: Array
    brackets: Array
    steering: Array
    steering_rates: Array
    kinetic: Array
    work: Array
    drift: float


def simulate_rolling(
    dynamics: RollingDynamics,
    twist: ArrayLike,
    torques: Torques | None,
    duration: float,
    *,
    pose: ArrayLike = (0.0, 0.0, 0.0),
    brackets: ArrayLike | None = None,
    steering: SteeringMotion | None = None,
    samples: int = 101,
) -> RollingSimulation:
    """Move a base under torques of its motors.

    Parameters
    ----------
    dynamics : RollingDynamics
    twist : array_like, shape (3,)
        At the start: ``[omega, v_x, v_y]`` (rad/s, m/s).
    torques : callable or None
        ``torques(t, twist, brackets)`` gives those of the driven wheels (N m); of a base with
        steered wheels ``torques(t, twist, brackets, steering)`` gives those of the driven and of
        the steered ones, from a SteeringMotion.  None for none.
    duration : float
        In s, up to an hour.
    pose : array_like, shape (3,), optional
        At the start: x, y (m) and heading (rad).
    brackets : array_like, shape (c,), optional
        At the start, angles of the casters' brackets (rad).  Default 0.
    steering : SteeringMotion, optional
        Of the steered wheels at the start.  Default at the angles of the twist, without rates.
    samples : int, optional
        How many moments are kept, evenly spaced, 2 or more.

    Examples
    --------
    A base that nothing drives keeps its energy, wherever its caster turns:

    >>> from robomech_ros.rolling import rolling_robot, simulate_rolling
    >>> moving = rolling_robot("differential").dynamics
    >>> run = simulate_rolling(moving, [0.8, 0.5, 0.0], None, 2.0, brackets=[1.0])
    >>> bool(run.drift < 1e-9 * run.kinetic[0])
    True
    """
    check_kind("dynamics", dynamics, RollingDynamics, "a RollingDynamics")
    if torques is not None and not callable(torques):
        raise BadValueError("torques", torques, "a function of time, twist and brackets, or None")
    time = checked_duration("duration", duration)
    if time > _LONGEST:
        raise BadValueError("duration", duration, f"up to {_LONGEST:g} s")
    if type(samples) is not int or not 2 <= samples <= 1_000_000:
        raise BadValueError("samples", samples, "a number from 2 to a million")
    base, m, c = dynamics.base, dynamics.free.shape[1], len(dynamics.base.casters)
    start, count = one_vector("twist", twist, 3), len(base.steered)
    begun = dynamics.moving(start, brackets, steering).independent
    angles = steering.angles if steering else base.steering_angles(start)
    psi = np.zeros(c) if brackets is None else one_vector("brackets", brackets, c)
    coordinates = np.linalg.pinv(dynamics.free)
    turning = (begun.shape @ begun.rates)[3:]
    parts = [one_vector("pose", pose, 3), coordinates @ start, angles, turning, psi, np.zeros(1)]
    ends = np.cumsum([3, m, count, count, c])

    t = np.linspace(0.0, time, samples)
    begin = np.concatenate(parts)
    derivative = _derivative(dynamics, torques, ends)
    found = solve_ivp(derivative, (0.0, time), begin, "DOP853", t, rtol=_RTOL, atol=_ATOL)
    if not found.success or found.y.shape[1] != samples:
        raise BadValueError("motion", found.message, "one that can be integrated")
    poses, rates, beta, beta_rates, brackets_at, work = np.split(found.y.T, ends, axis=1)
    twists, work = rates @ dynamics.free.T, work[:, 0]
    kinetic = np.array(
        [
            dynamics.moving(
                now, bracket, SteeringMotion(*turned), strict=False
            ).bodies.kinetic_energy
            for now, bracket, *turned in zip(twists, brackets_at, beta, beta_rates, strict=True)
        ]
    )
    drift = float(np.abs(kinetic - kinetic[0] - work).max())
    return RollingSimulation(t, poses, twists, brackets_at, beta, beta_rates, kinetic, work, drift)


def _derivative(
    dynamics: RollingDynamics, torques: Torques | None, ends: IntArray
) -> Callable[[float, Array], Array]:
    """Return the rates of a state: pose, independent rates, steering, brackets, work.

    ``ends`` are where these parts end, but the last one.
    """
    base, coordinates = dynamics.base, np.linalg.pinv(dynamics.free)

    def derivative(t: float, y: Array) -> Array:
        at, rates, beta, beta_rates, bracket, _ = np.split(y, ends)
        now, turned = dynamics.free @ rates, SteeringMotion(beta, beta_rates)
        drive = np.zeros(len(dynamics.motors))
        if torques is not None:
            given = torques(t, now, bracket, *([turned] if base.steered else []))
            drive = one_vector("torques", given, len(drive))
        state = dynamics.moving(now, bracket, turned, strict=False)
        change = state.accelerations(drive, np.zeros(3))
        cosine, sine = np.cos(at[2]), np.sin(at[2])
        moving = [cosine * now[1] - sine * now[2], sine * now[1] + cosine * now[2], now[0]]
        power = drive @ (state.motor_rates @ state.independent.rates)
        pivots = base.caster_rates(now, bracket)
        return np.concatenate([
            moving, coordinates @ change[:3], beta_rates, change[3:], pivots, [power]
        ])  # fmt: skip

    return derivative
