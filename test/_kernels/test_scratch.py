"""Small arrays on the stack of kernels, and arrays taken without counting references."""

import numba
import numpy as np

from robomech_ros._kernels.compiling.jit import borrowed, scratch, scratch_integers

ROWS = 3


@numba.njit
def sums(x, out):
    """Two tables at a time, and whole numbers beside them."""
    counts = scratch_integers(ROWS)
    table = scratch(ROWS, 4)
    other = scratch(4)
    for j in range(4):
        other[j] = -1000.0
    for i in range(ROWS):
        counts[i] = 0
        for j in range(4):
            table[i, j] = x[i] ** j
            counts[i] += 1
    for i in range(ROWS):
        row = table[i]
        out[i] = row.sum() + counts[i]
    return other.sum()


@numba.njit
def doubled_rows(given):
    array = borrowed(given)
    for i in range(array.shape[0]):
        row = array[i]
        for j in range(row.shape[0]):
            row[j] *= 2.0


def test_scratch_arrays_are_separate_and_hold_what_is_written():
    x, out = np.array([1.0, 2.0, 3.0]), np.empty(3)
    assert sums(x, out) == -4000.0
    assert out.tolist() == [8.0, 19.0, 44.0]


def test_what_is_borrowed_is_the_same_array_and_stays_alive():
    rows = np.arange(6.0).reshape(2, 3)
    view = rows[1]
    for _ in range(1000):
        doubled_rows(rows)
        rows /= 2.0
    assert rows.tolist() == [[0.0, 1.0, 2.0], [3.0, 4.0, 5.0]]
    assert view.tolist() == [3.0, 4.0, 5.0]
