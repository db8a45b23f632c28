"""Denavit-Hartenberg tables of joint axes that are given as lines."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from robomech_ros._kernels.tolerances import LARGEST_LENGTH
from robomech_ros.errors import BadValueError, NonFiniteError, WrongSizeError
from robomech_ros.robots.chain_layout import MOST_JOINTS, REVOLUTE
from robomech_ros.robots.dh_recovery import table_of_axes
from robomech_ros.robots.dh_table import DHTable
from robomech_ros.spatial.arrays import real_array


def dh_from_axes(points: ArrayLike, directions: ArrayLike) -> DHTable:
    """Return the Denavit-Hartenberg table of revolute joints whose axes are given as lines.

    The lines are those of a drawing or a measurement, in the posture in which all joint values
    are 0.  Where parameters are not unique (parallel and coincident axes, the first and the last
    frame), they are chosen as :func:`dh_from_chain` does; the last frame is that of the last joint.

    Parameters
    ----------
    points : array_like, shape (n, 3)
        A point of each axis, in the base (m).
    directions : array_like, shape (n, 3)
        Directions of positive rotation, of any length, in the base.

    Returns
    -------
    DHTable
        With ``base``, the pose of frame 1; ``tool`` is the identity.  Axes at an angle below
        1e-8 rad count as parallel.

    Raises
    ------
    BadValueError
        Naming the argument, and the axis without a direction.

    See Also
    --------
    chain_from_dh : a chain, with ``table.a``, ``table.b``, ``table.alpha``, ``table.theta`` and
        ``base=table.base``.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 4.2.

    Examples
    --------
    Two axes that cross at right angles, and one parallel to the second, 0.4 m away:

    >>> from robomech_ros.robots import dh_from_axes
    >>> points = [[0.0, 0.0, 0.0], [0.0, 0.0, 0.3], [0.4, 0.0, 0.3]]
    >>> table = dh_from_axes(points, [[0.0, 0.0, 1.0], [0.0, -1.0, 0.0], [0.0, -1.0, 0.0]])
    >>> table.a.tolist(), table.b.tolist(), table.alpha.round(4).tolist()
    ([0.0, 0.4, 0.0], [0.3, 0.0, 0.0], [1.5708, 0.0, 0.0])
    """
    lines = real_array("points", points), real_array("directions", directions)
    for what, given in zip(("points", "directions"), lines, strict=True):
        if given.ndim != 2 or given.shape[1] != 3 or not 0 < len(given) <= MOST_JOINTS:
            raise WrongSizeError(what, given.shape, f"(n, 3), n from 1 to {MOST_JOINTS}")
        if not np.isfinite(given).all():
            raise NonFiniteError(what, given)
    origins, axes = lines
    if len(origins) != len(axes):
        raise WrongSizeError("directions", axes.shape, origins.shape)
    if np.abs(origins).max() > LARGEST_LENGTH:
        raise BadValueError("points", float(np.abs(origins).max()), f"at most {LARGEST_LENGTH:g} m")
    longest = np.abs(axes).max(axis=1, keepdims=True)
    for k in np.flatnonzero(longest == 0.0):
        raise BadValueError(f"directions[{k}]", axes[k].tolist(), "a non-zero vector")
    # By the largest entry first, so that no square overflows or vanishes.
    axes = axes / longest
    axes /= np.linalg.norm(axes, axis=1, keepdims=True)
    return table_of_axes(axes, origins, None, np.full(len(axes), REVOLUTE))
