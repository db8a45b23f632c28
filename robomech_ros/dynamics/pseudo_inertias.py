"""Pseudo-inertias of bodies: matrices that are positive definite for every possible body.

With the ten parameters m, m c, and the moments xx, xy, xz, yy, yz, zz about the origin of
its frame, a body has ``[[Sigma, m c], [m c^T, m]]`` with second moments ``Sigma = tr(I)/2 - I``.

References
----------
Wensing, Kim, Slotine, Linear matrix inequalities for physically consistent inertial parameter
identification, IEEE Robotics and Automation Letters 3, 2018.
"""

from __future__ import annotations

import numpy as np

from robomech_ros.dynamics.checked_states import refuse_large
from robomech_ros.errors import BadValueError
from robomech_ros.robots.bodies import Body
from robomech_ros.spatial.arrays import as_finite, real_number
from robomech_ros.spatial.screws.bodies import inertia_of_point_mass
from robomech_ros.typing import Array, ArrayLike, BoolArray

# Products of parameters up to this do not overflow.
_LARGEST = 1e30
_UPPER = np.triu_indices(3)


def pseudo_inertia(parameters: ArrayLike) -> Array:
    """Form pseudo-inertias.

    Parameters
    ----------
    parameters : array_like, shape (..., 10)
        kg, kg m, kg m^2.

    Returns
    -------
    ndarray, shape (..., 4, 4)
        Symmetric.
    """
    p = _bounded("parameters", parameters, (10,))
    moments = np.empty((*p.shape[:-1], 3, 3))
    moments[..., _UPPER[0], _UPPER[1]] = moments[..., _UPPER[1], _UPPER[0]] = p[..., 4:]
    J = np.empty((*p.shape[:-1], 4, 4))
    half = 0.5 * np.trace(moments, axis1=-2, axis2=-1)
    J[..., :3, :3] = half[..., None, None] * np.eye(3) - moments
    J[..., :3, 3] = J[..., 3, :3] = p[..., 1:4]
    J[..., 3, 3] = p[..., 0]
    return J


def parameters_from_pseudo_inertia(J: ArrayLike) -> Array:
    """Invert :func:`pseudo_inertia`: (..., 4, 4) to (..., 10)."""
    matrix = _bounded("pseudo-inertia", J, (4, 4))
    second = matrix[..., :3, :3]
    trace = np.trace(second, axis1=-2, axis2=-1)
    moments = trace[..., None, None] * np.eye(3) - second
    parameters = np.empty((*matrix.shape[:-2], 10))
    parameters[..., 0] = matrix[..., 3, 3]
    parameters[..., 1:4] = matrix[..., :3, 3]
    parameters[..., 4:] = moments[..., _UPPER[0], _UPPER[1]]
    return parameters


def is_physically_consistent(parameters: ArrayLike) -> BoolArray:
    """Say which parameters (..., 10) a body of positive volume can have: shape (...)."""
    J = pseudo_inertia(parameters)
    least = np.linalg.eigvalsh(J)[..., 0]
    return np.asarray(least > 0.0)


def nearest_consistent(parameters: ArrayLike, *, least: float = 1e-6) -> Array:
    """Raise the eigenvalues of each pseudo-inertia that are too small.

    It is the nearest one by the Frobenius norm; how well the torques of a motion are met does not
    count here.

    Parameters
    ----------
    parameters : array_like, shape (..., 10)
        kg, kg m, kg m^2.
    least : float, optional
        Least eigenvalue of what is returned.

    Returns
    -------
    ndarray, shape (..., 10)
    """
    bound = real_number("least", least, "a positive number")
    if not 0.0 < bound <= _LARGEST:
        raise BadValueError("least", bound, f"a positive number, at most {_LARGEST:g}")
    values, vectors = np.linalg.eigh(pseudo_inertia(parameters))
    raised = vectors * np.maximum(values, bound)[..., None, :]
    return parameters_from_pseudo_inertia(raised @ np.swapaxes(vectors, -1, -2))


def bodies_from_parameters(parameters: ArrayLike) -> tuple[Body, ...]:
    """Make bodies of parameters, shape (n, 10), of positive mass."""
    rows = _bounded("parameters", parameters, (10,)).reshape(-1, 10)
    if not (rows[:, 0] > 0.0).all():
        raise BadValueError("masses", rows[:, 0].tolist(), "positive numbers")
    bodies = []
    for row in rows:
        com, moments = row[1:4] / row[0], np.empty((3, 3))
        moments[_UPPER] = moments[_UPPER[::-1]] = row[4:]
        shift = inertia_of_point_mass(row[0], com)
        bodies.append(Body(float(row[0]), com, moments - shift))
    return tuple(bodies)


def _bounded(what: str, value: ArrayLike, tail: tuple[int, ...]) -> Array:
    array = as_finite(what, value, tail)
    refuse_large(what, array)
    return array
