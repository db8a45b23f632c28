"""The screw of a rigid-body motion, and the pose that it makes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robomech_ros._kernels.compiling.jit import direct
from robomech_ros._kernels.spatial import exponential
from robomech_ros.spatial.rows import as_rows, broadcast_rows
from robomech_ros.spatial.screws.exponential import raise_bad_pose, raise_bad_rows
from robomech_ros.spatial.transformations.linear_maps import unit_vectors
from robomech_ros.typing import Array, ArrayLike

_screws = direct(exponential.screws)
_poses = direct(exponential.poses_of_screws)


@dataclass(frozen=True, eq=False)
class FiniteScrew:
    """Axis, turn and slide of a rigid-body motion.

    Attributes
    ----------
    axis : ndarray, shape (..., 3)
        Unit vector; of a translation its direction, z at the identity.
    point : ndarray, shape (..., 3)
        Point of the axis nearest to the origin (m); the origin for a translation, which has its
        axis anywhere.
    angle : ndarray, shape (...)
        In [0, pi] (rad).
    displacement : ndarray, shape (...)
        Along the axis (m).
    """

    axis: Array
    point: Array
    angle: Array
    displacement: Array

    @property
    def pitch(self) -> Array:
        """Displacement over angle (m/rad), infinite for a translation, shape (...)."""
        turns = self.angle > 0.0
        ratio = np.divide(
            self.displacement, self.angle, out=np.full(np.shape(turns), np.inf), where=turns
        )
        return np.asarray(ratio)


def finite_screw(pose: ArrayLike) -> FiniteScrew:
    r"""Find the screw of a motion (Mozzi and Chasles): a turn about an axis and a slide along it.

    All points move by the same :math:`d_0 = e \cdot d` along the axis, whose point nearest to the
    origin is

    .. math:: p_0 = \frac{(Q - 1)^T (Q a - a')}{2 (1 - \cos \varphi)}

    for any point that goes from a to a'.

    Parameters
    ----------
    pose : array_like, shape (..., 4, 4)
        The body after the motion, in the frame that it has left.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 3.2.1.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.spatial import finite_screw, pose_from_screw
    >>> T = pose_from_screw([0.0, 0.0, 1.0], [1.0, 0.0, 0.0], np.pi / 2.0, 0.3)
    >>> screw = finite_screw(T)
    >>> np.round(screw.point, 6) + 0.0, round(float(screw.displacement), 6)
    (array([1., 0., 0.]), 0.3)
    """
    rows, shape = as_rows("pose", pose, (4, 4), 16)
    out = np.empty((len(rows), 8))
    if _screws(rows, out):
        raise_bad_pose(rows, shape)
    found = out.reshape(*shape, 8)
    return FiniteScrew(found[..., :3], found[..., 3:6], found[..., 6], found[..., 7])


def pose_from_screw(
    axis: ArrayLike, point: ArrayLike, angle: ArrayLike, displacement: ArrayLike
) -> Array:
    """Turn about a line and slide along it.

    Parameters
    ----------
    axis : array_like, shape (..., 3)
        Direction, of any length but zero.
    point : array_like, shape (..., 3)
        Any point of the line (m).
    angle : array_like, shape (...)
        rad.
    displacement : array_like, shape (...)
        Along the axis (m).

    Returns
    -------
    ndarray, shape (..., 4, 4)

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 3.2.1.
    """
    unit_vectors("axis", axis)
    given = ("axis", axis, 3), ("point", point, 3), ("angle", angle, 0)
    parts, shape = broadcast_rows(*given, ("displacement", displacement, 0))
    rows = np.empty((int(np.prod(shape)), 8))
    rows[:, :3], rows[:, 3:6], rows[:, 6], rows[:, 7] = parts
    out = np.empty((len(rows), 16))
    status = _poses(rows, out)
    if status:
        raise_bad_rows("axis, point, angle and displacement", rows, shape, status)
    return out.reshape(*shape, 4, 4)
