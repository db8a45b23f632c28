"""Conditioning of omnidirectional wheels, and the length that makes twists comparable."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robomech_ros.errors import BadValueError
from robomech_ros.rolling.base import RollingBase
from robomech_ros.typing import Array

# A condition number this near to 1 is that of an isotropic base.
_ISOTROPIC = 1e-9


@dataclass(frozen=True, eq=False)
class Isotropy:
    """Conditioning of the wheels of a base.

    Attributes
    ----------
    matrix : ndarray, shape (k, 3)
        K, the rates of the driven wheels for units of ``[omega, v_x, v_y]`` (1, 1/m, 1/m).
    length : float
        Characteristic length (m): with omega times it in place of omega, the condition number of K
        by the Frobenius norm is least.
    condition_number : float
        Of K then, by the Frobenius norm: 1 where all directions are alike.
    isotropic : bool
        Whether they are.
    """

    matrix: Array
    length: float
    condition_number: float
    isotropic: bool


def isotropy(base: RollingBase) -> Isotropy:
    r"""Find the characteristic length of a base on omnidirectional wheels, and how isotropic it is.

    With :math:`A = K^T K`, the least condition number is at
    :math:`L^4 = a_{11} (b_{22} + b_{33}) / ((a_{22} + a_{33}) b_{11})`, b being entries of the
    inverse of A.

    Parameters
    ----------
    base : RollingBase
        On omnidirectional wheels, and casters.

    Raises
    ------
    BadValueError
        A base with conventional wheels, whose twist is not free.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., sections 5.8 and 10.5.2.

    Examples
    --------
    >>> from robomech_ros.rolling import isotropy, omnidirectional
    >>> found = isotropy(omnidirectional(3, radius=0.05, distance=0.25))
    >>> round(found.length, 5), found.isotropic
    (0.35355, True)
    """
    if not isinstance(base, RollingBase) or base.mobility.type != "(3,0)":
        kind = f"one of type {base.mobility.type}" if isinstance(base, RollingBase) else base
        raise BadValueError("base", kind, "a base of type (3,0), on omnidirectional wheels")
    K = base.driven_rows
    A = K.T @ K
    B = np.linalg.inv(A)
    own, others = A[0, 0], A[1, 1] + A[2, 2]
    inverse_own, inverse_others = B[0, 0], B[1, 1] + B[2, 2]
    length = float((own * inverse_others / (others * inverse_own)) ** 0.25)
    product = (own / length**2 + others) * (inverse_own * length**2 + inverse_others)
    condition = float(np.sqrt(product) / 3.0)
    return Isotropy(K.copy(), length, condition, abs(condition - 1.0) <= _ISOTROPIC)
