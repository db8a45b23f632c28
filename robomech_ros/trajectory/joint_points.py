"""Check points in joint space that come from a caller."""

from typing import NoReturn

import numpy as np
import numpy.typing as npt

from robomech_ros._kernels.tolerances import LARGEST_LENGTH
from robomech_ros.errors import BadValueError, NonFiniteError, WrongSizeError
from robomech_ros.spatial.arrays import real_array
from robomech_ros.trajectory.sample import FloatArray

__all__ = ["check_numbers", "joint_points", "joint_values"]


def joint_points(
    points: npt.ArrayLike, joints: int | None = None, most: int | None = None
) -> FloatArray:
    """Give at least two points as an array of its own that cannot be written to.

    Parameters
    ----------
    points : array_like, shape (m, n)
        Joint values, rad or m.
    joints : int, optional
        n; without it any number above 0.
    most : int, optional
        The largest m there may be.

    Returns
    -------
    ndarray, shape (m, n)

    Raises
    ------
    BadValueError, WrongSizeError, NonFiniteError
        No numbers, of another shape, not finite, or too large.
    """
    places = real_array("points", points).copy()
    right = places.ndim == 2 and places.shape[1] > 0 and joints in (None, places.shape[1])
    if not right or not 2 <= len(places) <= (most or len(places)):
        width = "n" if joints is None else joints
        few = "at least two points" if most is None else f"m from 2 to {most}"
        raise WrongSizeError("points", places.shape, f"(m, {width}) with {few}")
    good = np.abs(places) <= LARGEST_LENGTH
    if not good.all():
        _refuse(places, good)
    places.setflags(write=False)
    return places


def _refuse(places: FloatArray, good: npt.NDArray[np.bool_]) -> NoReturn:
    """Name the first of the points (m, n) that is not finite, or else the first too large."""
    for row in np.flatnonzero(~np.isfinite(places).all(axis=1)).tolist():
        raise NonFiniteError(f"points[{row}]", places[row])
    row = int(good.all(axis=1).argmin())
    expected = f"numbers of at most {LARGEST_LENGTH:g}"
    raise BadValueError(f"points[{row}]", places[row].tolist(), expected)


def joint_values(what: str, values: npt.ArrayLike, shape: tuple[int, ...]) -> FloatArray:
    """Copy one number for each joint, shape (n,), without a look at their size."""
    array = real_array(what, values).copy()
    if array.shape != shape:
        raise WrongSizeError(what, array.shape, shape)
    return array


def check_numbers(what: str, values: FloatArray) -> None:
    """Refuse numbers (n,) that are not finite, or too large."""
    if not np.isfinite(values).all():
        raise NonFiniteError(what, values)
    k = int(np.argmax(np.abs(values))) if len(values) else 0
    if len(values) and abs(values[k]) > LARGEST_LENGTH:
        raise BadValueError(f"{what}[{k}]", float(values[k]), f"at most {LARGEST_LENGTH:g}")
