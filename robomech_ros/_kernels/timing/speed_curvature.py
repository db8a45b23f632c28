"""Curvature of the squared speed x within the cells of a path, and refinement of the cells."""

import math

from robomech_ros._kernels.compiling.jit import inline, kernel
from robomech_ros._kernels.compiling.types import IIN1, IN1, OUT1, f8, i8

# Largest number of parts of a divided cell.
PARTS = 4

# Largest bend, for which x stays positive and nearly linear.
_LARGEST = 0.5
# Least distance of a switch from a node, as a fraction of the cell.
_AT_NODE = 1e-3


@inline
def _slope(x, spans, k):
    return (x[k + 1] - x[k]) / spans[k]


@inline
def _change(x, spans, binding, k):
    """Estimate the second derivative of x in cell k from neighbours with the same binding."""
    last = spans.shape[0] - 1
    middle = _slope(x, spans, k)
    before = k > 0 and binding[k - 1] == binding[k]
    after = k < last and binding[k + 1] == binding[k]
    left, right = 0.0, 0.0
    if before:
        left = 2.0 * (middle - _slope(x, spans, k - 1)) / (spans[k] + spans[k - 1])
    if after:
        right = 2.0 * (_slope(x, spans, k + 1) - middle) / (spans[k] + spans[k + 1])
    if before and after:
        if left * right <= 0.0:
            return 0.0
        return left if abs(left) < abs(right) else right
    return left + right


@kernel(i8(IN1, IN1, IIN1, OUT1))
def bends(x, spans, binding, thetas):
    """Estimate the bend of x in every cell from slopes in its neighbours.

    x (m + 1,) is at the nodes; ``spans`` (m,) are lengths of cells, and ``binding`` (m,) their
    binding quantities.  Only cells with the same one are compared.  ``thetas`` (m,) is written.
    """
    for k in range(spans.shape[0]):
        total = x[k] + x[k + 1]
        theta = 0.0
        if total > 0.0:
            theta = -_change(x, spans, binding, k) * spans[k] * spans[k] / total
        thetas[k] = max(-_LARGEST, min(_LARGEST, theta))
    return 0


@inline
def _meeting(x, spans, binding, k):
    """Return sigma in cell k where the arcs from left and right intersect, or 0."""
    if k == 0 or k == spans.shape[0] - 1 or binding[k - 1] == binding[k + 1]:
        return 0.0
    span = spans[k]
    bend_left = _change(x, spans, binding, k - 1) if binding[k - 1] != binding[k] else 0.0
    bend_right = _change(x, spans, binding, k + 1) if binding[k + 1] != binding[k] else 0.0
    left = _slope(x, spans, k - 1) + 0.5 * spans[k - 1] * bend_left
    right = _slope(x, spans, k + 1) - 0.5 * spans[k + 1] * bend_right
    a = 0.5 * (bend_left - bend_right) * span * span
    b = (left - right) * span + bend_right * span * span
    c = x[k] - x[k + 1] + right * span - 0.5 * bend_right * span * span
    # The root of a sigma^2 + b sigma + c = 0 that tends to -c / b for small a.
    if b == 0.0:
        return 0.0
    sigma = -c / b
    for _ in range(3):
        slope = b + 2.0 * a * sigma
        if slope * b <= 0.0:
            return 0.0
        sigma -= (c + sigma * (b + a * sigma)) / slope
    return sigma


@inline
def _loss(x, spans, thetas, k):
    """Estimate the cost of the change of slope through both cells at node k, 0 < k < m."""
    left, right = spans[k - 1], spans[k]
    begin = (x[k] - x[k - 1]) / left + 0.5 * thetas[k - 1] * (x[k] + x[k - 1]) / left
    end = (x[k + 1] - x[k]) / right - 0.5 * thetas[k] * (x[k + 1] + x[k]) / right
    total = _time(x, spans, k - 1) + _time(x, spans, k)
    return abs(begin - end) * min(left, right) * total / max(x[k], 1e-300)


@inline
def _time(x, spans, k):
    return 2.0 * spans[k] / (math.sqrt(x[k]) + math.sqrt(x[k + 1]))


@inline
def _divide(begin, span, theta, parts, shortest, finer, finer_thetas, count):
    """Write the parts of a cell from index `count` on; return the next index."""
    parts = max(1, min(parts, int(span / shortest)))
    for i in range(parts):
        finer[count] = begin + span * i / parts
        finer_thetas[count] = max(-_LARGEST, min(_LARGEST, theta / (parts * parts)))
        count += 1
    return count


@kernel(i8(IN1, IN1, IIN1, IN1, IN1, f8, f8, OUT1, OUT1))
def refine(x, spans, binding, nodes, thetas, accuracy, shortest, finer, finer_thetas):
    """Divide the cells with the largest changes of the slope, and those where x switches inside.

    x (m + 1,) is at the ``nodes`` (m + 1,), path coordinates; ``spans`` and ``thetas`` (m,) are
    lengths and bends of cells, and ``binding`` (m,) their binding quantities.  The ``accuracy`` is
    the fraction of the duration that a cell may lose; cells with larger losses are divided, but
    not below the length ``shortest``.  ``finer`` (2 PARTS m + 1,) and ``finer_thetas``
    (2 PARTS m,) receive nodes and bends of the new cells.  Returns their number.
    """
    cells = spans.shape[0]
    allowed = 0.0
    for k in range(cells):
        allowed += accuracy * _time(x, spans, k)
    count, after = 0, 0.0
    for k in range(cells):
        before = after
        after = _loss(x, spans, thetas, k + 1) if k + 1 < cells else 0.0
        excess = min(max(before, after) / allowed, float(PARTS**3))
        parts = math.ceil(excess ** (1.0 / 3.0))
        sigma = _meeting(x, spans, binding, k)
        least = max(_AT_NODE, shortest / spans[k])
        inner = least < sigma < 1.0 - least
        first = sigma if inner else 1.0
        theta = thetas[k - 1] * (spans[k] / spans[k - 1]) ** 2 if inner else thetas[k]
        count = _divide(nodes[k], spans[k] * first, theta * first * first, parts, shortest,
                        finer, finer_thetas, count)  # fmt: skip
        if inner:
            rest = 1.0 - sigma
            theta = thetas[k + 1] * (spans[k] / spans[k + 1]) ** 2
            count = _divide(nodes[k] + spans[k] * sigma, spans[k] * rest, theta * rest * rest,
                            parts, shortest, finer, finer_thetas, count)  # fmt: skip
    finer[count] = nodes[cells]
    return count
