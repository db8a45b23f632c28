"""Static stability: the polygon of feet on the ground, and how far inside the mass centre is."""

from __future__ import annotations

import numpy as np

from robomech_ros._kernels.walking.support import margins
from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.spatial.arrays import as_finite
from robomech_ros.typing import Array, ArrayLike


def stability_margin(com_xy: ArrayLike, feet_xy: ArrayLike) -> float | Array:
    """Measure how far inside the support polygon the mass centre is.

    Parameters
    ----------
    com_xy : array_like, shape (..., 2)
        The mass centre, projected to the ground (m).
    feet_xy : array_like, shape (n, 2)
        Feet on the ground (m), in the same frame, in any order.

    Returns
    -------
    float, or ndarray of shape (...)
        Distance (m) to the border of the polygon: positive inside, negative outside.  Two feet have
        no inside: minus the distance to the line between them.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 10.4.

    Examples
    --------
    >>> from robomech_ros.walking import stability_margin
    >>> stability_margin([0.0, 0.0], [[0.2, 0.15], [0.2, -0.15], [-0.2, -0.15], [-0.2, 0.15]])
    0.15
    """
    feet = _feet(feet_xy)
    points = as_finite("com_xy", com_xy, (2,))
    flat = np.ascontiguousarray(points.reshape(-1, 2))
    found = np.empty(len(flat))
    margins(flat, feet, found)
    if points.ndim == 1:
        return float(found[0])
    return found.reshape(points.shape[:-1])


def support_polygon(feet_xy: ArrayLike) -> Array:
    """Return the corners of the support polygon, the convex hull of the feet on the ground.

    Parameters
    ----------
    feet_xy : array_like, shape (n, 2)
        Feet on the ground (m).

    Returns
    -------
    ndarray, shape (k, 2)
        Counter-clockwise, from the least x on; feet on an edge are left out.

    Examples
    --------
    >>> from robomech_ros.walking import support_polygon
    >>> len(support_polygon([[0.0, 0.0], [1.0, 0.0], [0.5, 0.1], [0.5, 1.0]]))
    3
    """
    points = np.unique(_feet(feet_xy), axis=0)
    if len(points) < 3:
        return points
    lower, upper = _half(points), _half(points[::-1])
    return np.array(lower[:-1] + upper[:-1])


def _half(points: Array) -> list[Array]:
    """Return one half of the hull of sorted points (monotone chain of Andrew)."""
    found: list[Array] = []
    for point in points:
        while len(found) > 1:
            a, b = found[-1] - found[-2], point - found[-1]
            if a[0] * b[1] - a[1] * b[0] > 0.0:
                break
            found.pop()
        found.append(point)
    return found


def _feet(feet_xy: ArrayLike) -> Array:
    feet = as_finite("feet_xy", feet_xy, (2,))
    if feet.ndim != 2:
        raise WrongSizeError("feet_xy", feet.shape, "(n, 2)")
    if not len(feet):
        raise BadValueError("number of feet on the ground", 0, "1 or more")
    return np.ascontiguousarray(feet)
