"""Derivatives at the knots that make a spline through given values smooth.

With the first two derivatives there a quintic C4 spline is the Hermite interpolant of its knots.
"""

from typing import Literal, NamedTuple

import numpy as np

from robomech_ros.trajectory.curves.interpolation import interpolant
from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial
from robomech_ros.typing import Array

Ends = Literal["natural", "clamped", "periodic"]


def quintic_spline(
    knots: Array, values: Array, ends: Ends, rates: Array | None = None
) -> PiecewisePolynomial:
    """Put a quintic C4 spline through values (n, d) at increasing knots (n,).

    Ends are ``natural``, with third and fourth derivatives 0, ``clamped``, with the first and
    second derivatives `rates` (2, 2, d) at the start and at the end, or ``periodic``.
    """
    h = np.diff(knots)
    rise = np.diff(values, axis=0) / h[:, None]
    third, fourth = 1.0 / h**2, 1.0 / h**3
    start = Side(
        _blocks([[-36.0 * third, -9.0 / h], [192.0 * fourth, 36.0 * third]]),
        _blocks([[-24.0 * third, 3.0 / h], [168.0 * fourth, -24.0 * third]]),
        np.stack([60.0 * rise * third[:, None], -360.0 * rise * fourth[:, None]], axis=1),
    )
    end = Side(
        _blocks([[-24.0 * third, -3.0 / h], [-168.0 * fourth, -24.0 * third]]),
        _blocks([[-36.0 * third, 9.0 / h], [-192.0 * fourth, 36.0 * third]]),
        np.stack([60.0 * rise * third[:, None], 360.0 * rise * fourth[:, None]], axis=1),
    )
    found = matched(start, end, ends, rates)
    return interpolant(knots, values, found[:, 0], found[:, 1])


class Side(NamedTuple):
    """A derivative at one end of every segment: ``before x[k] + after x[k + 1] + constant``.

    x[k] are the unknown derivatives at knot k, shape (b, d); the blocks are (n - 1, b, b), the
    constants (n - 1, b, d).
    """

    before: Array
    after: Array
    constant: Array


def matched(start: Side, end: Side, ends: Ends, rates: Array | None) -> Array:
    """Find the unknowns (n, b, d) with which a derivative agrees on both sides of every knot.

    Where ends are ``natural`` it vanishes there, where ``clamped`` the unknowns are `rates` (2, b,
    d), and where ``periodic`` it agrees where the spline closes.
    """
    segments, b, d = start.constant.shape
    periodic = ends == "periodic"
    n = segments if periodic else segments + 1
    lower, diagonal, upper = (np.zeros((n, b, b)) for _ in range(3))
    right = np.zeros((n, b, d))
    # Knot k lies between the segments k - 1 and k; knot 0 of a closed spline is the last one, too.
    behind = np.arange(-1 if periodic else 0, segments - 1)
    ahead = behind + 1
    lower[ahead] = end.before[behind]
    diagonal[ahead] = end.after[behind] - start.before[ahead]
    upper[ahead] = -start.after[ahead]
    right[ahead] = start.constant[ahead] - end.constant[behind]
    if periodic:
        found = solve_cyclic_block_tridiagonal(lower, diagonal, upper, right)
        return np.concatenate([found, found[:1]])
    if ends == "natural":
        diagonal[0], upper[0], right[0] = start.before[0], start.after[0], -start.constant[0]
        lower[-1], diagonal[-1], right[-1] = end.before[-1], end.after[-1], -end.constant[-1]
    elif rates is not None:
        diagonal[[0, -1]], right[[0, -1]] = np.eye(b), rates
        upper[0] = lower[-1] = 0.0
    return solve_block_tridiagonal(lower, diagonal, upper, right)


def _blocks(rows: list[list[Array]]) -> Array:
    """Stack entries (m,) of a small matrix into matrices (m, b, b)."""
    return np.moveaxis(np.array(rows), -1, 0)


def solve_block_tridiagonal(lower: Array, diagonal: Array, upper: Array, right: Array) -> Array:
    """Solve ``lower[k] x[k-1] + diagonal[k] x[k] + upper[k] x[k+1] = right[k]`` for k = 0..n-1.

    Blocks have the shape (n, b, b), of which ``lower[0]`` and ``upper[n - 1]`` do not count; the
    right side and the solution (n, b, c).
    """
    from scipy.linalg.lapack import dgbsv  # 20 MB that only splines shall load

    n, b, c = right.shape
    reach = 2 * b - 1  # diagonals above the main one, and below
    band = np.zeros((3 * reach + 1, n * b))
    for i in range(b):
        for j in range(b):
            # Entry (row, column) of the matrix is band[2 reach + row - column, column].
            band[2 * reach + i - j, j::b] = diagonal[:, i, j]
            band[2 * reach + i - j - b, j + b :: b] = upper[:-1, i, j]
            band[2 * reach + i - j + b, j : (n - 1) * b : b] = lower[1:, i, j]
    solution = dgbsv(reach, reach, band, right.reshape(n * b, c), overwrite_ab=True)[2]
    return np.ascontiguousarray(solution).reshape(n, b, c)


def solve_cyclic_block_tridiagonal(
    lower: Array, diagonal: Array, upper: Array, right: Array
) -> Array:
    """Solve the same with x[-1] = x[n-1] and x[n] = x[0], for n at least 3.

    The last unknown is set aside: the others are linear in it, and the last row gives it.
    """
    b = diagonal.shape[1]
    coupled = np.zeros((len(right) - 1, b, b))
    coupled[0] = -lower[0]
    coupled[-1] -= upper[-2]
    sides = np.concatenate([right[:-1], coupled], axis=2)
    both = solve_block_tridiagonal(lower[:-1], diagonal[:-1], upper[:-1], sides)
    particular, slope = both[:, :, :-b], both[:, :, -b:]
    pivot = diagonal[-1] + upper[-1] @ slope[0] + lower[-1] @ slope[-1]
    value = right[-1] - upper[-1] @ particular[0] - lower[-1] @ particular[-1]
    last = np.linalg.solve(pivot, value)
    return np.concatenate([particular + slope @ last, last[None]])
