"""The natural orthogonal complement of planar arms: twists of three numbers instead of six."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from robomech_ros.dynamics.complement.stacking import transposed
from robomech_ros.dynamics.formulations.orthogonal_complement import natural_orthogonal_complement
from robomech_ros.dynamics.posed_bodies import reflected_inertias
from robomech_ros.kinetostatics.reduced_jacobians import planar_rows
from robomech_ros.robots.chain import SerialChain
from robomech_ros.typing import Array, ArrayLike


@dataclass(frozen=True, eq=False)
class PlanarComplement:
    """The matrices of a planar arm in motion.

    The twist of a body is ``[omega; v_x; v_y]``, v of its mass centre, in the plane of
    :func:`planar_rows`.  There the angular velocity is no part of the equations: the moments of
    ``W M t`` lie in the plane, across all axes.

    Attributes
    ----------
    rotors : ndarray, shape (n,)
        Inertias that the drives add to the joints (kg m^2 or kg).
    T : ndarray, shape (..., 3 m, n)
        Twist-shaping matrix.
    T_dot : ndarray, shape (..., 3 m, n)
        Its rate.
    M : ndarray, shape (3 m, 3 m) or (..., 3 m, 3 m)
        Extended mass matrix, blocks diag(I_i, m_i, m_i).
    """

    rotors: Array
    T: Array
    T_dot: Array
    M: Array

    @cached_property
    def generalised_inertia(self) -> Array:
        """``I = T^T M T`` and the rotors' inertias, shape (..., n, n) (kg m^2, kg m, kg)."""
        return transposed(self.T) @ self.M @ self.T + np.diag(self.rotors)

    @cached_property
    def coupling(self) -> Array:
        """``C = T^T M T_dot``, shape (..., n, n); dI/dt - 2 C is skew-symmetric."""
        return transposed(self.T) @ self.M @ self.T_dot


def planar_orthogonal_complement(
    chain: SerialChain, q: ArrayLike, qd: ArrayLike
) -> PlanarComplement:
    """Form the matrices of a planar arm, its base at rest.

    Parameters
    ----------
    chain : SerialChain
        Of m joints moved by n drives, all axes across one plane and all slides along it, with their
        bodies.
    q, qd : array_like, shape (n,) or (..., n)
        Joint values and rates (rad or m; per s).

    Raises
    ------
    BadValueError, WrongSizeError
        The arm is not planar, or arguments are no finite numbers of these shapes.
    MissingInertiaError
        Of some joints nothing is known that moves with them.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 7.6.1.
    """
    plane = planar_rows(chain)
    model = natural_orthogonal_complement(chain, q, qd)
    rows = np.kron(np.eye(len(model.masses)), plane)
    return PlanarComplement(
        rotors=reflected_inertias(chain),
        T=rows @ model.T,
        T_dot=rows @ model.T_dot,
        M=rows @ model.M @ rows.T,
    )
