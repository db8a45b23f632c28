"""Postures that share one angle: the two others by a second elimination, at that angle.

References
----------
Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 9.6.
"""

import numpy as np

from robomech_ros.kinematics.equations.closure import ClosureEquations, circle
from robomech_ros.kinematics.equations.half_angles import (
    HALF,
    angle_of_ratio,
    null_vectors,
    sampled_determinants,
)
from robomech_ros.typing import ComplexArray

# Least singular value, as part of the greatest, with which a direction may be a null vector: an
# angle shared by m postures is known to the m-th root of the rounding.
_MAYBE_NULL = 1e-3
_SAMPLES = 7
# Any three combinations of the six equations.
_THREE = np.linalg.qr(np.random.default_rng(0).normal(size=(6, 3)))[0].T


def angles_beside(equations: ClosureEquations, place: int, angle: complex) -> list[ComplexArray]:
    """Find all values of joints 3, 4 and 5 where one of them, number 0, 1 or 2, is known (rad).

    With it the equations are six in two unknowns, ``M(x) (y^2, y, 1)^T = 0``, M (6, 3) quadratic in
    x. Three combinations of them have a null vector at six values of x, and all six there, too,
    where x belongs to a posture. Returns rows (3,), perhaps with some that are no posture.
    """
    two = np.einsum("eijk,i->ejk", np.moveaxis(equations.free, place + 1, 1), circle(angle))
    six = np.einsum("yj,zk,ejk->yez", HALF, HALF, two)
    three = np.einsum("re,yez->yrz", _THREE, six)
    angles, determinants = sampled_determinants(three, _SAMPLES)
    try:
        xs, _ = null_vectors(three, float(angles[np.argmax(np.abs(determinants))]))
    except np.linalg.LinAlgError:
        return []
    found = []
    for x in xs[np.isfinite(xs)]:
        s, c = np.sin(0.5 * x), np.cos(0.5 * x)
        _, sizes, rows = np.linalg.svd(s * s * six[0] + s * c * six[1] + c * c * six[2])
        if sizes[2] > _MAYBE_NULL * sizes[0]:
            continue
        vectors = [rows[2].conj()]
        if sizes[1] <= _MAYBE_NULL * sizes[0]:
            vectors += _on_the_conic(rows[1].conj(), rows[2].conj())
        for vector in vectors:
            y = angle_of_ratio(vector[:2], vector[1:])
            if np.isfinite(y):
                found.append(np.insert(np.array([x, y], complex), place, angle))
    return found


def _on_the_conic(n: ComplexArray, m: ComplexArray) -> list[ComplexArray]:
    """Find combinations of two vectors that are proportional to (y^2, y, 1)."""
    quadratic = [
        n[0] * n[2] - n[1] ** 2,
        n[0] * m[2] + n[2] * m[0] - 2.0 * n[1] * m[1],
        m[0] * m[2] - m[1] ** 2,
    ]
    return [t * n + m for t in np.roots(quadratic)]
