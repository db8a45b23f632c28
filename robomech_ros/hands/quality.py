"""The load that a grasp resists in its weakest direction, between two bounds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robomech_ros._kernels.tolerances import LARGEST_LENGTH
from robomech_ros.errors import BadValueError, NonFiniteError
from robomech_ros.hands.closure import is_force_closed
from robomech_ros.hands.contacts import Contact, as_contacts, as_origin, cones_of
from robomech_ros.spatial.arrays import real_number

__all__ = ["GraspQuality", "grasp_quality"]

Array = NDArray[np.float64]

# Facets that are cut at once: more than one, since each call of the hull costs.
_AT_ONCE = 4
# Points of the hull, and points so near to one of them that they are the same.
_MOST_POINTS = 100_000
_SAME = 1e-9
# Rounding of a hull of numbers about 1.
_ROUNDING = 1e-10
# Share of a wrench that is given up, so that the hull has no facets of more points than it needs.
_SHRINKING = 1e-6


@dataclass(frozen=True, eq=False)
class GraspQuality:
    """How good a grasp is.

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
    most_points: int = 400,
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
    most_points : int, optional
        Wrenches after which it ends with the bounds that it has.

    Returns
    -------
    GraspQuality

    Raises
    ------
    BadValueError, WrongSizeError, NonFiniteError
        As for :func:`is_force_closed`, and for a length or tolerance that is not positive.

    References
    ----------
    Ferrari and Canny, Planning Optimal Grasps, ICRA 1992, the criterion of the sum of the forces.
    Zheng, An Efficient Algorithm for a Grasp Quality Measure, IEEE Trans. Robotics 29, 2013, for
    the growing hull.

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
    if real_number("most_points", most_points, expected) not in range(1, _MOST_POINTS + 1):
        raise BadValueError("most_points", most_points, expected)
    point = as_origin(origin, given)
    cones = cones_of(given, point, size)
    if not is_force_closed(given):
        return GraspQuality(0.0, 0.0, np.zeros(cones.shape[2]), size, point, True)
    lower, upper, weakest = _bounds(cones, close, int(most_points))
    return GraspQuality(lower, upper, weakest, size, point, upper - lower <= close)


def _positive(what: str, value: object, largest: float) -> float:
    expected = f"a number above 0, up to {largest:g}"
    number = real_number(what, value, expected)
    if not np.isfinite(number):
        raise NonFiniteError(what, number)
    if not 1e-9 <= number <= largest:
        raise BadValueError(what, value, expected)
    return number


def _bounds(cones: Array, close: float, most: int) -> tuple[float, float, Array]:
    """Let the hull grow until its nearest facet is close to where that would touch the cones."""
    # Loaded here: it takes a good part of the start of a node.
    from scipy.spatial import ConvexHull

    rng = np.random.default_rng(0)
    points = _shrunk(_first_points(cones), rng)
    upper, weakest, lower = np.inf, np.zeros(cones.shape[2]), 0.0
    hull = ConvexHull(points, incremental=True)
    while True:
        normals, distances = hull.equations[:, :-1], -hull.equations[:, -1]
        lower = max(lower, float(distances.min()) - _ROUNDING)
        near = np.flatnonzero(distances < upper - close)
        near = near[np.argsort(distances[near], kind="stable")[:_AT_ONCE]]
        if not len(near):
            break
        touching, heights = _touching(cones, normals[near])
        greatest = heights.max(axis=1)
        k = int(np.argmin(greatest))
        if greatest[k] < upper:
            upper, weakest = float(greatest[k]), normals[near[k]].copy()
        room = most - len(hull.points)
        new = _distinct(touching[heights > distances[near][:, None] + 0.25 * close], points)[:room]
        if upper - lower <= close or not len(new):
            break
        points = np.concatenate([points, new])
        hull.add_points(_shrunk(new, rng))
    return max(0.0, min(lower, upper)), upper, weakest


def _shrunk(points: Array, rng: np.random.Generator) -> Array:
    """Move points a little towards the origin, which leaves no six of them in one facet more."""
    return points * (1.0 - _SHRINKING * rng.random((len(points), 1)))


def _first_points(cones: Array) -> Array:
    """Give the wrench of the normal of each contact and some of the rim of its cone."""
    normal = cones[:, :1]
    rims = [normal + sign * cones[:, 1:] for sign in (1.0, -1.0)]
    points = np.concatenate([normal, *rims], axis=1).reshape(-1, cones.shape[2])
    return _distinct(points, np.empty((0, cones.shape[2])))


def _touching(cones: Array, normals: Array) -> tuple[Array, Array]:
    """Give the wrench of each contact that is farthest along each normal, and how far.

    Returns
    -------
    touching : ndarray, shape (m, k, d)
    heights : ndarray, shape (m, k)
    """
    along = np.einsum("kjd,md->mkj", cones, normals)
    across = along[:, :, 1:]
    size = np.sqrt((across * across).sum(axis=2))
    y = across / np.where(size > 0.0, size, 1.0)[:, :, None]
    return cones[:, 0] + np.einsum("mkj,kjd->mkd", y, cones[:, 1:]), along[:, :, 0] + size


def _distinct(points: Array, known: Array) -> Array:
    """Leave out points that are there already."""
    seen = {row.tobytes() for row in np.round(known / _SAME) + 0.0}
    keep = []
    for k, row in enumerate(np.round(points / _SAME) + 0.0):
        name = row.tobytes()
        if name not in seen:
            seen.add(name)
            keep.append(k)
    return points[keep]
