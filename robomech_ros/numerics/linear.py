"""Overdetermined and underdetermined linear systems by Householder reflections.

References
----------
Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., appendix B.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from robomech_ros.errors import BadValueError, NonFiniteError, WrongSizeError
from robomech_ros.numerics.arrays import real_array
from robomech_ros.typing import Array

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
    reflections, U = _triangular(A)
    turned = _reflect(reflections, b)
    return _back_substituted(U, turned[:n]), float(np.linalg.norm(turned[n:]))


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
    reflections, U = _triangular(A.T)
    y = np.zeros(n)
    for i in range(m):
        y[i] = (b[i] - U[:i, i] @ y[:i]) / U[i, i]
    return _reflect(reflections[::-1], y)


def _checked(A: ArrayLike, b: ArrayLike) -> tuple[Array, Array]:
    matrix, vector = real_array("A", A), real_array("b", b)
    if matrix.ndim != 2 or not matrix.size:
        raise WrongSizeError("A", matrix.shape, "(m, n)")
    if vector.shape != matrix.shape[:1]:
        raise WrongSizeError("b", vector.shape, matrix.shape[:1])
    for name, value in (("A", matrix), ("b", vector)):
        if not np.isfinite(value).all():
            raise NonFiniteError(name, value)
    return matrix, vector


def _triangular(A: Array) -> tuple[list[tuple[Array, float]], Array]:
    """Reflect A (m, n), m >= n, to an upper triangle; give reflections (u, beta) and triangle."""
    U = A.copy()
    m, n = U.shape
    largest = float(np.linalg.norm(A, axis=0).max())
    reflections = []
    for i in range(n):
        u = np.zeros(m)
        u[i:] = U[i:, i]
        length = float(np.linalg.norm(u))
        if length <= _RANK * largest:
            raise BadValueError("A", A.tolist(), "a matrix of full rank")
        alpha = length if u[i] >= 0.0 else -length
        u[i] += alpha
        beta = alpha * float(u[i])
        U -= np.outer(u, u @ U) / beta
        reflections.append((u, beta))
    return reflections, U


def _reflect(reflections: list[tuple[Array, float]], vector: Array) -> Array:
    for u, beta in reflections:
        vector = vector - u * float(u @ vector) / beta
    return vector


def _back_substituted(U: Array, b: Array) -> Array:
    x = np.zeros(len(b))
    for i in range(len(b) - 1, -1, -1):
        x[i] = (b[i] - U[i, i + 1 : len(b)] @ x[i + 1 :]) / U[i, i]
    return x
