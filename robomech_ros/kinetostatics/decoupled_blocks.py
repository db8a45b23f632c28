"""The blocks of the Jacobian of an arm with a spherical wrist."""

from __future__ import annotations

import functools
from typing import NamedTuple

import numpy as np

from robomech_ros._kernels.inverse.decoupled import layout as decoupled_layout
from robomech_ros.errors import BadValueError
from robomech_ros.kinematics.inverse.families import decoupled
from robomech_ros.kinematics.joint_values import check_chain
from robomech_ros.kinetostatics.point_jacobians import point_jacobian
from robomech_ros.robots.chain import SerialChain
from robomech_ros.typing import Array, ArrayLike


class Wrist(NamedTuple):
    """The centre (3,) of a spherical wrist after three joints, in the frame of the tip (m).

    It is exact where the axes meet to rounding, not just within 1e-5 of the arm's size.
    """

    centre: Array
    exact: bool


class DecoupledJacobian(NamedTuple):
    """The Jacobian at the wrist centre, ``[[J11, J12], [J21, 0]]``, and where that is.

    Attributes
    ----------
    J11, J12 : ndarray, shape (..., 3, 3)
        Angular rows of the joints 1 to 3 and 4 to 6.
    J21 : ndarray, shape (..., 3, 3)
        Linear rows of the joints 1 to 3 (m).
    centre : ndarray, shape (3,)
        The wrist centre in the frame of the tip (m).
    """

    J11: Array
    J12: Array
    J21: Array
    centre: Array

    @property
    def A(self) -> Array:
        """Angular rows, shape (..., 3, 6)."""
        return np.concatenate((self.J11, self.J12), axis=-1)

    @property
    def B(self) -> Array:
        """Linear rows at the wrist centre, shape (..., 3, 6) (m)."""
        return np.concatenate((self.J21, np.zeros_like(self.J21)), axis=-1)


def decoupled_jacobian(chain: SerialChain, q: ArrayLike) -> DecoupledJacobian:
    r"""Compute the blocks of the Jacobian at the wrist centre, where it is block triangular.

    .. math::

       J = \begin{bmatrix} J_{11} & J_{12} \\ J_{21} & 0 \end{bmatrix}, \quad
       J_{21}\, \dot q_\text{arm} = v_C, \quad
       J_{12}\, \dot q_\text{wrist} = \omega - J_{11}\, \dot q_\text{arm}, \quad
       \det J = -\det J_{12} \det J_{21}

    The determinant is the same wherever the tip is.

    Parameters
    ----------
    chain : SerialChain
        Three joints, and three revolute ones whose axes meet in one point.
    q : array_like, shape (6,) or (..., 6)
        Joint values (rad or m).

    Returns
    -------
    DecoupledJacobian
        In the axes of the base.  Where the wrist's axes pass each other by up to 1e-5 of the
        arm's size, what J22 has of that is left out.

    Raises
    ------
    BadValueError, WrongSizeError
        As for :func:`jacobian`, or the chain has no spherical wrist after three joints.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 5.3.
    """
    check_chain(chain)
    wrist = wrist_of(chain)
    if wrist is None:
        expected = "three joints that move a point freely, then three revolute ones through it"
        raise BadValueError("chain", chain.name, expected)
    J = point_jacobian(chain, q, wrist.centre)
    return DecoupledJacobian(J[..., :3, :3], J[..., :3, 3:], J[..., 3:, :3], wrist.centre)


@functools.lru_cache(maxsize=64)
def wrist_of(chain: SerialChain) -> Wrist | None:
    """Find the spherical wrist of an arm of six joints; None where there is none."""
    data = None if chain.coupling else decoupled.match(chain)
    if data is None:
        return None
    centre = data[decoupled_layout.CENTRE : decoupled_layout.CENTRE + 3].copy()
    centre.setflags(write=False)
    return Wrist(centre, bool(data[decoupled_layout.EXACT]))
