"""Linear equations with blocks on three diagonals, as splines have them."""

import numpy as np

from robomech_ros.trajectory.sample import FloatArray

__all__ = ["solve_block_tridiagonal", "solve_cyclic_block_tridiagonal"]


def solve_block_tridiagonal(
    lower: FloatArray, diagonal: FloatArray, upper: FloatArray, right: FloatArray
) -> FloatArray:
    """Solve ``lower[k] x[k-1] + diagonal[k] x[k] + upper[k] x[k+1] = right[k]`` for k = 0..n-1.

    Parameters
    ----------
    lower, diagonal, upper : ndarray, shape (n, b, b)
        The blocks of row k; ``lower[0]`` and ``upper[n - 1]`` do not count.  Diagonally dominant,
        as those of splines are: blocks are not exchanged.
    right : ndarray, shape (n, b, c)

    Returns
    -------
    ndarray, shape (n, b, c)
    """
    n, b, _ = diagonal.shape
    # Each row becomes x[k] + factor x[k+1] = reduced.
    factors, reduced = np.zeros_like(upper), np.empty_like(right)
    pivot, value = diagonal[0], right[0]
    for k in range(n):
        if k:
            pivot = diagonal[k] - lower[k] @ factors[k - 1]
            value = right[k] - lower[k] @ reduced[k - 1]
        both = np.linalg.solve(pivot, np.concatenate([upper[k], value], axis=1))
        factors[k], reduced[k] = both[:, :b], both[:, b:]
    solution = reduced
    for k in range(n - 2, -1, -1):
        solution[k] -= factors[k] @ solution[k + 1]
    return solution


def solve_cyclic_block_tridiagonal(
    lower: FloatArray, diagonal: FloatArray, upper: FloatArray, right: FloatArray
) -> FloatArray:
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
