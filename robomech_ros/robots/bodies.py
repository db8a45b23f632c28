"""Rigid bodies: mass, centre of mass and inertia, what bodies can have, and those of a chain."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from robomech_ros._kernels.tolerances import LARGEST_LENGTH
from robomech_ros.errors import BadValueError, MissingInertiaError, WrongSizeError
from robomech_ros.robots.chain_layout import PRISMATIC, joint_transform, unpack_chain
from robomech_ros.spatial.arrays import check_finite, listed, real_array
from robomech_ros.spatial.screws.bodies import inertia_of_point_mass
from robomech_ros.typing import Array

# Largest mass (kg) and moment of inertia (kg m^2) of a body.
LARGEST_INERTIA = 1e12
# Part of the greatest principal moment by which published moments, rounded to three digits, may
# miss what a body can have.
INERTIA_ROUNDING = 2e-3


# Shape and largest magnitude of the numbers.
_FIELDS: dict[str, tuple[tuple[int, ...], float]] = {
    "mass": ((), LARGEST_INERTIA),
    "com": ((3,), LARGEST_LENGTH),
    "inertia": ((3, 3), LARGEST_INERTIA),
}


@dataclass(frozen=True, eq=False)
class Body:
    """A rigid body, seen in a frame that is fixed to it.

    Numbers that no body can have are kept as they are: what needs them asks :meth:`fault`, what
    does not goes on without.

    Parameters
    ----------
    mass : float
        kg.
    com : array_like, shape (3,)
        Centre of mass (m).
    inertia : array_like, shape (3, 3)
        Moments of inertia about the centre of mass, in the axes of the frame (kg m^2).
    as_measured : bool, optional
        The moments are those of a measurement, kept although the greatest principal moment is
        above the sum of the others.
    """

    mass: float
    com: Array
    inertia: Array
    as_measured: bool = False

    def __post_init__(self) -> None:
        for field, (shape, largest) in _FIELDS.items():
            array = real_array(field, getattr(self, field))
            if array.shape != shape:
                raise WrongSizeError(field, array.shape, shape)
            check_finite(field, array)
            if np.abs(array).max() > largest:
                raise BadValueError(field, array.tolist(), f"magnitudes of at most {largest:g}")
            array.setflags(write=False)
            object.__setattr__(self, field, array if shape else float(array))
        if np.abs(self.inertia - self.inertia.T).max() > 1e-9 * np.abs(self.inertia).max():
            raise BadValueError("inertia", self.inertia.tolist(), "a symmetric matrix")

    def fault(self) -> str:
        """Say why no body has these numbers; empty where one has.

        The mass and the principal moments are positive, and none of the moments is above the sum
        of the two others, except for rounding of published numbers.  A point has a mass and no
        moments.
        """
        if self.mass <= 0.0:
            return f"its mass is {self.mass:g} kg, expected a positive number"
        moments = np.linalg.eigvalsh(self.inertia)
        slack = INERTIA_ROUNDING * moments[2]
        shown = ", ".join(f"{moment:.6g}" for moment in moments)
        if moments[0] < -slack or moments[2] < 0.0:
            return f"its principal moments of inertia are {shown} kg m^2, expected no negative one"
        if moments[2] > moments[0] + moments[1] + slack and not self.as_measured:
            return (
                f"its principal moments of inertia are {shown} kg m^2, expected the greatest to be "
                "at most the sum of the others"
            )
        return ""

    def expressed_in(self, T: Array) -> Body:
        """Return the same body in the frame in which T, shape (4, 4), is the pose of its own."""
        R = T[:3, :3]
        inertia = R @ self.inertia @ R.T
        com = R @ self.com + T[:3, 3]
        return Body(self.mass, com, 0.5 * (inertia + inertia.T), self.as_measured)


def possible_body(what: str, body: object) -> Body:
    """Return a body, unless no body can have its numbers."""
    if not isinstance(body, Body):
        raise BadValueError(what, body, "a Body")
    if fault := body.fault():
        raise BadValueError(what, f"{body.mass:g} kg", f"a possible body; {fault}")
    return body


def combine_bodies(bodies: Iterable[Body]) -> Body | None:
    """Make one body of several that are fixed to each other, all seen in one frame.

    Parameters
    ----------
    bodies : iterable of Body
        Each with its mass (kg), its mass centre (m) in the frame, and its moments of inertia
        (kg m^2) about its own mass centre, in the axes of the frame.

    Returns
    -------
    Body or None
        With the moments about the common mass centre; None where there are none.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.robots import Body, combine_bodies
    >>> two = [Body(1.0, [x, 0.0, 0.0], np.zeros((3, 3))) for x in (0.0, 0.4)]
    >>> dumbbell = combine_bodies(two)
    >>> dumbbell.mass, dumbbell.com.tolist(), round(float(dumbbell.inertia[2, 2]), 6)
    (2.0, [0.2, 0.0, 0.0], 0.08)
    """
    parts = listed("bodies", bodies, "a list of bodies")
    for part in parts:
        if not isinstance(part, Body):
            raise BadValueError("one of bodies", part, "a Body")
    if len(parts) < 2:
        return parts[0] if parts else None
    mass = sum(part.mass for part in parts)
    if mass == 0.0:
        com = np.zeros(3)
    else:
        com = np.asarray(sum(part.mass * part.com for part in parts)) / mass
    inertia = np.zeros((3, 3))
    for part in parts:
        r = part.com - com
        inertia = inertia + part.inertia + part.mass * inertia_of_point_mass(1.0, r)
    return Body(mass, com, inertia, any(part.as_measured for part in parts))


def lump_bodies(
    bodies: Sequence[Body | None], packed: Array, rest: Array, count: int
) -> tuple[Body | None, ...]:
    """Join bodies beyond the first joints of a chain, at rest, to the body of the last joint kept.

    - ``bodies``: body that moves with each of n joints, in its frame.
    - ``packed``: the chain, shape (n + 1, 13).
    - ``rest``: rest positions of the joints (rad or m), shape (n,).
    - ``count``: number of joints that remain.

    Returns the body that moves with each remaining joint; empty if none remains.
    """
    kept, constants = list(bodies), unpack_chain(packed)
    for i in range(len(kept) - 1, max(count, 1) - 1, -1):
        carried = kept.pop()
        if carried is not None:
            J = joint_transform(packed[i, 0] == PRISMATIC, rest[i])
            moved = carried.expressed_in(constants[i] @ J)
            kept[-1] = combine_bodies(part for part in (kept[-1], moved) if part is not None)
    return tuple(kept[:count])


def pack_bodies(
    bodies: Sequence[Body | None], links: Sequence[Sequence[str]], joints: Sequence[str]
) -> Array:
    """Lay out bodies as the kernels read them.

    - ``bodies``: what moves with each of n joints, in its frame.
    - ``links``: names of the links that each joint moves.
    - ``joints``: names of the joints.

    Returns rows (n, 10): mass (kg), centre of mass (m), and the moments xx, xy, xz, yy, yz, zz
    about it (kg m^2).

    Raises MissingInertiaError: of some joints nothing is known that moves with them.
    """
    missing = [i for i, body in enumerate(bodies) if body is None or body.mass == 0.0]
    if missing:
        unknown = [name for i in missing for name in links[i]]
        raise MissingInertiaError(unknown, [joints[i] for i in missing])
    rows = np.empty((len(bodies), 10))
    for i, body in enumerate(bodies):
        assert body is not None
        if fault := body.fault():
            names = " and ".join(links[i])
            raise BadValueError(
                f"body of {names}", f"{body.mass:g} kg", f"a possible body; {fault}"
            )
        rows[i, 0] = body.mass
        rows[i, 1:4] = body.com
        rows[i, 4:] = body.inertia[np.triu_indices(3)]
    rows.setflags(write=False)
    return rows
