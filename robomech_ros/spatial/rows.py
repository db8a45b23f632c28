"""Arrays with leading batch axes as rows for compiled loops, and results checked."""

import numpy as np

from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.spatial.arrays import all_finite, as_finite, real_array
from robomech_ros.typing import Array, ArrayLike


def as_rows(
    what: str, value: ArrayLike, tail: tuple[int, ...], width: int
) -> tuple[Array, tuple[int, ...]]:
    """Return a value of shape (..., *tail) as contiguous rows (m, width) and its batch shape.

    Only the shape is checked; compiled loops look at the numbers.
    """
    array = real_array(what, value)
    axes = len(tail)
    if array.shape[-axes:] != tail:
        raise WrongSizeError(what, array.shape, f"(..., {', '.join(map(str, tail))})")
    return np.ascontiguousarray(array).reshape(-1, width), array.shape[:-axes]


def broadcast_rows(*given: tuple[str, ArrayLike, int]) -> tuple[tuple[Array, ...], tuple[int, ...]]:
    """Return finite vectors as rows, one each or one for all, and their common batch shape.

    Each is given by name, value (..., width) and width, which is 0 for plain numbers.
    """
    arrays = [as_finite(what, value, (width,) if width else ()) for what, value, width in given]
    tails = [(width,) if width else () for _, _, width in given]
    batches = [a.shape[: a.ndim - len(t)] for a, t in zip(arrays, tails, strict=True)]
    shape = common_shape(" and ".join(what for what, _, _ in given), *batches)
    rows = []
    for array, batch, tail in zip(arrays, batches, tails, strict=True):
        if batch and batch != shape:
            array = np.broadcast_to(array, shape + tail)
        rows.append(np.ascontiguousarray(array).reshape(-1, *tail))
    return tuple(rows), shape


def common_shape(what: str, *shapes: tuple[int, ...]) -> tuple[int, ...]:
    """Return the batch shape that all can be broadcast to."""
    try:
        return np.broadcast_shapes(*shapes)
    except ValueError:
        found = " and ".join(str(shape) for shape in shapes)
        raise WrongSizeError(f"batch of {what}", found, "batch axes that fit together") from None


def finite_result(what: str, result: Array, given: Array) -> Array:
    """Return a result back, or say that what was given is too large for it."""
    if not all_finite(result):
        largest = float(np.abs(given).max(initial=0.0))
        raise BadValueError(f"largest of {what}", largest, "numbers that do not overflow")
    return result


def row_name(row: int, shape: tuple[int, ...]) -> tuple[tuple[int, ...], str]:
    """Return the index of a row in its batch, and " in row i, j" for messages, if there is one."""
    index = tuple(int(i) for i in np.unravel_index(row, shape)) if shape else ()
    return index, f" in row {', '.join(map(str, index))}" if index else ""
