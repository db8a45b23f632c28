"""Check numbers that come from a caller."""

import math
from collections.abc import Iterable
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from robomech_ros.errors import BadValueError, NonFiniteError, WrongSizeError
from robomech_ros.typing import Array, ArrayLike

_AnyArray = TypeVar("_AnyArray", bound=NDArray[Any])

_FLOAT64 = np.dtype(np.float64)
# So many numbers are looked at faster one by one.
_FEW = 16
# The least number above 0, and the largest that is not infinite.
LEAST, LARGEST = math.ulp(0.0), float(np.finfo(np.float64).max)


def real_array(what: str, value: ArrayLike) -> Array:
    """Return a value as float64, finite or not; truth values, text and complex do not count."""
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
    """Return one real number, finite or not; truth values and text do not count."""
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


def real_within(
    what: str, value: object, expected: str, least: float, most: float = math.inf
) -> float:
    """Return one real number from `least` to `most`."""
    number = real_number(what, value, expected)
    if not least <= number <= most:
        raise BadValueError(what, value, expected)
    return number


def finite_within(what: str, value: object, expected: str, least: float, most: float) -> float:
    """Return one number from `least` to `most`; what is not finite has an error of its own."""
    number = real_number(what, value, expected)
    if not math.isfinite(number):
        raise NonFiniteError(what, number)
    if not least <= number <= most:
        raise BadValueError(what, number, expected)
    return number


def positive_number(what: str, value: object, expected: str = "a positive number") -> float:
    """Return one real number above 0."""
    number = real_number(what, value, expected)
    if not number > 0.0:
        raise BadValueError(what, number, expected)
    return number


def whole_number(
    what: str, value: object, expected: str, least: float, most: float = math.inf
) -> int:
    """Return one whole number from `least` to `most`."""
    number = real_within(what, value, expected, least, most)
    if not number.is_integer():
        raise BadValueError(what, value, expected)
    return int(number)


def of_shape(what: str, array: _AnyArray, shape: tuple[int, ...]) -> _AnyArray:
    """Return an array back, of exactly one shape."""
    if array.shape != shape:
        raise WrongSizeError(what, array.shape, shape)
    return array


def shaped_array(what: str, value: ArrayLike, shape: tuple[int, ...]) -> Array:
    """Return a value as finite float64 of exactly one shape."""
    array = of_shape(what, real_array(what, value), shape)
    check_finite(what, array)
    return array


def distinct(points: Iterable[Array], apart: float) -> list[Array]:
    """Return points (n,) that differ from those before them by more than this in a number."""
    kept: list[Array] = []
    for point in points:
        if all(np.abs(point - other).max() > apart for other in kept):
            kept.append(point)
    return kept


def all_finite(array: Array) -> bool:
    """Return whether there is neither NaN nor infinity in an array."""
    if array.size <= _FEW:
        return all(map(math.isfinite, array.ravel().tolist()))
    return bool(np.isfinite(array).all())


def check_finite(what: str, array: Array) -> None:
    """Refuse an array with NaN or infinity."""
    if not all_finite(array):
        raise NonFiniteError(what, array if array.ndim else float(array))


def check_kind(what: str, value: object, kind: Any, expected: str) -> None:
    """Refuse a value that is not an instance of a class."""
    if not isinstance(value, kind):
        raise BadValueError(what, value, expected)
