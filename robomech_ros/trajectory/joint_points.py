"""Check points in joint space that come from a caller, and choose their whole turns."""

from __future__ import annotations

import math

import numpy as np

from robomech_ros._kernels.tolerances import LARGEST_LENGTH
from robomech_ros.errors import BadValueError, NonFiniteError, WrongSizeError
from robomech_ros.spatial.arrays import as_flag, listed, of_shape, real_array
from robomech_ros.typing import Array, ArrayLike, IntArray


def joint_points(points: ArrayLike, joints: int | None = None, most: int | None = None) -> Array:
    """Return at least two points (m, n), m up to `most`, as an array that cannot be written to."""
    places = real_array("points", points).copy()
    right = places.ndim == 2 and places.shape[1] > 0 and joints in (None, places.shape[1])
    if not right or not 2 <= len(places) <= (most or len(places)):
        width = "n" if joints is None else joints
        few = "at least two points" if most is None else f"m from 2 to {most}"
        raise WrongSizeError("points", places.shape, f"(m, {width}) with {few}")
    good = np.abs(places) <= LARGEST_LENGTH
    if not good.all():
        for row in np.flatnonzero(~np.isfinite(places).all(axis=1)).tolist():
            raise NonFiniteError(f"points[{row}]", places[row])
        row = int(good.all(axis=1).argmin())
        expected = f"numbers of at most {LARGEST_LENGTH:g}"
        raise BadValueError(f"points[{row}]", places[row].tolist(), expected)
    places.setflags(write=False)
    return places


def nearest_turns(points: ArrayLike, continuous: ArrayLike) -> tuple[Array, IntArray]:
    """Return points whose continuous joints take the short way from each to the next.

    Parameters
    ----------
    points : array_like, shape (m, n)
        Joint values, rad or m.
    continuous : array_like, shape (n,)
        Which joints turn without limits, such as `SerialChain.continuous`; the others stay.

    Returns
    -------
    points : ndarray, shape (m, n)
        The first one as given; no continuous joint goes more than half a turn to the next one.
    turns : ndarray, shape (m, n)
        How many whole turns each was moved by.

    Examples
    --------
    >>> from robomech_ros.trajectory import nearest_turns
    >>> points, turns = nearest_turns([[3.0, 0.5], [-3.0, 0.0]], [True, False])
    >>> points[-1].round(3).tolist(), turns[-1].tolist()
    ([3.283, 0.0], [1, 0])
    """
    places = joint_points(points)
    if not isinstance(continuous, np.ndarray) or continuous.dtype != np.bool_:
        given = listed("continuous", continuous, "True or False for each joint")
        continuous = [as_flag(f"continuous[{i}]", one) for i, one in enumerate(given)]
    free = np.asarray(continuous)
    of_shape("continuous", free, places[0].shape)
    if not free.any():
        return places.copy(), np.zeros(places.shape, dtype=np.int64)
    steps = np.where(free, np.round(np.diff(places, axis=0) / math.tau), 0.0)
    turns = np.concatenate([np.zeros((1, len(free))), -np.cumsum(steps, axis=0)]) + 0.0
    return places + math.tau * turns, turns.astype(np.int64)


def joint_values(what: str, values: ArrayLike, shape: tuple[int, ...]) -> Array:
    """Copy one number for each joint, shape (n,), without a look at their size."""
    return of_shape(what, real_array(what, values).copy(), shape)


def check_increasing(what: str, values: Array, unit: str = "") -> None:
    """Refuse numbers (m,) that do not increase strictly."""
    late = np.flatnonzero(np.diff(values) <= 0.0)
    if len(late):
        k = int(late[0]) + 1
        raise BadValueError(
            f"{what}[{k}]", float(values[k]), f"more than {values[k - 1]:.9g}{unit}"
        )


def check_numbers(what: str, values: Array) -> None:
    """Refuse numbers (n,) that are not finite, or too large."""
    if not np.isfinite(values).all():
        raise NonFiniteError(what, values)
    k = int(np.argmax(np.abs(values))) if len(values) else 0
    if len(values) and abs(values[k]) > LARGEST_LENGTH:
        raise BadValueError(f"{what}[{k}]", float(values[k]), f"at most {LARGEST_LENGTH:g}")
