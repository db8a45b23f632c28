"""Check points in joint space that come from a caller."""

import numpy as np
import numpy.typing as npt

from robomech_ros._kernels.tolerances import LARGEST_LENGTH
from robomech_ros.errors import BadValueError, NonFiniteError, WrongSizeError
from robomech_ros.spatial.arrays import real_array
from robomech_ros.trajectory.sample import FloatArray

__all__ = ["joint_points", "joint_values"]


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
    bad = np.flatnonzero(~np.isfinite(places).all(axis=1))
    if len(bad):
        raise NonFiniteError(f"points[{bad[0]}]", places[bad[0]])
    far = np.flatnonzero((np.abs(places) > LARGEST_LENGTH).any(axis=1))
    if len(far):
        expected = f"numbers of at most {LARGEST_LENGTH:g}"
        raise BadValueError(f"points[{far[0]}]", places[far[0]].tolist(), expected)
    places.setflags(write=False)
    return places


def joint_values(what: str, values: npt.ArrayLike | None, joints: int) -> FloatArray:
    """Give one number for each joint as an array of its own.

    Parameters
    ----------
    what : str
        Name of the values in messages.
    values : array_like, shape (n,), or None
        rad or m, or over s and s^2; None for zeros.
    joints : int
        n.

    Returns
    -------
    ndarray, shape (n,)

    Raises
    ------
    BadValueError, WrongSizeError, NonFiniteError
        No numbers, of another shape, not finite, or too large.
    """
    array = np.zeros(joints) if values is None else real_array(what, values).copy()
    if array.shape != (joints,):
        raise WrongSizeError(what, array.shape, (joints,))
    if not np.isfinite(array).all():
        raise NonFiniteError(what, array)
    far = np.flatnonzero(np.abs(array) > LARGEST_LENGTH)
    if len(far):
        k = int(far[0])
        raise BadValueError(f"{what}[{k}]", float(array[k]), f"at most {LARGEST_LENGTH:g}")
    return array
