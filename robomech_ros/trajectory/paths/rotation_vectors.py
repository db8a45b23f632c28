"""Angular velocity and acceleration of a motion given by its rotation vector.

For ``Q = exp(CPM(theta))``, x = theta . theta, a(x) = (1 - cos) / theta^2 and
b(x) = (theta - sin) / theta^3,

``omega = theta' + a theta x theta' + b theta x (theta x theta')``

in the fixed frame, and in the moving one with -a for a.
"""

import numpy as np

from robomech_ros.spatial.cross_product import cross_product_matrix
from robomech_ros.trajectory.sample import FloatArray

__all__ = ["angular_motion", "applied", "body_rate_matrix", "turning_acceleration"]

# Below this x the series is exact to rounding with the terms kept; above, the closed forms lose
# two digits at most.
_SERIES = 1.0
_TERMS = 11
_FACTORIALS = np.cumprod(np.concatenate([[1.0], np.arange(1.0, 2.0 * _TERMS + 4.0)]))
_SIGNS = (-1.0) ** np.arange(_TERMS)
_A = _SIGNS / _FACTORIALS[2 : 2 * _TERMS + 2 : 2]
_B = _SIGNS / _FACTORIALS[3 : 2 * _TERMS + 3 : 2]
_DA, _DB = (series[1:] * np.arange(1.0, _TERMS) for series in (_A, _B))


def angular_motion(
    theta: FloatArray, rate: FloatArray, second: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Give angular velocity and acceleration from a rotation vector and its derivatives.

    Parameters
    ----------
    theta, rate, second : ndarray, shape (m, 3)
        Rotation vector (rad) and its first two derivatives.

    Returns
    -------
    omega, alpha : ndarray, shape (m, 3)
        In the frame in which the rotation turns the coordinates of vectors.
    """
    a, b, _, _ = _factors(theta)
    omega = rate + _through(theta, rate, a, b)
    alpha = second + _through(theta, second, a, b) + turning_acceleration(theta, rate)
    return omega, alpha


def turning_acceleration(theta: FloatArray, rate: FloatArray) -> FloatArray:
    """Part of the angular acceleration that is quadratic in the rate of the rotation vector."""
    _, b, da, db = _factors(theta)
    across = np.cross(theta, rate)
    growth = 2.0 * np.sum(theta * rate, axis=-1, keepdims=True)
    turned: FloatArray = (
        growth * da * across + growth * db * np.cross(theta, across) + b * np.cross(rate, across)
    )
    return turned


def body_rate_matrix(theta: FloatArray) -> FloatArray:
    """Matrices (m, 3, 3) from the rate of a rotation vector to the moving frame's own velocity."""
    a, b, _, _ = _factors(theta)
    K = cross_product_matrix(theta)
    matrix: FloatArray = np.eye(3) - a[..., None] * K + b[..., None] * (K @ K)
    return matrix


def applied(matrices: FloatArray, vectors: FloatArray) -> FloatArray:
    """Products of matrices (m, 3, 3) with vectors (m, 3), one by one."""
    product: FloatArray = (matrices @ vectors[..., None])[..., 0]
    return product


def _through(theta: FloatArray, vector: FloatArray, a: FloatArray, b: FloatArray) -> FloatArray:
    across = np.cross(theta, vector)
    turned: FloatArray = a * across + b * np.cross(theta, across)
    return turned


def _factors(theta: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Give a, b and their derivatives with respect to x, each (m, 1)."""
    x = np.sum(theta * theta, axis=-1, keepdims=True)
    small = x < _SERIES
    low = np.where(small, x, 0.0)
    high = np.where(small, 1.0, x)
    t = np.sqrt(high)
    cosine, sine = np.cos(t), np.sin(t)
    a, b = (1.0 - cosine) / high, (t - sine) / (high * t)
    closed = (a, b, (0.5 * sine / t - a) / high, (0.5 * a - 1.5 * b) / high)
    series = (np.polynomial.polynomial.polyval(low, c) for c in (_A, _B, _DA, _DB))
    first, second, third, fourth = (
        np.where(small, near, far) for near, far in zip(series, closed, strict=True)
    )
    return first, second, third, fourth
