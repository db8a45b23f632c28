"""Joint positions, rates and accelerations of several states, checked together."""

from collections.abc import Callable
from functools import wraps
from typing import ParamSpec

import numpy as np

from robomech_ros.errors import BadValueError
from robomech_ros.kinematics.joint_values import as_states, raise_not_finite
from robomech_ros.robots.chain import SerialChain
from robomech_ros.spatial.arrays import as_single
from robomech_ros.typing import Array, ArrayLike

P = ParamSpec("P")

# Products of a few numbers up to this do not overflow.
_LARGEST = 1e30


def finite_states(chain: SerialChain, **values: ArrayLike) -> tuple[Array, ...]:
    """Return values (..., n) of joints as float64 arrays of one shape, named in messages."""
    arrays = as_states(chain, tuple(values), *values.values())
    for what, array in zip(values, arrays, strict=True):
        if not np.isfinite(array).all():
            raise_not_finite(chain, array, what)
        refuse_large(what, array)
    return arrays


def as_vector(what: str, value: ArrayLike, size: int) -> Array:
    """Return a vector of finite real numbers, shape (size,), or raise an error that names it."""
    vector = as_single(what, value, (size,))
    refuse_large(what, vector)
    return vector


def as_screw(what: str, value: ArrayLike | None) -> Array:
    """Return a twist, its rate or a wrench as six finite numbers, shape (6,): zeros for None."""
    return np.zeros(6) if value is None else as_vector(what, value, 6)


def refuse_large(what: str, array: Array) -> None:
    """Refuse numbers whose products with a few others could overflow."""
    largest = float(np.abs(array).max(initial=0.0))
    if largest > _LARGEST:
        raise BadValueError(f"largest of {what}", largest, f"at most {_LARGEST:g}")


def finite_result(function: Callable[P, Array]) -> Callable[P, Array]:
    """Make a function refuse arguments whose result overflows, or that no inertia resists."""

    @wraps(function)
    def checked(*args: P.args, **kwargs: P.kwargs) -> Array:
        try:
            with np.errstate(all="ignore"):
                result = function(*args, **kwargs)
        except np.linalg.LinAlgError:
            expected = "bodies or rotors that resist every motion"
            raise BadValueError("least inertia of the chain", 0.0, expected) from None
        if not np.isfinite(result).all():
            value = float(result[~np.isfinite(result)].flat[0])
            raise BadValueError("result", value, "arguments that have a finite one")
        return result

    return checked
