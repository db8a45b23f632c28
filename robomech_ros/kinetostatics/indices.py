"""Performance indices of a posture, and their gradients with respect to the joint values."""

from __future__ import annotations

import functools
from typing import NamedTuple

import numpy as np

from robomech_ros._kernels.compiling.jit import direct
from robomech_ros._kernels.kinetostatics import indices as kernels
from robomech_ros.kinematics.joint_values import as_joint_values, as_rows, raise_not_finite
from robomech_ros.kinetostatics.task_parts import PARTS, task_part
from robomech_ros.robots.chain import SerialChain
from robomech_ros.spatial.arrays import as_choice, real_number, real_within
from robomech_ros.typing import Array, ArrayLike, IntArray

# Columns of the kernels that hold a condition number.
NORMS = {"2": kernels.CONDITION, "frobenius": kernels.SCHATTEN}


_indices = direct(kernels.indices)
_index_gradients = direct(kernels.index_gradients)
_index_gradient_one = direct(kernels.index_gradient_one)


class _Task(NamedTuple):
    """The chain, the rows of its Jacobian that count, and what they are multiplied by."""

    packed: Array
    weights: Array
    rows: IntArray
    power: float = 2.0


def manipulability(
    chain: SerialChain, q: ArrayLike, *, part: str = "pose", length: float | None = None
) -> float | Array:
    r"""Compute the product of the singular values of the Jacobian.

    .. math:: \mu = \sigma_1 \cdots \sigma_m = \sqrt{\det J J^T}

    The root is for no fewer joints than rows: how much the joints move the tip, in volume.
    Directions that the arm has in no posture, such as those out of the plane of a planar one, do
    not count.

    Parameters
    ----------
    chain : SerialChain
        Chain of n joints.
    q : array_like, shape (n,) or (..., n)
        Joint values (rad or m).
    part : {"pose", "position", "orientation"}, optional
        Which rows of the Jacobian count.
    length : float, optional
        What the linear rows are divided by (m, from 1e-9 to 1e9), such as the characteristic
        length; default 1 m.

    Returns
    -------
    float or ndarray, shape (...)
        0 where the posture is singular.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 5.8.  Yoshikawa,
    Manipulability of robotic mechanisms, Int. J. of Robotics Research 4(2), 1985.

    Examples
    --------
    >>> from robomech_ros.kinetostatics import manipulability
    >>> from robomech_ros.robots import load_robot
    >>> puma = load_robot("puma560")
    >>> round(manipulability(puma, [0.3, 0.5, -1.2, 0.4, 0.8, 0.2]), 4)
    0.0287
    """
    return _value(chain, q, part, length, kernels.MANIPULABILITY)


def condition_number(
    chain: SerialChain,
    q: ArrayLike,
    *,
    norm: str = "2",
    part: str = "pose",
    length: float | None = None,
) -> float | Array:
    r"""Compute the condition number of the Jacobian: 1 where isotropic, infinite where singular.

    .. math::

       \kappa_2 = \frac{\sigma_\max}{\sigma_\min}, \qquad
       \kappa_F = \frac1m \sqrt{\textstyle\sum_i \sigma_i^2 \sum_i \sigma_i^{-2}}

    with the m singular values of the rows that count, the linear ones divided by the length.
    :math:`\kappa_F` is never larger, and smooth.  As for :func:`manipulability`, directions that
    the arm has in no posture do not count.

    Parameters
    ----------
    chain : SerialChain
        Chain of n joints.
    q : array_like, shape (n,) or (..., n)
        Joint values (rad or m).
    norm : {"2", "frobenius"}, optional
        "2": the largest singular value over the least.  "frobenius": the weighted Frobenius norm
        of J times that of its inverse.
    part, length
        As for :func:`manipulability`.  A condition number of rows of different units means
        something only with a length.

    Returns
    -------
    float or ndarray, shape (...)

    See Also
    --------
    characteristic_length : the length to give.
    conditioning_index : its best value over all postures.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 5.8.

    Examples
    --------
    >>> from robomech_ros.kinetostatics import condition_number
    >>> from robomech_ros.robots import load_robot
    >>> puma = load_robot("puma560")
    >>> round(condition_number(puma, [0.3, 0.5, -1.2, 0.4, 0.8, 0.2], length=0.283), 3)
    19.193
    """
    return _value(chain, q, part, length, _norm(norm))


def min_singular_value(
    chain: SerialChain, q: ArrayLike, *, part: str = "pose", length: float | None = None
) -> float | Array:
    """Compute the least singular value of the Jacobian.

    The least speed of the tip at joint rates of norm 1, over all directions; 0 where singular.

    Parameters
    ----------
    chain, q, part, length
        As for :func:`manipulability`.

    Returns
    -------
    float or ndarray, shape (...)
    """
    return _value(chain, q, part, length, kernels.LEAST)


def manipulability_gradient(
    chain: SerialChain, q: ArrayLike, *, part: str = "pose", length: float | None = None
) -> Array:
    """Compute the derivatives of :func:`manipulability` by the joint values.

    Parameters
    ----------
    chain, q, part, length
        As for :func:`manipulability`.

    Returns
    -------
    ndarray, shape (n,) or (..., n)
        Per rad or m; NaN where the posture is singular.
    """
    return _gradient(chain, q, part, length, kernels.MANIPULABILITY)


def condition_number_gradient(
    chain: SerialChain,
    q: ArrayLike,
    *,
    norm: str = "2",
    part: str = "pose",
    length: float | None = None,
) -> Array:
    """Compute the derivatives of :func:`condition_number` by the joint values.

    Parameters
    ----------
    chain, q, norm, part, length
        As for :func:`condition_number`.

    Returns
    -------
    ndarray, shape (n,) or (..., n)
        Per rad or m; NaN where the posture is singular.  With norm "2" a subgradient where the
        largest or the least singular value is a double one.
    """
    return _gradient(chain, q, part, length, _norm(norm))


def least_singular_value_gradient(
    chain: SerialChain, q: ArrayLike, *, part: str = "pose", length: float | None = None
) -> Array:
    """Compute the derivatives of :func:`min_singular_value` by the joint values.

    Parameters
    ----------
    chain, q, part, length
        As for :func:`manipulability`.

    Returns
    -------
    ndarray, shape (n,) or (..., n)
        Per rad or m; NaN where the posture is singular, a subgradient where the least singular
        value is a double one.
    """
    return _gradient(chain, q, part, length, kernels.LEAST)


def _value(
    chain: SerialChain, q: ArrayLike, part: str, length: float | None, index: int
) -> float | Array:
    q = as_joint_values(chain, q)
    out = evaluate(chain, q, part, length)
    return float(out[0, index]) if q.ndim == 1 else out[:, index].reshape(q.shape[:-1])


def evaluate(chain: SerialChain, q: Array, part: str, length: float | None) -> Array:
    """Return all indices of the postures q (..., n), one row each as the kernels lay them out."""
    packed, *task = _task(chain, part, length)
    rows = q[None] if q.ndim == 1 else as_rows(q)
    out = np.empty((len(rows), kernels.COUNT))
    if _indices(packed, rows, *task, out):
        raise_not_finite(chain, q)
    return out


def _gradient(
    chain: SerialChain, q: ArrayLike, part: str, length: float | None, index: int
) -> Array:
    q = as_joint_values(chain, q)
    packed, weights, kept, power = _task(chain, part, length)
    if q.ndim == 1:
        gradient = np.empty(q.shape)
        if _index_gradient_one(packed, q, weights, kept, power, index, gradient):
            raise_not_finite(chain, q)
        return gradient
    rows = as_rows(q)
    out = np.empty((len(rows), chain.n + 1))
    values = np.empty((len(rows), kernels.COUNT))
    if _index_gradients(packed, rows, weights, kept, power, index, values, out):
        raise_not_finite(chain, q)
    return out[:, :-1].reshape(q.shape)


def as_length(length: float) -> float:
    """Check a length (m) that linear motions are divided by."""
    expected = "a length from 1e-9 to 1e9 m"
    return real_within("length", real_number("length", length, expected), expected, 1e-9, 1e9)


def _norm(norm: str) -> int:
    try:
        return NORMS[norm]
    except (KeyError, TypeError):
        return NORMS[as_choice("norm", norm, tuple(NORMS))]


def _task(chain: SerialChain, part: str, length: float | None) -> _Task:
    try:
        return _known_task(chain, part, length)
    except TypeError:  # what cannot be a key is refused by name, or is a number in an array
        return _new_task(chain, part, length)


def _new_task(chain: SerialChain, part: str, length: float | None) -> _Task:
    packed, rows = task_part(chain, as_choice("part", part, tuple(PARTS)))
    metres = 1.0 if length is None else as_length(length)
    return _Task(packed, np.repeat((1.0, 1.0 / metres), 3), rows)


_known_task = functools.lru_cache(maxsize=64, typed=True)(_new_task)
