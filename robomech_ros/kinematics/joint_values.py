"""Joint values as they come from a caller, checked and laid out for the kernels."""

import math
from typing import NoReturn

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robomech_ros.errors import BadValueError, NonFiniteError, WrongSizeError
from robomech_ros.robots.chain import SerialChain
from robomech_ros.spatial.arrays import real_array

__all__ = ["as_joint_values", "as_rows", "check_chain", "raise_not_finite"]

Array = NDArray[np.float64]

_FLOAT = np.dtype(np.float64)


def as_joint_values(chain: SerialChain, q: ArrayLike, what: str = "q") -> Array:
    """Give q as contiguous float64 of shape (..., n), without a look at whether it is finite.

    Parameters
    ----------
    chain : SerialChain
        Of n joints.
    q : array_like, shape (n,) or (..., n)
        Joint values (rad or m).
    what : str
        Name of the quantity in messages.

    Raises
    ------
    BadValueError
        Not an array of real numbers, or no chain.
    WrongSizeError
        The last axis has not n entries.
    """
    check_chain(chain)
    if type(q) is not np.ndarray or q.dtype is not _FLOAT or not q.flags.c_contiguous:
        # Not ascontiguousarray: it makes a scalar one-dimensional, which would hide a wrong shape.
        q = np.array(real_array(what, q), order="C")
    if q.ndim == 0 or q.shape[-1] != chain.n:
        expected = f"({chain.n},) or (..., {chain.n}) for {', '.join(chain.joint_names) or 'none'}"
        raise WrongSizeError(what, q.shape, expected)
    return q


def check_chain(chain: SerialChain) -> None:
    """Refuse what is no chain.

    Raises
    ------
    BadValueError
    """
    if not isinstance(chain, SerialChain):
        raise BadValueError("chain", chain, "a SerialChain, as load_robot gives it")


def as_rows(q: Array) -> Array:
    """Flatten the batch axes of joint values (..., n) to one, shape (m, n)."""
    return q.reshape(math.prod(q.shape[:-1]), q.shape[-1])


def raise_not_finite(chain: SerialChain, q: Array, what: str = "q") -> NoReturn:
    """Raise :class:`NonFiniteError` with the first joint, and row of a batch, at fault.

    Where all are finite, the pose was not: then they are too large.
    """
    bad = np.argwhere(~np.isfinite(q))
    if len(bad) == 0:
        largest = float(np.abs(q).max(initial=0.0))
        raise BadValueError(f"largest of {what}", largest, "joint values with a finite pose")
    index = tuple(int(i) for i in bad[0])
    row = f" in row {', '.join(str(i) for i in index[:-1])}" if len(index) > 1 else ""
    joint = chain.joint_names[index[-1]]
    raise NonFiniteError(f"{what} of joint '{joint}'{row}", float(q[index]))
