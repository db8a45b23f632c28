"""Object motion by the fingers of a hand, and torques of contact forces."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from robomech_ros.errors import BadValueError
from robomech_ros.hands.contacts import Contact, as_contacts, as_origin, centre
from robomech_ros.hands.grasp_map import grasp_matrix, null_space, transmitted
from robomech_ros.hands.hand import Hand, fingers_of, hand_posture
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.kinetostatics import bias_acceleration, jacobian, point_jacobian
from robomech_ros.spatial.arrays import as_single
from robomech_ros.typing import Array, ArrayLike

# Squares of more have no digits left.
_FASTEST = 1e9


@dataclass(frozen=True, eq=False)
class GraspMobility:
    """Mobility and internal forces of a grasp.

    Parameters
    ----------
    mobility : int
        Independent motions of object and fingers together that keep all contacts.
    object_twists : ndarray, shape (6, a)
        Orthonormal basis of the twists, about the centre of the contacts, that the object takes in
        them (rad/s and m/s).
    loose_twists : ndarray, shape (6, b)
        Those with all joints locked.
    idle_rates : ndarray, shape (n, c)
        Joint rates that leave all contacts and the object at rest.
    internal_forces : ndarray, shape (m, s)
        Orthonormal basis of contact forces without a wrench (see :func:`internal_forces`).
    rigid_forces : ndarray, shape (m, r)
        Those of them that need no torque, which the structure of the hand bears.
    """

    mobility: int
    object_twists: Array
    loose_twists: Array
    idle_rates: Array
    internal_forces: Array
    rigid_forces: Array


def hand_jacobian(
    hand: Hand, q: ArrayLike, contacts: Sequence[Contact], *, fingers: Sequence[int] | None = None
) -> Array:
    r"""Compute the matrix that maps joint rates to velocities at the contacts.

    .. math:: G^T t = J \dot q

    while all contacts hold: t is the twist of the object, G the grasp matrix about the same point.

    Parameters
    ----------
    hand : Hand
        Hand of n joints.
    q : array_like, shape (n,)
        Joint values, finger by finger (rad or m).
    contacts : sequence of Contact
        In the frame of the palm; each is taken as a point of the last link of its finger.
    fingers : sequence of int, optional
        The number of the finger of each contact; default one after the other.

    Returns
    -------
    ndarray, shape (m, n)
        Rows in the order of the columns of :func:`grasp_matrix` (m, or 1 for turning about the
        normal of a soft finger).

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 10.3.  Murray, Li and
    Sastry, A Mathematical Introduction to Robotic Manipulation, CRC Press 1994, section 5.5.
    """
    given, owners = fingers_of(hand, contacts, fingers)
    parts = hand.split(q)
    starts = np.cumsum([0, *(one.n for one in hand.fingers)])
    rows = []
    for contact, k in zip(given, owners, strict=True):
        whole = point_jacobian(hand.fingers[k], parts[k], _point(hand, k, parts[k], contact))
        block = np.zeros((contact.size, hand.n))
        block[:, starts[k] : starts[k + 1]] = transmitted(contact, whole)
        rows.append(block)
    return np.vstack(rows)


def _point(hand: Hand, k: int, q: Array, contact: Contact) -> Array:
    """Return a contact in the frame of the last link of a finger."""
    T = forward_kinematics(hand.fingers[k], q)
    return T[:3, :3].T @ (contact.position - T[:3, 3])


def grasp_mobility(
    hand: Hand, q: ArrayLike, contacts: Sequence[Contact], *, fingers: Sequence[int] | None = None
) -> GraspMobility:
    """Compute what moves, and what internal forces there are, while all contacts hold.

    Parameters
    ----------
    hand, q, contacts, fingers
        As for :func:`hand_jacobian`.

    References
    ----------
    Prattichizzo and Trinkle, Grasping, in: Springer Handbook of Robotics, 2nd ed. 2016, section
    38.3.
    """
    contacts = as_contacts(contacts)
    J = hand_jacobian(hand, q, contacts, fingers=fingers)
    G = grasp_matrix(contacts, centre(contacts))
    together = null_space(np.hstack([G.T, -J]))
    moved, s, _ = np.linalg.svd(together[:6], full_matrices=False)
    inner = null_space(G)
    rigid = inner @ null_space(J.T @ inner) if inner.shape[1] else inner
    return GraspMobility(
        together.shape[1], moved[:, s > 1e-9], null_space(G.T), null_space(J), inner, rigid
    )


def finger_rates(
    hand: Hand,
    q: ArrayLike,
    contacts: Sequence[Contact],
    twist: ArrayLike,
    *,
    origin: ArrayLike | None = None,
    fingers: Sequence[int] | None = None,
) -> tuple[Array, float]:
    """Compute the joint rates that give the object a twist, all contacts kept.

    Parameters
    ----------
    hand, q, contacts, fingers
        As for :func:`hand_jacobian`.
    twist : array_like, shape (6,)
        Angular velocity (rad/s) and velocity of the origin (m/s).
    origin : array_like, shape (3,), optional
        A point of the object, in the frame of the palm (m); default that frame's origin.

    Returns
    -------
    rates : ndarray, shape (n,)
        Rates of least norm where several do (rad/s or m/s).
    slip : float
        What is left of the velocity at the contacts (m/s): 0 where the fingers can follow.
    """
    contacts = as_contacts(contacts)
    J, t = hand_jacobian(hand, q, contacts, fingers=fingers), _six("twist", twist)
    G = grasp_matrix(contacts, np.zeros(3) if origin is None else origin)
    return _least_squares(J, G.T @ t)


def object_twist(
    hand: Hand,
    q: ArrayLike,
    contacts: Sequence[Contact],
    rates: ArrayLike,
    *,
    origin: ArrayLike | None = None,
    fingers: Sequence[int] | None = None,
) -> tuple[Array, float]:
    """Compute the twist that joint rates give the object, all contacts kept.

    Parameters
    ----------
    hand, q, contacts, fingers, origin
        As for :func:`finger_rates`.
    rates : array_like, shape (n,)
        Joint rates (rad/s or m/s).

    Returns
    -------
    twist : ndarray, shape (6,)
        Angular first, of the origin (rad/s and m/s); of least norm where the contacts leave it
        free.
    slip : float
        What is left of the velocity at the contacts (m/s): 0 where the rates agree.
    """
    contacts = as_contacts(contacts)
    J = hand_jacobian(hand, q, contacts, fingers=fingers)
    G = grasp_matrix(contacts, np.zeros(3) if origin is None else origin)
    return _least_squares(G.T, J @ hand_posture(hand, rates, "rates"))


def finger_accelerations(
    hand: Hand,
    q: ArrayLike,
    rates: ArrayLike,
    contacts: Sequence[Contact],
    twist: ArrayLike,
    twist_rate: ArrayLike,
    *,
    origin: ArrayLike | None = None,
    fingers: Sequence[int] | None = None,
) -> tuple[Array, float]:
    r"""Compute the joint accelerations that go with the acceleration of the object.

    Points of object and finger that touch stay together, :math:`\dot v + \dot\omega \times r +
    \omega \times (\omega \times r) = J \ddot q + \dot J \dot q`, and soft fingers turn about the
    normal of the object as it does.

    Parameters
    ----------
    hand, q, contacts, fingers, origin
        As for :func:`finger_rates`; contacts with friction.
    rates : array_like, shape (n,)
        Joint rates (rad/s or m/s).
    twist, twist_rate : array_like, shape (6,)
        Of the object, angular first (rad/s, m/s), and its time derivative.

    Returns
    -------
    accelerations : ndarray, shape (n,)
        Accelerations of least norm where several do (rad/s^2 or m/s^2).
    slip : float
        What is left of the acceleration at the contacts (m/s^2).

    Raises
    ------
    BadValueError, WrongSizeError
        As for :func:`finger_rates`; a frictionless contact slides, and how it accelerates depends
        on how the surfaces are curved.
    """
    given, owners = fingers_of(hand, contacts, fingers)
    for one in given:
        if one.model == "frictionless":
            raise BadValueError("model of the contact", one.model, "point or soft")
    t, td = _six("twist", twist), _six("twist_rate", twist_rate)
    point = as_origin(np.zeros(3) if origin is None else origin, given)
    parts, speeds = hand.split(q), hand.split(hand_posture(hand, rates, "rates"))
    w = t[:3]
    wanted = []
    for contact, k in zip(given, owners, strict=True):
        r = contact.position - point
        here = _point(hand, k, parts[k], contact)
        bias = bias_acceleration(hand.fingers[k], parts[k], speeds[k], point=here)
        turned = jacobian(hand.fingers[k], parts[k])[:3] @ speeds[k]
        moved = td[3:] + np.cross(td[:3], r) + np.cross(w, np.cross(w, r))
        wanted.append(moved - bias[3:])
        if contact.model == "soft":
            normal_rate = np.cross(w, contact.normal)
            turning = contact.normal @ (td[:3] - bias[:3]) + normal_rate @ (w - turned)
            wanted.append(np.array([turning]))
    J = hand_jacobian(hand, q, given, fingers=fingers)
    return _least_squares(J, np.concatenate(wanted))


def finger_torques(
    hand: Hand,
    q: ArrayLike,
    contacts: Sequence[Contact],
    components: ArrayLike,
    *,
    fingers: Sequence[int] | None = None,
) -> Array:
    r"""Compute the joint torques that make the fingers exert contact forces, at rest.

    .. math:: \tau = J^T f

    Parameters
    ----------
    hand, q, contacts, fingers
        As for :func:`hand_jacobian`.
    components : array_like, shape (m,)
        f, in the components of :func:`grasp_matrix`, such as ``components`` of
        :class:`ContactForces` (N, N m).

    Returns
    -------
    ndarray, shape (n,)
        N m or N.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 10.3.
    """
    J = hand_jacobian(hand, q, contacts, fingers=fingers)
    return J.T @ as_single("components", components, (len(J),))


def _six(what: str, value: ArrayLike) -> Array:
    array = as_single(what, value, (6,))
    if np.abs(array).max() > _FASTEST:
        raise BadValueError(what, array.tolist(), f"numbers up to {_FASTEST:g}")
    return array


def _least_squares(A: Array, b: Array) -> tuple[Array, float]:
    x = np.asarray(np.linalg.lstsq(A, b, rcond=1e-10)[0], np.float64)
    return x, float(np.linalg.norm(A @ x - b))
