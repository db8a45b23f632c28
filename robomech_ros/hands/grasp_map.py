"""The grasp matrix and its internal forces."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robomech_ros.hands.contacts import Contact, as_contacts, as_origin, span
from robomech_ros.spatial.cross_product import cross_product_matrix
from robomech_ros.typing import Array, ArrayLike

# Singular values below this share of the largest are rounding.
_RANK = 1e-10


def grasp_matrix(contacts: Sequence[Contact], origin: ArrayLike) -> Array:
    r"""Compute the matrix that maps contact forces to the wrench on the object.

    .. math::

       w = G f, \qquad G_i = \begin{bmatrix} \mathrm{CPM}(p_i - o) \\ 1 \end{bmatrix}

    for a point contact.  A frictionless one has the column of its normal only, a soft finger a
    fourth column of the moment about its normal.

    Parameters
    ----------
    contacts : sequence of Contact
    origin : array_like, shape (3,) or (2,)
        o, the point that moments are about, in the frame of the contacts (m).

    Returns
    -------
    ndarray, shape (6, m) or (3, m)
        Moments first (m and 1), in the axes of the contacts.  Columns, contact by contact: of a
        frictionless contact 1, the force along the normal; of a point contact 3 (2 in the plane),
        the force along x, y, z; of a soft finger these and the moment about the normal.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 10.3.

    Examples
    --------
    >>> from robomech_ros.hands import Contact, grasp_matrix
    >>> grasp_matrix([Contact([0.0, 0.0, 1.0], [0.0, 0.0, -1.0], "point", 0.5)], [0.0, 0.0, 0.0])
    array([[ 0., -1.,  0.],
           [ 1.,  0.,  0.],
           [ 0.,  0.,  0.],
           [ 1.,  0.,  0.],
           [ 0.,  1.,  0.],
           [ 0.,  0.,  1.]])
    """
    given = as_contacts(contacts)
    point = as_origin(origin, given)
    return np.hstack([_columns(one, one.position - point) for one in given])


def _columns(contact: Contact, r: Array) -> Array:
    there = np.eye(3 if contact.planar else 6)
    if contact.planar:
        there[1:, 0] = -r[1], r[0]
    else:
        there[3:, :3] = cross_product_matrix(-r) + 0.0
    return transmitted(contact, there).T


def transmitted(contact: Contact, twists: Array) -> Array:
    """Return the components of twists (6, k), or (3, k) in the plane, that a contact hands on."""
    turns, moves = np.split(twists, [len(twists) // 2])
    if contact.model == "frictionless":
        return (contact.normal @ moves)[None]
    if contact.model == "soft":
        return np.concatenate([moves, (contact.normal @ turns)[None]])
    return moves


def internal_forces(contacts: Sequence[Contact]) -> Array:
    """Compute a basis of the contact forces that exert no wrench on the object.

    Parameters
    ----------
    contacts : sequence of Contact

    Returns
    -------
    ndarray, shape (m, s)
        Orthonormal columns, each in the components of :func:`grasp_matrix` (N, N m): the product of
        that matrix with them is 0.
    """
    given = as_contacts(contacts)
    origin = as_origin(None, given)
    length = span(given, origin)
    G = grasp_matrix(given, origin)
    G[: len(G) // 2] /= length
    return null_space(G)


def null_space(A: Array) -> Array:
    """Return orthonormal columns of the null space of a matrix, its rank by a relative bound."""
    _, s, Vt = np.linalg.svd(A)
    rank = int((s > _RANK * (s[0] if len(s) else 1.0)).sum())
    return np.ascontiguousarray(Vt[rank:].T)
