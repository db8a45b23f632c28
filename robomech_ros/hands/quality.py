"""The load that a grasp resists in its weakest direction, between two bounds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from robomech_ros._kernels.hands.quality_bounds import CLOSE, grow
from robomech_ros._kernels.tolerances import LARGEST_LENGTH
from robomech_ros.errors import BadValueError, NonFiniteError
from robomech_ros.hands.closure import is_force_closed
from robomech_ros.hands.contacts import Contact, as_contacts, as_origin, cones_of, rows_of
from robomech_ros.printing import Printed
from robomech_ros.spatial.arrays import real_number, whole_number
from robomech_ros.typing import Array, ArrayLike

# Least length (m) or tolerance.
SHORTEST = 1e-9
_MOST_POINTS = 100_000
# Facets at one time: in space more than any grasp of six contacts takes, in the plane twice as many
# as points.
_MOST_FACETS = 200_000


@dataclass(frozen=True, eq=False)
class GraspQuality(Printed):
    """Quality of a grasp.

    Parameters
    ----------
    lower, upper : float
        The quality is between them: the largest load (N, moments divided by the length) that
        normal forces with the sum 1 N resist in every direction.  Both are 0 where the grasp is
        not closed.
    weakest : ndarray, shape (d,)
        Unit wrench, moments in units of the length first, along which the contacts exert ``upper``
        at most; all 0 where the grasp is not closed.
    length : float
        What moments were divided by (m).
    origin : ndarray, shape (3,) or (2,)
        What moments are about (m).
    certified : bool
        Whether the bounds are as close as was asked.
    """

    lower: float
    upper: float
    weakest: Array
    length: float
    origin: Array
    certified: bool


def grasp_quality(
    contacts: Sequence[Contact],
    *,
    length: float,
    origin: ArrayLike | None = None,
    tolerance: float = 1e-4,
    max_wrenches: int = 2000,
) -> GraspQuality:
    """Compute bounds of the quality of Ferrari and Canny, friction cones as they are, round.

    It is the radius of the largest ball about the origin in the convex hull of the wrenches of
    unit normal forces.  The hull of some of these wrenches bounds it from below, a facet of that
    hull moved out until it touches the cones from above, and the points where it touches make the
    hull larger.

    Parameters
    ----------
    contacts : sequence of Contact
    length : float
        Moments are divided by it (m): the quality depends on it.
    origin : array_like, shape (3,) or (2,), optional
        The point that moments are about, such as the mass centre (m); default the centre of the
        contacts.
    tolerance : float, optional
        How close the bounds are to be.
    max_wrenches : int, optional
        Wrenches after which it ends with the bounds that it has; 200000 facets at one time end it,
        too.

    References
    ----------
    Ferrari and Canny, Planning Optimal Grasps, ICRA 1992, the criterion of the sum of the forces.
    Zheng, An Efficient Algorithm for a Grasp Quality Measure, IEEE Trans. Robotics 29, 2013, for
    the hull that grows where it is nearest.

    Examples
    --------
    >>> from robomech_ros.hands import Contact, grasp_quality
    >>> sides = [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)]
    >>> disc = [Contact(p, (-p[0], -p[1]), "point", 0.5) for p in sides]
    >>> round(grasp_quality(disc, length=1.0).lower, 3)
    0.5
    """
    given = as_contacts(contacts)
    size = _positive("length", length, LARGEST_LENGTH)
    close = _positive("tolerance", tolerance, 1.0)
    expected = f"a whole number from 1 to {_MOST_POINTS}"
    most = whole_number("max_wrenches", max_wrenches, expected, 1, _MOST_POINTS)
    point = as_origin(origin, given)
    cones = cones_of(rows_of(given), point, size)
    if not is_force_closed(given):
        return GraspQuality(0.0, 0.0, np.zeros(cones.shape[2]), size, point, True)
    lower, upper, weakest, certified = _bounds(cones, close, most)
    return GraspQuality(lower, upper, weakest, size, point, certified)


def _positive(what: str, value: object, largest: float) -> float:
    expected = f"a number from {SHORTEST:g} to {largest:g}"
    number = real_number(what, value, expected)
    if not np.isfinite(number):
        raise NonFiniteError(what, number)
    if not SHORTEST <= number <= largest:
        raise BadValueError(what, value, expected)
    return number


def _bounds(cones: Array, close: float, most: int) -> tuple[float, float, Array, bool]:
    """Extend a hull until its nearest facet nearly touches the cones."""
    d = cones.shape[2]
    room = _MOST_FACETS if d > 3 else 2 * (most + d)
    found = np.empty(d + 2)
    status = grow(
        cones,
        close,
        np.empty((most + d + 1, d)),
        np.empty((room, 2 * d + 1), np.int64),
        np.empty((room, d + 1)),
        np.empty((room, 2)),
        np.empty((3, room), np.int64),
        found,
    )
    return float(found[0]), float(found[1]), found[2:].copy(), status == CLOSE
