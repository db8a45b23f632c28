"""Mass, momentum and the equations of motion of a rigid body."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from robomech_ros.errors import BadValueError
from robomech_ros.spatial.arrays import as_finite
from robomech_ros.spatial.cross_product import cross, cross_product_matrix
from robomech_ros.spatial.rows import common_shape, finite_result
from robomech_ros.typing import Array, ArrayLike

# Largest difference of an inertia matrix from its transpose, over its largest entry, that is taken
# for rounding: six digits.
_ASYMMETRY = 1e-5


class PrincipalInertia(NamedTuple):
    """Principal moments and axes of inertia.

    Attributes
    ----------
    moments : ndarray, shape (..., 3)
        In increasing order (kg m^2).
    axes : ndarray, shape (..., 3, 3)
        The rotation with the principal axes as columns; those of equal moments are arbitrary in
        their plane or space.
    """

    moments: Array
    axes: Array


def principal_inertia(inertia: ArrayLike) -> PrincipalInertia:
    r"""Find the principal moments and axes: :math:`I = R \,\mathrm{diag}(I_1, I_2, I_3)\, R^T`.

    Parameters
    ----------
    inertia : array_like, shape (..., 3, 3)
        About any point, in any axes (kg m^2).

    Returns
    -------
    PrincipalInertia
        The axes are expressed in the axes of ``inertia``.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 3.8.

    Examples
    --------
    >>> from robomech_ros.spatial import principal_inertia
    >>> principal_inertia([[2.0, 1.0, 0.0], [1.0, 2.0, 0.0], [0.0, 0.0, 4.0]]).moments.round(9)
    array([1., 3., 4.])
    """
    own = _inertia(inertia)
    # Scaled, so that no square overflows or vanishes.
    scale = np.abs(own).max(axis=(-1, -2), keepdims=True, initial=0.0)
    scale = np.where(scale > 0.0, scale, 1.0)
    part = own / scale
    moments, axes = np.linalg.eigh(0.5 * (part + np.swapaxes(part, -1, -2)))
    axes[..., 0] *= np.linalg.det(axes)[..., None]
    with np.errstate(over="ignore"):
        found = moments * scale[..., 0]
    return PrincipalInertia(finite_result("inertia", found, own), axes)


def radii_of_gyration(mass: ArrayLike, inertia: ArrayLike) -> Array:
    r"""Compute the radii of gyration about the principal axes: :math:`k_i = \sqrt{I_i / m}`.

    Parameters
    ----------
    mass : array_like, shape (...)
        kg, positive.
    inertia : array_like, shape (..., 3, 3)
        As for :func:`principal_inertia`; its principal moments are not negative (kg m^2).

    Returns
    -------
    ndarray, shape (..., 3)
        In the increasing order of the principal moments (m).

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 3.8.
    """
    m, moments = as_finite("mass", mass, ()), principal_inertia(inertia).moments
    if (m <= 0.0).any():
        raise BadValueError("mass", float(m.min()), "more than 0 kg")
    common_shape("mass and inertia", m.shape, moments.shape[:-1])
    if (moments[..., 0] < -_ASYMMETRY * moments[..., 2]).any():
        least = float(moments[..., 0].min())
        raise BadValueError("principal moment of inertia", least, "at least 0 kg m^2")
    # Roots first: their quotient does not overflow.
    radii: Array = np.sqrt(np.maximum(moments, 0.0)) / np.sqrt(m[..., None])
    return radii


def inertia_of_point_mass(mass: ArrayLike, position: ArrayLike) -> Array:
    """Form the inertia ``m (|r|^2 1 - r r^T)`` of a point mass about the origin.

    Parameters
    ----------
    mass : array_like, shape (...)
        kg, not negative.
    position : array_like, shape (..., 3)
        r in m.

    Returns
    -------
    ndarray, shape (..., 3, 3)
        In kg m^2.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 3.8.
    """
    m, r = _mass(mass), as_finite("position", position, (3,))
    common_shape("mass and position", m.shape, r.shape[:-1])
    with np.errstate(over="ignore", invalid="ignore"):
        square = np.sum(r * r, axis=-1)[..., None, None]
        spread = square * np.eye(3) - r[..., :, None] * r[..., None, :]
        inertia: Array = m[..., None, None] * spread
    return finite_result("position", inertia, r)


def inertia_about_point(
    mass: ArrayLike, inertia: ArrayLike, center: ArrayLike, point: ArrayLike
) -> Array:
    r"""Return the inertia of a body about any point, from that about its mass centre.

    .. math:: I_A = I_C + m (|r|^2 1 - r r^T), \qquad r = c - a

    Parameters
    ----------
    mass : array_like, shape (...)
        kg.
    inertia : array_like, shape (..., 3, 3)
        About the mass centre c (kg m^2).
    center, point : array_like, shape (..., 3)
        Mass centre c, and a (m), in the axes of the inertia.

    Returns
    -------
    ndarray, shape (..., 3, 3)
        In the same axes (kg m^2).

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 3.8.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.spatial import inertia_about_point
    >>> inertia_about_point(2.0, np.zeros((3, 3)), [0.5, 0.0, 0.0], [0.0, 0.0, 0.0]).diagonal()
    array([0. , 0.5, 0.5])
    """
    own = _inertia(inertia)
    c, a = as_finite("center", center, (3,)), as_finite("point", point, (3,))
    shape = common_shape("center and point", c.shape[:-1], a.shape[:-1])
    common_shape("inertia and points", own.shape[:-2], shape)
    with np.errstate(over="ignore"):
        r = finite_result("center and point", c - a, c)
        total: Array = own + inertia_of_point_mass(mass, r)
    return finite_result("inertia", total, own)


def inertia_dyad(mass: ArrayLike, inertia: ArrayLike) -> Array:
    """Form M = diag(I, m 1), which takes a twist at the mass centre to its momentum screw.

    Parameters
    ----------
    mass : array_like, shape (...)
        kg.
    inertia : array_like, shape (..., 3, 3)
        About the mass centre (kg m^2).

    Returns
    -------
    ndarray, shape (..., 6, 6)

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 3.8.
    """
    m, own = _mass(mass), _inertia(inertia)
    M = np.zeros((*common_shape("mass and inertia", m.shape, own.shape[:-2]), 6, 6))
    M[..., :3, :3] = own
    M[..., 3:, 3:] = m[..., None, None] * np.eye(3)
    return M


def angular_velocity_dyad(angular_velocity: ArrayLike) -> Array:
    """Form W = diag(CPM(omega), 0) of the equation of motion ``M t' + W M t = w``.

    Parameters
    ----------
    angular_velocity : array_like, shape (..., 3)
        rad/s.

    Returns
    -------
    ndarray, shape (..., 6, 6)

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 3.8.
    """
    turn = cross_product_matrix(angular_velocity)
    W = np.zeros((*turn.shape[:-2], 6, 6))
    W[..., :3, :3] = turn
    return W


def momentum_screw(mass: ArrayLike, inertia: ArrayLike, twist: ArrayLike) -> Array:
    """Compute the momentum screw ``M t`` of a body.

    Parameters
    ----------
    mass : array_like, shape (...)
        kg.
    inertia : array_like, shape (..., 3, 3)
        About the mass centre (kg m^2).
    twist : array_like, shape (..., 6)
        Angular velocity (rad/s), then velocity of the mass centre (m/s).

    Returns
    -------
    ndarray, shape (..., 6)
        Angular momentum about the mass centre (kg m^2/s), then momentum (kg m/s).

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 3.8.
    """
    return _momentum(_mass(mass), _inertia(inertia), "twist", twist)


def twist_kinetic_energy(mass: ArrayLike, inertia: ArrayLike, twist: ArrayLike) -> Array:
    """Compute the kinetic energy ``t^T M t / 2`` of a body.

    Parameters
    ----------
    mass, inertia, twist
        As for :func:`momentum_screw`.

    Returns
    -------
    ndarray, shape (...)
        In J.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 3.8.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.spatial import twist_kinetic_energy
    >>> float(twist_kinetic_energy(2.0, 0.1 * np.eye(3), [0.0, 0.0, 1.0, 3.0, 0.0, 0.0]))
    9.05
    """
    t = as_finite("twist", twist, (6,))
    momentum = momentum_screw(mass, inertia, t)
    with np.errstate(over="ignore", invalid="ignore"):
        energy: Array = 0.5 * np.sum(t * momentum, axis=-1)
    return finite_result("twist", energy, t)


def newton_euler_wrench(
    mass: ArrayLike, inertia: ArrayLike, twist: ArrayLike, twist_rate: ArrayLike
) -> Array:
    r"""Compute the wrench that moves a body, by the Newton-Euler equations.

    .. math::

       w = M \dot t + W M t: \qquad n_C = I \dot \omega + \omega \times I \omega,
       \quad f = m \ddot c

    Parameters
    ----------
    mass, inertia, twist
        As for :func:`momentum_screw`.
    twist_rate : array_like, shape (..., 6)
        Angular acceleration (rad/s^2), then acceleration of the mass centre (m/s^2).

    Returns
    -------
    ndarray, shape (..., 6)
        Moment about the mass centre (N m), then force (N), of all that acts on the body.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 3.8.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.spatial import newton_euler_wrench
    >>> spin = [1.0, 0.0, 2.0, 0.0, 0.0, 0.0]
    >>> newton_euler_wrench(1.0, np.diag([1.0, 2.0, 3.0]), spin, np.zeros(6))
    array([ 0., -4.,  0.,  0.,  0.,  0.])
    """
    m, own = _mass(mass), _inertia(inertia)
    t = as_finite("twist", twist, (6,))
    momentum = _momentum(m, own, "twist", t)
    wrench = _momentum(m, own, "twist_rate", twist_rate)
    shape = common_shape("twist and twist_rate", momentum.shape[:-1], wrench.shape[:-1])
    wrench = np.array(np.broadcast_to(wrench, (*shape, 6)))
    with np.errstate(over="ignore", invalid="ignore"):
        wrench[..., :3] += cross(t[..., :3], momentum[..., :3])
    return finite_result("twist", wrench, t)


def _momentum(m: Array, own: Array, what: str, value: ArrayLike) -> Array:
    six = as_finite(what, value, (6,))
    shape = common_shape(f"mass, inertia and {what}", m.shape, own.shape[:-2], six.shape[:-1])
    out = np.empty((*shape, 6))
    with np.errstate(over="ignore", invalid="ignore"):
        out[..., :3] = (own @ six[..., :3, None])[..., 0]
        out[..., 3:] = m[..., None] * six[..., 3:]
    return finite_result(f"mass, inertia and {what}", out, six)


def _mass(mass: ArrayLike) -> Array:
    m = as_finite("mass", mass, ())
    if (m < 0.0).any():
        raise BadValueError("mass", float(m.min()), "at least 0")
    return m


def _inertia(inertia: ArrayLike) -> Array:
    own = as_finite("inertia", inertia, (3, 3))
    largest = np.abs(own).max(initial=0.0, axis=(-1, -2))
    with np.errstate(over="ignore"):
        off = np.abs(own - np.swapaxes(own, -1, -2)).max(initial=0.0, axis=(-1, -2))
    if (off > _ASYMMETRY * largest).any():
        raise BadValueError("inertia", own.tolist(), "a symmetric matrix")
    return own
