"""Rigid bodies: mass, centre of mass and inertia, and whether a body can have them."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robomech_ros._kernels.tolerances import INERTIA_ROUNDING, LARGEST_INERTIA, LARGEST_LENGTH
from robomech_ros.errors import BadValueError, NonFiniteError, WrongSizeError
from robomech_ros.spatial.arrays import real_array

__all__ = ["Body", "combined"]

Array = NDArray[np.float64]

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

    Raises
    ------
    WrongSizeError, NonFiniteError, BadValueError
        An entry is no number, or the inertia is not symmetric.
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
            if not np.isfinite(array).all():
                raise NonFiniteError(field, array)
            if np.abs(array).max() > largest:
                raise BadValueError(field, array.tolist(), f"magnitudes of at most {largest:g}")
            array.setflags(write=False)
            object.__setattr__(self, field, array if shape else float(array))
        if np.abs(self.inertia - self.inertia.T).max() > 1e-9 * np.abs(self.inertia).max():
            raise BadValueError("inertia", self.inertia.tolist(), "a symmetric matrix")

    def fault(self) -> str:
        """Say why no body has these numbers; empty where one has.

        The mass and the principal moments are positive, and none of the moments is above the sum
        of the two others, but for rounding of published numbers.  A point has a mass and no
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

    def seen_from(self, T: Array) -> "Body":
        """Give the same body in the frame in which T, shape (4, 4), is the pose of its own."""
        R = T[:3, :3]
        inertia = R @ self.inertia @ R.T
        com = R @ self.com + T[:3, 3]
        return Body(self.mass, com, 0.5 * (inertia + inertia.T), self.as_measured)


def combined(bodies: Iterable[Body]) -> Body | None:
    """Make one body of several that are fixed to each other, all seen in one frame.

    Parameters
    ----------
    bodies : iterable of Body

    Returns
    -------
    Body or None
        None where there are none.
    """
    parts = list(bodies)
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
        inertia = inertia + part.inertia + part.mass * (r @ r * np.eye(3) - np.outer(r, r))
    return Body(mass, com, inertia, any(part.as_measured for part in parts))
