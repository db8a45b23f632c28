"""Linear equations with blocks on three diagonals, as splines have them."""

import numpy as np

from robomech_ros.typing import Array


def solve_block_tridiagonal(lower: Array, diagonal: Array, upper: Array, right: Array) -> Array:
    """Solve ``lower[k] x[k-1] + diagonal[k] x[k] + upper[k] x[k+1] = right[k]`` for k = 0..n-1.

    Parameters
    ----------
    lower, diagonal, upper : ndarray, shape (n, b, b)
        The blocks of row k; ``lower[0]`` and ``upper[n - 1]`` do not count.
    right : ndarray, shape (n, b, c)

    Returns
    -------
    ndarray, shape (n, b, c)
    """
    from scipy.linalg.lapack import dgbsv  # 20 MB that only who makes splines shall load

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
