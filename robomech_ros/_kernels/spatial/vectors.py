"""Vectors of three numbers."""

import math

from robomech_ros._kernels.compiling.jit import flat, lean

# Lengths outside this range have squares that over- or underflow.
_SMALL = 1e-140
_LARGE = 1e140
# Three parts of pi / 2; the first two have 33 bits.
_HALF_PI_1 = 1.57079632673412561417e00
_HALF_PI_2 = 6.07710050630396597660e-11
_HALF_PI_3 = 2.02226624879595063154e-21
_TWO_OVER_PI = 6.36619772367581382433e-01
# Products of a number of quarter turns with the parts are exact below this angle.
_REDUCED = 1e5


@lean
def cross(a, b):
    """Return the vector product a x b."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


@lean
def dot(a, b):
    """Return the scalar product a . b."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@lean
def scaled(a, factor):
    """Return the product of a vector and a number."""
    return a[0] * factor, a[1] * factor, a[2] * factor


@lean
def combined(a, b, factor):
    """Return a + factor b."""
    return a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]


@lean
def triple(a, b):
    """Return a x (a x b)."""
    return cross(a, cross(a, b))


@lean
def cramer(a, b, c, d):
    """Return the determinant of columns a, b and c, and its product with x of [a b c] x = d."""
    normal = cross(b, c)
    return dot(a, normal), (dot(d, normal), dot(d, cross(c, a)), dot(d, cross(a, b)))


@lean
def upper(A, i):
    """Return the first three numbers of column i."""
    return A[0, i], A[1, i], A[2, i]


@lean
def lower(A, i):
    """Return the last three numbers of column i of six."""
    return A[3, i], A[4, i], A[5, i]


@flat
def mixed(v, a, b, c):
    """Return the linear combination of three vectors with the components of v."""
    x, y, z = v[0], v[1], v[2]
    return (
        x * a[0] + y * b[0] + z * c[0],
        x * a[1] + y * b[1] + z * c[1],
        x * a[2] + y * b[2] + z * c[2],
    )


@flat
def product(A, B):
    """Return the product of two matrices, each as three rows."""
    return (
        mixed(A[0], B[0], B[1], B[2]),
        mixed(A[1], B[0], B[1], B[2]),
        mixed(A[2], B[0], B[1], B[2]),
    )


@flat
def rotated(rows, k, v):
    """Return R v for R in rows of four numbers from entry k on."""
    x, y, z = v
    return (
        rows[k] * x + rows[k + 1] * y + rows[k + 2] * z,
        rows[k + 4] * x + rows[k + 5] * y + rows[k + 6] * z,
        rows[k + 8] * x + rows[k + 9] * y + rows[k + 10] * z,
    )


@flat
def rotated_back(rows, k, v):
    """Return R^T v for R in rows of four numbers from entry k on."""
    x, y, z = v
    return (
        rows[k] * x + rows[k + 4] * y + rows[k + 8] * z,
        rows[k + 1] * x + rows[k + 5] * y + rows[k + 9] * z,
        rows[k + 2] * x + rows[k + 6] * y + rows[k + 10] * z,
    )


@flat
def times(A, v):
    """Return the product of a matrix (3, 3), or the rotation of a pose (4, 4), and a vector."""
    x, y, z = v
    return (
        A[0, 0] * x + A[0, 1] * y + A[0, 2] * z,
        A[1, 0] * x + A[1, 1] * y + A[1, 2] * z,
        A[2, 0] * x + A[2, 1] * y + A[2, 2] * z,
    )


@lean
def length(x, y, z):
    """Return the length of a vector without over- or underflow of squares."""
    largest = max(abs(x), abs(y), abs(z))
    if _SMALL < largest < _LARGE:
        return math.sqrt(x * x + y * y + z * z)
    if largest == 0.0 or not largest < math.inf:
        return largest
    x, y, z = x / largest, y / largest, z / largest
    return largest * math.sqrt(x * x + y * y + z * z)


@lean
def sine_cosine(angle):
    """Return sine and cosine to one unit in the last place, in half the time of two calls.

    The polynomials for a quarter turn are those of fdlibm.
    """
    if not abs(angle) < _REDUCED:
        return math.sin(angle), math.cos(angle)
    quarters = angle * _TWO_OVER_PI
    # Rounding is symmetric, and pi / 4 itself is not reduced.
    count = math.copysign(math.ceil(abs(quarters) - 0.5), quarters)
    high = angle - count * _HALF_PI_1
    low = count * _HALF_PI_2
    x = high - low
    rest = ((high - x) - low) - count * _HALF_PI_3
    x, before = x + rest, x
    rest += before - x
    z = x * x
    s = 1.58969099521155010221e-10
    s = -2.50507602534068634195e-08 + z * s
    s = 2.75573137070700676789e-06 + z * s
    s = -1.98412698298579493134e-04 + z * s
    s = 8.33333333332248946124e-03 + z * s
    cubic = z * x
    sine = x - ((z * (0.5 * rest - cubic * s) - rest) + cubic * 1.66666666666666324348e-01)
    c = -1.13596475577881948265e-11
    c = 2.08757232129817482790e-09 + z * c
    c = -2.75573143513906633035e-07 + z * c
    c = 2.48015872894767294178e-05 + z * c
    c = -1.38888888888741095749e-03 + z * c
    c = 4.16666666666666019037e-02 + z * c
    half = 0.5 * z
    flat = 1.0 - half
    cosine = flat + (((1.0 - flat) - half) + (z * z * c - x * rest))
    quarter = int(count) & 3
    if quarter & 1:
        sine, cosine = cosine, -sine
    if quarter & 2:
        sine, cosine = -sine, -cosine
    return sine, cosine
