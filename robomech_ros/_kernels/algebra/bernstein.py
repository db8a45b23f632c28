"""Conversion of polynomials on [0, 1] to the Bernstein basis, whose coefficients bound them.

References
----------
R. T. Farouki, "The Bernstein polynomial basis: a centennial retrospective", Computer Aided
Geometric Design 29, 2012, section 3.3: the hull.
"""

import math

import numpy as np

from robomech_ros._kernels.compiling.jit import inline

# Inverses of the binomial coefficients, up to the degree of a squared speed.
_INVERSE_BINOMIALS = np.array(
    [[1.0 / math.comb(n, k) if k <= n else 0.0 for k in range(13)] for n in range(13)]
)


@inline
def to_bernstein(values, degree):
    """Convert power coefficients on [0, 1] to Bernstein coefficients, in place."""
    for k in range(1, degree):
        values[k] *= _INVERSE_BINOMIALS[degree, k]
    for r in range(1, degree + 1):
        for k in range(degree, r - 1, -1):
            values[k] += values[k - 1]
