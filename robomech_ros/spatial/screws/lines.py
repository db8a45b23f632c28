"""Lines by their Pluecker coordinates ``[e; n]``: direction, and moment about the origin."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robomech_ros.errors import BadValueError
from robomech_ros.spatial.arrays import as_finite
from robomech_ros.spatial.cross_product import cross
from robomech_ros.spatial.rows import common_shape, finite_result
from robomech_ros.spatial.screws.transfers import transfer_wrench
from robomech_ros.spatial.transformations.linear_maps import unit_vectors
from robomech_ros.typing import Array, ArrayLike, BoolArray

# Sine of the angle between lines that count as parallel: what their feet are computed from is
# divided by its square.
_PARALLEL = 1e-9
# Part of the moment along the direction of a line that is taken for rounding.
_ASKEW = 1e-6
# Distance (m), over that from the origin where it is more than 1, of lines that meet.
_MEETING = 1e-9


@dataclass(frozen=True, eq=False)
class CommonNormal:
    """The shortest way between two lines.

    Attributes
    ----------
    first, second : ndarray, shape (..., 3)
        Its feet on the lines (m); of parallel lines the foot on the first is nearest to the origin.
    distance : ndarray, shape (...)
        Between the feet (m).
    direction : ndarray, shape (..., 3)
        Unit vector from the first towards the second; of lines that meet at right angles to both.
    angle : ndarray, shape (...)
        From the first direction to the second about that one, in [-pi, pi] (rad).
    parallel : ndarray of bool, shape (...)
        There is one at every place.
    """

    first: Array
    second: Array
    distance: Array
    direction: Array
    angle: Array
    parallel: BoolArray


def line_through(point: ArrayLike, direction: ArrayLike) -> Array:
    """Return the Pluecker coordinates of a line.

    Parameters
    ----------
    point : array_like, shape (..., 3)
        Any point p of it (m).
    direction : array_like, shape (..., 3)
        Direction of any length but zero.

    Returns
    -------
    ndarray, shape (..., 6)
        Unit direction e, then moment ``n = p x e`` (m).

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 3.2.2.

    Examples
    --------
    >>> from robomech_ros.spatial import line_through
    >>> line_through([0.0, 2.0, 0.0], [3.0, 0.0, 0.0])
    array([ 1.,  0.,  0.,  0.,  0., -2.])
    """
    p, e = as_finite("point", point, (3,)), unit_vectors("direction", direction)
    shape = common_shape("point and direction", p.shape[:-1], e.shape[:-1])
    line = np.empty((*shape, 6))
    with np.errstate(over="ignore", invalid="ignore"):
        line[..., :3], line[..., 3:] = e, cross(p, e)
    return finite_result("point", line, p)


def line_through_points(first: ArrayLike, second: ArrayLike) -> Array:
    """Return the Pluecker coordinates of the line through two points, from the first to the second.

    Parameters
    ----------
    first, second : array_like, shape (..., 3)
        Different points (m).

    Returns
    -------
    ndarray, shape (..., 6)
        As :func:`line_through`.

    Raises
    ------
    BadValueError
        Points that coincide.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 3.2.2.
    """
    p, q = as_finite("first point", first, (3,)), as_finite("second point", second, (3,))
    common_shape("points", p.shape[:-1], q.shape[:-1])
    with np.errstate(over="ignore"):
        way = finite_result("points", q - p, p)
    if not way.any(axis=-1).all():
        raise BadValueError("distance of the points", 0.0, "two different points")
    return line_through(p, way)


def line_nearest_point(line: ArrayLike, point: ArrayLike | None = None) -> Array:
    """Find the point of a line that is nearest to a given one.

    Parameters
    ----------
    line : array_like, shape (..., 6)
        Pluecker coordinates.
    point : array_like, shape (..., 3), optional
        In m; default the origin.

    Returns
    -------
    ndarray, shape (..., 3)
        In m.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 3.2.2.
    """
    e, n = _line("line", line)
    foot = cross(e, n)
    if point is None:
        return foot
    p = as_finite("point", point, (3,))
    common_shape("line and point", e.shape[:-1], p.shape[:-1])
    with np.errstate(over="ignore", invalid="ignore"):
        nearest: Array = foot + e * np.sum(e * p, axis=-1, keepdims=True)
    return finite_result("point", nearest, p)


def transfer_line(line: ArrayLike, from_point: ArrayLike, to_point: ArrayLike) -> Array:
    """Return the coordinates of a line with the moment about another point.

    Parameters
    ----------
    line : array_like, shape (..., 6)
        Direction, then moment about ``from_point`` (m).
    from_point, to_point : array_like, shape (..., 3)
        In m.

    Returns
    -------
    ndarray, shape (..., 6)
        ``[e; n + (a - b) x e]``.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 3.2.2.
    """
    e, n = _line("line", line)
    # A line has its moment where a unit force along it would have it.
    moved = transfer_wrench(np.concatenate((n, e), axis=-1), from_point, to_point)
    return np.concatenate((moved[..., 3:], moved[..., :3]), axis=-1)


def line_reciprocity(first: ArrayLike, second: ArrayLike) -> Array:
    r"""Compute the mutual moment of two lines, which vanishes where they meet or are parallel.

    .. math:: e_1 \cdot n_2 + e_2 \cdot n_1

    Its size is the distance of the lines times the sine of the angle between them; a force along
    one does no work on a turn about the other where it is zero.

    Parameters
    ----------
    first, second : array_like, shape (..., 6)
        Pluecker coordinates.

    Returns
    -------
    ndarray, shape (...)
        In m.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 3.2.2.

    Examples
    --------
    >>> from robomech_ros.spatial import line_reciprocity, line_through
    >>> x, y = line_through([0, 0, 0], [1, 0, 0]), line_through([0, 0, 2], [0, 1, 0])
    >>> float(line_reciprocity(x, y))
    -2.0
    """
    (e, n), (f, m) = _line("first line", first), _line("second line", second)
    common_shape("lines", e.shape[:-1], f.shape[:-1])
    return np.sum(e * m + f * n, axis=-1)


def line_distance(first: ArrayLike, second: ArrayLike) -> Array:
    """Measure the distance of two lines.

    Parameters
    ----------
    first, second : array_like, shape (..., 6)
        Pluecker coordinates.

    Returns
    -------
    ndarray, shape (...)
        In m.
    """
    return common_normal(first, second).distance


def common_normal(first: ArrayLike, second: ArrayLike) -> CommonNormal:
    """Find the shortest way between two lines: twist angle and distance of a link's axes.

    Parameters
    ----------
    first, second : array_like, shape (..., 6)
        Pluecker coordinates.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., sections 3.2.2 and 4.2.

    Examples
    --------
    >>> from robomech_ros.spatial import common_normal, line_through
    >>> x, y = line_through([0, 0, 0], [1, 0, 0]), line_through([3, 0, 2], [0, 1, 0])
    >>> found = common_normal(x, y)
    >>> found.second, float(found.distance)
    (array([3., 0., 2.]), 2.0)
    """
    (e, n), (f, m) = _line("first line", first), _line("second line", second)
    shape = (*common_shape("lines", e.shape[:-1], f.shape[:-1]), 3)
    e, n, f, m = (np.broadcast_to(one, shape) for one in (e, n, f, m))
    normal = cross(e, f)
    sine = np.linalg.norm(normal, axis=-1, keepdims=True)
    parallel = sine <= _PARALLEL
    p, q = cross(e, n), cross(f, m)
    between = q - p
    square = np.where(parallel, 1.0, sine * sine)
    # Ways along the lines from p and q to the feet.
    along = np.sum(cross(between, f) * normal, axis=-1, keepdims=True) / square
    back = np.sum(cross(between, e) * normal, axis=-1, keepdims=True) / square
    start = p + np.where(parallel, 0.0, along) * e
    drop = -np.sum(between * f, axis=-1, keepdims=True)
    end = q + np.where(parallel, drop, back) * f
    way = end - start
    unit = normal / np.where(parallel, 1.0, sine)
    # For skew lines by projection: the difference of the feet loses digits where they are near.
    apart = np.sum(between * unit, axis=-1, keepdims=True)
    aside = np.linalg.norm(way, axis=-1, keepdims=True)
    across = np.where(aside > 0.0, way / np.where(aside > 0.0, aside, 1.0), _any_normal(e))
    direction = np.where(parallel, across, np.where(apart < 0.0, -unit, unit))
    turn = np.sum(normal * direction, axis=-1)
    return CommonNormal(
        first=start,
        second=end,
        distance=np.where(parallel, aside, np.abs(apart))[..., 0],
        direction=direction,
        angle=np.arctan2(turn, np.sum(e * f, axis=-1)),
        parallel=parallel[..., 0],
    )


def line_intersection(first: ArrayLike, second: ArrayLike, tolerance: float = _MEETING) -> Array:
    """Find the point where two lines meet.

    Parameters
    ----------
    first, second : array_like, shape (..., 6)
        Pluecker coordinates.
    tolerance : float, optional
        Distance (m) of lines that count as meeting, more in proportion where the feet are farther
        than 1 m from the origin.

    Returns
    -------
    ndarray, shape (..., 3)
        Middle between the feet (m); NaN where they do not meet, or not in one point.
    """
    found = common_normal(first, second)
    middle = 0.5 * (found.first + found.second)
    reach = np.maximum(1.0, np.abs(middle).max(axis=-1))
    meet = (found.distance <= tolerance * reach) & ~found.parallel
    return np.where(meet[..., None], middle, np.nan)


def _any_normal(e: Array) -> Array:
    """Return unit vectors at right angles to unit vectors."""
    least = np.eye(3)[np.argmin(np.abs(e), axis=-1)]
    normal = cross(e, least)
    return normal / np.linalg.norm(normal, axis=-1, keepdims=True)


def _line(what: str, value: ArrayLike) -> tuple[Array, Array]:
    """Check Pluecker coordinates and make the direction a unit vector."""
    line = as_finite(what, value, (6,))
    e = unit_vectors(f"direction of {what}", line[..., :3])
    length = np.sum(e * line[..., :3], axis=-1, keepdims=True)
    with np.errstate(over="ignore", invalid="ignore"):
        n = line[..., 3:] / length
        along = np.sum(e * n, axis=-1, keepdims=True)
        largest = np.abs(n).max(axis=-1, keepdims=True)
    finite_result(what, along, line)
    if (np.abs(along) > _ASKEW * np.maximum(largest, _ASKEW)).any():
        amount = float(np.abs(along).max())
        expected = f"a moment at right angles to the direction (along it: {amount:.3g})"
        raise BadValueError(what, line.tolist(), expected)
    if (largest > 1e100).any():
        raise BadValueError(f"largest of {what}", float(largest.max()), "at most 1e100")
    return e, n - along * e
