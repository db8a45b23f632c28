"""The torques along a path, as linear functions of what the motion along it may choose."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robomech_ros.dynamics.inverse import inverse_dynamics
from robomech_ros.dynamics.model import GRAVITY
from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.kinematics.joint_values import check_chain
from robomech_ros.robots.chain import SerialChain
from robomech_ros.spatial.arrays import as_finite

__all__ = ["path_torques"]

Array = NDArray[np.float64]

_AT_REST = (0.0, 0.0, 0.0)


def path_torques(
    chain: SerialChain,
    path: Any,
    *,
    gravity: ArrayLike = GRAVITY,
) -> Callable[[ArrayLike], tuple[Array, Array, Array]]:
    r"""Give the coefficients of the joint torques along a joint path q(s).

    .. math:: \tau = a(s) \ddot s + b(s) \dot s^2 + c(s), \quad
        a = M q', \quad b = M q'' + C(q, q') q', \quad c = g

    They are what the `TorqueLimits` of a time-optimal motion need.

    Parameters
    ----------
    chain : SerialChain
        Of n joints, with the bodies that they move.
    path : PiecewisePolynomial
        Joint values (rad or m) over the path coordinate s, or what else has a ``sample(s)`` that
        begins with q, q' and q''.
    gravity : array_like, shape (3,), optional
        In the axes of the base (m/s^2).

    Returns
    -------
    callable
        Of path coordinates, shape (m,): a, b and c there, each of shape (m, n), N m or N.  It
        raises what `inverse_dynamics` raises.

    Raises
    ------
    BadValueError, WrongSizeError, NonFiniteError
        Not a chain, not a path, a path of another number of joints, or gravity is no vector.

    References
    ----------
    J. E. Bobrow, S. Dubowsky and J. S. Gibson, "Time-optimal control of robotic manipulators along
    specified paths", International Journal of Robotics Research 4(3), 1985, equation 8.
    """
    check_chain(chain)
    if isinstance(path, type) or not callable(getattr(path, "sample", None)):
        raise BadValueError("path", path, "a joint path, with sample(s)")
    joints = getattr(path, "joints", chain.n)
    if joints != chain.n:
        raise WrongSizeError("joints of the path", joints, chain.n)
    down = as_finite("gravity", gravity, (3,))
    if down.shape != (3,):
        raise WrongSizeError("gravity", down.shape, (3,))

    def coefficients(s: ArrayLike) -> tuple[Array, Array, Array]:
        q, rate, bend = path.sample(s)[:3]
        still = np.zeros_like(q)
        return (
            inverse_dynamics(chain, q, still, rate, gravity=_AT_REST),
            inverse_dynamics(chain, q, rate, bend, gravity=_AT_REST),
            inverse_dynamics(chain, q, still, still, gravity=down),
        )

    return coefficients
