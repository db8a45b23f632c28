"""Contacts of fingers with an object."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from robomech_ros._kernels.hands.force_closure import wrench_cones
from robomech_ros._kernels.tolerances import LARGEST_LENGTH
from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.spatial.arrays import (
    as_choice,
    as_finite,
    as_single,
    finite_within,
    listed,
    of_shape,
)
from robomech_ros.typing import Array, ArrayLike

MODELS = ("frictionless", "point", "soft")
# Below this a normal is none.
_NO_NORMAL = 1e-9
_MOST_FRICTION = 1e3
# More than any hand has; what is computed grows with the number.
_MOST_CONTACTS = 200


@dataclass(frozen=True, eq=False)
class Contact:
    """One contact of a finger with an object.

    Parameters
    ----------
    position : array_like, shape (3,) or (2,)
        Where it is (m); two coordinates make it one in the plane, where wrenches are the moment
        about z and the force along x and y.
    normal : array_like, shape (3,) or (2,)
        Inward: the direction in which the finger presses.  Any length above 1e-9.
    model : {"frictionless", "point", "soft"}, optional
        A normal force only; friction, too; or friction and a moment about the normal.
    friction : float, optional
        Largest tangential force as a share of the normal force.  A frictionless contact has none,
        whatever is given here.
    torsional : float, optional
        Largest moment about the normal of a soft finger, for a unit of normal force (m).  Friction
        and moment share the normal force as an ellipse.

    Raises
    ------
    BadValueError
        A normal of no length, a negative friction, an unknown model, a soft finger in the plane, or
        what are not two or three finite numbers.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 10.3.  Murray, Li and
    Sastry, A Mathematical Introduction to Robotic Manipulation, CRC Press 1994, ch. 5.

    Examples
    --------
    >>> from robomech_ros.hands import Contact
    >>> Contact([0.05, 0.0, 0.0], [-2.0, 0.0, 0.0], "point", 0.5).normal.tolist()
    [-1.0, 0.0, 0.0]
    """

    position: Array
    normal: Array
    model: str = "point"
    friction: float = 0.0
    torsional: float = 0.0

    def __post_init__(self) -> None:
        """Check everything."""
        position = as_finite("position of the contact", self.position, ())
        if position.shape not in ((2,), (3,)):
            shapes = "(3,), or (2,) in a plane"
            raise WrongSizeError("position of the contact", position.shape, shapes)
        check_coordinates("position of the contact", position)
        normal = as_finite("normal of the contact", self.normal, ())
        of_shape("normal of the contact", normal, position.shape)
        largest = float(np.abs(normal).max())
        if not largest > _NO_NORMAL:
            why = f"a direction into the object, of a length above {_NO_NORMAL:g}"
            raise BadValueError("normal of the contact", normal.tolist(), why)
        normal = normal / largest
        normal = normal / np.linalg.norm(normal)
        model = as_choice("model of the contact", self.model, MODELS)
        if model == "soft" and len(position) == 2:
            why = "frictionless or point: in the plane nothing turns about a normal"
            raise BadValueError("model of the contact", model, why)
        position = position.copy()
        for array in (position, normal):
            array.setflags(write=False)
        object.__setattr__(self, "position", position)
        object.__setattr__(self, "normal", normal)
        expected = f"a number from 0 to {_MOST_FRICTION:g}"
        for field in ("friction", "torsional"):
            what, value = f"{field} of the contact", getattr(self, field)
            value = finite_within(what, value, expected, 0.0, _MOST_FRICTION)
            object.__setattr__(self, field, value)

    @property
    def planar(self) -> bool:
        """True if it is a contact in the plane."""
        return len(self.position) == 2

    @property
    def size(self) -> int:
        """The number of its force components: columns of the grasp matrix."""
        if self.model == "frictionless":
            return 1
        return len(self.position) + (self.model == "soft")

    @cached_property
    def tangents(self) -> Array:
        """Unit vectors at right angles to the normal and each other, shape (2, 3) or (1, 2)."""
        n = self.normal.tolist()
        if self.planar:
            return np.array([[-n[1], n[0]]])
        k = min(range(3), key=lambda i: abs(n[i]))
        first = [-n[k] * x for x in n]
        first[k] += 1.0
        size = math.hypot(*first)
        first = [x / size for x in first]
        second = [
            n[1] * first[2] - n[2] * first[1],
            n[2] * first[0] - n[0] * first[2],
            n[0] * first[1] - n[1] * first[0],
        ]
        return np.array([first, second])

    @cached_property
    def row(self) -> tuple[float, ...]:
        """Its numbers as kernels take them."""
        flat = 0 if self.model == "frictionless" else self.friction
        torsional = self.torsional if self.model == "soft" else 0.0
        if not self.planar:
            along, across = self.tangents.tolist()
            place = (*self.position.tolist(), *self.normal.tolist())
            return (*place, *along, *across, flat, flat, torsional)
        (x, y), (nx, ny) = self.position.tolist(), self.normal.tolist()
        return (x, y, 0.0, nx, ny, 0.0, -ny, nx, 0.0, 0.0, 0.0, 0.0, flat, 0.0, 0.0)


def as_contacts(contacts: Sequence[Contact]) -> tuple[Contact, ...]:
    """Check a list of contacts: one at least, all in space or all in the plane."""
    found = listed("contacts", contacts, "a list of contacts")
    for k, one in enumerate(found):
        if not isinstance(one, Contact):
            raise BadValueError(f"contacts[{k}]", one, "a Contact")
    if not 1 <= len(found) <= _MOST_CONTACTS:
        raise WrongSizeError("contacts", len(found), f"1 to {_MOST_CONTACTS}")
    planes = {len(one.position) for one in found}
    if len(planes) > 1:
        raise BadValueError("contacts", "some in space, some in the plane", "all of one kind")
    return found


def as_origin(origin: ArrayLike | None, contacts: Sequence[Contact]) -> Array:
    """Check the point that moments are about; None is the centre of the contacts."""
    if origin is None:
        return centre(contacts)
    size = len(contacts[0].position)
    array = as_single("origin", origin, (size,))
    check_coordinates("origin", array)
    return array


def check_coordinates(what: str, places: Array) -> None:
    """Refuse places that are too far away."""
    if np.abs(places).max() > LARGEST_LENGTH:
        raise BadValueError(what, places.tolist(), f"coordinates up to {LARGEST_LENGTH:g} m")


def centre(contacts: Sequence[Contact]) -> Array:
    """Return the mean of the positions of contacts (m)."""
    return np.asarray(np.mean([one.position for one in contacts], axis=0), np.float64)


def span(contacts: Sequence[Contact], origin: Array) -> float:
    """Return the distance of the farthest contact from a point (m), 1 where all are in it."""
    middle = origin.tolist()
    farthest = max(math.dist(one.position.tolist(), middle) for one in contacts)
    return farthest if farthest > 0.0 else 1.0


def rows_of(contacts: Sequence[Contact]) -> Array:
    """Return contacts as kernels take them, shape (k, 15)."""
    return np.array([one.row for one in contacts])


def cones_of(rows: Array, origin: Array, length: float) -> Array:
    """Return the wrenches (k, 4, d) of a unit normal force and of its friction and torsion.

    Rows (k, 15) are those of :func:`rows_of`.  Moments are about the origin, in units of the
    length, and come first; d is 6, or 3 in the plane.  Contact i exerts ``n cones[i, 0] + y @
    cones[i, 1:]`` with ``|y| <= n``.
    """
    planar = len(origin) == 2
    cones = np.empty((len(rows), 4, 3 if planar else 6))
    point = np.zeros(3)
    point[: len(origin)] = origin
    wrench_cones(rows, point, length, planar, cones)
    return cones
