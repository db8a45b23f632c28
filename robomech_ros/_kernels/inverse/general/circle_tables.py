"""Constant tables for trigonometric polynomials of order eight: transforms and Bernstein forms.

On an arc of half width h, with t = tan(half the angle from its centre) / tan(h / 2) in [-1, 1],
such a polynomial times (1 + tan^2)^8 is an ordinary polynomial of degree 16 in t.
"""

import math

import numpy as np

ORDER = 8
DEGREE = 2 * ORDER
SAMPLES = 2 * ORDER + 1
ARCS = 8
# Away from multiples of 45 degrees, which are common postures.
_FIRST_CENTRE = 0.2345

_angles = 2.0 * np.pi * np.arange(SAMPLES) / SAMPLES
SAMPLE_COSINES = np.cos(_angles)
SAMPLE_SINES = np.sin(_angles)
_orders = np.arange(ORDER + 1)[:, None]
# Maps from equally spaced samples to the coefficients of cos kx and sin kx, k = 0 .. 8.
TO_COSINES = np.where(_orders == 0, 1.0, 2.0) * np.cos(_orders * _angles) / SAMPLES
TO_SINES = 2.0 * np.sin(_orders * _angles) / SAMPLES

CENTRES = _FIRST_CENTRE + 2.0 * np.pi * np.arange(ARCS) / ARCS
ARC_COSINES = np.ascontiguousarray(np.cos(_orders * CENTRES).T)
ARC_SINES = np.ascontiguousarray(np.sin(_orders * CENTRES).T)
ARC_TANGENT = math.tan(0.5 * math.pi / ARCS)

BINOMIALS = np.array([float(math.comb(DEGREE, i)) for i in range(DEGREE + 1)])


def _bernstein(powers: np.ndarray) -> np.ndarray:
    """Return the Bernstein coefficients on [-1, 1] of a polynomial given by powers of t."""
    shifted = np.zeros(1)
    for value in powers[::-1]:
        shifted = np.convolve(shifted, [-1.0, 2.0])[: DEGREE + 1]
        shifted[0] += value
    shifted = np.pad(shifted, (0, DEGREE + 1 - len(shifted)))
    return np.array(
        [
            sum(math.comb(i, j) / math.comb(DEGREE, j) * shifted[j] for j in range(i + 1))
            for i in range(DEGREE + 1)
        ]
    )


def _harmonic(k: int) -> np.ndarray:
    """Return the coefficients by powers of t of harmonic k (cos + i sin) times (1 + tan^2)^8."""
    powers = np.ones(1, complex)
    for _ in range(2 * k):
        powers = np.convolve(powers, [1.0, 1j * ARC_TANGENT])
    for _ in range(ORDER - k):
        powers = np.convolve(powers, [1.0, 0.0, ARC_TANGENT**2])
    return powers


# Bernstein coefficients 0 .. 8 of the even (cosines) and the odd part (sines); the others mirror
# them.
FROM_COSINES = np.column_stack([_bernstein(_harmonic(k).real)[:9] for k in range(ORDER + 1)])
FROM_SINES = np.column_stack([_bernstein(_harmonic(k).imag)[:9] for k in range(ORDER + 1)])

# Chebyshev points of an arc, and the map from values there to Bernstein coefficients.
NODES = -np.cos(np.pi * np.arange(DEGREE + 1) / DEGREE)
_half = 0.5 * (NODES + 1.0)[:, None]
_basis = BINOMIALS * _half ** np.arange(DEGREE + 1) * (1.0 - _half) ** np.arange(DEGREE, -1, -1)
FROM_NODES = np.ascontiguousarray(np.linalg.inv(_basis))
# Map from values there to the last three Chebyshev coefficients.
_weights = np.where((np.arange(DEGREE + 1) % DEGREE) == 0, 0.5, 1.0) * 2.0 / DEGREE
TO_LAST = np.array(
    [np.cos(np.pi * k * np.arange(DEGREE, -1, -1) / DEGREE) * _weights for k in (14, 15, 16)]
)
FROM_COSINES = np.ascontiguousarray(FROM_COSINES)
FROM_SINES = np.ascontiguousarray(FROM_SINES)
