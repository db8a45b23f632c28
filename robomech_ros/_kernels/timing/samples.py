"""Piecewise polynomials and their first three derivatives at many instants."""

from robomech_ros._kernels.compiling.jit import IN1, IN3, OUT3, i8, inline, kernel


@inline
def _piece(breaks, pieces, t, known):
    """Find the piece that begins last before t, or at t; the known one is tried first."""
    if breaks[known] <= t and (known + 1 == pieces or t < breaks[known + 1]):
        return known
    low, high = 0, pieces
    while high - low > 1:
        middle = (low + high) // 2
        if breaks[middle] <= t:
            low = middle
        else:
            high = middle
    return low


@kernel(i8(IN1, IN3, IN1, OUT3))
def sample_pieces(breaks, coefficients, times, rates):
    """Sample positions and three derivatives, ``rates`` (4, m, n), at ``times`` (m,).

    ``breaks`` (s + 1,) are where the pieces begin and the last one ends, increasing; before and
    after the joints rest.  ``coefficients`` (d + 1, max(s, 1), n) are powers of the time since the
    beginning of the piece, lowest first.
    """
    size, pieces, joints = coefficients.shape
    last = breaks[breaks.shape[0] - 1]
    k = 0
    for i in range(times.shape[0]):
        t = min(max(times[i], breaks[0]), last)
        k = _piece(breaks, pieces, t, k)
        elapsed = t - breaks[k]
        moving = 1.0 if t == times[i] else 0.0
        for j in range(joints):
            # The derivatives over their factorials, by Horner's scheme.
            value, first, second, third = coefficients[size - 1, k, j], 0.0, 0.0, 0.0
            for p in range(size - 2, -1, -1):
                third = third * elapsed + second
                second = second * elapsed + first
                first = first * elapsed + value
                value = value * elapsed + coefficients[p, k, j]
            rates[0, i, j] = value
            rates[1, i, j] = moving * first
            rates[2, i, j] = moving * 2.0 * second
            rates[3, i, j] = moving * 6.0 * third
    return 0
