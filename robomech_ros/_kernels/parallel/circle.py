"""Real zeros of trigonometric polynomials of order three and four, from equally spaced samples.

The zeros solve the direct kinematics of planar (order three) and spherical (order four) robots.
"""

import math

import numpy as np

from robomech_ros._kernels.compiling.jit import inline, part
from robomech_ros._kernels.compiling.types import OUT1, i8

# Largest number of sweeps of Aberth's iteration, and the step that ends it.
_SWEEPS, _SETTLED = 100, 1e-15
# A zero of the complex polynomial this near to the unit circle may be a real angle.  Double zeros
# leave the circle by the square root of rounding errors; the caller checks the pose.
_NEAR = 1e-4
# A zero of this size stays there: the polynomial has a lower degree.
_INFINITY = 1e12
# Relative size of samples that are only rounding errors: every angle is a zero.
_VOID = 1e-13


@inline
def _polynomial(samples, count, c):
    """Write the coefficients of the polynomial in z = exp(i x) times z^n."""
    for j in range(count):
        total = 0.0j
        for k in range(count):
            angle = -2.0 * math.pi * k * (j - count // 2) / count
            total += samples[k] * complex(math.cos(angle), math.sin(angle))
        c[j] = total / count


@inline
def _ratio(c, degree, z):
    """Return p'(z) / p(z), and whether p(z) is zero; use powers of 1 / z outside the circle."""
    inside = abs(z) <= 1.0
    x = z if inside else 1.0 / z
    value, slope = c[degree] if inside else c[0], 0.0j
    for k in range(1, degree + 1):
        slope = slope * x + value
        value = value * x + (c[degree - k] if inside else c[k])
    if value == 0.0:
        return 0.0j, True
    ratio = slope / value
    return (ratio if inside else x * (degree - x * ratio)), False


@inline
def _iterate(c, degree, z):
    """Write the zeros to z by Aberth's iteration."""
    for i in range(degree):
        # Starts must not be on the circle, nor symmetric about the real line.
        angle = 2.0 * math.pi * i / degree + 0.4
        radius = 0.9 if i % 2 == 0 else 1.1
        z[i] = radius * complex(math.cos(angle), math.sin(angle))
    for _ in range(_SWEEPS):
        moved = 0.0
        for i in range(degree):
            below, exact = _ratio(c, degree, z[i])
            if exact:
                continue
            for k in range(degree):
                gap = z[i] - z[k]
                if k != i and gap != 0.0:
                    below -= 1.0 / gap
            if below == 0.0:
                continue
            step = 1.0 / below
            z[i] -= step
            if not abs(z[i]) < _INFINITY:
                z[i] = _INFINITY * complex(math.cos(i), math.sin(i))
            moved = max(moved, abs(step) / (1.0 + abs(z[i])))
        if moved < _SETTLED:
            break


@part(i8(OUT1, OUT1, i8, OUT1))
def circle_zeros(samples, sizes, count, zeros):
    """Write the angles (rad) near possible zeros of a polynomial of order n.

    ``samples`` are its ``count`` values at 2 pi k / (2 n + 1), and ``sizes`` the magnitudes of
    their terms.  Returns the number of angles, at most 2 n, or -1 if all samples vanish.
    """
    order = count // 2
    largest, size = 0.0, 0.0
    for k in range(count):
        largest, size = max(largest, abs(samples[k])), max(size, sizes[k])
    if not largest > _VOID * size:
        return -1
    degree = 2 * order
    c, z = np.empty(count, np.complex128), np.empty(degree, np.complex128)
    _polynomial(samples, count, c)
    _iterate(c, degree, z)
    found = 0
    for i in range(degree):
        if abs(abs(z[i]) - 1.0) < _NEAR:
            zeros[found] = math.atan2(z[i].imag, z[i].real)
            found += 1
    return found
