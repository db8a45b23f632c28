"""The smallest contact forces that hold a load, or the direction in which they cannot."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csc_matrix

from robomech_ros._kernels.tolerances import LARGEST_LENGTH
from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.hands.conic_solver import conic_solver
from robomech_ros.hands.contacts import Contact, as_contacts, as_origin, cones_of, span
from robomech_ros.spatial.arrays import as_choice, as_finite

__all__ = ["SMALLEST", "ContactForces", "ForceStatus", "contact_forces"]

Array = NDArray[np.float64]

SMALLEST = ("largest", "total")
# Of loads of size 1, and the equilibrium that is left after one correction.
_PRECISION = 1e-9
_BALANCED = 1e-9
# Cones are narrower by this part for the solver, so that what it leaves open lies within them.
_NARROWER = 2e-8
_MOST_LOAD = 1e12


class ForceStatus(Enum):
    """How the search for contact forces ended."""

    HELD = "held"
    NOT_HELD = "not held"
    NOT_CONVERGED = "not converged"


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
        Equilibrium to 1e-9 of the load.

    Raises
    ------
    ConicSolverUnavailableError
        The extra ``hands`` is not installed.
    BadValueError, WrongSizeError, NonFiniteError
        Not contacts of one kind, or no wrench of their size.

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
    load = as_finite("wrench", wrench, (d,))
    if load.shape != (d,):
        raise WrongSizeError("wrench", load.shape, (d,))
    if np.abs(load).max() > _MOST_LOAD:
        raise BadValueError("wrench", load.tolist(), f"numbers up to {_MOST_LOAD:g}")
    smallest = as_choice("smallest", smallest, SMALLEST)
    size = len(given[0].position)
    point = as_origin(np.zeros(size) if origin is None else origin, given)
    length = min(span(given, point), LARGEST_LENGTH)
    scaled = load.copy()
    scaled[: d // 2] /= length
    weight = float(np.linalg.norm(scaled))
    if weight == 0.0:
        zero = np.zeros((len(given), 4))
        return _result(given, zero, ForceStatus.HELD, None)
    cones = cones_of(given, point, length)
    y, status, direction = _solved(given, cones, -scaled / weight, smallest)
    if direction is not None:
        direction = direction.copy()
        direction[: d // 2] /= length
    return _result(given, y * weight, status, direction)


def _solved(
    contacts: Sequence[Contact], cones: Array, needed: Array, smallest: str
) -> tuple[Array, ForceStatus, Array | None]:
    """Solve for normal forces and bounded components y (k, 4) that exert the wrench needed."""
    library = conic_solver()
    columns, program = _program(library, contacts, cones, needed, smallest)
    P, q, A, b, kinds = program
    settings = library.DefaultSettings()
    settings.verbose = False
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = _PRECISION
    found = library.DefaultSolver(P, q, A, b, kinds, settings).solve()
    y = np.full((len(contacts), 4), np.nan)
    if found.status == library.SolverStatus.PrimalInfeasible:
        direction = -np.array(found.z[: len(needed)])
        return y, ForceStatus.NOT_HELD, direction / np.linalg.norm(direction)
    W = cones.reshape(-1, len(needed)).T[:, columns]
    x = np.array(found.x[: len(columns)])
    x -= np.linalg.lstsq(W, W @ x - needed, rcond=None)[0]
    if not float(np.abs(W @ x - needed).max()) < _BALANCED:
        return y, ForceStatus.NOT_CONVERGED, None
    y[:] = 0.0
    y.ravel()[columns] = x
    return y, ForceStatus.HELD, None


def _program(
    library: Any, contacts: Sequence[Contact], cones: Array, needed: Array, smallest: str
) -> tuple[NDArray[np.intp], tuple[Any, ...]]:
    """Write min q x with A x + s = b and s in cones; the last unknown bounds each force."""
    k, d = len(contacts), len(needed)
    used = np.array([_used(one) for one in contacts])
    columns = np.flatnonzero(used.ravel())
    place = np.full(4 * k, -1)
    place[columns] = np.arange(len(columns))
    m = len(columns)
    rows, kinds = [], [library.ZeroConeT(d)]
    for i, one in enumerate(contacts):
        own = place[4 * i : 4 * i + 4]
        own = own[own >= 0]
        block = np.zeros((len(own), m + 1))
        block[np.arange(len(own)), own] = -1.0
        block[0, own[0]] = _NARROWER - 1.0
        rows.append(block)
        kinds.append(library.SecondOrderConeT(len(own)))
        if smallest == "largest":
            tangents = 0 if one.model == "frictionless" else len(one.tangents)
            force = np.zeros((2 + tangents, m + 1))
            force[0, m] = -1.0
            force[1, own[0]] = -1.0
            for j in range(tangents if one.friction > 0.0 else 0):
                force[2 + j, own[1 + j]] = -one.friction
            rows.append(force)
            kinds.append(library.SecondOrderConeT(len(force)))
    balance = np.zeros((d, m + 1))
    balance[:, :m] = cones.reshape(4 * k, d).T[:, columns]
    A = np.vstack([balance, *rows])
    b = np.zeros(len(A))
    b[:d] = needed
    q = np.zeros(m + 1)
    if smallest == "largest":
        q[m] = 1.0
    else:
        q[place[4 * np.arange(k)]] = 1.0
        A, q = A[:, :m], q[:m]
    empty = csc_matrix((len(q), len(q)))
    return columns, (empty, q, csc_matrix(A), b, kinds)


def _used(contact: Contact) -> list[bool]:
    """Say which of the normal force, two tangential components and the torsion a contact has."""
    friction = contact.model != "frictionless" and contact.friction > 0.0
    soft = contact.model == "soft" and contact.torsional > 0.0
    return [True, friction, friction and not contact.planar, soft]


def _result(
    contacts: Sequence[Contact], y: Array, status: ForceStatus, direction: Array | None
) -> ContactForces:
    """Give forces (k, size) and components of normal forces and bounded parts y (k, 4)."""
    forces, torsions, components = [], [], []
    for one, (normal, *parts) in zip(contacts, y, strict=True):
        tangential = np.array(parts[: len(one.tangents)])
        force = normal * one.normal
        if one.model != "frictionless":
            force = force + one.friction * tangential @ one.tangents
        torsion = one.torsional * parts[2] if one.model == "soft" else 0.0
        forces.append(force)
        torsions.append(torsion)
        own = [normal] if one.model == "frictionless" else [*force]
        components.extend([*own, torsion] if one.model == "soft" else own)
    held = np.array(forces)
    largest = float(np.linalg.norm(held, axis=1).max())
    total = float(y[:, 0].sum())
    return ContactForces(
        held, np.array(torsions), np.array(components), status, direction, largest, total
    )
