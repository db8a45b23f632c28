"""Joint values as they come from a caller, checked and laid out for the kernels."""

import math
from collections.abc import Sequence
from typing import Any, NoReturn

import numpy as np

from robomech_ros.errors import BadValueError, NonFiniteError, WrongSizeError
from robomech_ros.robots.chain import SerialChain
from robomech_ros.spatial.arrays import real_array
from robomech_ros.typing import Array, ArrayLike

# Types that need no conversion, as names for speed.
_ARRAY, _FLOAT = np.ndarray, np.dtype(np.float64)


def as_joint_values(chain: SerialChain, q: ArrayLike, what: str = "q") -> Array:
    """Return q (n,) or (..., n), rad or m, as contiguous float64, finite or not; errors name it."""
    check_chain(chain)
    if type(q) is not _ARRAY or q.dtype is not _FLOAT or not q.flags.c_contiguous:
        # Not ascontiguousarray: it makes a scalar one-dimensional, which would hide a wrong shape.
        q = np.array(real_array(what, q), order="C")
    shape = q.shape
    if not shape or shape[-1] != chain.n:
        expected = f"({chain.n},) or (..., {chain.n}) for {', '.join(chain.joint_names) or 'none'}"
        raise WrongSizeError(what, shape, expected)
    return q


def as_finite_values(chain: SerialChain, q: ArrayLike, what: str = "q") -> Array:
    """Return q as :func:`as_joint_values` does, or raise an error that names what is not finite."""
    q = as_joint_values(chain, q, what)
    if not np.isfinite(q).all():
        raise_not_finite(chain, q, what)
    return q


def as_posture(chain: SerialChain, q: ArrayLike, what: str = "q") -> Array:
    """Return one posture as contiguous float64 of shape (n,), for searches that begin there."""
    q = as_joint_values(chain, q, what)
    if q.ndim != 1:
        raise WrongSizeError(what, q.shape, f"({chain.n},)")
    if not np.isfinite(q).all():
        raise_not_finite(chain, q, what)
    for i in np.flatnonzero(np.abs(q) > chain.largest):
        most = f"{chain.largest[i]:g} {chain.units[i]}"
        expected = f"at most {most}, where doubles still hold a pose to 1e-9"
        raise BadValueError(f"{what} of joint '{chain.joint_names[i]}'", float(q[i]), expected)
    return q


def as_states(chain: SerialChain, names: Sequence[str], *values: Any) -> tuple[Array, ...]:
    """Return joint values, and what else belongs to them, as contiguous arrays of one shape.

    They are (n,) or (..., n): joint values, rates, accelerations or torques, named in messages.
    """
    if isinstance(chain, SerialChain):
        vector = chain.types.shape
        for value in values:
            # One state whose arrays are right already, as in most calls, costs no more than this.
            if (
                type(value) is not _ARRAY
                or value.dtype is not _FLOAT
                or value.shape != vector
                or not value.flags.c_contiguous
            ):
                break
        else:
            return values
    arrays = [as_joint_values(chain, *pair) for pair in zip(values, names, strict=True)]
    shape = arrays[0].shape
    for name, array in zip(names, arrays, strict=True):
        if array.shape != shape:
            raise WrongSizeError(name, array.shape, f"{shape}, that of {names[0]}")
    return tuple(arrays)


def check_chain(chain: SerialChain) -> None:
    """Refuse what is no chain."""
    if not isinstance(chain, SerialChain):
        raise BadValueError("chain", chain, "a SerialChain, as returned by load_robot")


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
