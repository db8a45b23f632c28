"""Elimination of angles from equations that are linear in cosine and sine of each angle.

References
----------
Nanua, Waldron and Murthy, Direct kinematic solution of a Stewart platform, IEEE Trans. Robotics
and Automation 6 (1990), pp. 438-444.
"""

from collections.abc import Callable

import numpy as np

from robomech_ros.kinematics.equations.closure import circle
from robomech_ros.kinematics.equations.half_angles import (
    angle_of,
    angles_of_line,
    half_angle_polynomial,
    waves_of_samples,
)
from robomech_ros.typing import Array, ComplexArray

Numbers = Array | ComplexArray
# Evenly spaced angles that determine the resultant of two lines, of order two in one angle.
_FIVE = np.linspace(0.0, 2.0 * np.pi, 5, endpoint=False)
# Determinant of two lines over their size below which they count as parallel.
_PARALLEL = 1e-4
# Newton's method for complex angles: step of central differences, most iterations, last step, and
# largest residual relative to the derivative.
_STEP, _STEPS, _LAST, _ACCEPTED = 1e-5, 40, 1e-15, 1e-10


def line_resultant(g: Numbers, h: Numbers) -> Numbers:
    """Eliminate an angle from ``g (c, s, 1) = 0`` and ``h (c, s, 1) = 0``, shapes (3, ...).

    Both lines cross on the unit circle if ``x^2 + y^2 = w^2`` for ``(x, y, w) = g x h``.
    """
    x, y, w = np.cross(g, h, axis=0)
    return np.asarray(x * x + y * y - w * w)


def crossing_angles(g: Numbers, h: Numbers) -> list[complex]:
    """Return the angles (rad) at the crossing of two lines (3,), or those of one if they agree."""
    x, y, w = np.cross(g, h)
    larger = g if np.linalg.norm(g[:2]) >= np.linalg.norm(h[:2]) else h
    if abs(w) > _PARALLEL * np.linalg.norm(g) * np.linalg.norm(h):
        return [angle_of(x / w, y / w)]
    return list(angles_of_line(*larger.tolist()))


def sylvester(table: Array, lines: Callable[[Array, Array], Numbers], angle: float) -> Array:
    """Return the dialytic matrix (6, 6) that eliminates the second of three angles.

    - ``table``: coefficients of the equation between the first and the second angle, shape (3, 3).
    - ``lines``: from the first and the second angle (rad) to the resultant of the equations in the
      third.
    - ``angle``: the first (rad).

    Returns an array (6, 6); rows: the quadratic in the tangent of the second half angle times
    x^3 .. 1, then the quartic times x and 1; columns: x^5 .. 1.
    """
    C, D, E = circle(angle) @ table
    quadratic = np.array([E - C, 2.0 * D, E + C])
    quartic = half_angle_polynomial(waves_of_samples(np.real(lines(np.array(angle), _FIVE))))
    matrix = np.zeros((6, 6))
    for row in range(4):
        matrix[row, row : row + 3] = quadratic
    for row in range(2):
        matrix[4 + row, row : row + 5] = quartic
    return matrix


def refined_angles(
    equations: Callable[[Numbers], Numbers], start: ComplexArray
) -> ComplexArray | None:
    """Refine angles (n,), real or complex, by Newton's method; None if it does not converge."""
    x = np.array(start, complex)
    steps = _STEP * np.eye(len(x))
    with np.errstate(over="ignore", invalid="ignore"):
        for _ in range(_STEPS):
            slope = np.stack([equations(x + h) - equations(x - h) for h in steps], axis=1)
            slope /= 2.0 * _STEP
            try:
                change = np.linalg.solve(slope, -equations(x))
            except np.linalg.LinAlgError:
                return None
            if not np.isfinite(change).all():
                return None
            x = x + change
            if np.abs(change).max() < _LAST * (1.0 + np.abs(x).max()):
                break
        left = np.abs(equations(x)).max()
    if not left <= _ACCEPTED * max(1.0, float(np.abs(slope).max())):
        return None
    return (x.real + np.pi) % (2.0 * np.pi) - np.pi + 1j * x.imag
