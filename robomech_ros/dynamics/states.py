"""Joint positions, rates and accelerations of several states, checked together."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robomech_ros.errors import WrongSizeError
from robomech_ros.kinematics.joint_values import as_joint_values, raise_not_finite
from robomech_ros.robots.chain import SerialChain
from robomech_ros.spatial.arrays import as_finite

__all__ = ["as_vector", "finite_states"]

Array = NDArray[np.float64]


def finite_states(chain: SerialChain, **values: ArrayLike) -> tuple[Array, ...]:
    """Give joint values, rates, accelerations or torques as float64 arrays of one shape.

    Parameters
    ----------
    chain : SerialChain
        Of n joints.
    **values : array_like, shape (..., n)
        By the name that messages give them.

    Raises
    ------
    BadValueError, WrongSizeError, NonFiniteError
        One is not an array of n finite real numbers or of rows of them, or they differ in shape.
    """
    arrays: list[Array] = []
    for what, value in values.items():
        array = as_joint_values(chain, value, what)
        if arrays and array.shape != arrays[0].shape:
            raise WrongSizeError(
                what, array.shape, f"{arrays[0].shape}, that of {next(iter(values))}"
            )
        if not np.isfinite(array).all():
            raise_not_finite(chain, array, what)
        arrays.append(array)
    return tuple(arrays)


def as_vector(what: str, value: ArrayLike, size: int) -> Array:
    """Give a vector of finite real numbers, shape (size,), or raise an error that names it."""
    vector = as_finite(what, value, (size,))
    if vector.ndim != 1:
        raise WrongSizeError(what, vector.shape, (size,))
    return vector
