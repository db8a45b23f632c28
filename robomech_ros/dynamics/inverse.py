"""Inverse dynamics: the torques that a motion takes."""

from __future__ import annotations

import numpy as np

from robomech_ros._kernels.compiling.jit import direct
from robomech_ros._kernels.dynamics import inverse as kernels
from robomech_ros.dynamics.model import GRAVITY, dynamic_model, raise_outcome, surroundings
from robomech_ros.kinematics.joint_values import as_joint_values, as_rows, as_states
from robomech_ros.robots.chain import SerialChain
from robomech_ros.spatial.arrays import as_choice
from robomech_ros.typing import Array, ArrayLike

# The first is compiled, the others follow other formulations.
INVERSE_METHODS = ("newton-euler", "orthogonal-complement", "lagrange", "kane")

_inverse_one = direct(kernels.inverse_dynamics_one)
_gravity_one = direct(kernels.gravity_torque_one)


def inverse_dynamics(
    chain: SerialChain,
    q: ArrayLike,
    qd: ArrayLike,
    qdd: ArrayLike,
    *,
    gravity: ArrayLike = GRAVITY,
    tip_wrench: ArrayLike | None = None,
    base_twist: ArrayLike | None = None,
    base_twist_rate: ArrayLike | None = None,
    method: str = INVERSE_METHODS[0],
) -> Array:
    r"""Compute the joint torques that a motion takes, ``M(q) qdd + h(q, qd)``.

    Those of the rigid bodies and of the rotors, which add their inertia reflected to the joint, and
    nothing else of their motion.  Without the friction of the drives: add :func:`friction_torque`.

    Outward from a base that accelerates by :math:`-g`, for a revolute joint i at :math:`o_i` and
    the mass centre :math:`c_i` of its link,

    .. math::

       \omega_i &= \omega_{i-1} + \dot q_i e_i, \\
       \dot\omega_i &= \dot\omega_{i-1} + \omega_{i-1} \times \dot q_i e_i + \ddot q_i e_i, \\
       \ddot c_i &= \ddot o_i + \dot\omega_i \times (c_i - o_i)
       + \omega_i \times (\omega_i \times (c_i - o_i)),

    and inward from the tip, with moments about :math:`o_i`,

    .. math::

       f_i &= f_{i+1} + m_i \ddot c_i, \\
       n_i &= n_{i+1} + (o_{i+1} - o_i) \times f_{i+1} + (c_i - o_i) \times m_i \ddot c_i
       + I_i \dot\omega_i + \omega_i \times I_i \omega_i, \\
       \tau_i &= n_i \cdot e_i.

    A prismatic joint leaves :math:`\omega` as it is, adds :math:`\ddot q_i e_i
    + 2 \omega_i \times \dot q_i e_i` to the acceleration, and has :math:`\tau_i = f_i \cdot e_i`.

    Parameters
    ----------
    chain : SerialChain
        Chain of n joints, with the bodies that they move.
    q : array_like, shape (n,) or (..., n)
        Joint values (rad or m); a batch runs inside one compiled loop.
    qd, qdd : array_like, of the same shape
        Joint rates (rad/s or m/s) and accelerations (rad/s^2 or m/s^2).
    gravity : array_like, shape (3,), optional
        In the axes of the base (m/s^2).
    tip_wrench : array_like, shape (6,) or (..., 6), optional
        Moment and force [n; f] that the surroundings exert on the tip (N m and N), at the tip's
        origin, in the axes of the base: minus the ``exerted_wrench`` of :func:`joint_torques`.
        Default none.
    base_twist, base_twist_rate : array_like, shape (6,) or (..., 6), optional
        Of a base that moves: angular velocity and velocity of its origin [omega; v] (rad/s, m/s),
        and the accelerations [omega'; v'] (rad/s^2, m/s^2), in the axes that the base has at that
        moment; v' is the acceleration of the origin in space.  No torque depends on v.  Default at
        rest.
    method : str, optional
        ``"newton-euler"``, which is compiled, or to check it ``"orthogonal-complement"``,
        ``"lagrange"`` or ``"kane"``: the functions ``inverse_dynamics_by_...``.

    Returns
    -------
    ndarray, shape (n,) or (..., n)
        Torques or forces that the drives exert on the joints (N m or N).

    Raises
    ------
    MissingInertiaError
        Of some joints nothing is known that moves with them; their links are named.
    BadValueError, WrongSizeError
        An argument is not of finite real numbers of its shape, the result is not finite, or no body
        can have the numbers of one.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., sections 7.4, 7.5.2 and 7.7.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.dynamics import inverse_dynamics
    >>> from robomech_ros.robots import load_robot
    >>> arm = load_robot("planar3r")
    >>> q, qd, qdd = [0.3, -0.7, 1.1], [0.5, -1.2, 2.0], [1.0, -0.5, 0.25]
    >>> np.round(inverse_dynamics(arm, q, qd, qdd, gravity=[0.0, -9.81, 0.0]), 4)
    array([53.0212, 16.0675,  2.3256])
    >>> np.round(inverse_dynamics(arm, q, qd, qdd, gravity=[0.0, -9.81, 0.0], method="kane"), 4)
    array([53.0212, 16.0675,  2.3256])
    """
    if method is not INVERSE_METHODS[0]:
        method = as_choice("method", method, INVERSE_METHODS)
        if method != INVERSE_METHODS[0]:
            from robomech_ros.dynamics.formulations import table

            base = {"base_twist": base_twist, "base_twist_rate": base_twist_rate}
            state = chain, q, qd, qdd
            return table.by_formulation(
                table.INVERSE, method, *state, base=base, gravity=gravity, tip_wrench=tip_wrench
            )
    q, qd, qdd = as_states(chain, ("q", "qd", "qdd"), q, qd, qdd)
    model, shape = dynamic_model(chain), q.shape
    around = surroundings(shape, gravity, tip_wrench, base_twist, base_twist_rate)
    tau = np.empty(shape)
    if q.ndim == 1:
        status = _inverse_one(model, q, qd, qdd, around, tau)
    else:
        status = kernels.inverse_dynamics(
            model, as_rows(q), as_rows(qd), as_rows(qdd), around, as_rows(tau)
        )
    if status:
        raise_outcome(chain, status, q=q, qd=qd, qdd=qdd)
    return tau


def bias_torque(
    chain: SerialChain,
    q: ArrayLike,
    qd: ArrayLike,
    *,
    gravity: ArrayLike = GRAVITY,
    tip_wrench: ArrayLike | None = None,
    base_twist: ArrayLike | None = None,
    base_twist_rate: ArrayLike | None = None,
) -> Array:
    """Compute the torques at which no joint accelerates: :func:`inverse_dynamics` with qdd = 0.

    Without the friction of the drives: add :func:`friction_torque`.

    Parameters
    ----------
    chain, q, qd, gravity, tip_wrench, base_twist, base_twist_rate
        As for :func:`inverse_dynamics`.

    Returns
    -------
    ndarray, shape (n,) or (..., n)
        Coriolis and centrifugal terms, gravity and the wrench on the tip (N m or N).

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 7.4.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.dynamics import bias_torque, coriolis_matrix, gravity_torque
    >>> from robomech_ros.robots import load_robot
    >>> arm, q, qd = load_robot("planar3r"), [0.3, -0.7, 1.1], [0.5, -1.2, 2.0]
    >>> parts = coriolis_matrix(arm, q, qd) @ qd + gravity_torque(arm, q)
    >>> np.allclose(bias_torque(arm, q, qd), parts)
    True
    """
    q = as_joint_values(chain, q)
    return inverse_dynamics(
        chain,
        q,
        qd,
        np.zeros(q.shape),
        gravity=gravity,
        tip_wrench=tip_wrench,
        base_twist=base_twist,
        base_twist_rate=base_twist_rate,
    )


def gravity_torque(
    chain: SerialChain,
    q: ArrayLike,
    *,
    gravity: ArrayLike = GRAVITY,
    tip_wrench: ArrayLike | None = None,
) -> Array:
    """Compute the torques that hold the chain still.

    Parameters
    ----------
    chain, q, gravity, tip_wrench
        As for :func:`inverse_dynamics`.

    Returns
    -------
    ndarray, shape (n,) or (..., n)
        Torques or forces that the drives exert (N m or N).

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 7.7.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.dynamics import gravity_torque
    >>> from robomech_ros.robots import load_robot
    >>> arm = load_robot("planar3r")
    >>> np.round(gravity_torque(arm, [0.3, -0.7, 1.1], gravity=[0.0, -9.81, 0.0]), 4)
    array([47.3271, 14.5256,  1.8758])
    """
    q = as_joint_values(chain, q)
    model, shape = dynamic_model(chain), q.shape
    around = surroundings(shape, gravity, tip_wrench)
    tau = np.empty(shape)
    if q.ndim == 1:
        status = _gravity_one(model, q, around, tau)
    else:
        status = kernels.gravity_torque(model, as_rows(q), around, as_rows(tau))
    if status:
        raise_outcome(chain, status, q=q)
    return tau
