"""Forward dynamics: accelerations from torques."""

from __future__ import annotations

import numpy as np

from robomech_ros._kernels.compiling.jit import direct
from robomech_ros._kernels.dynamics import forward as kernels
from robomech_ros.dynamics.model import GRAVITY, dynamic_model, raise_outcome, surroundings
from robomech_ros.kinematics.joint_values import as_rows, as_states
from robomech_ros.robots.chain import SerialChain
from robomech_ros.spatial.arrays import as_choice
from robomech_ros.typing import Array, ArrayLike

METHODS = ("articulated-body", "cholesky")
# Other formulations.
_OTHERS = ("reflections", "lagrange", "kane")

_forward_one = direct(kernels.forward_dynamics_one)


def forward_dynamics(
    chain: SerialChain,
    q: ArrayLike,
    qd: ArrayLike,
    tau: ArrayLike,
    *,
    gravity: ArrayLike = GRAVITY,
    tip_wrench: ArrayLike | None = None,
    base_twist: ArrayLike | None = None,
    base_twist_rate: ArrayLike | None = None,
    method: str = "articulated-body",
) -> Array:
    r"""Compute the joint accelerations that torques give.

    The inverse of :func:`inverse_dynamics`, whatever the method.  Without the friction of the
    drives: where there is some, pass their torques less :func:`friction_torque`.

    .. math:: M(q)\, \ddot q = \tau - h(q, \dot q)

    Parameters
    ----------
    chain : SerialChain
        Chain of n joints, with the bodies that they move.
    q : array_like, shape (n,) or (..., n)
        Joint values (rad or m); a batch runs inside one compiled loop.
    qd, tau : array_like, of the same shape
        Joint rates (rad/s or m/s), and torques or forces that the drives exert (N m or N).
    gravity, tip_wrench, base_twist, base_twist_rate
        As for :func:`inverse_dynamics`.
    method : str, optional
        One of METHODS: ``"articulated-body"``, in a time that grows with n, or ``"cholesky"``,
        from the factor of the mass matrix, as the book does it.  To check them ``"reflections"``,
        ``"lagrange"`` or ``"kane"``: the functions ``forward_dynamics_by_...``.

    Returns
    -------
    ndarray, shape (n,) or (..., n)
        Accelerations (rad/s^2 or m/s^2).

    Raises
    ------
    MissingInertiaError, BadValueError, WrongSizeError
        As for :func:`inverse_dynamics`; or nothing resists some motion of the chain.

    References
    ----------
    Featherstone, Rigid Body Dynamics Algorithms, Springer 2008, ch. 7; Angeles, Fundamentals of
    Robotic Mechanical Systems, 4th ed., section 7.6.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.dynamics import forward_dynamics, inverse_dynamics
    >>> from robomech_ros.robots import load_robot
    >>> puma = load_robot("puma560")
    >>> q, qd, qdd = np.random.default_rng(0).uniform(-1.0, 1.0, (3, 6))
    >>> np.allclose(forward_dynamics(puma, q, qd, inverse_dynamics(puma, q, qd, qdd)), qdd)
    True
    """
    if method is not METHODS[0]:
        method = as_choice("method", method, METHODS + _OTHERS)
        if method in _OTHERS:
            from robomech_ros.dynamics.formulations import table

            base = {"base_twist": base_twist, "base_twist_rate": base_twist_rate}
            state = chain, q, qd, tau
            return table.by_formulation(
                table.FORWARD, method, *state, base=base, gravity=gravity, tip_wrench=tip_wrench
            )
    q, qd, tau = as_states(chain, ("q", "qd", "tau"), q, qd, tau)
    model, shape = dynamic_model(chain), q.shape
    around = surroundings(shape, gravity, tip_wrench, base_twist, base_twist_rate)
    qdd = np.empty(shape)
    recursive = method == METHODS[0]
    if recursive and q.ndim == 1:
        status = _forward_one(model, q, qd, tau, around, qdd)
    elif recursive:
        status = kernels.forward_dynamics(
            model, as_rows(q), as_rows(qd), as_rows(tau), around, as_rows(qdd)
        )
    else:
        room = np.empty((chain.n + 1, chain.n))
        status = kernels.forward_dynamics_cholesky(
            model, as_rows(q), as_rows(qd), as_rows(tau), around, room, as_rows(qdd)
        )
    if status:
        raise_outcome(chain, status, q=q, qd=qd, tau=tau)
    return qdd
