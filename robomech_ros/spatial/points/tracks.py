"""The motion of a rigid body from noisy positions of its points over time."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robomech_ros._kernels.compiling.jit import direct
from robomech_ros._kernels.spatial import points as kernels
from robomech_ros.errors import BadValueError, InconsistentDataError, WrongSizeError
from robomech_ros.spatial.arrays import (
    LARGEST,
    as_finite,
    positive_number,
    real_within,
    whole_number,
)
from robomech_ros.spatial.points.from_points import (
    angular_acceleration_from_points,
    angular_velocity_from_points,
)
from robomech_ros.spatial.points.rigidity import spread_matrix
from robomech_ros.typing import Array, ArrayLike

_fit = direct(kernels.fit_tracks)

# For a motion with frequencies up to a few hertz, sampled at 100 Hz.
_WINDOW = 21
_DEGREE = 4
_MOST_DEGREE = 12
_LEAST_POINTS = 3
# Noise changes distances by 1.4 deviations and less after the fit, a window that is too long for
# the motion by a few more.
_MOST_CHANGE, _ROUNDING = 10.0, 1e-6


@dataclass(frozen=True, eq=False)
class TrackedMotion:
    """Motion of a body at the times of n samples of m of its points.

    Attributes
    ----------
    times : ndarray, shape (n,)
        In s.
    points, velocities, accelerations : ndarray, shape (n, m, 3)
        Of the points, smoothed (m, m/s, m/s^2).
    angular_velocity, angular_acceleration : ndarray, shape (n, 3)
        rad/s, rad/s^2.
    velocity_covariance : ndarray, shape (n, 3, 3)
        Of the angular velocity, by the noise ((rad/s)^2).
    acceleration_covariance : ndarray, shape (n, 3, 3)
        Of the angular acceleration, without the small part that the error of the velocity adds
        ((rad/s^2)^2).
    deviation : float
        Standard deviation of a coordinate of a position (m): as given, or as the samples scatter
        about the fit.
    """

    times: Array
    points: Array
    velocities: Array
    accelerations: Array
    angular_velocity: Array
    angular_acceleration: Array
    velocity_covariance: Array
    acceleration_covariance: Array
    deviation: float


def motion_from_tracks(
    times: ArrayLike,
    points: ArrayLike,
    *,
    window: int = _WINDOW,
    degree: int = _DEGREE,
    deviation: float | None = None,
    tolerance: float | None = None,
) -> TrackedMotion:
    """Compute how a body moves from noisy tracks of its points.

    A polynomial of each coordinate is fitted to the samples around each time; its value and
    derivatives there go into the robust form.  A longer window or a lower degree leaves less noise
    and follows fast motions less closely.

    Parameters
    ----------
    times : array_like, shape (n,)
        Strictly increasing, evenly spaced or not (s).
    points : array_like, shape (n, m, 3)
        Positions of three points or more, in a fixed frame (m).
    window : int, optional
        Number of samples that a polynomial is fitted to; fewer than n are there use all.
    degree : int, optional
        Degree of the polynomial, from 2 to 12 and less than the window.
    deviation : float, optional
        Standard deviation of the noise of a coordinate (m); default as the samples scatter.
    tolerance : float, optional
        Largest change (root mean square, m) of the distance between two points of a rigid body;
        default ten times the deviation.

    Raises
    ------
    BadValueError, WrongSizeError
        Times that do not increase, too few samples or points, or a window or degree out of range.
    InconsistentDataError, UnderdeterminedError
        Points that are no rigid body; points on one line, or all the same.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., sections 8.2.1 and 8.3.1.
    A. Savitzky, M. J. E. Golay, Smoothing and differentiation of data by simplified least squares
    procedures, Analytical Chemistry 36(8), 1964.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.spatial import matrix_from_axis_angle, motion_from_tracks
    >>> times = np.linspace(0.0, 1.0, 101)
    >>> tracks = (matrix_from_axis_angle([0.0, 0.0, 1.0], 2.0 * times) @ np.eye(3)).swapaxes(1, 2)
    >>> np.round(motion_from_tracks(times, tracks).angular_velocity[50], 4) + 0.0
    array([0., 0., 2.])
    """
    t, p = _checked(times, points)
    count, m = p.shape[:2]
    expected = "a whole number, at least 1"
    span = min(whole_number("window", window, expected, 1, 2**31 - 1), count)
    order = whole_number("degree", degree, expected, 1, 2**31 - 1)
    if not 2 <= order <= _MOST_DEGREE:
        raise BadValueError("degree", order, f"2 to {_MOST_DEGREE}")
    if span <= order:
        raise BadValueError("window", span, f"more than the degree {order}, and so many samples")
    rows = np.ascontiguousarray(p).reshape(count, 3 * m)
    found, gains = np.empty((3, count, 3 * m)), np.empty((count, 3))
    squares = np.empty(count)
    _fit(t, rows, span, order, np.empty((5, span)), found, gains, squares)
    smooth, speed, change = found.reshape(3, count, m, 3)
    omega = angular_velocity_from_points(smooth, speed)
    alpha = angular_acceleration_from_points(smooth, speed, change)
    sigma = _deviation(deviation, squares, gains[:, 0], 3 * m)
    limit = _MOST_CHANGE * sigma if sigma > 0.0 else np.inf
    _check_distances(
        smooth, limit if tolerance is None else positive_number("tolerance", tolerance)
    )
    centred = smooth - smooth.mean(axis=1, keepdims=True)
    inverse = np.linalg.inv(spread_matrix(centred))
    noise = sigma * sigma * gains[:, 1:, None, None] * inverse[:, None]
    return TrackedMotion(t, smooth, speed, change, omega, alpha, noise[:, 0], noise[:, 1], sigma)


def _check_distances(points: Array, limit: float) -> None:
    """Refuse tracks (n, m, 3) whose distances change by more than a limit (m)."""
    first, second = np.triu_indices(points.shape[1], 1)
    with np.errstate(over="ignore", invalid="ignore"):
        lengths = np.linalg.norm(points[:, first] - points[:, second], axis=-1)
        changes = np.std(lengths, axis=0)
    worst = int(np.argmax(changes))
    # Rounding of the fit of exact tracks.
    if changes[worst] > limit + _ROUNDING * float(np.abs(lengths).max()):
        raise InconsistentDataError(
            f"change of the distance of points {first[worst]} and {second[worst]}",
            f"{float(changes[worst]):.3g} m",
            f"at most {limit:.3g} m of points of a rigid body",
        )


def _deviation(given: float | None, squares: Array, gains: Array, width: int) -> float:
    """Find the standard deviation of the noise: as given, or by what the fit leaves over."""
    if given is not None:
        return real_within("deviation", given, "a number, at least 0", 0.0, LARGEST)
    # The value of a fit at its own sample has the weight of that sample, which is also the sum
    # of the squared weights: of the noise 1 - weight is left over.
    free = float(np.sum(1.0 - gains)) * width
    return float(np.sqrt(np.sum(squares) / free)) if free > 0.0 else 0.0


def _checked(times: ArrayLike, points: ArrayLike) -> tuple[Array, Array]:
    t, p = as_finite("times", times, ()), as_finite("points", points, (3,))
    if t.ndim != 1 or len(t) < _LEAST_POINTS:
        raise WrongSizeError("times", t.shape, "(n,) with n at least 3")
    if p.ndim != 3 or len(p) != len(t) or p.shape[1] < _LEAST_POINTS:
        raise WrongSizeError("points", p.shape, f"({len(t)}, m, 3) with m at least 3")
    with np.errstate(over="ignore"):
        steps = np.diff(t)
    if not ((steps > 0.0) & (steps < np.inf)).all():
        k = int(np.argmax(~(steps > 0.0)))
        raise BadValueError(f"times[{k + 1}] - times[{k}]", float(steps[k]), "a positive number")
    return np.ascontiguousarray(t), p
