"""Check arrays that come from a caller."""

from collections.abc import Iterable, Mapping, Sequence, Set
from typing import Any

import numpy as np

from robomech_ros.errors import BadValueError, NonFiniteError, WrongSizeError
from robomech_ros.numerics.arrays import (
    LARGEST as LARGEST,
    LEAST as LEAST,
    all_finite as all_finite,
    check_finite as check_finite,
    check_kind as check_kind,
    finite_within as finite_within,
    of_shape as of_shape,
    positive_number as positive_number,
    real_array as real_array,
    real_number as real_number,
    real_within as real_within,
    shaped_array as shaped_array,
    whole_number as whole_number,
)
from robomech_ros.typing import Array, ArrayLike, IntArray


def listed(what: str, value: object, expected: str) -> tuple[Any, ...]:
    """Return the entries of a list; text, mappings and sets do not count."""
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
    """Return a value as finite float64 of shape (..., *tail); ``()`` accepts every shape."""
    array = real_array(what, value)
    if tail and array.shape[-len(tail) :] != tail:
        raise WrongSizeError(what, array.shape, f"(..., {', '.join(map(str, tail))})")
    if not all_finite(array):
        raise NonFiniteError(what, array if array.ndim else float(array))
    return array


def as_single(what: str, value: ArrayLike, shape: tuple[int, ...]) -> Array:
    """Return a value as finite float64 of exactly one shape, without batch axes."""
    return of_shape(what, as_finite(what, value, shape), shape)


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
    """Check a truth value; 0 and 1 count as such."""
    if value is True or value is False:
        return value
    if isinstance(value, bool | np.bool_ | int | np.integer) and value in (0, 1):
        return bool(value)
    raise BadValueError(what, value, "True or False")
