"""The recursions of Newton and Euler with all that they compute: motions of links, joint wrenches.

References
----------
Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., sections 7.4, 7.4.1, 7.4.2 and 7.7.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robomech_ros.dynamics.checked_states import as_screw, as_vector, finite_states
from robomech_ros.dynamics.model import GRAVITY
from robomech_ros.dynamics.posed_bodies import PosedBodies, posed_bodies, reflected_inertias
from robomech_ros.robots.chain import SerialChain
from robomech_ros.typing import Array, ArrayLike


@dataclass(frozen=True, eq=False)
class NewtonEuler:
    """Motions of links and wrenches at joints, all in the axes of the base.

    Parameters
    ----------
    bodies : PosedBodies
        Positions of axes and bodies.
    twists : ndarray, shape (..., m, 6)
        Angular velocity and velocity of the mass centre of each link (rad/s, m/s).
    twist_rates : ndarray, shape (..., m, 6)
        Their rates (rad/s^2, m/s^2).
    joint_wrenches : ndarray, shape (..., m, 6)
        Moment and force [n; f] that the link before exerts on link i, at the joint's origin o_i
        (N m, N): the sum of bearings, drive and coupling.
    torques : ndarray, shape (..., n)
        Of the drives, as from `inverse_dynamics`: the part of each wrench along the joint's axis,
        and what the rotor takes (N m or N).
    """

    bodies: PosedBodies
    twists: Array
    twist_rates: Array
    joint_wrenches: Array
    torques: Array


def newton_euler(
    chain: SerialChain,
    q: ArrayLike,
    qd: ArrayLike,
    qdd: ArrayLike,
    *,
    gravity: ArrayLike = GRAVITY,
    tip_wrench: ArrayLike | None = None,
    base_twist: ArrayLike | None = None,
    base_twist_rate: ArrayLike | None = None,
) -> NewtonEuler:
    r"""Follow a motion outward from the base, and its wrenches inward from the tip.

    `inverse_dynamics` has the equations, and gives the torques alone, much faster.

    Parameters
    ----------
    chain : SerialChain
        Chain of m joints moved by n drives, with the inertia of all its bodies.
    q, qd, qdd : array_like, shape (n,) or (..., n)
        Joint values, rates and accelerations (rad or m; per s, per s^2).
    gravity : array_like, shape (3,), optional
        In the axes of the base (m/s^2).
    tip_wrench : array_like, shape (6,), optional
        Moment and force [n; f] that the surroundings exert on the tip, at its origin (N m, N).
    base_twist, base_twist_rate : array_like, shape (6,), optional
        Of a base that moves, as for `inverse_dynamics`.

    Raises
    ------
    MissingInertiaError
        Of some joints nothing is known that moves with them.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., sections 7.4.1 and 7.4.2.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.dynamics import newton_euler
    >>> from robomech_ros.robots import load_robot
    >>> arm = load_robot("planar3r")
    >>> still = newton_euler(arm, [0.3, -0.7, 1.1], [0.0] * 3, [0.0] * 3, gravity=[0, -9.81, 0])
    >>> still.joint_wrenches[0].round(4) + 0.0  # the shoulder holds 4.5 kg
    array([ 0.    ,  0.    , 47.3271,  0.    , 44.145 ,  0.    ])
    """
    q, qd, qdd = finite_states(chain, q=q, qd=qd, qdd=qdd)
    bodies = posed_bodies(chain, q)
    base = (as_screw("base_twist", base_twist), as_screw("base_twist_rate", base_twist_rate))
    twists, rates = _outward(bodies, chain.joint_rates(qd), chain.joint_rates(qdd), *base)
    tip, g = as_screw("tip_wrench", tip_wrench), as_vector("gravity", gravity, 3)
    wrenches = _inward(bodies, twists, rates, g, tip)
    along = np.where(bodies.revolute[:, None], wrenches[..., :3], wrenches[..., 3:])
    efforts = chain.drive_efforts(np.sum(along * bodies.axes, axis=-1))
    torques = efforts + reflected_inertias(chain) * qdd
    return NewtonEuler(bodies, twists, rates, wrenches, torques)


def _outward(
    bodies: PosedBodies, qd: Array, qdd: Array, base_twist: Array, base_twist_rate: Array
) -> tuple[Array, Array]:
    """Return twists and twist rates of the links at their mass centres, (..., m, 6)."""
    shape = (*qd.shape[:-1], 3)
    omega, v = (np.broadcast_to(one, shape) for one in (base_twist[:3], base_twist[3:]))
    alpha, a = (np.broadcast_to(one, shape) for one in (base_twist_rate[:3], base_twist_rate[3:]))
    point = np.zeros(shape)
    twists, rates = np.empty((*qd.shape, 6)), np.empty((*qd.shape, 6))
    for i in range(qd.shape[-1]):
        e, o = bodies.axes[..., i, :], bodies.origins[..., i, :]
        rate, gain = qd[..., i, None] * e, qdd[..., i, None] * e
        # Motion of the previous link at joint i.
        v, a = _moved(omega, alpha, v, a, o - point)
        if bodies.revolute[i]:
            alpha = alpha + np.cross(omega, rate) + gain
            omega = omega + rate
        else:
            a = a + 2.0 * np.cross(omega, rate) + gain
            v = v + rate
        point = o
        centre = _moved(omega, alpha, v, a, bodies.centres[..., i, :] - o)
        twists[..., i, :] = np.concatenate((omega, centre[0]), axis=-1)
        rates[..., i, :] = np.concatenate((alpha, centre[1]), axis=-1)
    return twists, rates


def _moved(omega: Array, alpha: Array, v: Array, a: Array, r: Array) -> tuple[Array, Array]:
    """Return velocity and acceleration of a point of a body that is r from one known."""
    across = np.cross(omega, r)
    return v + across, a + np.cross(alpha, r) + np.cross(omega, across)


def _inward(
    bodies: PosedBodies, twists: Array, rates: Array, gravity: Array, tip_wrench: Array
) -> Array:
    """Return the wrenches (..., m, 6) that the joints pass on outward, at their origins."""
    wrenches = np.empty(twists.shape)
    # The wrench that the last link passes outward acts on the surroundings.
    moment, force, point = -tip_wrench[:3], -tip_wrench[3:], bodies.tip
    for i in range(twists.shape[-2] - 1, -1, -1):
        o, inertia = bodies.origins[..., i, :], bodies.inertias[..., i, :, :]
        omega, alpha = twists[..., i, :3], rates[..., i, :3]
        own = bodies.masses[i] * (rates[..., i, 3:] - gravity)
        spin = np.einsum("...ij,...j->...i", inertia, alpha)
        spin = spin + np.cross(omega, np.einsum("...ij,...j->...i", inertia, omega))
        lever = np.cross(point - o, force) + np.cross(bodies.centres[..., i, :] - o, own)
        moment, force, point = moment + lever + spin, force + own, o
        wrenches[..., i, :] = np.concatenate((moment, force), axis=-1)
    return wrenches
