"""Check arrays that come from a caller."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robomech_ros.errors import BadValueError, NonFiniteError, WrongSizeError

__all__ = ["as_finite", "real_array"]

Array = NDArray[np.float64]


def real_array(what: str, value: ArrayLike) -> Array:
    """Give a value as float64, finite or not.

    Parameters
    ----------
    what : str
        Name of the quantity in messages.
    value : array_like
        Real numbers; truth values, text and complex numbers are none.

    Raises
    ------
    BadValueError
        Not real numbers.
    """
    try:
        array = np.asarray(value)
    except (TypeError, ValueError):
        raise BadValueError(what, value, "an array of real numbers") from None
    if array.size and array.dtype.kind not in "fiu":
        raise BadValueError(what, value, "an array of real numbers")
    return array.astype(np.float64, copy=False)


def as_finite(what: str, value: ArrayLike, tail: tuple[int, ...]) -> Array:
    """Give a value as float64 of shape (..., *tail).

    Parameters
    ----------
    what : str
        Name of the quantity in messages.
    value : array_like
        Real numbers.
    tail : tuple of int
        The last axes; ``()`` accepts every shape.

    Raises
    ------
    BadValueError, WrongSizeError, NonFiniteError
        Not real numbers, another shape, or NaN or infinite somewhere.
    """
    array = real_array(what, value)
    if tail and array.shape[-len(tail) :] != tail:
        raise WrongSizeError(what, array.shape, f"(..., {', '.join(map(str, tail))})")
    if not np.isfinite(array).all():
        raise NonFiniteError(what, array if array.ndim else float(array))
    return array
