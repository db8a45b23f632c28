"""Li, Woernle and Hiller's procedure: eight equations in eight monomials, and nothing extraneous.

Pairs of equations that turn with a joint become linear in the tangent of its half angle.  The
matrix here follows this idea from the six equations that are left without joints 1 and 2; it need
not be that of the paper entry by entry.

References
----------
Lee, Woernle and Hiller, ASME J. Mechanical Design 113 (1991), pp. 481-486.
Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., sections 9.3.2 and 9.6.2.
"""

from __future__ import annotations

import numpy as np

from robomech_ros.kinematics.equations.closure import ClosureEquations
from robomech_ros.kinematics.equations.half_angles import HALF
from robomech_ros.typing import Array


def half_angle_equations(equations: ClosureEquations) -> Array:
    r"""Combine the six equations to four that are linear in the tangent of half of joint 3.

    Two combinations that turn with joint 3,

    .. math:: e = a c_3 + b s_3 + g, \qquad f = -b c_3 + a s_3 + h,

    give, since :math:`c_3 + x_3 s_3 = 1` and :math:`s_3 - x_3 c_3 = x_3`,

    .. math:: e + x_3 f = (b + h)\, x_3 + (a + g).

    Such e and f are a null vector of 18 equations in their twelve weights; there are four.

    Returns
    -------
    ndarray, shape (4, 2, 3, 3)
        Coefficients of (x_3, 1) times the products of (cos, sin, 1) of joints 4 and 5.
    """
    c, s, one = (equations.free[:, k].reshape(6, 9) for k in range(3))
    # Weights u of e and v of f: u c = v s and u s = -v c.
    turning = np.block([[c.T, -s.T], [s.T, c.T]])
    weights = np.linalg.svd(turning)[2][8:]
    u, v = weights[:, :6], weights[:, 6:]
    pairs = np.stack([u @ s + v @ one, u @ c + u @ one], axis=1)
    return pairs.reshape(4, 2, 3, 3)


def li_woernle_hiller_matrix(equations: ClosureEquations) -> Array:
    r"""Return the 8 x 8 matrix whose determinant hides joint 5.

    The four equations linear in :math:`x_3 = \tan(\theta_3 / 2)` are quadratic in :math:`x_4` and
    :math:`x_5`.  Multiplied by :math:`x_4` they are four more, in the eight monomials
    :math:`x_4^i x_3^j`, i from 3, j from 1 down to 0.  The determinant has degree sixteen.

    Returns
    -------
    ndarray, shape (3, 8, 8)
        Coefficients of x_5^2, x_5 and 1.
    """
    four = np.einsum("yj,zk,etjk->zeyt", HALF, HALF, half_angle_equations(equations))
    eight = np.zeros((3, 8, 4, 2))
    eight[:, :4, 1:] = four
    eight[:, 4:, :3] = four
    return eight.reshape(3, 8, 8)
