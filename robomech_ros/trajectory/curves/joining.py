"""Curves put one behind the other, on one clock."""

from collections.abc import Sequence

import numpy as np

from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial, lasting_pieces


def joined(curves: Sequence[PiecewisePolynomial]) -> PiecewisePolynomial:
    """Put curves of the same joints one behind the other.

    Parameters
    ----------
    curves : sequence of PiecewisePolynomial
        One at least; each begins at its own t = 0 where the one before it ends.

    Returns
    -------
    PiecewisePolynomial
        From t = 0 on, without pieces so short that their ends are the same instant.
    """
    starts = np.cumsum([0.0, *(curve.breaks[-1] for curve in curves)])
    breaks = [curve.breaks[:-1] + start for curve, start in zip(curves, starts, strict=False)]
    size = max(len(curve.coefficients) for curve in curves)
    padded = [
        np.pad(curve.coefficients, ((0, size - len(curve.coefficients)), (0, 0), (0, 0)))
        for curve in curves
    ]
    pieces, _ = lasting_pieces(
        np.append(np.concatenate(breaks), starts[-1]), np.concatenate(padded, axis=1)
    )
    return pieces
