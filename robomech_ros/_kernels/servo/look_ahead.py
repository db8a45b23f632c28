"""Sampling of a joint path, and check of limits of the cubics between knots."""

from robomech_ros._kernels.compiling.jit import kernel
from robomech_ros._kernels.compiling.types import IN1, IN2, IOUT1, OUT2, i8

# Period (s) of a controller, over which a step of acceleration counts as jerk.
CYCLE = 2e-3


@kernel(i8(IN1, IN2, IN2, IN1, IN1, OUT2, OUT2))
def postures_on_path(nodes, postures, slopes, coordinates, rates, q, v):
    """Write positions q and rates v (k, n) of the joints on a path of cubics.

    ``nodes`` (s,) are increasing path coordinates, and ``postures`` and ``slopes`` (s, n) the
    positions there and their derivatives by the coordinate.  ``coordinates`` (k,) are the sampled
    coordinates, which do not decrease, and ``rates`` (k,) their time derivatives.
    """
    count, joints = postures.shape
    i = 0
    for k in range(coordinates.shape[0]):
        if count == 1:
            for j in range(joints):
                q[k, j] = postures[0, j]
                v[k, j] = slopes[0, j] * rates[k]
            continue
        while i < count - 2 and nodes[i + 1] <= coordinates[k]:
            i += 1
        width = nodes[i + 1] - nodes[i]
        x = (coordinates[k] - nodes[i]) / width
        for j in range(joints):
            rise = postures[i + 1, j] - postures[i, j]
            first, last = width * slopes[i, j], width * slopes[i + 1, j]
            b, c = 3.0 * rise - 2.0 * first - last, first + last - 2.0 * rise
            q[k, j] = postures[i, j] + x * (first + x * (b + x * c))
            v[k, j] = (first + x * (2.0 * b + 3.0 * x * c)) / width * rates[k]
    return 0


@kernel(i8(IN1, IN2, IN2, IN2, IN2, IOUT1))
def cubics_inside(widths, q, v, reached, limits, out):
    """Check that cubics between knots are within limits: return 0, 1 for rates, or 2 for ranges.

    The control points of a cubic, and of its derivatives, bound it.  A joint with final velocity 0
    rests afterwards.  ``widths`` (k - 1,) are times between knots (s), q and v (k, n) positions
    and velocities there (rad or m, and per s), and ``reached`` (2, n) acceleration and jerk just
    before the first knot (per s^2 and s^3).  ``limits`` (5, n) are smallest and largest positions,
    and largest velocities, accelerations and jerks.  ``out`` (n,) receives 1 for joints that leave
    their ranges, and 0 for others, if rates are within limits.
    """
    status = 0
    for j in range(q.shape[1]):
        out[j] = 0
        before, jerk_before = reached[0, j], reached[1, j]
        for k in range(widths.shape[0]):
            h, first, last = widths[k], v[k, j], v[k + 1, j]
            middle = 3.0 * (q[k + 1, j] - q[k, j]) / h - first - last
            start, end = 2.0 * (middle - first) / h, 2.0 * (last - middle) / h
            # A step of acceleration at a knot counts as a change within one period.
            jerk, kink = (end - start) / h, (start - before) / CYCLE
            hardest = max(abs(jerk), abs(jerk + kink), abs(jerk_before + kink))
            before, jerk_before = end, jerk
            speed = max(abs(middle), abs(first), abs(last))
            if (
                speed > limits[2, j]
                or max(abs(start), abs(end)) > limits[3, j]
                or hardest > limits[4, j]
            ):
                return 1
            low = min(q[k, j], q[k + 1, j], q[k, j] + h / 3.0 * first, q[k + 1, j] - h / 3.0 * last)
            high = max(
                q[k, j], q[k + 1, j], q[k, j] + h / 3.0 * first, q[k + 1, j] - h / 3.0 * last
            )
            if low < limits[0, j] or high > limits[1, j]:
                out[j], status = 1, 2
        stop = before / CYCLE if v[widths.shape[0], j] == 0.0 else 0.0
        if max(abs(stop), abs(jerk_before - stop)) > limits[4, j] and stop != 0.0:
            return 1
    return status
