"""Polynomials from values and derivatives at both ends of every segment."""

import math

import numpy as np

from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial
from robomech_ros.typing import Array


def septic(breaks: Array, values: Array) -> PiecewisePolynomial:
    """Interpolate positions and three derivatives, segment by segment.

    Parameters
    ----------
    breaks : ndarray, shape (m,)
        Instants in s, strictly increasing.
    values : ndarray, shape (4, m, n)
        Position, velocity, acceleration and jerk there, rad or m over powers of s.

    Returns
    -------
    PiecewisePolynomial
        Of order 7, with continuous jerk.
    """
    spans = np.diff(breaks)[:, None]
    factorials = np.array([math.factorial(d) for d in range(4)])[:, None, None]
    powers = spans ** np.arange(4)[:, None, None]
    # Taylor coefficients over segments of length 1, from the front and at the back.
    front, back = values[:, :-1] / factorials * powers, values[:, 1:] / factorials * powers
    left = np.array([[math.comb(k, d) for k in range(4)] for d in range(4)], float)
    missing = back - np.tensordot(left, front, axes=1)
    right = np.array([[math.comb(k, d) for k in range(4, 8)] for d in range(4)], float)
    high = np.tensordot(np.linalg.inv(right), missing, axes=1)
    scaled = np.concatenate([front, high]) / spans ** np.arange(8)[:, None, None]
    return PiecewisePolynomial(breaks, scaled)
