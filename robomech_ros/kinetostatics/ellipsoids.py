"""The ellipsoids of velocity and force of a posture."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from robomech_ros.errors import WrongSizeError
from robomech_ros.spatial.arrays import as_finite
from robomech_ros.typing import Array, ArrayLike

# Half axes below this part of the longest are zero.
_ZERO = 1e-12


class ManipulabilityEllipsoid(NamedTuple):
    """Velocities at joint rates of norm 1, and forces at joint torques of norm 1, of a point.

    Attributes
    ----------
    axes : ndarray, shape (3, 3)
        Principal directions of both as columns, a right-handed frame in the axes of the Jacobian.
    velocity : ndarray, shape (3,)
        Half axes of the ellipsoid of velocities, longest first, 0 where it is flat: rad/s for
        angular rows of a Jacobian, m/s for linear ones.
    force : ndarray, shape (3,)
        Half axes of the ellipsoid of moments (N m) or forces (N) along the same directions, each
        one over that of the velocities; infinite where that is 0.
    """

    axes: Array
    velocity: Array
    force: Array


def manipulability_ellipsoid(rows: ArrayLike) -> ManipulabilityEllipsoid:
    r"""Compute the ellipsoids of velocity and force from three rows of a Jacobian.

    .. math::

       \{ B \dot q : \|\dot q\| \le 1 \}, \qquad \{ f : \|B^T f\| \le 1 \}

    Where the first is long the point moves fast, and is held with little force.

    Parameters
    ----------
    rows : array_like, shape (3, n)
        B, the angular or the linear rows of a Jacobian.

    References
    ----------
    Yoshikawa, Manipulability of robotic mechanisms, Int. J. of Robotics Research 4(2), 1985.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.kinetostatics import jacobian, manipulability_ellipsoid
    >>> from robomech_ros.robots import chain_from_dh
    >>> arm = chain_from_dh(a=[2.0**0.5, 1.0], b=[0.0, 0.0], alpha=[0.0, 0.0])
    >>> found = manipulability_ellipsoid(jacobian(arm, [0.3, 0.75 * np.pi])[3:])
    >>> np.round(found.velocity, 6), np.round(found.force, 6)
    (array([1., 1., 0.]), array([ 1.,  1., inf]))
    """
    B = as_finite("rows", rows, ())
    if B.ndim != 2 or B.shape[0] != 3:
        raise WrongSizeError("rows", B.shape, "(3, n)")
    axes, values, _ = np.linalg.svd(B)
    velocity = np.zeros(3)
    velocity[: len(values)] = np.where(values > _ZERO * values.max(initial=0.0), values, 0.0)
    with np.errstate(divide="ignore"):
        force = 1.0 / velocity
    axes[:, 2] *= np.sign(np.linalg.det(axes))
    return ManipulabilityEllipsoid(axes, velocity, force)
