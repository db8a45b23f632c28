"""The sum of two curves."""

import numpy as np

from robomech_ros._kernels.timing import constraint_rows as time_rows
from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial
from robomech_ros.typing import Array


def summed(one: PiecewisePolynomial, other: PiecewisePolynomial) -> PiecewisePolynomial:
    """Add two curves of the same joints over the same time.

    Parameters
    ----------
    one, other : PiecewisePolynomial
        From the same instant to the same.

    Returns
    -------
    PiecewisePolynomial
        With the breaks of both.
    """
    breaks = np.union1d(one.breaks, other.breaks)
    parts = [_divided(curve, breaks) for curve in (one, other)]
    size = max(len(part) for part in parts)
    total = np.zeros((size, *parts[0].shape[1:]))
    for part in parts:
        total[: len(part)] += part
    return PiecewisePolynomial(breaks, total)


def _divided(curve: PiecewisePolynomial, breaks: Array) -> Array:
    """Return the coefficients between breaks that include those of the curve."""
    size, _, joints = curve.coefficients.shape
    local = np.empty((len(breaks) - 1, joints, size))
    time_rows.local_path(curve.breaks, curve.coefficients, breaks, local)
    return local.transpose(2, 0, 1)
