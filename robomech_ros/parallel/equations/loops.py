"""The closure equations of each kind of platform in angles."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from robomech_ros.errors import BadValueError
from robomech_ros.kinematics.equations.closure import FROM_THIRDS, THIRDS, turn_about_z
from robomech_ros.parallel.argument_checks import actuated, positive
from robomech_ros.parallel.equations.closure import PlatformEquations
from robomech_ros.parallel.equations.elimination import Numbers
from robomech_ros.parallel.planar import Planar3RPR, Planar3RRR
from robomech_ros.parallel.spherical import Spherical3RRR
from robomech_ros.parallel.stewart_gough import StewartGough
from robomech_ros.spatial import cross_product_matrix, matrix_from_rotation_vector
from robomech_ros.typing import Array, ArrayLike

# Relative distance up to which points coincide.
_SAME = 1e-9
_KINDS = ("StewartGough", "Planar3RPR", "Planar3RRR", "Spherical3RRR")
_VERTICES = ((0, 1), (0, 2), (1, 2))

Robot = StewartGough | Planar3RPR | Planar3RRR | Spherical3RRR


def platform_equations(robot: Robot, drives: ArrayLike) -> PlatformEquations:
    r"""Return the closure equations of a platform for values of its drives.

    The angles, and the degree of the polynomial, are:

    - ``StewartGough``, degree 16: angle of each vertex of the platform about the line of its two
      base points, from the plane through that line and the middle of the base.
    - ``Planar3RPR`` and ``Planar3RRR``, degree 6: angles of the platform and of leg or distal
      link 1.
    - ``Spherical3RRR``, degree 8: angles of distal link 1 about its middle axis, and of the
      platform about its axis 1.

    Parameters
    ----------
    robot : StewartGough, Planar3RPR, Planar3RRR or Spherical3RRR
        The six legs of a StewartGough end in pairs at three points of the platform.
    drives : array_like, shape (6,) or (3,)
        Leg lengths (m) or angles of the drives (rad), as for ``direct``.

    Raises
    ------
    BadValueError
        The robot is of another kind, or two legs are too short or too long to meet.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 10.2.

    Examples
    --------
    >>> from robomech_ros.parallel import load_parallel
    >>> from robomech_ros.parallel.equations import platform_equations
    >>> equations = platform_equations(load_parallel("planar_3rpr"), [14.98, 15.38, 12.0])
    >>> found = equations.roots()
    >>> found.polynomial.shape, found.angles.shape, len(found.real)
    ((7,), (6, 2), 6)
    """
    if isinstance(robot, StewartGough):
        return _vertex_equations(robot, _lengths(drives, 6))
    if isinstance(robot, Planar3RPR):
        return _triangle_equations(robot, robot.base_points, _lengths(drives, 3))
    if isinstance(robot, Planar3RRR):
        q = actuated("q", drives, 3)
        arms = robot.proximal[:, None] * np.stack((np.cos(q), np.sin(q)), axis=1)
        return _triangle_equations(robot, robot.base_points + arms, robot.distal)
    if isinstance(robot, Spherical3RRR):
        return _axis_equations(robot, actuated("q", drives, 3))
    raise BadValueError("robot", type(robot).__name__, f"one of {', '.join(_KINDS)}")


def _lengths(drives: ArrayLike, count: int) -> Array:
    given = enumerate(actuated("lengths", drives, count).tolist(), 1)
    return np.array([positive(f"length of leg {leg}", one, zero=True) for leg, one in given])


def _vertex_equations(robot: StewartGough, lengths: Array) -> PlatformEquations:
    """Equate the distances of three points on circles with those of the platform's vertices."""
    legs = _pairs_of_legs(robot)
    vertices = robot.platform_points[[pair[0] for pair in legs]]
    middle = robot.base_points.mean(axis=0)
    centres, sides, radii = np.empty((3, 3)), np.empty((3, 2, 3)), np.empty(3)
    for k, (one, other) in enumerate(legs):
        a, b = robot.base_points[[one, other]]
        width = float(np.linalg.norm(b - a))
        line = (b - a) / width
        along = (width**2 + lengths[one] ** 2 - lengths[other] ** 2) / (2.0 * width)
        square = lengths[one] ** 2 - along**2
        if not square >= 0.0:
            what = f"lengths of legs {one + 1} and {other + 1}"
            expected = f"two that meet: their base points are {width:.6g} m apart"
            raise BadValueError(what, lengths[[one, other]].tolist(), expected)
        centres[k], radii[k] = a + along * line, np.sqrt(square)
        outward = a - middle - (a - middle) @ line * line
        if np.linalg.norm(outward) <= _SAME * np.abs(robot.base_points - middle).max():
            outward = np.cross(line, np.eye(3)[np.argmin(np.abs(line))])
        outward /= np.linalg.norm(outward)
        sides[k] = outward, np.cross(outward, line)
    size = float(max(np.abs(robot.base_points - middle).max(), lengths.max()))

    def point(k: int, angle: Numbers) -> Numbers:
        turned = np.multiply.outer(np.cos(angle), sides[k, 0])
        return centres[k] + radii[k] * (turned + np.multiply.outer(np.sin(angle), sides[k, 1]))

    def closure(i: int, j: int) -> Callable[[Array, Array], Array]:
        square = np.sum((vertices[i] - vertices[j]) ** 2)
        return lambda x, y: (np.sum((point(i, x) - point(j, y)) ** 2, axis=-1) - square) / size**2

    def placed(angles: Numbers) -> Numbers:
        corners = np.array([point(k, angle) for k, angle in enumerate(angles)])
        R = _triad(corners) @ np.linalg.inv(_triad(vertices))
        return _assembled(R, corners[0] - R @ vertices[0])

    tables = np.array([_table(closure(i, j)) for i, j in _VERTICES])
    return PlatformEquations(
        robot.family, ("phi_1", "phi_2", "phi_3"), tables, _VERTICES, 16, placed
    )


def _triangle_equations(
    robot: Planar3RPR | Planar3RRR, anchors: Array, distances: Array
) -> PlatformEquations:
    """Equate the distances of corners 2 and 3 from their anchors with those given."""
    corners = robot.platform_points - robot.platform_points[0]
    size = float(max(np.abs(anchors - anchors[0]).max(), distances.max(), np.abs(corners).max()))

    def turned(angle: Numbers, vector: Array) -> Numbers:
        c, s = np.cos(angle), np.sin(angle)
        return np.stack((c * vector[0] - s * vector[1], s * vector[0] + c * vector[1]), axis=-1)

    def closure(i: int) -> Callable[[Array, Array], Array]:
        def left(turn: Array, leg: Array) -> Array:
            first = anchors[0] + turned(leg, distances[0] * np.eye(2)[0])
            apart = first + turned(turn, corners[i]) - anchors[i]
            return np.asarray((np.sum(apart**2, axis=-1) - distances[i] ** 2) / size**2)

        return left

    def placed(angles: Numbers) -> Numbers:
        R = turn_about_z(angles[0])[:3, :3]
        first = anchors[0] + turned(angles[1], distances[0] * np.eye(2)[0])
        origin = first - R[:2, :2] @ robot.platform_points[0]
        return _assembled(R, np.append(origin, 0.0))

    tables = np.array([_table(closure(i)) for i in (1, 2)])
    return PlatformEquations(robot.family, ("phi", "psi_1"), tables, ((0, 1), (0, 1)), 6, placed)


def _axis_equations(robot: Spherical3RRR, q: Array) -> PlatformEquations:
    """Equate the cosines of the angles between axes 2 and 3 of both ends with those given."""
    turns = matrix_from_rotation_vector(q[:, None] * robot.base_axes)
    w = np.einsum("kij,kj->ki", turns, robot.middle_axes)
    v, cosines = robot.platform_axes, np.cos(robot.distal)
    before, after = _frame_along(w[0]), _frame_along(v[0]).T
    link = np.eye(4)
    c, s = np.cos(robot.distal[0]), np.sin(robot.distal[0])
    link[1:3, 1:3] = [[c, -s], [s, c]]

    def rotation(first: Numbers, second: Numbers) -> Numbers:
        inner = turn_about_z(first) @ link @ turn_about_z(second)
        turned: Numbers = before @ inner[..., :3, :3] @ after
        return turned

    def closure(i: int) -> Callable[[Array, Array], Array]:
        return lambda x, y: w[i] @ rotation(x, y) @ v[i] - cosines[i]

    def placed(angles: Numbers) -> Numbers:
        return _assembled(rotation(*angles), np.zeros(3))

    tables = np.array([_table(closure(i)) for i in (1, 2)])
    return PlatformEquations(robot.family, ("phi_1", "psi_1"), tables, ((0, 1), (0, 1)), 8, placed)


def _table(closure: Callable[[Array, Array], Array]) -> Array:
    """Return the coefficients (3, 3) of products of (cos, sin, 1) of two angles."""
    values = closure(*np.meshgrid(THIRDS, THIRDS, indexing="ij"))
    return np.asarray(FROM_THIRDS @ values @ FROM_THIRDS.T)


def _pairs_of_legs(robot: StewartGough) -> list[tuple[int, int]]:
    """Return the legs that end at each of three points of the platform."""
    b = robot.platform_points
    near = np.abs(b[:, None] - b).max(axis=2) <= _SAME * np.ptp(b, axis=0).max()
    pairs = sorted({tuple(np.flatnonzero(row).tolist()) for row in near})
    expected = "three points, each the end of two legs with different base points"
    if [len(pair) for pair in pairs] != [2, 2, 2]:
        raise BadValueError("platform_points", b.tolist(), expected)
    vertices = b[[pair[0] for pair in pairs]]
    apart = np.diff(robot.base_points[np.array(pairs)], axis=1)
    if np.abs(apart).max(axis=(1, 2)).min() <= _SAME * np.ptp(robot.base_points, axis=0).max():
        raise BadValueError("base_points", robot.base_points.tolist(), expected)
    first, second = vertices[1:] - vertices[0]
    if np.linalg.norm(np.cross(first, second)) <= _SAME * (first @ first + second @ second):
        raise BadValueError("platform_points", vertices.tolist(), "a triangle, not a line")
    return [(pair[0], pair[1]) for pair in pairs]


def _triad(points: Numbers) -> Numbers:
    """Return two sides and their cross product as columns: all rotate with the points (3, 3)."""
    one, other = points[1] - points[0], points[2] - points[0]
    return np.stack((one, other, np.cross(one, other)), axis=1)


def _frame_along(axis: Array) -> Array:
    """Return a rotation (3, 3) whose third column is a unit vector."""
    x = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    x = x / np.linalg.norm(x)
    return np.stack((x, cross_product_matrix(axis) @ x, axis), axis=1)


def _assembled(R: Numbers, p: Numbers) -> Numbers:
    T = np.eye(4, dtype=np.result_type(R, p))
    T[:3, :3], T[:3, 3] = R, p
    return T
