"""The torques as a linear function of the bodies' parameters, and which of these count."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robomech_ros._kernels.dynamics import regressor as kernels
from robomech_ros.dynamics.model import GRAVITY, raise_outcome, surroundings
from robomech_ros.kinematics.joint_values import as_rows, as_states, check_chain
from robomech_ros.robots.chain import SerialChain
from robomech_ros.typing import Array, ArrayLike, IntArray

# A column of a torque regressor, of unit length, that is nearer than this to those before it
# depends on them: rounding leaves 1e-13, and what a motion can show is above 1e-4.
BASE_PARAMETER = 1e-8


# Random states whose regressors span what any motion can show, for each parameter of a chain.
_STATES = 3
_SEED = 7


def torque_regressor(
    chain: SerialChain,
    q: ArrayLike,
    qd: ArrayLike,
    qdd: ArrayLike,
    *,
    gravity: ArrayLike = GRAVITY,
    base_twist: ArrayLike | None = None,
    base_twist_rate: ArrayLike | None = None,
) -> Array:
    r"""Compute the matrix Y by which the bodies' parameters give the torques.

    .. math:: \tau = Y(q, \dot q, \ddot q)\, p

    :func:`inverse_dynamics` is ``Y p``, with p the rows of :func:`body_parameters` one after the
    other, plus the rotors' reflected inertias times qdd.  The chain needs no bodies for it, and the
    friction of the drives is left out.

    Parameters
    ----------
    chain, q, qd, qdd, gravity, base_twist, base_twist_rate
        As for :func:`inverse_dynamics`.

    Returns
    -------
    ndarray, shape (n, 10 n) or (..., n, 10 n)
        (n, 10 m) where n drives move m joints.

    References
    ----------
    Atkeson, An, Hollerbach, Int. J. Robotics Research 5, 1986.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.dynamics import body_parameters, inverse_dynamics, torque_regressor
    >>> from robomech_ros.robots import load_robot
    >>> arm, state = load_robot("planar3r"), np.ones((3, 3))
    >>> Y = torque_regressor(arm, *state)
    >>> np.allclose(Y @ body_parameters(arm).ravel(), inverse_dynamics(arm, *state))
    True
    """
    q, qd, qdd = as_states(chain, ("q", "qd", "qdd"), q, qd, qdd)
    around = surroundings(q.shape, gravity, None, base_twist, base_twist_rate)
    values = chain.joint_values(as_rows(q))
    rates, changes = chain.joint_rates(as_rows(qd)), chain.joint_rates(as_rows(qdd))
    m = values.shape[1]
    Y = np.empty((len(values), m, 10 * m))
    status = kernels.torque_regressor(chain.packed, values, rates, changes, around, Y)
    if status:
        raise_outcome(chain, status, q=q, qd=qd, qdd=qdd)
    if chain.coupling is not None:
        Y = chain.coupling.matrix.T @ Y
    return Y.reshape(*q.shape, 10 * m)


@dataclass(frozen=True, eq=False)
class BaseParameters:
    """The combinations of the bodies' parameters that motions can show.

    Attributes
    ----------
    columns : ndarray of int, shape (r,)
        Columns of the regressor that are independent, the first ones that are.
    combination : ndarray, shape (r, 10 n)
        The base parameters are this matrix times the parameters of :func:`body_parameters`; its
        columns ``columns`` are those of the unit matrix.
    """

    columns: IntArray
    combination: Array

    @property
    def rank(self) -> int:
        """Number r of base parameters."""
        return len(self.columns)


def base_parameters(chain: SerialChain, *, gravity: ArrayLike = GRAVITY) -> BaseParameters:
    """Find which combinations of the bodies' parameters the torques depend on.

    A column of the regressor that depends on those before it, in all states, adds its parameter to
    theirs; one that is always zero has a parameter of no effect.

    Parameters
    ----------
    chain : SerialChain
        Chain of n joints.
    gravity : array_like, shape (3,), optional
        In the axes of the base (m/s^2).

    References
    ----------
    Gautier, Numerical calculation of the base inertial parameters of robots, J. Robotic Systems 8,
    1991.
    """
    check_chain(chain)
    rng = np.random.default_rng(_SEED)
    columns_for_each = -(-10 * len(chain.bodies) // chain.n)
    q, qd, qdd = rng.uniform(-np.pi, np.pi, (3, columns_for_each * _STATES, chain.n))
    Y = torque_regressor(chain, q, qd, qdd, gravity=gravity).reshape(-1, 10 * len(chain.bodies))
    scale = np.linalg.norm(Y, axis=0)
    columns: list[int] = []
    directions = np.empty((len(Y), 0))
    for k, size in enumerate(scale):
        if size <= BASE_PARAMETER * scale.max():
            continue  # zero except for rounding
        rest = Y[:, k] / size
        for _ in range(2):
            rest = rest - directions @ (directions.T @ rest)
        left = float(np.linalg.norm(rest))
        if left > BASE_PARAMETER:
            columns.append(k)
            directions = np.column_stack([directions, rest / left])
    combination: Array = np.linalg.lstsq(Y[:, columns], Y, rcond=None)[0].astype(np.float64)
    combination[np.abs(combination) < BASE_PARAMETER] = 0.0
    combination[:, columns] = np.eye(len(columns))
    return BaseParameters(np.array(columns, dtype=np.int64), combination)
