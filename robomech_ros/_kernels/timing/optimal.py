"""Largest speed along a path within rows of limits, by two passes over all cells.

The rows of :mod:`.constraint_rows` are linear in the squared speeds at both ends of a cell.

References
----------
H. Pham and Q.-C. Pham, "A new approach to time-optimal path parameterization based on
reachability analysis", IEEE Transactions on Robotics 34(3), 2018: the two passes.
"""

import numpy as np

from robomech_ros._kernels.compiling.jit import inline, kernel
from robomech_ros._kernels.compiling.types import IIN1, IN1, IN2, IOUT1, OUT1, f8, i8
from robomech_ros._kernels.timing.planar_program import ROW_SLACK, farthest

# Results of the passes.
DONE, BLOCKED, STALLED = 0, 1, 2
# Least magnitude of a binding row, whose bound is 1.
_BINDING = 0.999


@inline
def _next(first, second, rest, x, lowest, highest):
    """Return the largest x_1 in [lowest, highest] allowed by the rows for x_0 = x."""
    low, high = lowest, highest
    for i in range(first.shape[0]):
        slope = second[i]
        value = first[i] * x + rest[i]
        if slope > 0.0:
            if value + slope * high > 1.0 + ROW_SLACK:
                high = (1.0 - value) / slope
            if value + slope * low < -1.0 - ROW_SLACK:
                low = (-1.0 - value) / slope
        elif slope < 0.0:
            if value + slope * high < -1.0 - ROW_SLACK:
                high = (-1.0 - value) / slope
            if value + slope * low > 1.0 + ROW_SLACK:
                low = (1.0 - value) / slope
    # An empty range is due to rounding errors.
    found = high if high >= low else 0.5 * (low + high)
    return max(lowest, min(highest, found))


@inline
def _scaled_down(first, second, x, y):
    """Scale x_0 = x and x_1 = y until the rows allow them, without `rest`; return x_0."""
    largest = 1.0
    for i in range(first.shape[0]):
        largest = max(largest, abs(first[i] * x + second[i] * y))
    return x / largest


@inline
def _find_ranges(first, second, rest, order, bounds, end, lowest, highest, where):
    """Write the ranges of x from which the end can be reached; return False if one is empty."""
    cells = first.shape[0]
    drift = rest.shape[0] == cells
    lowest[cells] = min(max(end, 0.0), bounds[cells])
    highest[cells] = min(end, bounds[cells]) if end >= 0.0 else bounds[cells]
    for k in range(cells - 1, -1, -1):
        box = (0.0, bounds[k], lowest[k + 1], highest[k + 1])
        row = rest[k if drift else 0]
        found = farthest(first[k], second[k], row, order, box, 1.0)
        where[0] = k
        free = not drift and lowest[k + 1] == 0.0
        if free and not found > 0.0:
            found = _scaled_down(first[k], second[k], bounds[k], highest[k + 1])
        if not found >= 0.0:
            return False
        highest[k] = found
        lowest[k] = 0.0
        if not free:
            found = farthest(first[k], second[k], row, order, box, -1.0)
            if not found >= 0.0:
                return False
            lowest[k] = min(found, highest[k])
    return True


@kernel(i8(IN2, IN2, IN2, IN1, f8, f8, OUT1, OUT1, OUT1, IOUT1))
def speed_profile(first, second, rest, bounds, begin, end, lowest, highest, x, where):
    """Find the largest x at all nodes within the rows of the cells, from end to start and back.

    In cell k, ``|first x_k + second x_k+1 + rest| <= 1`` for rows of ``first``, ``second`` and
    ``rest`` (m, r); the latter is (1, r) zeros without drift.  ``bounds`` (m + 1,) are the largest
    x at the nodes.  ``begin`` and ``end`` are the required x at both ends, negative for any; the
    nearest possible x is used at the start.

    ``lowest`` and ``highest`` (m + 1,) receive the range of x from which the end can be reached,
    x (m + 1,) the result, and ``where`` (1,) the cell of a failure.  Returns DONE; BLOCKED if no x
    can pass a cell or lead to the required end; or STALLED if both ends of a cell are at rest.
    """
    cells, rows = first.shape
    drift = rest.shape[0] == cells
    order = np.arange(rows)
    if not _find_ranges(first, second, rest, order, bounds, end, lowest, highest, where):
        return BLOCKED
    if begin < 0.0:
        # Maximise the next x; if x_0 is bounded as well, a smaller x_0 may allow a larger next x.
        row = rest[0]
        box = (lowest[1], highest[1], lowest[0], highest[0])
        reached = farthest(second[0], first[0], row, order, box, 1.0)
        if reached >= 0.0:
            begin = _next(second[0], first[0], row, reached, lowest[0], highest[0])
    x[0] = min(max(begin, lowest[0]), highest[0])
    for k in range(cells):
        row = rest[k if drift else 0]
        x[k + 1] = _next(first[k], second[k], row, x[k], lowest[k + 1], highest[k + 1])
        if not x[k + 1] + x[k] > 0.0:
            where[0] = k
            return STALLED
    return DONE


@kernel(i8(IN2, IN2, IN2, IN1, IN1, IIN1, IOUT1))
def binding_rows(first, second, rest, bounds, x, owners, binding):
    """Find the binding quantity of each cell.

    The first five arguments are as for `speed_profile`; ``owners`` (r,) are the quantities, from 1,
    to which the rows belong.  ``binding`` (m,) receives the quantity with the sign of its bound, 0
    if x is at its bounds instead, or a unique number if nothing binds throughout the cell.
    """
    drift = rest.shape[0] == first.shape[0]
    for k in range(first.shape[0]):
        largest = _BINDING
        bounded = x[k] >= largest * bounds[k] and x[k + 1] >= largest * bounds[k + 1]
        binding[k] = 0 if bounded else first.shape[1] + 1 + k
        row = rest[k if drift else 0]
        for i in range(first.shape[1]):
            value = first[k, i] * x[k] + second[k, i] * x[k + 1] + row[i]
            if abs(value) > largest:
                largest = abs(value)
                binding[k] = owners[i] if value > 0.0 else -owners[i]
    return DONE
