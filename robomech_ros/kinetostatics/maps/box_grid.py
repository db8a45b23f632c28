"""Points on a grid that fills a box."""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.spatial.arrays import as_finite, as_single
from robomech_ros.typing import Array, ArrayLike, IntArray

LARGEST_BOUND = 1e6
_AXES = "xyz"
# Fraction of a step by which a point may be beyond the box: rounding.
_ROUNDING = 1e-9


@dataclass(frozen=True, eq=False)
class BoxGrid:
    """A grid with the same number of points in every row, column and layer.

    The first and the last point, ``lower`` and ``upper`` (3,), are corners (m); where there is one
    point along an axis, it is ``lower``.  The shape counts the points along x, y and z.
    """

    lower: Array
    upper: Array
    shape: tuple[int, int, int]

    @cached_property
    def cells(self) -> int:
        """Number of points."""
        return math.prod(self.shape)

    @cached_property
    def axes(self) -> tuple[Array, Array, Array]:
        """Coordinates of the points along x, along y and along z (m)."""
        x, y, z = (
            np.linspace(low, high, count) if count > 1 else np.array([low])
            for low, high, count in zip(self.lower, self.upper, self.shape, strict=True)
        )
        return x, y, z

    def points(self, cells: IntArray) -> Array:
        """Return the points (k, 3) of these cells (k,), which are counted along z first, then y."""
        places = np.unravel_index(cells, self.shape)
        return np.stack([axis[at] for axis, at in zip(self.axes, places, strict=True)], axis=-1)


def as_grid(
    lower: ArrayLike, upper: ArrayLike, spacing: ArrayLike | None, shape: ArrayLike | None
) -> BoxGrid:
    """Check corners (3,) in m, and either the distance between points or their number.

    The spacing (m) and the shape are one number, or one for each axis; the last point is at most a
    spacing before ``upper``.
    """
    low, high = _as_bound("lower", lower), _as_bound("upper", upper)
    for i in range(3):
        if low[i] > high[i]:
            expected = f"at most upper[{i}], which is {high[i]:g} m"
            raise BadValueError(f"lower[{i}] ({_AXES[i]})", float(low[i]), expected)
    if (spacing is None) == (shape is None):
        given = "both" if spacing is not None else "neither"
        raise BadValueError("spacing and shape", given, "one of the two")
    if spacing is None:
        return BoxGrid(low, high, _as_shape(shape, low, high))
    step = _as_spacing(spacing)
    with np.errstate(over="ignore"):
        steps = np.floor((high - low) / step * (1.0 + _ROUNDING) + _ROUNDING)
    if not np.isfinite(steps).all():
        raise BadValueError(
            "spacing", spacing, "a distance that divides the box into finitely many"
        )
    x, y, z = (int(count) + 1 for count in steps)
    return BoxGrid(low, low + steps * step, (x, y, z))


def _as_bound(what: str, bound: ArrayLike) -> Array:
    corner = as_single(what, bound, (3,))
    if np.abs(corner).max() > LARGEST_BOUND:
        raise BadValueError(what, corner.tolist(), f"at most {LARGEST_BOUND:g} m from the base")
    return corner + 0.0


def _three(what: str, value: ArrayLike) -> Array:
    """Return a number for each axis, where one number stands for all."""
    numbers = as_finite(what, value, ())
    if numbers.shape not in ((), (3,)):
        raise WrongSizeError(what, numbers.shape, "() or (3,)")
    return np.broadcast_to(numbers, (3,))


def _as_spacing(spacing: ArrayLike) -> Array:
    step = _three("spacing", spacing)
    if not (step > 0.0).all():
        raise BadValueError("spacing", spacing, "a positive distance in m")
    return step


def _as_shape(shape: ArrayLike | None, low: Array, high: Array) -> tuple[int, int, int]:
    counts = _three("shape", 0 if shape is None else shape)
    if not (counts >= 1.0).all() or not (counts == np.floor(counts)).all():
        raise BadValueError("shape", shape, "whole numbers of at least 1")
    for i in range(3):
        if counts[i] == 1.0 and low[i] < high[i]:
            expected = f"at least 2, or the same lower and upper bound along {_AXES[i]}"
            raise BadValueError(f"shape[{i}] ({_AXES[i]})", 1, expected)
    x, y, z = (int(count) for count in counts)
    return x, y, z
