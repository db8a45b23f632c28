r"""Matrices that are quadratic in the tangent of a half angle: determinants and null vectors.

Written with sine and cosine of the half angle, ``A s^2 + B s c + C c^2``, no angle is at infinity.
The determinant is a polynomial of some order m in cosine and sine of the angle itself, and

.. math:: \det = (1 + x^2)^{-m} \sum_{k=0}^{2m} p_k x^k, \qquad x = \tan(\theta / 2)

References
----------
Manocha and Canny, IEEE Trans. Robotics and Automation 10(5), 1994, pp. 648-657.
"""

from __future__ import annotations

import numpy as np

from robomech_ros.typing import Array, ComplexArray

# From (cos, sin, 1) to the coefficients of x^2, x, 1.
HALF = np.array([[-1.0, 0.0, 1.0], [0.0, 2.0, 0.0], [1.0, 0.0, 1.0]])


def sampled_determinants(matrix: Array, count: int) -> tuple[Array, Array]:
    """Evaluate the determinant of a matrix (3, n, n) at evenly spaced angles.

    The matrix is A, B and C: coefficients of x^2, x and 1. Returns angles (count,), rad, and
    determinants (count,), with A s^2 + B s c + C c^2 for s and c of the half angle.
    """
    angles = 2.0 * np.pi * np.arange(count) / count
    s, c = np.sin(0.5 * angles), np.cos(0.5 * angles)
    values = np.einsum("xij,nx->nij", matrix, np.stack([s * s, s * c, c * c], axis=-1))
    return angles, np.linalg.det(values)


def waves_of_samples(samples: Array) -> ComplexArray:
    """Return d_k, k = -m .. m, with ``f = sum d_k exp(i k theta)``, from 2 m + 1 even samples."""
    return np.fft.fftshift(np.fft.fft(samples)) / len(samples)


def half_angle_polynomial(waves: ComplexArray) -> Array:
    """Return the coefficients of x^2m .. 1 of (1 + x^2)^m f, for x = tan(theta / 2).

    Parameters
    ----------
    waves : ndarray, shape (2 m + 1,)
        As from `waves_of_samples`.

    Returns
    -------
    ndarray, shape (2 m + 1,)
        Highest first; the first is f at a half turn.
    """
    m = len(waves) // 2
    total = np.zeros(2 * m + 1, complex)
    for k, wave in zip(range(-m, m + 1), waves, strict=True):
        # exp(i theta) = (1 + i x) / (1 - i x)
        total += wave * np.poly([1j] * (m + k) + [-1j] * (m - k)) * 1j ** (m + k) * (-1j) ** (m - k)
    return total.real


def null_vectors(matrix: Array, front: float) -> tuple[ComplexArray, ComplexArray]:
    """Find all angles at which a matrix (3, n, n) has a null vector, from 2 n eigenvalues.

    At the angle ``front`` (rad) it is regular; where it is not, numpy.linalg.LinAlgError is raised.
    Angles are measured from opposite to it, so that no tangent of a half angle is infinite. Returns
    angles (2 n,), rad, complex, of an infinite imaginary part where x is plus or minus i, and
    vectors (2 n, n).
    """
    A, B, C = matrix
    shift = front - np.pi
    c, s = np.cos(0.5 * shift), np.sin(0.5 * shift)
    leading = c * c * A - c * s * B + s * s * C
    middle = 2.0 * c * s * (A - C) + (c * c - s * s) * B
    last = s * s * A + c * s * B + c * c * C
    n = len(A)
    companion = np.zeros((2 * n, 2 * n), dtype=matrix.dtype)
    companion[:n, n:] = np.eye(n)
    companion[n:] = -np.linalg.solve(leading, np.hstack((last, middle)))
    values, vectors = np.linalg.eig(companion)
    upper, lower = vectors[:n].T, vectors[n:].T
    longer = np.linalg.norm(upper, axis=1) >= np.linalg.norm(lower, axis=1)
    angles = angles_of_tangents(values.astype(complex), np.ones(2 * n, complex)) + shift
    return angles, np.where(longer[:, None], upper, lower).astype(complex)


def angles_of_tangents(above: ComplexArray, below: ComplexArray) -> ComplexArray:
    """Return the angles (rad) whose half has the tangent above / below, shapes (...).

    Either may be zero: a half turn has below = 0. They are infinite where the tangent is plus or
    minus i.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        angle: ComplexArray = -1j * np.log((below + 1j * above) / (below - 1j * above))
    return angle


def angle_of_ratio(high: ComplexArray, low: ComplexArray) -> complex:
    """Return the angle whose half has the tangent high / low, by their greatest entries."""
    k = int(np.argmax(np.abs(high.ravel()) + np.abs(low.ravel())))
    return complex(angles_of_tangents(high.ravel()[k], low.ravel()[k]))


def angle_of(c: complex, s: complex) -> complex:
    """Return the angle (rad) of this cosine and sine, known up to a positive factor."""
    length = np.sqrt(complex(c * c + s * s))
    return complex(-1j * np.log((c + 1j * s) / length)) if length != 0 else 0j


def angles_of_roots(waves: ComplexArray) -> ComplexArray:
    """Find all angles at which a polynomial in cosine and sine vanishes, shape (2 m,).

    The waves (2 m + 1,) are as from `waves_of_samples`, not all zero. The angles (rad) have real
    parts within a turn, and are real or complex; infinite where the half angle's tangent is plus or
    minus i.
    """
    m = len(waves) // 2
    k = np.arange(-m, m + 1)
    # Measured from where the polynomial is greatest, no root is a half turn.
    fronts = np.pi * np.arange(2 * m + 1) / (m + 0.5)
    values = np.exp(1j * np.outer(fronts, k)) @ waves
    shift = float(fronts[np.argmax(np.abs(values))]) - np.pi
    tangents = np.roots(half_angle_polynomial(waves * np.exp(1j * k * shift))).astype(complex)
    angles = angles_of_tangents(tangents, np.ones(2 * m, complex)) + shift
    return (angles.real + np.pi) % (2.0 * np.pi) - np.pi + 1j * angles.imag


def angles_of_line(C: complex, D: complex, E: complex) -> ComplexArray:
    """Solve C cos + D sin + E = 0 for both angles (rad), complex, or infinite if C = D = 0."""
    # (C - i D) z^2 + 2 E z + (C + i D) = 0 for z = exp(i angle)
    roots = np.zeros(2, complex)
    found = np.roots([C - 1j * D, 2.0 * E, C + 1j * D])
    roots[: len(found)] = found
    with np.errstate(divide="ignore"):
        angles: ComplexArray = -1j * np.log(roots)
    return angles
