"""Real roots of trigonometric polynomials of order one and two, including double roots.

Roots are returned as cosine and sine, so that an angle of half a turn is no special case.
"""

import math

from robomech_ros._kernels.compiling.jit import lean, lean_part
from robomech_ros._kernels.compiling.types import OUT2, f8, i8

# Relative size of an extremum, or of a discriminant, that counts as zero: a double root.
# The merged roots differ by at most the square root of this.
DOUBLE_ROOT = 1e-14
# Rounding error of coefficients of order one: if all are smaller, every x is a root.
VANISHING = 1e-12

_HALF = math.sqrt(0.5)
_EIGHTHS = (
    (1.0, 0.0),
    (_HALF, _HALF),
    (0.0, 1.0),
    (-_HALF, _HALF),
    (-1.0, 0.0),
    (-_HALF, -_HALF),
    (0.0, -1.0),
    (_HALF, -_HALF),
)


@lean
def value(form, cosine, sine):
    """Evaluate the form a + c cos x + s sin x."""
    return form[0] + form[1] * cosine + form[2] * sine


@lean
def square(form):
    """Return the square of a + c cos x + s sin x: parts of 1, cos x, sin x, cos 2x and sin 2x."""
    a, c, s = form
    return a * a + 0.5 * (c * c + s * s), 2.0 * a * c, 2.0 * a * s, 0.5 * (c * c - s * s), c * s


@lean
def quadratic_roots(a, b, c, slack):
    """Solve a x^2 + 2 b x + c = 0 as (count, x_1, x_2), x_1 <= x_2, coefficients of order one.

    A root at infinity (a = 0) is omitted.  A complex pair whose discriminant is above -``slack``
    counts as one double root; a count of -1 means that every x is a root.
    """
    if abs(a) <= VANISHING:
        if abs(b) <= VANISHING:
            return (-1 if abs(c) <= VANISHING else 0), 0.0, 0.0
        x = -0.5 * c / b
        return 1, x, x
    discriminant = b * b - a * c
    if discriminant <= DOUBLE_ROOT * (b * b + abs(a * c)):
        if discriminant < -slack:
            return 0, 0.0, 0.0
        return 1, -b / a, -b / a
    larger = -b - math.copysign(math.sqrt(discriminant), b)
    x, y = larger / a, c / larger
    return 2, min(x, y), max(x, y)


@lean
def order_one_roots(k, c, s, slack):
    """Solve k + c cos x + s sin x = 0 as (count, cos x_1, sin x_1, cos x_2, sin x_2).

    The left side falls at the first root and rises at the second.  A count of 1 is a double root,
    also if |k| is too large by up to ``slack``; a count of -1 means that every x is a root.
    """
    square = c * c + s * s
    radius = math.sqrt(square)
    if radius <= VANISHING:
        return (-1 if abs(k) <= VANISHING else 0), 1.0, 0.0, 1.0, 0.0
    room = (radius - k) * (radius + k)
    if room <= DOUBLE_ROOT * square:
        if abs(k) - radius > slack:
            return 0, 1.0, 0.0, 1.0, 0.0
        sign = -1.0 if k > 0.0 else 1.0
        return 1, sign * c / radius, sign * s / radius, 1.0, 0.0
    h = math.sqrt(room)
    inverse = 1.0 / square
    a = -k * c * inverse
    b = -k * s * inverse
    u = s * h * inverse
    v = c * h * inverse
    return 2, a - u, b + v, a + u, b - v


@lean
def _newton_on_cubic(t, a, b, c):
    """Improve a root of t^3 + a t^2 + b t + c, unless it is nearly a double root."""
    for _ in range(2):
        slope = (3.0 * t + 2.0 * a) * t + b
        step = ((t + a) * t + b) * t + c
        if abs(step) >= 1e-3 * abs(slope) * (1.0 + abs(t)):
            break
        t -= step / slope
    return t


@lean
def cubic_knots(a, b, c):
    """Return the real parts of the roots of t^3 + a t^2 + b t + c in ascending order."""
    shift = -a / 3.0
    p = b - a * a / 3.0
    q = (2.0 * a * a / 27.0 - b / 3.0) * a + c
    half = 0.5 * q
    cube = p / 3.0
    discriminant = half * half + cube * cube * cube
    if discriminant > 0.0:
        root = math.sqrt(discriminant)
        u = math.copysign((abs(half) + root) ** (1.0 / 3.0), -half)
        alone = u - cube / u
        pair = shift - 0.5 * alone
        alone = _newton_on_cubic(shift + alone, a, b, c)
        if alone < pair:
            return alone, pair, pair
        return pair, pair, alone
    radius = 2.0 * math.sqrt(max(0.0, -cube))
    third = math.atan2(math.sqrt(max(0.0, -discriminant)), -half) / 3.0
    x = _newton_on_cubic(shift + radius * math.cos(third), a, b, c)
    y = _newton_on_cubic(shift + radius * math.cos(third + 2.0943951023931953), a, b, c)
    z = _newton_on_cubic(shift + radius * math.cos(third - 2.0943951023931953), a, b, c)
    return y, z, x


@lean
def _bracketed_root(b, c, d, e, low, high, rising):
    """Return the root of t^4 + b t^3 + c t^2 + d t + e between points of opposite sign."""
    t = 0.5 * (low + high)
    for _ in range(80):
        f = (((t + b) * t + c) * t + d) * t + e
        if (f > 0.0) == rising:
            high = t
        else:
            low = t
        slope = ((4.0 * t + 3.0 * b) * t + 2.0 * c) * t + d
        step = f / slope if slope != 0.0 else high - low
        following = t - step
        if not low < following < high:
            following = 0.5 * (low + high)
        if abs(following - t) <= 1e-15 * (1.0 + abs(t)):
            return following
        t = following
    return t


@lean
def _quartic_roots(b, c, d, e, touching, roots):
    """Write the real roots of t^4 + b t^3 + c t^2 + d t + e to the first column of ``roots``.

    The quartic is divided at its extrema.  An extremum that is zero up to rounding is a double
    root, and intervals next to it are not searched, unless it is so flat that there may be more.
    """
    k1, k2, k3 = cubic_knots(0.75 * b, 0.5 * c, 0.25 * d)
    bound = 1.0 + max(max(abs(b), abs(c)), max(abs(d), abs(e)))
    count = 0
    low = -bound
    negative = bound < 0.0
    for knot in range(4):
        high = k1 if knot == 0 else k2 if knot == 1 else k3 if knot == 2 else bound
        value = (((high + b) * high + c) * high + d) * high + e
        size = 1.0 + high * high
        size *= size
        bend = abs((12.0 * high + 6.0 * b) * high + 2.0 * c) * size
        if knot < 3 and abs(value) <= DOUBLE_ROOT * min(size, bend):
            roots[count, 0] = high
            count += 1
        elif (value < 0.0) != negative:
            roots[count, 0] = _bracketed_root(b, c, d, e, low, high, negative)
            count += 1
            negative = not negative
        elif knot < 3 and abs(value) <= touching * size:
            roots[count, 0] = high
            count += 1
        low = high
    return count


@lean_part(i8(f8, f8, f8, f8, f8, f8, OUT2))
def order_two_roots(a0, a1, b1, a2, b2, touching, roots):
    """Solve a0 + a1 cos x + b1 sin x + a2 cos 2x + b2 sin 2x = 0, coefficients of order one.

    Rows [cos x, sin x] are written to ``roots`` (7, 2): every sign change, and every extremum
    nearer to zero than ``touching`` times the largest value of the polynomial.  Returns the number
    of roots, or -1 if the polynomial is zero everywhere.
    """
    # The half angle's tangent is infinite where the polynomial is largest: no root is there.
    largest = 0.0
    cos0 = 1.0
    sin0 = 0.0
    for k in range(8):
        x, y = _EIGHTHS[k]
        value = a0 + a1 * x + b1 * y + a2 * (x * x - y * y) + b2 * 2.0 * x * y
        if abs(value) > abs(largest):
            largest = value
            cos0, sin0 = -x, -y
    if abs(largest) <= VANISHING:
        return -1
    a1, b1 = a1 * cos0 + b1 * sin0, b1 * cos0 - a1 * sin0
    cos2 = cos0 * cos0 - sin0 * sin0
    sin2 = 2.0 * cos0 * sin0
    a2, b2 = a2 * cos2 + b2 * sin2, b2 * cos2 - a2 * sin2
    scale = 1.0 / (a0 - a1 + a2)
    b = (2.0 * b1 - 4.0 * b2) * scale
    c = (2.0 * a0 - 6.0 * a2) * scale
    d = (2.0 * b1 + 4.0 * b2) * scale
    e = (a0 + a1 + a2) * scale
    count = _quartic_roots(b, c, d, e, touching, roots)
    for k in range(count):
        t = roots[k, 0]
        inverse = 1.0 / (1.0 + t * t)
        x = (1.0 - t * t) * inverse
        y = 2.0 * t * inverse
        roots[k, 0] = x * cos0 - y * sin0
        roots[k, 1] = y * cos0 + x * sin0
    return count
