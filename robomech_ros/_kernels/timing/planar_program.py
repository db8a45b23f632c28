"""Linear programs in two variables: largest x within a box and between pairs of parallel lines.

References
----------
R. Seidel, "Small-dimensional linear programming and convex hulls made easy", Discrete &
Computational Geometry 6, 1991, section 2: constraints are added one by one; one that the current
optimum violates is solved as a program in one variable on its line.
"""

import math

from robomech_ros._kernels.compiling.jit import inline

# Relative excess over a bound that is rounding in a cell of a time-optimal path: its rows multiply
# squared speeds by up to 1e6, the inverse length of the shortest cells.
ROW_SLACK = 1e-10


# Rounding error of the distance of two coincident lines.
_BESIDE = 1e-9
# Relative slope of a row along a line, below which it is parallel to the line: rounding errors are
# smaller, and slopes of intersecting lines in the shortest cells larger.
_PARALLEL = 1e-14


@inline
def _along(first, second, rest, order, rows, offset, slope, box):
    """Return the range of x with ``y = offset + slope x`` allowed by the first rows and the box.

    It keeps all its digits, even if it is smaller than the box by many orders of magnitude.
    """
    low, high = box[0], box[1]
    for k in range(rows + 1):
        if k < rows:
            i = order[k]
            rise = first[i] + second[i] * slope
            value = rest[i] + second[i] * offset
            below, above = -1.0 - value, 1.0 - value
            steep = abs(rise) > _PARALLEL * (abs(first[i]) + abs(second[i]))
        else:
            rise, value, steep = slope, offset, abs(slope) > 1e-12
            below, above = box[2] - offset, box[3] - offset
        if not steep:
            # A parallel line, violated only by rounding.
            if max(below, -above) <= _BESIDE * (1.0 + abs(value)):
                continue
            # A farther line intersects if its small slope suffices within the box.
            if rise == 0.0:
                return math.inf, -math.inf
        inverse = 1.0 / rise
        if rise < 0.0:
            below, above = above, below
        low = max(low, below * inverse)
        high = min(high, above * inverse)
    return low, high


@inline
def farthest(first, second, rest, order, box, sign):
    """Return the largest x with ``|first x + second y + rest| <= 1`` inside a box.

    ``order`` (r,) is the order of testing the rows (r,); binding rows are moved to its front, so
    that they are tested first the next time.  The ``box`` is smallest and largest x, smallest and
    largest y.  For the ``sign`` -1.0, the smallest x is returned; NaN if no point fulfils all rows.
    """
    x = box[1] if sign > 0.0 else box[0]
    y = box[3]
    for k in range(order.shape[0]):
        i = order[k]
        value = first[i] * x + second[i] * y + rest[i]
        if abs(value) <= 1.0 + ROW_SLACK:
            continue
        if not abs(first[i]) + abs(second[i]) > 0.0:
            return math.nan
        bound = math.copysign(1.0, value) - rest[i]
        # Parametrise the line by the variable that changes more along it.
        if abs(second[i]) >= abs(first[i]):
            offset, slope = bound / second[i], -first[i] / second[i]
            low, high = _along(first, second, rest, order, k, offset, slope, box)
            x = high if sign > 0.0 else low
            y = offset + slope * x
        else:
            offset, slope = bound / first[i], -second[i] / first[i]
            turned = (box[2], box[3], box[0], box[1])
            low, high = _along(second, first, rest, order, k, offset, slope, turned)
            y = high if sign * slope >= 0.0 else low
            x = offset + slope * y
        if not low <= high + 1e-9 * (abs(low) + abs(high)) + 1e-300:
            return math.nan
        for j in range(k, 0, -1):
            order[j] = order[j - 1]
        order[0] = i
    return min(max(x, box[0]), box[1])
