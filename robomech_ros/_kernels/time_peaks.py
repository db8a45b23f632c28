"""Largest velocity and acceleration of a piecewise quintic over their limits, if above a floor."""

import numpy as np

from robomech_ros._kernels._jit import IN1, IN3, f8, i8, inline, kernel
from robomech_ros._kernels.time_bernstein import to_bernstein

__all__ = ["peak_above"]

# Each halving narrows the hull four times; what is left after these is far below any tolerance.
_HALVINGS = 24


@inline
def _highest(control, degree, floor, stack):
    """Find the largest magnitude on [0, 1] from Bernstein coefficients, or floor if it is less."""
    for i in range(degree + 1):
        stack[0, i] = control[i]
    stack[0, degree + 1] = 0.0
    count = 1
    while count > 0:
        count -= 1
        floor = max(floor, abs(stack[count, 0]), abs(stack[count, degree]))
        largest = 0.0
        for i in range(degree + 1):
            largest = max(largest, abs(stack[count, i]))
        depth = stack[count, degree + 1]
        if largest <= floor * (1.0 + 1e-9) or depth >= _HALVINGS:
            floor = max(floor, largest if depth >= _HALVINGS else 0.0)
            continue
        # De Casteljau: the left half replaces the whole, the right half goes on top of it.
        for i in range(degree + 1):
            control[i] = stack[count, i]
        for i in range(degree + 1):
            stack[count, i] = control[0]
            stack[count + 1, degree - i] = control[degree - i]
            for k in range(degree - i):
                control[k] = 0.5 * (control[k] + control[k + 1])
        stack[count, degree + 1] = depth + 1.0
        stack[count + 1, degree + 1] = depth + 1.0
        count += 2
    return floor


@kernel(f8(IN1, IN3, IN1, i8, f8))
def peak_above(times, coefficients, scales, order, floor):
    """Find the largest magnitude of a derivative over its limit, between the ends of pieces too.

    Parameters
    ----------
    times : ndarray, shape (p + 1,)
        Where the pieces begin and end, in s.
    coefficients : ndarray, shape (c, p, n)
        Powers of the time since the beginning of the piece, lowest first.
    scales : ndarray, shape (n,)
        One over the limit of each joint.
    order : int
        1 velocity, 2 acceleration, 3 jerk.
    floor : float
        What is below does not matter, and is not looked at closely.

    Returns
    -------
    float
        The largest ratio, `floor` at least.
    """
    degree = coefficients.shape[0] - 1 - order
    control, stack = np.empty(degree + 1), np.empty((_HALVINGS + 3, degree + 2))
    for k in range(coefficients.shape[1]):
        span = times[k + 1] - times[k]
        for j in range(coefficients.shape[2]):
            power, largest = scales[j], 0.0
            for i in range(degree + 1):
                factor = power
                for r in range(order):
                    factor *= i + order - r
                control[i] = coefficients[i + order, k, j] * factor
                power *= span
                largest += abs(control[i])
            if largest <= floor:
                continue
            to_bernstein(control, degree)
            floor = _highest(control, degree, floor, stack)
    return floor
