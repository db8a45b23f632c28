"""Overdetermined and underdetermined linear systems by Householder reflections.

References
----------
Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., appendix B.
"""

from __future__ import annotations

import numpy as np

from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.numerics.arrays import check_finite, of_shape, real_array
from robomech_ros.typing import Array, ArrayLike

# A pivot below this (of the longest column) is rounding: the columns depend on each other.
_RANK = 1e-13


def least_squares(A: ArrayLike, b: ArrayLike) -> tuple[Array, float]:
    r"""Minimise ``|A x - b|`` for a matrix with at least as many rows as columns.

    The normal equations, which square the condition number, are not formed.

    Householder's reflections :math:`H_i = 1 - u u^T / \beta` make A an upper triangle:

    .. math::

       H A = \begin{bmatrix} U \\ 0 \end{bmatrix}, \qquad
       H b = \begin{bmatrix} b_U \\ b_L \end{bmatrix}, \qquad U x = b_U, \qquad
       |A x - b| = |b_L|

    Parameters
    ----------
    A : array_like, shape (m, n)
        Of full rank, m >= n.
    b : array_like, shape (m,)

    Returns
    -------
    x : ndarray, shape (n,)
    error : float
        What is left of ``|A x - b|``.

    Raises
    ------
    BadValueError
        The columns depend on each other.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., appendix B.1.

    Examples
    --------
    >>> from robomech_ros.numerics import least_squares
    >>> x, error = least_squares([[1, 2], [3, 4], [5, 6], [7, 9]], [1, 0, 2, -1])
    >>> x.round(6), round(error, 6)
    (array([ 0.220339, -0.135593]), 2.407615)
    """
    A, b = _checked(A, b)
    m, n = A.shape
    if m < n:
        raise WrongSizeError("A", A.shape, "at least as many rows as columns")
    Q, U = _triangular(A)
    turned = Q.T @ b
    x = np.linalg.solve(U, turned).astype(np.float64, copy=False)
    return x, float(np.linalg.norm(b - Q @ turned))


def minimum_norm(A: ArrayLike, b: ArrayLike) -> Array:
    r"""Find the shortest x with ``A x = b`` for a matrix with at most as many rows as columns.

    .. math::

       H A^T = \begin{bmatrix} U \\ 0 \end{bmatrix}, \qquad U^T y = b, \qquad
       x = H^T \begin{bmatrix} y \\ 0 \end{bmatrix}

    Parameters
    ----------
    A : array_like, shape (m, n)
        Of full rank, m <= n.
    b : array_like, shape (m,)

    Returns
    -------
    ndarray, shape (n,)

    Raises
    ------
    BadValueError
        The rows depend on each other.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., appendix B.2.

    Examples
    --------
    >>> from robomech_ros.numerics import minimum_norm
    >>> minimum_norm([[1.0, 1.0, 1.0]], [3.0]).round(6)
    array([1., 1., 1.])
    """
    A, b = _checked(A, b)
    m, n = A.shape
    if m > n:
        raise WrongSizeError("A", A.shape, "at most as many rows as columns")
    # With H A^T = [U; 0], A x = U^T y for x = H^T [y; 0]: the rest of y would only lengthen x.
    Q, U = _triangular(A.T)
    return Q @ np.linalg.solve(U.T, b)


def _checked(A: ArrayLike, b: ArrayLike) -> tuple[Array, Array]:
    matrix, vector = real_array("A", A), real_array("b", b)
    if matrix.ndim != 2 or not matrix.size:
        raise WrongSizeError("A", matrix.shape, "(m, n)")
    of_shape("b", vector, matrix.shape[:1])
    check_finite("A", matrix)
    check_finite("b", vector)
    return matrix, vector


def _triangular(A: Array) -> tuple[Array, Array]:
    Q, U = np.linalg.qr(A)
    if np.abs(np.diag(U)).min() <= _RANK * np.linalg.norm(A, axis=0).max():
        raise BadValueError("A", A.tolist(), "a matrix of full rank")
    return Q, U
