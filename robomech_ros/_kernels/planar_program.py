"""Linear programs in two variables: the largest first one within a box and between pairs of lines.

References
----------
R. Seidel, "Small-dimensional linear programming and convex hulls made easy", Discrete &
Computational Geometry 6, 1991, section 2: constraints are added one by one, and only one that the
optimum so far violates asks for work, a program in one variable on its line.
"""

import math

from robomech_ros._kernels._jit import inline
from robomech_ros._kernels.tolerances import ROW_SLACK

__all__ = ["farthest"]


@inline
def _along(first, second, rest, order, rows, x, y, dx, dy, box):
    """Find the range of t for which (x + t dx, y + t dy) keeps to the first rows and to the box."""
    low, high = -math.inf, math.inf
    for k in range(rows + 2):
        if k < rows:
            i = order[k]
            value = first[i] * x + second[i] * y + rest[i]
            slope = first[i] * dx + second[i] * dy
            below, above = -1.0 - value, 1.0 - value
            steep = abs(slope) > 1e-12 * (abs(first[i]) + abs(second[i]))
        elif k == rows:
            slope, below, above, steep = dx, box[0] - x, box[1] - x, abs(dx) > 1e-12
        else:
            slope, below, above, steep = dy, box[2] - y, box[3] - y, abs(dy) > 1e-12
        if not steep:
            continue
        inverse = 1.0 / slope
        if slope < 0.0:
            below, above = above, below
        low = max(low, below * inverse)
        high = min(high, above * inverse)
    return low, high


@inline
def farthest(first, second, rest, order, box, sign):
    """Find the largest `sign` x with ``|first x + second y + rest| <= 1`` inside a box.

    Parameters
    ----------
    first, second, rest : ndarray, shape (r,)
        The rows.
    order : ndarray of int, shape (r,)
        In which order to look at them; the rows that bind are moved to its front, so that they
        come first the next time.
    box : tuple of float
        Least and largest x, least and largest y.
    sign : float
        1.0 for the largest x, -1.0 for the smallest.

    Returns
    -------
    x : float
        NaN where no point keeps to all rows.
    """
    x = box[1] if sign > 0.0 else box[0]
    y = box[3]
    for k in range(order.shape[0]):
        i = order[k]
        value = first[i] * x + second[i] * y + rest[i]
        if abs(value) <= 1.0 + ROW_SLACK:
            continue
        square = first[i] * first[i] + second[i] * second[i]
        if not square > 0.0:
            return math.nan
        step = (value - math.copysign(1.0, value)) / square
        x -= step * first[i]
        y -= step * second[i]
        length = math.sqrt(square)
        dx, dy = second[i] / length, -first[i] / length
        if sign * dx < 0.0:
            dx, dy = -dx, -dy
        low, high = _along(first, second, rest, order, k, x, y, dx, dy, box)
        if low > high + 1e-9 * (abs(low) + abs(high)) + 1e-300:
            return math.nan
        x += high * dx
        y += high * dy
        for j in range(k, 0, -1):
            order[j] = order[j - 1]
        order[0] = i
    return min(max(x, box[0]), box[1])
