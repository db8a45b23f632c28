"""The univariate approach: the real postures among the roots of a polynomial of degree sixteen.

References
----------
Raghavan and Roth, ASME J. Mechanical Design 115 (1993), pp. 502-508.
Lee, Woernle and Hiller, ASME J. Mechanical Design 113 (1991), pp. 481-486.
Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 9.3.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, DTypeLike

from robomech_ros.kinematics.equations.univariate import PROCEDURES, univariate_roots
from robomech_ros.robots.chain import SerialChain
from robomech_ros.spatial.arrays import as_choice
from robomech_ros.typing import Array


@dataclass(frozen=True, eq=False)
class UnivariateSolutions:
    """Postures from eigenvalues; a sequence of them, and an array (k, 6) for numpy.

    Parameters
    ----------
    q : ndarray, shape (k, 6)
        Joint angles (rad), distinct, by increasing joint 3.
    complete : bool
        Whether every root that may be real has led to a posture of its own.  It is False wherever
        postures merge or roots belong to none, though all may be there.
    reason : str
        What is missing; empty where nothing is.
    """

    q: Array
    complete: bool
    reason: str

    def __len__(self) -> int:
        return len(self.q)

    def __iter__(self) -> Iterator[Array]:
        return iter(self.q)

    def __getitem__(self, k: int) -> Array:
        return self.q[k]

    def __array__(self, dtype: DTypeLike | None = None, copy: bool | None = None) -> Array:
        return np.array(self.q, dtype=dtype)


def solve_univariate(
    chain: SerialChain, T: ArrayLike, *, procedure: str = "raghavan-roth"
) -> UnivariateSolutions:
    """Find the postures of an arm of six revolute joints by eigenvalues.

    Parameters
    ----------
    chain : SerialChain
    T : array_like, shape (4, 4)
        Target pose of the tip in the base (m).
    procedure : {"raghavan-roth", "li-woernle-hiller"}, optional
        Twelve equations in twelve monomials, or eight in eight.

    Returns
    -------
    UnivariateSolutions
        Not ``complete`` where roots are equal, as of singular postures and of arms with parallel
        axes or a spherical wrist.

    See Also
    --------
    robomech_ros.kinematics.equations.raghavan_roth : with the polynomial and complex roots.
    robomech_ros.kinematics.equations.li_woernle_hiller : the same.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 9.3.
    """
    found = univariate_roots(as_choice("procedure", procedure, tuple(PROCEDURES)), chain, T)
    q = found.real
    return UnivariateSolutions(q[np.argsort(q[:, 2])], found.complete, found.reason)
