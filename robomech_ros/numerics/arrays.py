"""Check numbers that come from a caller."""

import math

import numpy as np
from numpy.typing import ArrayLike

from robomech_ros.errors import BadValueError
from robomech_ros.typing import Array

_FLOAT64 = np.dtype(np.float64)


def real_array(what: str, value: ArrayLike) -> Array:
    """Return a value as float64, finite or not.

    Parameters
    ----------
    what : str
        Name of the quantity in messages.
    value : array_like
        Real numbers; truth values, text and complex numbers do not count.
    """
    if type(value) is np.ndarray and value.dtype is _FLOAT64:
        return value  # a third of the time of what follows
    try:
        array = np.asarray(value)
    except (TypeError, ValueError):
        raise BadValueError(what, value, "an array of real numbers") from None
    if array.size and array.dtype.kind not in "fiu":
        raise BadValueError(what, value, "an array of real numbers")
    return array.astype(np.float64, copy=False)


def real_number(what: str, value: object, expected: str) -> float:
    """Return one real number, finite or not; truth values and text do not count.

    Parameters
    ----------
    what : str
        Name of the quantity in messages.
    value : object
        From a caller.
    expected : str
        What messages say was expected.
    """
    if type(value) is float:
        return value
    try:
        number = np.asarray(value)
    except (TypeError, ValueError):
        number = np.empty(0)
    if number.ndim or number.dtype.kind not in "fiu":
        raise BadValueError(what, value, expected)
    return float(number)


def finite_number(what: str, value: object, unit: str) -> float:
    """Return one finite number, as :func:`real_number` does; ``unit`` is for messages."""
    expected = f"a finite number, {unit}"
    number = real_number(what, value, expected)
    if not math.isfinite(number):
        raise BadValueError(what, value, expected)
    return number
