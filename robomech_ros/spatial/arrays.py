"""Check arrays that come from a caller."""

import math
from collections.abc import Iterable, Mapping, Sequence, Set
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from robomech_ros.errors import BadValueError, NonFiniteError, WrongSizeError
from robomech_ros.numerics.arrays import real_array as real_array, real_number as real_number
from robomech_ros.typing import Array, IntArray

# So many numbers are looked at faster one by one.
_FEW = 16


def all_finite(array: Array) -> bool:
    """Say whether there is neither NaN nor infinity in an array."""
    if array.size <= _FEW:
        return all(map(math.isfinite, array.ravel().tolist()))
    return bool(np.isfinite(array).all())


def listed(what: str, value: object, expected: str) -> tuple[Any, ...]:
    """Return the entries of a list; text, mappings and sets do not count.

    Parameters
    ----------
    what : str
        Name of the list in messages.
    value : object
        From a caller.
    expected : str
        What messages say was expected.
    """
    if isinstance(value, str | bytes | Mapping | Set) or not isinstance(value, Iterable):
        raise BadValueError(what, value, expected)
    try:
        return tuple(value)
    except TypeError:  # an array without axes says that it is one to iterate over
        raise BadValueError(what, value, expected) from None


def readable_axis(axis: Array) -> list[float]:
    """Return a unit vector as messages show it: four digits, its largest entry positive."""
    axis = axis * np.sign(axis[int(np.argmax(np.abs(axis)))])
    return [float(x) for x in np.round(axis, 4) + 0.0]


def as_finite(what: str, value: ArrayLike, tail: tuple[int, ...]) -> Array:
    """Return a value as float64 of shape (..., *tail).

    Parameters
    ----------
    what : str
        Name of the quantity in messages.
    value : array_like
        Real numbers.
    tail : tuple of int
        The last axes; ``()`` accepts every shape.
    """
    array = real_array(what, value)
    if tail and array.shape[-len(tail) :] != tail:
        raise WrongSizeError(what, array.shape, f"(..., {', '.join(map(str, tail))})")
    if not all_finite(array):
        raise NonFiniteError(what, array if array.ndim else float(array))
    return array


def as_choice(what: str, value: object, known: Sequence[str]) -> str:
    """Check that a value is one of the names that are known, or raise BadValueError with them."""
    for name in known:
        if isinstance(value, str) and value == name:
            return name
    raise BadValueError(what, value, "one of " + ", ".join(known))


def held_rows(what: str, mask: object) -> IntArray:
    """Return the rows of a twist, angular first, that a task mask (x, y, z, rx, ry, rz) holds."""
    given = listed(what, mask, "six of True or False: x, y, z, rx, ry, rz")
    if len(given) != 6:
        raise WrongSizeError(what, len(given), "6: x, y, z, rx, ry, rz")
    entries = [as_flag(f"{what}[{i}]", one) for i, one in enumerate(given)]
    return np.flatnonzero([*entries[3:], *entries[:3]])


def as_flag(what: str, value: object) -> bool:
    """Check a truth value; 0 and 1 count as such.

    Parameters
    ----------
    what : str
        Name of the value in messages.
    value : object
        From a caller.
    """
    if value is True or value is False:
        return value
    if isinstance(value, bool | np.bool_ | int | np.integer) and value in (0, 1):
        return bool(value)
    raise BadValueError(what, value, "True or False")
