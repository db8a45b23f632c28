"""Raghavan and Roth's procedure: twelve equations in twelve monomials, quadratic in one tangent.

References
----------
Raghavan and Roth, ASME J. Mechanical Design 115 (1993), pp. 502-508.
Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., sections 9.3.1 and 9.6.1.
"""

from __future__ import annotations

import numpy as np

from robomech_ros.kinematics.equations.closure import ClosureEquations
from robomech_ros.kinematics.equations.half_angles import HALF
from robomech_ros.typing import Array


def raghavan_roth_matrix(equations: ClosureEquations) -> Array:
    r"""Return the 12 x 12 matrix whose determinant hides joint 3.

    With :math:`x_i = \tan(\theta_i / 2)` the six equations are quadratic in each of :math:`x_3`,
    :math:`x_4` and :math:`x_5`.  Multiplied by :math:`x_4` they are six more, in the twelve
    monomials :math:`x_4^i x_5^j`, i from 3, j from 2 down to 0:

    .. math::

       \Sigma(x_3)\, m = 0, \qquad
       \Sigma = \begin{bmatrix} 0 & E_2 & E_1 & E_0 \\ E_2 & E_1 & E_0 & 0 \end{bmatrix}, \qquad
       \det \Sigma = (1 + x_3^2)^4\, P_{16}(x_3)

    Returns
    -------
    ndarray, shape (3, 12, 12)
        Coefficients of x_3^2, x_3 and 1.
    """
    six = np.einsum("xi,yj,zk,eijk->xeyz", HALF, HALF, HALF, equations.free)
    twelve = np.zeros((3, 12, 4, 3))
    twelve[:, :6, 1:] = six
    twelve[:, 6:, :3] = six
    return twelve.reshape(3, 12, 12)
