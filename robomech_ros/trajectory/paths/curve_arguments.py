"""Checks of the numbers that curves and paths are made of."""

import math

import numpy as np

from robomech_ros._kernels.tolerances import LARGEST_LENGTH
from robomech_ros.errors import BadValueError, NonFiniteError, WrongSizeError
from robomech_ros.spatial.arrays import check_finite, real_array, real_number, shaped_array
from robomech_ros.trajectory.joint_points import check_increasing
from robomech_ros.trajectory.tolerances import COINCIDENT, PARAMETER_SLACK
from robomech_ros.typing import Array, ArrayLike


def as_breaks(what: str, value: ArrayLike) -> Array:
    """Check numbers that increase strictly, at least two; give a copy."""
    breaks = real_array(what, value).copy()
    if breaks.ndim != 1 or len(breaks) < 2:
        raise WrongSizeError(what, breaks.shape, "(k,) with at least two numbers")
    check_finite(what, breaks)
    check_increasing(what, breaks)
    return breaks


def as_points(what: str, value: ArrayLike, least: int) -> Array:
    """Check points (m), shape (k, 3), at least this many, neighbours apart from each other."""
    points = real_array(what, value)
    if points.ndim != 2 or points.shape[1] != 3 or len(points) < least:
        raise WrongSizeError(what, points.shape, f"(k, 3) with k at least {least}")
    check_finite(what, points)
    if np.abs(points).max() > LARGEST_LENGTH:
        worst = np.unravel_index(int(np.abs(points).argmax()), points.shape)
        where = ", ".join(str(int(i)) for i in worst)
        expected = f"at most {LARGEST_LENGTH:g} m"
        raise BadValueError(f"{what}[{where}]", float(points[worst]), expected)
    apart = np.linalg.norm(np.diff(points, axis=0), axis=1)
    size = float(np.ptp(points, axis=0).max())
    close = np.flatnonzero(apart <= COINCIDENT * max(size, COINCIDENT * np.abs(points).max()))
    if len(close):
        k = int(close[0])
        raise BadValueError(f"{what}[{k + 1}]", points[k + 1].tolist(), f"apart from {what}[{k}]")
    return points


def as_parameters(what: str, value: ArrayLike, start: float, end: float) -> Array:
    """Check parameters within a range, shape () or (m,); those off by rounding are put on it."""
    numbers = real_array(what, value)
    if numbers.ndim > 1:
        raise WrongSizeError(what, numbers.shape, "() or (m,)")
    if not np.isfinite(numbers).all():
        raise NonFiniteError(what, numbers if numbers.ndim else float(numbers))
    slack = PARAMETER_SLACK * (end - start)
    outside = np.atleast_1d((numbers < start - slack) | (numbers > end + slack))
    if outside.any():
        k = int(np.argmax(outside))
        name = f"{what}[{k}]" if numbers.ndim else what
        value = float(np.atleast_1d(numbers)[k])
        raise BadValueError(name, value, f"from {start:.9g} to {end:.9g}")
    return np.clip(numbers, start, end)


def as_vector(what: str, value: ArrayLike, shape: tuple[int, ...] = (3,)) -> Array:
    """Check finite numbers of exactly one shape, none above 1e6."""
    numbers = shaped_array(what, value, shape)
    if np.abs(numbers).max(initial=0.0) > LARGEST_LENGTH:
        raise BadValueError(what, numbers.tolist(), f"numbers of at most {LARGEST_LENGTH:g}")
    return numbers


def as_number(what: str, value: object, largest: float = LARGEST_LENGTH) -> float:
    """Check a finite number, of either sign, up to the largest."""
    number = real_number(what, value, "a finite number")
    if not math.isfinite(number):
        raise NonFiniteError(what, number)
    if abs(number) > largest:
        raise BadValueError(what, number, f"at most {largest:g}")
    return number


def as_positive(what: str, value: object, largest: float = LARGEST_LENGTH) -> float:
    """Check a finite number above 0, up to the largest."""
    number = as_number(what, value, largest)
    if not number > 0.0:
        raise BadValueError(what, number, "a number above 0")
    return number
