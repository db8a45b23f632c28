"""The axes and pitches of twists and wrenches."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robomech_ros.spatial.arrays import as_finite
from robomech_ros.spatial.cross_product import cross
from robomech_ros.spatial.rows import common_shape, finite_result
from robomech_ros.typing import Array, ArrayLike


@dataclass(frozen=True, eq=False)
class InstantScrew:
    """Axis, pitch and size of a twist or of a wrench.

    Attributes
    ----------
    axis : ndarray, shape (..., 3)
        Unit vector along the angular velocity or the force; of a pure translation along the
        velocity, of a pure couple along the moment; z where all is zero.
    point : ndarray, shape (..., 3)
        Point of the axis nearest to the origin (m); the origin where the axis may be anywhere.
    pitch : ndarray, shape (...)
        Velocity along the axis over angular velocity, or moment along it over force (m/rad or m);
        infinite for a translation or a couple.
    magnitude : ndarray, shape (...)
        Angular velocity (rad/s) or force (N); where the pitch is infinite, velocity (m/s) or moment
        (N m).
    """

    axis: Array
    point: Array
    pitch: Array
    magnitude: Array


def instant_screw(twist: ArrayLike, point: ArrayLike | None = None) -> InstantScrew:
    r"""Find the instant screw of a twist.

    .. math::

       p_0 = \frac{\omega \times (v_A - \omega \times a)}{|\omega|^2}, \qquad
       \text{pitch} = \frac{\omega \cdot v_A}{|\omega|^2}

    Parameters
    ----------
    twist : array_like, shape (..., 6)
        Angular velocity (rad/s), then velocity of the point (m/s).
    point : array_like, shape (..., 3), optional
        The point a of the body (m); default the origin.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 3.4.1.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.spatial import instant_screw
    >>> screw = instant_screw([0.3, -0.2, 0.5, 1.0, 2.0, -0.5], [0.4, 0.1, -0.3])
    >>> round(float(screw.pitch), 6), np.round(screw.point, 6)
    (-0.921053, array([-1.928947,  1.784211,  1.871053]))
    """
    t = as_finite("twist", twist, (6,))
    return _screw("twist", t[..., :3], t[..., 3:], point)


def wrench_axis(wrench: ArrayLike, point: ArrayLike | None = None) -> InstantScrew:
    """Find the axis of a wrench: the line along which the force acts with the least moment.

    Parameters
    ----------
    wrench : array_like, shape (..., 6)
        Moment about the point (N m), then force (N).
    point : array_like, shape (..., 3), optional
        The point that the moment is about (m); default the origin.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 3.7.

    Examples
    --------
    >>> from robomech_ros.spatial import wrench_axis
    >>> wrench_axis([0.0, 0.0, 5.0, 0.0, 10.0, 0.0]).point
    array([0.5, 0. , 0. ])
    """
    w = as_finite("wrench", wrench, (6,))
    return _screw("wrench", w[..., 3:], w[..., :3], point)


def _screw(what: str, free: Array, bound: Array, point: ArrayLike | None) -> InstantScrew:
    """Find the screw of a free vector and of one bound to a point."""
    a = np.zeros(3) if point is None else as_finite("point", point, (3,))
    common_shape(f"{what} and point", free.shape[:-1], a.shape[:-1])
    with np.errstate(over="ignore", invalid="ignore"):
        bound = bound - cross(free, a)
    finite_result(f"{what} and point", bound, a)
    free = np.broadcast_to(free, bound.shape)
    # Divided by their largest entries, so that no square over- or underflows.
    sizes = [np.abs(one).max(axis=-1, keepdims=True) for one in (free, bound)]
    units = [
        np.where(size > 0.0, one / np.where(size > 0.0, size, 1.0), (0.0, 0.0, 1.0))
        for one, size in zip((free, bound), sizes, strict=True)
    ]
    lengths = [np.linalg.norm(one, axis=-1, keepdims=True) for one in units]
    directions = [one / length for one, length in zip(units, lengths, strict=True)]
    turns = sizes[0] > 0.0
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        amounts = [size * length for size, length in zip(sizes, lengths, strict=True)]
        ratio = np.where(turns, amounts[1] / np.where(turns, amounts[0], 1.0), 0.0)
        along = np.sum(directions[0] * directions[1], axis=-1, keepdims=True)
        nearest = np.where(turns, ratio * cross(*directions), 0.0)
        pitch = np.where(turns, ratio * along, np.inf)[..., 0]
    finite_result(what, nearest, bound)
    return InstantScrew(
        axis=np.where(turns, directions[0], directions[1]) + 0.0,
        point=nearest + 0.0,
        pitch=pitch,
        magnitude=np.where(turns, amounts[0], amounts[1])[..., 0],
    )
