"""The natural orthogonal complement: matrices of the constraints and of what they leave free.

The twists ``t_i = [omega_i; v_i]`` of the n bodies, v_i of the mass centre, are stacked to t.  The
joints constrain them, ``K t = 0``, and leave ``t = T qd``; T is an orthogonal complement of K, so
wrenches that keep the constraints, combinations of the rows of K, drop out of ``T^T w``.

References
----------
Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., sections 7.5, 7.5.2, 7.6 and 7.7.
Angeles and Lee, The formulation of dynamical equations of holonomic mechanical systems using a
natural orthogonal complement, ASME J. Applied Mechanics 55 (1988), pp. 243-244.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robomech_ros.dynamics.checked_states import as_screw, finite_states
from robomech_ros.dynamics.complement.constrained_bodies import ConstrainedBodies
from robomech_ros.dynamics.complement.stacking import times, transposed
from robomech_ros.dynamics.formulations.stacked_matrices import (
    base_shaping,
    constraints,
    drive_wrenches,
    twist_shaping,
    twist_shaping_rate,
)
from robomech_ros.dynamics.posed_bodies import PosedBodies, posed_bodies, reflected_inertias
from robomech_ros.robots.chain import SerialChain
from robomech_ros.spatial.screws.transfers import transfer_wrench
from robomech_ros.typing import Array, ArrayLike


@dataclass(frozen=True, eq=False, kw_only=True)
class OrthogonalComplement(ConstrainedBodies):
    """The matrices of a chain in motion; all vectors in the axes of the base.

    The constrained bodies of a chain of r joints, whose independent rates are those of its m
    drives: body i moves with joint i, and r = m unless joints follow others.

    Parameters
    ----------
    bodies : PosedBodies
        Positions of axes and bodies.
    K : ndarray, shape (..., 7 r - m, 6 r)
        Constraint matrix: ``K t + K_0 t_0 = 0``; moments of the constraints in rows 6 i to
        6 i + 2, forces in the three below.  The last r - m rows couple followers to drives.
    K_0 : ndarray, shape (..., 7 r - m, 6)
        Of the base's twist [omega; velocity of its origin].
    T_0, T_0_dot : ndarray, shape (..., 6 r, 6)
        What the base's twist shapes, and its rate.
    masses, inertias, T, T_dot, rates, rotors, N, N_dot, t_0, t_0_dot, A
        As for :class:`ConstrainedBodies`; the prescribed motion is that of the base.
    """

    bodies: PosedBodies
    K: Array
    K_0: Array
    T_0: Array
    T_0_dot: Array

    def tip_wrenches(self, wrench: ArrayLike | None) -> Array:
        """Wrench on the last body that a wrench [n; f] at the tip's origin is, (..., 6 r)."""
        given = as_screw("tip_wrench", wrench)
        wrenches = np.zeros(self.T.shape[:-1])
        centre = self.bodies.centres[..., -1, :]
        wrenches[..., -6:] = transfer_wrench(given, self.bodies.tip, centre)
        return wrenches


def natural_orthogonal_complement(
    chain: SerialChain,
    q: ArrayLike,
    qd: ArrayLike,
    *,
    base_twist: ArrayLike | None = None,
    base_twist_rate: ArrayLike | None = None,
) -> OrthogonalComplement:
    r"""Form the matrices of a chain in motion.

    The twists :math:`t_i = [\omega_i; \dot c_i]` of the bodies, stacked to t, obey the constraints
    :math:`K t = 0` of the joints and are shaped by the joint rates:

    .. math::

       t = T \dot q, \qquad K T = 0, \qquad
       t_{ij} = \begin{bmatrix} e_j \\ e_j \times (c_i - o_j) \end{bmatrix} \text{ or }
       \begin{bmatrix} 0 \\ e_j \end{bmatrix}, \quad j \le i,

    for a revolute and a prismatic joint j.  Wrenches that keep the constraints drop out of
    :math:`T^T w`, which leaves

    .. math::

       I \ddot q + C \dot q = T^T w, \qquad I = T^T M T, \qquad C = T^T M \dot T + T^T W M T

    with :math:`M = \mathrm{diag}(I_i, m_i 1)` and :math:`W = \mathrm{diag}(\Omega_i, 0)` of all
    bodies, and the wrenches w of drives, weights and load.

    Parameters
    ----------
    chain : SerialChain
        With the inertia of all its bodies.
    q, qd : array_like, shape (n,) or (..., n)
        Joint values and rates (rad or m; per s).  Where joints follow others, these are the
        drives', and T is that of all joints times the coupling's matrix.
    base_twist, base_twist_rate : array_like, shape (6,), optional
        Angular velocity of the base and velocity of its origin in its own axes, and the rates of
        these vectors (rad/s, m/s; per s).  Default at rest.

    Raises
    ------
    MissingInertiaError
        Of some joints nothing is known that moves with them.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., sections 7.5, 7.5.1 and 7.5.2.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.dynamics import mass_matrix, natural_orthogonal_complement
    >>> from robomech_ros.robots import load_robot
    >>> puma = load_robot("puma560")
    >>> model = natural_orthogonal_complement(puma, puma.midrange(), np.ones(6))
    >>> model.K.shape, model.T.shape, np.allclose(model.K @ model.T, 0.0)
    ((36, 36), (36, 6), True)
    >>> np.allclose(model.generalised_inertia, mass_matrix(puma, puma.midrange()))
    True
    """
    q, qd = finite_states(chain, q=q, qd=qd)
    t_0, t_0_dot = as_screw("base_twist", base_twist), as_screw("base_twist_rate", base_twist_rate)
    bodies = posed_bodies(chain, q)
    T = chain.drive_columns(twist_shaping(bodies))
    T_0 = base_shaping(bodies.centres)
    twists = (times(T, qd) + T_0 @ t_0).reshape(*q.shape[:-1], -1, 6)
    rates = twists[..., 3:] - t_0[3:]
    K, K_0 = constraints(bodies)
    A = drive_wrenches(bodies)
    if chain.coupling is not None:
        driven = _driven_joints(chain)
        remainder = np.eye(len(driven)) - chain.coupling.matrix @ driven.T
        rows = remainder[~driven.any(axis=1)] @ transposed(A)
        K = np.concatenate((K, rows), axis=-2)
        K_0 = np.concatenate((K_0, -rows @ T_0), axis=-2)
        A = A @ driven
    T_0_dot = base_shaping(rates) - base_shaping(np.zeros_like(rates))
    return OrthogonalComplement(
        masses=bodies.masses,
        inertias=bodies.inertias,
        T=T,
        T_dot=chain.drive_columns(twist_shaping_rate(bodies, twists)),
        rates=qd,
        rotors=reflected_inertias(chain),
        t_0=T_0 @ t_0,
        t_0_dot=T_0_dot @ t_0 + T_0 @ t_0_dot,
        A=A,
        bodies=bodies,
        K=K,
        K_0=K_0,
        T_0=T_0,
        T_0_dot=T_0_dot,
    )


def _driven_joints(chain: SerialChain) -> Array:
    """Return the efforts (m, n) at the joints for unit efforts of the drives.

    A drive acts on the joint of its name; if that is not on the chain, on the joint it moves most.
    """
    names = chain.all_joint_names
    driven = np.zeros((len(names), chain.n))
    for k, name in enumerate(chain.joint_names):
        joint, gain = (names.index(name), 1.0) if name in names else chain.driven_joint(k)
        driven[joint, k] = 1.0 / gain
    return driven
