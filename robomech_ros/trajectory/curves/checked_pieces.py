"""Piecewise polynomials as they come from a caller, checked."""

import numpy as np

from robomech_ros._kernels.tolerances import LARGEST_LENGTH
from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.spatial.arrays import check_finite, real_array
from robomech_ros.trajectory.curves.bounds import hull
from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial


def checked_pieces(
    pieces: PiecewisePolynomial, what: str, largest_order: int
) -> PiecewisePolynomial:
    """Check the numbers of a curve, and return it with plain arrays."""
    breaks = real_array(f"breaks of the {what}", pieces.breaks)
    coefficients = real_array(f"coefficients of the {what}", pieces.coefficients)
    if breaks.ndim != 1 or not len(breaks):
        raise WrongSizeError(f"breaks of the {what}", breaks.shape, "(s + 1,)")
    wanted = max(len(breaks) - 1, 1)
    shape = coefficients.shape
    if len(shape) != 3 or shape[1] != wanted or not shape[2] or not shape[0]:
        raise WrongSizeError(f"coefficients of the {what}", shape, f"(order + 1, {wanted}, n)")
    if shape[0] > largest_order + 1:
        raise BadValueError(f"order of the {what}", shape[0] - 1, f"at most {largest_order}")
    check_finite(f"breaks of the {what}", breaks)
    check_finite(f"coefficients of the {what}", coefficients)
    if not (np.diff(breaks) > 0.0).all():
        k = int(np.argmin(np.diff(breaks)))
        expected = f"more than the one before, {float(breaks[k])!r}"
        raise BadValueError(f"breaks of the {what}[{k + 1}]", float(breaks[k + 1]), expected)
    curve = PiecewisePolynomial(breaks, coefficients)
    with np.errstate(over="ignore", invalid="ignore"):
        largest = float(np.abs(hull(curve, 0)).max())
    if not largest <= LARGEST_LENGTH:
        expected = f"at most {LARGEST_LENGTH:g}"
        raise BadValueError(f"largest position on the {what}", largest, expected)
    return curve
