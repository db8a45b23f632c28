"""Real zeros of trigonometric polynomials of order three and four, from equally spaced samples.

Robots with a platform of three degrees of freedom have their direct kinematics in one: the planar
ones of order three, the spherical one of order four.
"""

import math

import numpy as np

from robomech_ros._kernels.compiling.jit import inline, part
from robomech_ros._kernels.compiling.types import OUT1, i8

# Sweeps of Aberth's iteration, and the step that ends it.
_SWEEPS, _SETTLED = 100, 1e-15
# A zero of the complex polynomial this near to the unit circle may be a real one: those of a double
# root leave it by the root of the rounding, and the caller judges by the pose.
_NEAR = 1e-4
# A zero that has gone so far stays there: the polynomial is of lower degree.
_INFINITY = 1e12
# Samples of nothing but rounding, of what they are differences of: every angle is a zero.
_VOID = 1e-13


@inline
def _polynomial(samples, count, c):
    """Write the coefficients of the polynomial in z = exp(i x), multiplied by z^n."""
    for j in range(count):
        total = 0.0j
        for k in range(count):
            angle = -2.0 * math.pi * k * (j - count // 2) / count
            total += samples[k] * complex(math.cos(angle), math.sin(angle))
        c[j] = total / count


@inline
def _ratio(c, degree, z):
    """Return p'(z) / p(z) and whether p(z) is zero; outside the circle by powers of 1 / z."""
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
    """Bring z to the zeros by Aberth's iteration."""
    for i in range(degree):
        # Neither on the circle nor symmetric to the real line.
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
    """Write the angles (rad) near which a polynomial of order n may vanish.

    Samples are its values at 2 pi k / (2 n + 1), of which there are ``count``, and sizes those of
    the terms they are made of.
    Returns how many there are, at most 2 n, or -1 where the polynomial is zero throughout.
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
