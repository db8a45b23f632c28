"""The smallest contact forces that hold a load, or the direction in which they cannot."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from robomech_ros.errors import BadValueError
from robomech_ros.hands.contacts import (
    Contact,
    as_contacts,
    as_origin,
    centre,
    cones_of,
    rows_of,
    span,
)
from robomech_ros.hands.force_search import ForceStatus as ForceStatus, search
from robomech_ros.spatial.arrays import as_choice, as_single
from robomech_ros.typing import Array, ArrayLike

SMALLEST = ("largest", "total")
_MOST_LOAD = 1e12
# Components of contacts among the normal force, the force along x, y, z, and the torsion.
_EXERTED = {
    "frictionless": (True, False, False, False, False),
    "point": (False, True, True, True, False),
    "soft": (False, True, True, True, True),
}


@dataclass(frozen=True, eq=False)
class ContactForces:
    """Contact forces that balance a load.

    Parameters
    ----------
    forces : ndarray, shape (k, 3) or (k, 2)
        Force of each finger on the object (N), in the axes of the contacts; NaN unless held.
    torsions : ndarray, shape (k,)
        Moment of each finger about its normal (N m).
    components : ndarray, shape (m,)
        The same in the components of :func:`grasp_matrix`: its product with the matrix is minus the
        load.
    status : ForceStatus
    separating_wrench : ndarray, shape (6,) or (3,), or None
        Where the load cannot be held: a direction s of wrench space, moments first, with s . w <= 0
        for every wrench w of the contacts and s . load < 0, so that s . w > 0 would be needed.  Its
        length is 1 with the moments times the distance of the farthest contact from the origin.
        For unit normal forces s . w may be above 0 by rounding, and by 1e-6 of what the load needs
        at the most: no forces a million times the load hold it.
    largest, total : float
        The greatest force of a contact and the sum of the normal forces (N); NaN unless held.
    """

    forces: Array
    torsions: Array
    components: Array
    status: ForceStatus
    separating_wrench: Array | None
    largest: float
    total: float


def contact_forces(
    contacts: Sequence[Contact],
    wrench: ArrayLike,
    *,
    origin: ArrayLike | None = None,
    smallest: str = "largest",
) -> ContactForces:
    """Compute the smallest contact forces inside the friction cones that balance a load.

    Parameters
    ----------
    contacts : sequence of Contact
    wrench : array_like, shape (6,) or (3,)
        What acts on the object besides the fingers, such as its weight: moment about the origin
        (N m), then force (N), in the axes of the contacts.
    origin : array_like, shape (3,) or (2,), optional
        The point that the moment is about (m); default the origin of the frame.
    smallest : {"largest", "total"}, optional
        What is made as small as can be: the greatest force of a contact, or the sum of the normal
        forces.

    Returns
    -------
    ContactForces
        Equilibrium to 1e-9 of the load, forces inside the cones to 1e-9 of load or forces.  The
        status is not converged at most for loads within 1e-7 of the border of what is held.

    Raises
    ------
    ConicSolverUnavailableError
        The extra ``hands`` is not installed.

    References
    ----------
    Boyd and Wegbreit, Fast Computation of Optimal Contact Forces, IEEE Trans. Robotics 23, 2007.
    Goulart and Chen, Clarabel: An interior-point solver for conic programs, arXiv:2405.12762.

    Examples
    --------
    >>> from robomech_ros.hands import Contact, contact_forces
    >>> pair = [Contact([x, 0.0, 0.0], [-x, 0.0, 0.0], "soft", 0.5, 0.01) for x in (1.0, -1.0)]
    >>> found = contact_forces(pair, [0.0, 0.0, 0.0, 0.0, 0.0, -1.0])
    >>> found.status.value, round(found.total, 6)
    ('held', 2.0)
    """
    given = as_contacts(contacts)
    d = 3 if given[0].planar else 6
    load = as_single("wrench", wrench, (d,))
    if np.abs(load).max() > _MOST_LOAD:
        raise BadValueError("wrench", load.tolist(), f"numbers up to {_MOST_LOAD:g}")
    smallest = as_choice("smallest", smallest, SMALLEST)
    size = len(given[0].position)
    point = as_origin(np.zeros(size) if origin is None else origin, given)
    # About the centre of the contacts: from an origin far away moments say little.
    middle = centre(given)
    length = span(given, middle)
    scaled = load.copy()
    scaled[: d // 2] += _moment((point - middle).tolist(), load[d // 2 :].tolist())
    scaled[: d // 2] /= length
    weight = math.hypot(*scaled)
    rows = rows_of(given)
    if weight == 0.0:
        return _result(given, rows, np.zeros((len(given), 4)), ForceStatus.HELD, None)
    cones = cones_of(rows, middle, length)
    y, status, direction = search(rows, cones, -scaled / weight, smallest)
    if direction is not None:
        direction[: d // 2] /= length
        direction[d // 2 :] += _along(direction[: d // 2].tolist(), (point - middle).tolist())
        reach = span(given, point)
        direction /= math.hypot(*(reach * direction[: d // 2]), *direction[d // 2 :])
    return _result(given, rows, y * weight, status, direction)


def _cross(a: list[float], b: list[float]) -> list[float]:
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def _moment(r: list[float], f: list[float]) -> list[float]:
    """Return r x f, in the plane about z."""
    return _cross(r, f) if len(r) == 3 else [r[0] * f[1] - r[1] * f[0]]


def _along(n: list[float], r: list[float]) -> list[float]:
    """Return n x r, in the plane with n along z."""
    return _cross(n, r) if len(r) == 3 else [-n[0] * r[1], n[0] * r[0]]


def _result(
    contacts: Sequence[Contact], rows: Array, y: Array, status: ForceStatus, direction: Array | None
) -> ContactForces:
    """Return forces (k, size) and components of normal forces and bounded parts y (k, 4)."""
    size = len(contacts[0].position)
    normal, scaled = y[:, 0], y[:, 1:] * rows[:, 12:]
    parts = np.empty((len(rows), 5))
    parts[:, 0], parts[:, 4] = normal, scaled[:, 2]
    parts[:, 1:4] = normal[:, None] * rows[:, 3:6]
    parts[:, 1:4] += scaled[:, :1] * rows[:, 6:9] + scaled[:, 1:2] * rows[:, 9:12]
    exerted = np.array([_EXERTED[one.model] for one in contacts])
    exerted[:, 1 + size : 4] = False
    forces = parts[:, 1 : 1 + size].copy()
    largest = math.sqrt((forces * forces).sum(axis=1).max())
    return ContactForces(
        forces, scaled[:, 2], parts[exerted], status, direction, largest, float(normal.sum())
    )
