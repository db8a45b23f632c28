"""Check what callers give to rolling robots."""

import math

import numpy as np

from robomech_ros._kernels.tolerances import LARGEST_LENGTH
from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.spatial.arrays import LEAST, as_finite, of_shape, real_within
from robomech_ros.typing import Array, ArrayLike

# Rates, twists, poses and times beyond this (SI) are no motion of a robot; angles have no digits.
_LARGEST = 1e9
# Times below this (s) are none of a cycle.
_SHORTEST = 1e-9
# Lengths below this (m) are none of a wheel.
_LEAST_LENGTH = 1e-6
_MOST_TURNED = 1e6


def bounded(what: str, value: ArrayLike, length: int) -> Array:
    """Return finite numbers of shape (..., length), up to 1e9."""
    array = as_finite(what, value, (length,))
    largest = float(np.abs(array).max(initial=0.0))
    if largest > _LARGEST:
        raise BadValueError(f"largest of {what}", largest, f"numbers up to {_LARGEST:g}")
    return array


def one_vector(what: str, value: ArrayLike, length: int) -> Array:
    """Return finite numbers of shape (length,), up to 1e9."""
    return of_shape(what, bounded(what, value, length), (length,))


def check_entries(what: str, value: object, kind: type, expected: str) -> None:
    """Refuse what is no list of instances of a class."""
    if not isinstance(value, list | tuple) or not all(isinstance(one, kind) for one in value):
        raise BadValueError(what, value, expected)


def shared_batch(*named: tuple[str, Array]) -> tuple[int, ...]:
    """Return the batch axes that arrays have together; the last axis is that of one item."""
    batch: tuple[int, ...] = ()
    for what, array in named:
        try:
            batch = np.broadcast_shapes(batch, array.shape[:-1])
        except ValueError:
            fitting = (*batch, array.shape[-1])
            raise WrongSizeError(what, array.shape, f"{array.shape[-1:]} or {fitting}") from None
    return batch


def duration(what: str, value: object) -> float:
    """Return a time from 1 ns (s)."""
    expected = f"a time from {_SHORTEST:g} s, up to {_LARGEST:g}"
    return real_within(what, value, expected, _SHORTEST, _LARGEST)


def above_zero(what: str, value: object, unit: str, most: float = _LARGEST) -> float:
    """Return a number above 0; ``unit`` is for messages."""
    expected = f"a number above 0 {unit}" + (f", up to {most:g}" if math.isfinite(most) else "")
    return real_within(what, value, expected, LEAST, most)


def length(what: str, value: object) -> float:
    """Return a length (m) that a robot can have."""
    expected = f"a length from {_LEAST_LENGTH:g} to {LARGEST_LENGTH:g} m"
    return real_within(what, value, expected, _LEAST_LENGTH, LARGEST_LENGTH)


def angle(what: str, value: object) -> float:
    """Return an angle (rad) that has digits."""
    expected = f"an angle (rad), up to {_MOST_TURNED:g}"
    return real_within(what, value, expected, -_MOST_TURNED, _MOST_TURNED)
