"""Poses as Study parameters, and the quadrics in them that the legs of a platform stand for."""

import numpy as np
from numpy.typing import NDArray

from robomech_ros._kernels.parallel.quadrics import FORMS, STUDY
from robomech_ros.typing import BoolArray, ComplexArray

# Smallest e . e, of |x|^2, of a pose without a regular end that is not on its way to infinity.
_AT_INFINITY = 1e-5


def quadrics_of_platform(
    base_points: NDArray, platform_points: NDArray, squares: NDArray
) -> ComplexArray:
    """Return the seven quadrics (7, 30) of a platform, those of the legs orthonormal."""
    return quadrics_between(base_points, platform_points, squares, squares)[1]


def quadrics_between(
    base_points: NDArray, platform_points: NDArray, first: NDArray, last: NDArray
) -> tuple[ComplexArray, ComplexArray]:
    """Return the quadrics for two sets of squared lengths, the last ones orthonormal.

    All between them, on a line, are those of the same platform for lengths on a line.
    """
    one = _forms(base_points, platform_points, first)
    two = _forms(base_points, platform_points, last)
    triangle = np.linalg.qr(two.conj().T)[1].conj().T
    return _quadrics(np.linalg.solve(triangle, one)), _quadrics(np.linalg.solve(triangle, two))


def _forms(base_points: NDArray, platform_points: NDArray, squares: NDArray) -> NDArray:
    """Return the conditions of the legs (6, 17) in the seventeen forms."""
    a, b = np.asarray(base_points), np.asarray(platform_points)
    first = (a * a).sum(axis=1) + (b * b).sum(axis=1) - squares
    turned = -2.0 * (a[:, :, None] * b[:, None, :]).reshape(6, 9)
    rows = (first[:, None], np.ones((6, 1)), turned, -2.0 * a, 2.0 * b)
    return np.concatenate(rows, axis=1).astype(np.complex128)


def _quadrics(rows: NDArray) -> ComplexArray:
    return np.ascontiguousarray(np.concatenate((rows @ FORMS, STUDY[None])))


def still_finite(x: ComplexArray) -> BoolArray:
    """Say of which parameters (n, 8), of unit length, the pose is not about to go to infinity."""
    e = x[:, :4]
    return np.asarray(np.abs((e * e).sum(axis=1)) > _AT_INFINITY)
