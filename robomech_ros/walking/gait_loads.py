"""Torques of all joints over a cycle of a gait, and their peaks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from robomech_ros.errors import BadValueError, MissingSupportError
from robomech_ros.spatial import pose_error
from robomech_ros.spatial.arrays import as_single, check_kind
from robomech_ros.typing import Array, ArrayLike, BoolArray
from robomech_ros.walking.dynamics import WalkingDynamics
from robomech_ros.walking.ground_forces import FootForces
from robomech_ros.walking.walker import Walker, WalkUpdate

_DOWN = np.array([0.0, 0.0, -9.81])


@dataclass(frozen=True, eq=False)
class GaitTorques:
    """Loads of a walk at m times, of a robot with k legs.

    Attributes
    ----------
    t : ndarray, shape (m,)
        Times (s), from 0.
    torques : ndarray, shape (m, 3 k)
        Joint torques (N m or N).
    forces : ndarray, shape (m, k, 3)
        Ground forces on the feet (N), in the axes of the trunk.
    contacts : ndarray of bool, shape (m, k)
        Which feet stand.
    rates : ndarray, shape (m, 6 + 3 k)
        Twist of the trunk in its axes, then joint rates.
    peaks, peak_times : ndarray, shape (3 k,)
        Largest magnitude of each joint's torque, and its time (s).
    used_effort : ndarray, shape (3 k,)
        Peaks as parts of the effort limits, NaN without one.
    """

    t: Array
    torques: Array
    forces: Array
    contacts: BoolArray
    rates: Array
    peaks: Array
    peak_times: Array
    used_effort: Array


def gait_torques(
    dynamics: WalkingDynamics,
    walker: Walker,
    twist: ArrayLike,
    *,
    friction: float = 0.6,
    smallest: str = "forces",
) -> GaitTorques:
    """Compute ground forces and joint torques over one cycle of a steady walk.

    The walker first walks for one cycle from its present state, and keeps its state at the end.
    Rates and accelerations are finite differences of its updates.

    Parameters
    ----------
    dynamics : WalkingDynamics
        Dynamics of the walking robot.
    walker : Walker
        Walker whose gait always stands on three feet or more: two do not carry all loads.
    twist : array_like, shape (3,)
        [w, vx, vy] of the trunk (rad/s, m/s).
    friction, smallest
        As for :func:`foot_forces`.

    Returns
    -------
    GaitTorques

    Raises
    ------
    MissingSupportError
        Feet cannot carry the load at some time, which the message names.
    LimitExceededError, BadValueError, WrongSizeError
        As for :func:`foot_forces`; or walker and dynamics have different robots.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 10.4.

    Examples
    --------
    >>> from robomech_ros.walking import Walker, WalkingDynamics, gait_torques, load_legged
    >>> robot = load_legged("phantomx")
    >>> walk = gait_torques(WalkingDynamics(robot), Walker(robot, period=0.02), [0.0, 0.04, 0.0])
    >>> bool(walk.used_effort.max() < 0.5)
    True
    """
    check_kind("dynamics", dynamics, WalkingDynamics, "a WalkingDynamics")
    check_kind("walker", walker, Walker, "a Walker")
    if walker.robot is not dynamics.robot:
        raise BadValueError(
            "robot of the walker", walker.robot.name, "the same LeggedRobot as the dynamics"
        )
    command, count = as_single("twist", twist, (3,)), round(walker.cycle / walker.period)

    def update() -> WalkUpdate:
        walker.command(command)
        return walker.update()

    for _ in range(count):
        update()
    updates = [update() for _ in range(count + 2)]
    found, rates = list[FootForces](), list[Array]()
    for i in range(1, count + 1):
        three = updates[i - 1], updates[i], updates[i + 1]
        try:
            u, share = step_loads(
                dynamics, three, walker.period, friction=friction, smallest=smallest
            )
        except MissingSupportError as error:
            when = (i - 1) * walker.period
            raise MissingSupportError(error.feet, error.missing, f" at {when:.4g} s") from None
        rates.append(u)
        found.append(share)
    torques = np.array([one.torques for one in found])
    at, peaks = np.abs(torques).argmax(axis=0), np.abs(torques).max(axis=0)
    return GaitTorques(
        t=np.asarray(walker.period * np.arange(count), dtype=np.float64),
        torques=torques,
        forces=np.array([one.forces for one in found]),
        contacts=np.array([one.contacts for one in updates[1:-1]]),
        rates=np.array(rates),
        peaks=peaks,
        peak_times=np.asarray(walker.period * at, dtype=np.float64),
        used_effort=peaks / dynamics.robot.effort,
    )


def step_loads(
    dynamics: WalkingDynamics,
    three: Sequence[WalkUpdate],
    period: float,
    *,
    friction: float,
    smallest: str = "forces",
) -> tuple[Array, FootForces]:
    """Compute rates u and ground forces at the middle of three updates, a period (s) apart."""
    u, du = _differences(three, period)
    here, names = three[1], dynamics.robot.leg_names
    down = here.trunk[:3, :3].T
    share = dynamics.share_load(
        here.q,
        u,
        du,
        stance=[name for name, stands in zip(names, here.contacts, strict=True) if stands],
        gravity=down @ _DOWN,
        friction=friction,
        normals=down[:, 2],
        smallest=smallest,
    )
    return u, share


def _differences(three: Sequence[WalkUpdate], period: float) -> tuple[Array, Array]:
    """Return rates u and their derivative in the middle of three updates, (6 + 3 k,) each."""
    before, here, after = three
    back, forth = pose_error(here.trunk, before.trunk), pose_error(after.trunk, here.trunk)
    turn = here.trunk[:3, :3].T
    twist = ((back + forth) / (2.0 * period)).reshape(2, 3) @ turn.T
    change = ((forth - back) / period**2).reshape(2, 3) @ turn.T
    # The derivative in the axes of the trunk, which turn.
    change[1] -= np.cross(twist[0], twist[1])
    u = np.concatenate((twist.ravel(), (after.q - before.q) / (2.0 * period)))
    du = np.concatenate((change.ravel(), (after.q - 2.0 * here.q + before.q) / period**2))
    return u, du
