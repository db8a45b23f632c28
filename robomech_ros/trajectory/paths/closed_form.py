"""Curves in closed form: lines, circular arcs, helices, and intersections of surfaces."""

from __future__ import annotations

import math

import numpy as np

from robomech_ros.errors import BadValueError
from robomech_ros.spatial.arrays import real_array
from robomech_ros.trajectory.paths.curve import FunctionCurve
from robomech_ros.trajectory.paths.curve_arguments import (
    as_number,
    as_points,
    as_positive,
    as_vector,
)
from robomech_ros.trajectory.tolerances import COINCIDENT, COLLINEAR
from robomech_ros.typing import Array, ArrayLike


def line(start: ArrayLike, end: ArrayLike) -> FunctionCurve:
    """Go straight from a point to another; the parameter is the distance from the first (m).

    Parameters
    ----------
    start, end : array_like, shape (3,)
        Points (m).

    Raises
    ------
    BadValueError, WrongSizeError
        Not two points apart from each other.
    """
    first, last = as_points(
        "points of the line", [as_vector("start", start), as_vector("end", end)], 2
    )
    length = float(np.linalg.norm(last - first))
    direction = (last - first) / length

    def rows(u: Array) -> Array:
        values = np.zeros((5, len(u), 3))
        values[0], values[1] = first + u[:, None] * direction, direction
        return values

    return FunctionCurve(rows, np.array([0.0, length]))


def arc_through(start: ArrayLike, through: ArrayLike, end: ArrayLike) -> FunctionCurve:
    """Go along the circle through three points; the parameter is the angle from the first (rad).

    Parameters
    ----------
    start, through, end : array_like, shape (3,)
        Points (m), passed in this order.

    Raises
    ------
    BadValueError, WrongSizeError
        Not three points, two of them coincide, or all lie on a line.
    """
    given = [as_vector("start", start), as_vector("through", through), as_vector("end", end)]
    points = as_points("points of the arc", [*given, given[0]], 4)
    a, b = points[1] - points[0], points[2] - points[0]
    normal = np.cross(a, b)
    sine = np.linalg.norm(normal) / np.linalg.norm(a) / np.linalg.norm(b)
    if sine < COLLINEAR or np.linalg.norm(normal) < COLLINEAR * (a @ a):
        raise BadValueError("points of the arc", points[:3].tolist(), "three points not on a line")
    offset = np.cross((a @ a) * b - (b @ b) * a, normal) / (2.0 * (normal @ normal))
    pose = _frame(points[0] + offset, normal, -offset)
    x, y, _ = (points[2] - pose[:3, 3]) @ pose[:3, :3]
    radius = float(np.linalg.norm(offset))
    return helix(radius, 0.0, float(np.arctan2(y, x)) % math.tau, pose=pose)


def arc_about(center: ArrayLike, axis: ArrayLike, start: ArrayLike, angle: float) -> FunctionCurve:
    """Turn a point about an axis; the parameter is the angle (rad).

    Parameters
    ----------
    center : array_like, shape (3,)
        A point of the axis (m); the centre is its point nearest to `start`.
    axis : array_like, shape (3,)
        Direction of the axis, of any length but zero.
    start : array_like, shape (3,)
        Where the arc begins (m).
    angle : float
        By how much the point turns (rad), against the axis if negative; several turns are allowed.

    Raises
    ------
    BadValueError
        Not points, a vector and an angle other than zero, or a start on the axis.
    """
    origin, first = as_vector("center", center), as_vector("start", start)
    direction, turn = as_vector("axis", axis), as_number("angle", angle)
    largest = float(np.abs(direction).max())
    if not largest > 0.0:
        raise BadValueError("axis", direction.tolist(), "a vector that is not zero")
    # First by the largest entry, so that no square underflows.
    scaled = direction / largest
    unit = scaled / np.linalg.norm(scaled) * math.copysign(1.0, turn)
    foot = origin + unit * (unit @ (first - origin))
    arm = first - foot
    if np.linalg.norm(arm) <= COINCIDENT * max(1.0, float(np.abs(first).max())):
        raise BadValueError("start", first.tolist(), "a point away from the axis")
    return helix(float(np.linalg.norm(arm)), 0.0, abs(turn), pose=_frame(foot, unit, arm))


def helix(
    radius: float, rise: float, angle: float, *, start: float = 0.0, pose: ArrayLike | None = None
) -> FunctionCurve:
    r"""Build the helix (a cos u, a sin u, b u) about the z axis of its frame.

    .. math::

       \kappa = \frac{a}{a^2 + b^2}, \qquad \tau = \frac{b}{a^2 + b^2}

    Parameters
    ----------
    radius : float
        a (m).
    rise : float
        b (m/rad), negative for a left-handed helix and 0 for a circle.
    angle : float
        How far it turns (rad), above 0.
    start : float, optional
        Angle where it begins (rad).
    pose : array_like, shape (4, 4), optional
        ``T_base_curve`` (m); the base frame itself where not given.

    Returns
    -------
    FunctionCurve
        The parameter u is the angle (rad).

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., sections 11.2 and 11.3.
    """
    a, b = as_positive("radius", radius), as_number("rise", rise)
    first, turn = as_number("start", start), as_positive("angle", angle)

    def rows(u: Array) -> Array:
        climb = np.zeros((5, len(u)))
        climb[0], climb[1] = b * u, b
        return np.stack([a * _cosines(u), a * _sines(u), climb], axis=-1)

    return FunctionCurve(rows, np.array([first, first + turn]), _placement(pose))


def viviani(
    radius: float, *, start: float = 0.0, end: float = 4.0 * math.pi, pose: ArrayLike | None = None
) -> FunctionCurve:
    r"""Build Viviani's curve (a (1 + cos u), a sin u, 2 a sin(u / 2)).

    It is where a cylinder of radius a meets a sphere of radius 2 a about a point of the cylinder.

    .. math::

       \kappa = \frac{\sqrt{13 + 3 \cos u}}{a (3 + \cos u)^{3/2}}, \qquad
       \tau = \frac{6 \cos(u / 2)}{a (13 + 3 \cos u)}

    Parameters
    ----------
    radius : float
        a (m).
    start, end : float, optional
        Angles between which it runs (rad); the whole curve, closed, where not given.
    pose : array_like, shape (4, 4), optional
        ``T_base_curve`` (m).

    Returns
    -------
    FunctionCurve
        The parameter u is the angle about the cylinder's axis (rad).

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., sections 11.2 and 11.3.

    Examples
    --------
    >>> from robomech_ros.trajectory import frenet_serret, viviani
    >>> found = frenet_serret(viviani(2.0), 0.0)
    >>> round(float(found.curvature), 6), round(float(found.torsion), 6)
    (0.25, 0.1875)
    """
    a = as_positive("radius", radius)
    ends = np.array([as_number("start", start), as_number("end", end)])
    halves = 0.5 ** np.arange(5.0)[:, None]

    def rows(u: Array) -> Array:
        x = a * _cosines(u)
        x[0] += a
        return np.stack([x, a * _sines(u), 2.0 * a * halves * _sines(0.5 * u)], axis=-1)

    return FunctionCurve(rows, ends, _placement(pose))


def cylinder_intersection(
    large: float,
    small: float,
    *,
    offset: float = 0.0,
    start: float = 0.0,
    end: float = math.tau,
    pose: ArrayLike | None = None,
) -> FunctionCurve:
    """Build the seam of a pipe on another: (r cos u, r sin u, sqrt(R^2 - (r sin u - d)^2)).

    The pipe of radius r has the axis z; the other, of radius R, has an axis parallel to x that
    passes z at the distance d along y.

    Parameters
    ----------
    large, small : float
        R and r (m).
    offset : float, optional
        d (m); the axes meet where it is 0.
    start, end : float, optional
        Angles between which it runs (rad); one turn, closed, where not given.
    pose : array_like, shape (4, 4), optional
        ``T_base_curve`` (m).

    Returns
    -------
    FunctionCurve
        The parameter u is the angle about the smaller pipe's axis (rad).

    Raises
    ------
    BadValueError
        Radii that are not above 0 or a smaller pipe that does not end on the larger one all round
        (r + abs(d) must be below R).

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., sections 11.2 and 11.3.

    Examples
    --------
    >>> from robomech_ros.trajectory import arc_length, cylinder_intersection
    >>> round(arc_length(cylinder_intersection(2.0, 1.0)).length, 6)
    6.394489
    """
    R, r, d = as_positive("large", large), as_positive("small", small), as_number("offset", offset)
    if r + abs(d) >= R:
        raise BadValueError("small + |offset|", r + abs(d), f"less than large, {R:.9g}")
    ends = np.array([as_number("start", start), as_number("end", end)])

    def rows(u: Array) -> Array:
        y = r * _sines(u)
        height = _root_of(_height_squared(R, d, y))
        return np.stack([r * _cosines(u), y, height], axis=-1)

    return FunctionCurve(rows, ends, _placement(pose))


def _height_squared(R: float, d: float, y: Array) -> Array:
    """Return R^2 - (y - d)^2 and four derivatives from y (5, m) and its derivatives."""
    e = y.copy()
    e[0] -= d
    return np.stack(
        [
            R * R - e[0] ** 2,
            -2.0 * e[0] * e[1],
            -2.0 * (e[1] ** 2 + e[0] * e[2]),
            -2.0 * (3.0 * e[1] * e[2] + e[0] * e[3]),
            -2.0 * (3.0 * e[2] ** 2 + 4.0 * e[1] * e[3] + e[0] * e[4]),
        ]
    )


def _root_of(w: Array) -> Array:
    """Return the square root z of w (5, m) and its derivatives, from those of z z = w."""
    z = np.empty_like(w)
    z[0] = np.sqrt(w[0])
    z[1] = w[1] / (2.0 * z[0])
    z[2] = (w[2] / 2.0 - z[1] ** 2) / z[0]
    z[3] = (w[3] / 2.0 - 3.0 * z[1] * z[2]) / z[0]
    z[4] = (w[4] / 2.0 - 4.0 * z[1] * z[3] - 3.0 * z[2] ** 2) / z[0]
    return z


def _cosines(u: Array) -> Array:
    """Cosine and its four derivatives, shape (5, m)."""
    c, s = np.cos(u), np.sin(u)
    return np.stack([c, -s, -c, s, c])


def _sines(u: Array) -> Array:
    """Sine and its four derivatives, shape (5, m)."""
    c, s = np.cos(u), np.sin(u)
    return np.stack([s, c, -s, -c, s])


def _frame(origin: Array, z: Array, x: Array) -> Array:
    """Place a frame with z along one vector and x along another, orthogonal to it."""
    pose = np.eye(4)
    pose[:3, 2] = z / np.linalg.norm(z)
    pose[:3, 0] = x / np.linalg.norm(x)
    pose[:3, 1] = np.cross(pose[:3, 2], pose[:3, 0])
    pose[:3, 3] = origin
    return pose


def _placement(pose: ArrayLike | None) -> Array:
    return np.eye(4) if pose is None else real_array("pose", pose)
