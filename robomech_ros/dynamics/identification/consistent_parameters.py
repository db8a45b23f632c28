r"""Least squares over the parameters of possible bodies: a convex program.

A body is physically possible where its pseudo-inertia J is positive definite.  What is
minimised is

.. math:: |C p - t|^2 / 2 + \gamma \sum_i (\mathrm{tr} J_i K_i^{-1} - \log \det J_i K_i^{-1} - 4)

with the pseudo-inertias K_i of bodies known before.  The sum, a divergence that does not depend on
frames and units, is convex, 0 at the bodies known before, and infinite where J_i is no longer
positive definite; so there is one minimum, which damped Newton steps find from anywhere, for less
and less gamma.

References
----------
T. Lee, P. M. Wensing and F. C. Park, "Geometric robot dynamic identification: a convex programming
approach", IEEE Transactions on Robotics 36(2), 2020.
Y. Nesterov and A. Nemirovskii, Interior-Point Polynomial Algorithms in Convex Programming, SIAM
1994, chapter 2: damped Newton steps.
"""

from dataclasses import dataclass

import numpy as np

from robomech_ros.dynamics.pseudo_inertias import parameters_from_pseudo_inertia, pseudo_inertia
from robomech_ros.numerics import least_squares
from robomech_ros.typing import Array

# From one gamma to the next, and Newton steps for all of them together.
_LESS, _MOST_STEPS = 0.2, 500
# Newton decrements at which gamma is made smaller, and at which the last minimum is found.
_NEAR, _ARRIVED = 0.5, 1e-6
# An orthonormal basis of the symmetric matrices of order 4.
_ROWS, _COLUMNS = np.triu_indices(4)
_BASIS = np.zeros((10, 4, 4))
_BASIS[np.arange(10), _ROWS, _COLUMNS] = np.where(_ROWS == _COLUMNS, 1.0, np.sqrt(0.5))
_BASIS[np.arange(10), _COLUMNS, _ROWS] = _BASIS[np.arange(10), _ROWS, _COLUMNS]


@dataclass(frozen=True, eq=False)
class ConsistentParameters:
    """Parameters (n, 10) of possible bodies, and whether the minimum is found."""

    parameters: Array
    converged: bool


def consistent_least_squares(
    C: Array, t: Array, known: Array, gamma: float
) -> ConsistentParameters:
    """Find the bodies whose parameters p have ``C p`` nearest to t, C (m, 10 n) and t (m,).

    Directions that C leaves free remain near the ``known`` (n, 10) of possible bodies, which count
    gamma: half the square of a residual, or of the mean residual where that is above 1. ``|C p -
    t|^2 / 2`` is above its least value by some ``4 n gamma`` of them.
    """
    J = pseudo_inertia(known)
    inverse = np.linalg.inv(J)
    left = t - C @ known.ravel()
    weight = max(gamma, float(left @ left) / J.shape[0])
    for _ in range(_MOST_STEPS):
        L = np.linalg.cholesky(J)
        # J + L Z L^T, with Z in the basis: where it stays positive definite does not depend on J.
        moves = L[:, None] @ _BASIS @ np.swapaxes(L, -1, -2)[:, None]
        shifts = parameters_from_pseudo_inertia(moves)
        A = np.einsum("mik,ijk->mij", C.reshape(len(C), -1, 10), shifts).reshape(len(C), -1)
        slope = (np.swapaxes(L, -1, -2) @ inverse @ L - np.eye(4))[:, None] * _BASIS
        root = np.sqrt(weight)
        rows = np.vstack((A, root * np.eye(A.shape[1])))
        step, _ = least_squares(rows, np.concatenate((left, -root * slope.sum((-2, -1)).ravel())))
        decrement = float(np.linalg.norm(rows @ step)) / root
        part = 1.0 / (1.0 + decrement) if decrement > 0.25 else 1.0
        Z = (part * step.reshape(-1, 10, 1, 1) * _BASIS).sum(axis=1)
        J = L @ (np.eye(4) + Z) @ np.swapaxes(L, -1, -2)
        J = 0.5 * (J + np.swapaxes(J, -1, -2))
        left = t - C @ parameters_from_pseudo_inertia(J).ravel()
        # As many digits for a large distance as for a small one.
        last = weight <= gamma * max(1.0, float(left @ left) / len(t))
        if not last and decrement < _NEAR:
            weight = max(gamma, _LESS * weight)
        elif last and decrement < _ARRIVED:
            return ConsistentParameters(parameters_from_pseudo_inertia(J), True)
    return ConsistentParameters(parameters_from_pseudo_inertia(J), False)
