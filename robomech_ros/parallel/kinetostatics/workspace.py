"""Range of a platform from a pose, in translation or rotation, and the limb that ends it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.parallel.kinetostatics.limb_geometry import limbs_at, motions_of, poses_of
from robomech_ros.parallel.kinetostatics.mechanism_poses import (
    followed,
    free_axes,
    platform_span,
    side_of_mechanism,
)
from robomech_ros.parallel.kinetostatics.pose_limits import (
    PoseLimits,
    as_branches,
    limits_at,
    together,
)
from robomech_ros.parallel.kinetostatics.pose_samples import size_of
from robomech_ros.parallel.library import AnyParallelRobot
from robomech_ros.parallel.mechanism.model import Mechanism
from robomech_ros.parallel.planar import Planar3RPR
from robomech_ros.parallel.stewart_gough import StewartGough
from robomech_ros.spatial.arrays import as_finite
from robomech_ros.spatial.poses import assembled
from robomech_ros.spatial.rotations.axis_angle import matrix_from_rotation_vector
from robomech_ros.typing import Array, ArrayLike, IntArray

TYPE_2 = "type 2 singularity"

_ANGULAR = 3
# Poses that are looked at along each direction, and halvings between two of them.
_SAMPLES, _HALVINGS = 64, 45
_DIRECTIONS, _MOST_DIRECTIONS = 256, 100_000
_GOLDEN_ANGLE = np.pi * (3.0 - np.sqrt(5.0))
# Robots without strokes: how far they are looked at, of their size.
_FARTHEST = 4.0
# Part of a direction that the platform does not have and that is rounding.
_OFF = 1e-6
# Names of joints of a mechanism are part of a cause.
_CAUSE = np.dtype("U120")


@dataclass(frozen=True, eq=False)
class PlatformWorkspace:
    """Range of a platform from a pose, along directions or by rotations about axes.

    Parameters
    ----------
    centre : ndarray, shape (4, 4)
        The pose from which it was explored.
    turns : bool
        Whether the platform was turned about the directions instead of moved along them.
    directions : ndarray, shape (k, 3)
        Unit vectors in the base.
    distances : ndarray, shape (k,)
        How far it gets (m, or rad up to pi), to 1e-12 of what was looked at.
    causes : ndarray of str, shape (k,)
        What ends it, as ``pose_limits`` says it, or "type 2 singularity"; empty where nothing does.
    """

    centre: Array
    turns: bool
    directions: Array
    distances: Array
    causes: NDArray[np.str_]

    @property
    def poses(self) -> Array:
        """The last poses along each direction, shape (k, 4, 4)."""
        return _poses(self.centre, self.turns, self.directions, self.distances)

    @property
    def points(self) -> Array:
        """Positions of the last poses, shape (k, 3), in the base (m)."""
        return np.asarray(self.poses[:, :3, 3])

    def shares(self) -> dict[str, float]:
        """Return which part of the directions each cause ends, the largest first."""
        names, counts = np.unique(self.causes, return_counts=True)
        order = np.argsort(-counts, kind="stable")
        return {str(names[k]): float(counts[k] / len(self.causes)) for k in order}


def platform_position_workspace(
    robot: AnyParallelRobot,
    T: ArrayLike,
    *,
    branches: str | None = None,
    directions: int | ArrayLike = _DIRECTIONS,
) -> PlatformWorkspace:
    """Find where the platform can be with the orientation of a pose, around its position.

    From the pose outwards each direction is followed to the first place that limbs do not reach
    within their limits, or that is singular of type 2; islands behind it do not count, nor what is
    thinner than a 64th of the reach.

    Parameters
    ----------
    robot : StewartGough, Delta, Planar3RPR, Planar3RRR or Mechanism
        One that moves to places.
    T : array_like, shape (4, 4)
        ``T_base_platform``, or a shorter form as for :func:`velocity_matrices`.
    branches : str, optional
        Of the limbs, such as "---"; default any, and then singularities of type 2, which depend on
        them, end nothing.  Robots with legs have none, and of a mechanism the posture nearest to
        its home counts, and those that follow it.
    directions : int or array_like, shape (k, 3), optional
        How many, evenly all round in the space or the plane in which it moves, or which, in the
        base; a platform that moves along a line does so both ways.

    Raises
    ------
    BadValueError
        The pose is excluded itself, or singular; a robot that only turns, or moves only as it
        turns; directions that the platform does not have.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.parallel import load_parallel, platform_position_workspace
    >>> T = np.eye(4)
    >>> T[2, 3] = 0.6
    >>> up = platform_position_workspace(load_parallel("hexapod"), T, directions=[[0, 0, 1]])
    >>> up.distances.round(4), str(up.causes[0])
    (array([0.1679]), 'leg 3: too long')
    """
    return _explored(robot, T, branches, directions, turns=False)


def platform_orientation_workspace(
    robot: AnyParallelRobot,
    T: ArrayLike,
    *,
    branches: str | None = None,
    directions: int | ArrayLike = _DIRECTIONS,
) -> PlatformWorkspace:
    """Find how far the platform can turn at the position of a pose, from its orientation.

    As :func:`platform_position_workspace`, with turns about axes of the base through the
    platform's origin, by up to half a turn each way.

    Parameters
    ----------
    robot : StewartGough, Planar3RPR, Planar3RRR, Spherical3RRR or Mechanism
        One that turns at a place.
    T : array_like, shape (4, 4)
        ``T_base_platform``, or a shorter form as for :func:`velocity_matrices`.
    branches : str, optional
        As for :func:`platform_position_workspace`.
    directions : int or array_like, shape (k, 3), optional
        Axes of the turns in the base: how many, evenly all round, or which; a platform that turns
        about one axis, as of planar robots, does so both ways.

    Raises
    ------
    BadValueError, WrongSizeError
        As for :func:`platform_position_workspace`; a robot that only translates, or turns only as
        it moves, as ``tripod_3prs``.
    """
    return _explored(robot, T, branches, directions, turns=True)


def _pose(centre: Array, turns: bool, direction: Array, distance: float) -> Array:
    return np.asarray(_poses(centre, turns, direction[None], np.array([distance]))[0])


def _axes(robot: AnyParallelRobot, centre: Array, first: PoseLimits, turns: bool) -> Array:
    """Return axes (3, d) along which a platform moves or about which it turns, one at least."""
    name = type(robot).__name__
    if isinstance(robot, Mechanism):
        name, axes = robot.name, free_axes(robot, centre, first.q[0], turns=turns)
    else:
        kind = range(_ANGULAR) if turns else range(_ANGULAR, 2 * _ANGULAR)
        axes = np.eye(3)[:, [k % _ANGULAR for k in motions_of(robot) if k in kind]]
    if not axes.size:
        does = "turns without moving" if turns else "moves to places without turning"
        raise BadValueError("robot", name, f"one whose platform {does}")
    return axes


def _directions(given: int | ArrayLike, axes: Array) -> Array:
    """Check directions, or spread them along an axis, in a plane or in the space."""
    count = axes.shape[1]
    if not isinstance(given, int | np.integer) or isinstance(given, bool):
        rays = as_finite("directions", given, (3,))
        norms = np.linalg.norm(rays, axis=-1, keepdims=True)
        if rays.ndim != 2 or not len(rays):
            raise WrongSizeError("directions", rays.shape, "(k, 3)")
        if not (norms > 0.0).all():
            raise BadValueError("directions", rays.tolist(), "none of them zero")
        rays = np.asarray(rays / norms)
        if np.abs(rays - rays @ axes @ axes.T).max() > _OFF:
            where = "along" if count == 1 else "in the plane of"
            expected = f"{where} {' and '.join(str(axis.round(6).tolist()) for axis in axes.T)}"
            raise BadValueError("directions", rays.tolist(), expected)
        return rays
    if not 1 <= given <= _MOST_DIRECTIONS:
        why = f"a number from 1 to {_MOST_DIRECTIONS:,}"
        raise BadValueError("directions", given, why)
    if count == 1:
        return np.stack((axes[:, 0], -axes[:, 0]))
    k = np.arange(given)
    if count == 2:
        angle = 2.0 * np.pi * k / given
        return np.asarray(np.stack((np.cos(angle), np.sin(angle)), axis=1) @ axes.T)
    z, angle = 1.0 - (2.0 * k + 1.0) / given, _GOLDEN_ANGLE * k
    radius = np.sqrt(1.0 - z * z)
    return np.stack((radius * np.cos(angle), radius * np.sin(angle), z), axis=1)


def _poses(centre: Array, turns: bool, directions: Array, distances: Array) -> Array:
    """Return the poses (k, 4, 4) at distances along directions."""
    steps = distances[:, None] * directions
    if not turns:
        return assembled(centre[:3, :3], centre[:3, 3] + steps)
    return assembled(matrix_from_rotation_vector(steps) @ centre[:3, :3], centre[:3, 3])


def _explored(
    robot: AnyParallelRobot,
    T: ArrayLike,
    branches: str | None,
    directions: int | ArrayLike,
    *,
    turns: bool,
) -> PlatformWorkspace:
    centre, mode = poses_of(robot, T), as_branches(robot, branches)
    if centre.shape != (4, 4):
        raise WrongSizeError("pose", centre.shape, (4, 4))
    first = limits_at(robot, centre[None], mode)
    if not first.inside[0]:
        why = f"one within the limits, not {first.cause[0]} by {first.excess[0]:.3g}"
        raise BadValueError("pose to begin with", centre.tolist(), why)
    rays = _directions(directions, _axes(robot, centre, first, turns))
    sided = mode is not None or isinstance(robot, StewartGough | Planar3RPR | Mechanism)
    side = _side(robot, centre[None], first, first)[0] if sided else 0.0
    if sided and side == 0.0:
        why = "a pose that is not singular: no side of it is known"
        raise BadValueError("pose to begin with", centre.tolist(), why)

    # Postures of a mechanism are followed along each direction, from the last place that it takes.
    last, reached = np.tile(first.q[0], (len(rays), 1)), np.zeros(len(rays))

    def verdict(which: IntArray, distances: Array) -> NDArray[np.str_]:
        poses = _poses(centre, turns, rays[which], distances)
        if isinstance(robot, Mechanism):
            rows = []
            for k, end in zip(which, distances.tolist(), strict=True):
                way = partial(_pose, centre, turns, rays[k])
                rows.append(followed(robot, way, reached[k], end, last[k]))
            found = together(rows, robot.n)
        else:
            found = limits_at(robot, poses, mode)
        cause = found.cause.astype(_CAUSE)
        if sided:
            kept = np.flatnonzero(found.inside)
            own = PoseLimits(*(part[kept] for part in vars(found).values()))
            crossed = _side(robot, poses[kept], own, first) != side
            cause[kept[crossed]] = TYPE_2
        inside = cause == ""
        last[which[inside]], reached[which[inside]] = found.q[inside], distances[inside]
        return cause

    distances, causes = _ends(verdict, len(rays), np.pi if turns else _far(robot, centre))
    return PlatformWorkspace(centre, turns, rays, distances, causes)


def _far(robot: AnyParallelRobot, centre: Array) -> float:
    if isinstance(robot, StewartGough | Planar3RPR) and robot.strokes is None:
        return _FARTHEST * size_of(robot)
    far = platform_span(robot) if isinstance(robot, Mechanism) else size_of(robot)
    return far + float(np.linalg.norm(centre[:3, 3]))


def _side(robot: AnyParallelRobot, poses: Array, found: PoseLimits, first: PoseLimits) -> Array:
    """Return the sign (k,) of the determinant of K for the platform's motions."""
    if isinstance(robot, Mechanism):
        return side_of_mechanism(robot, poses, found.q, first.q[0])
    K = limbs_at(robot, poses, found.q).rows()[0]
    return np.asarray(np.sign(np.linalg.det(K[..., list(motions_of(robot))])))


def _ends(
    verdict: Callable[[IntArray, Array], NDArray[np.str_]], count: int, far: float
) -> tuple[Array, NDArray[np.str_]]:
    """Find the first place along each of some rays that is excluded, and why."""
    near, beyond = np.zeros(count), np.full(count, far)
    causes = np.full(count, "", dtype=_CAUSE)

    def kept(rays: IntArray, places: Array) -> IntArray:
        """Look at a place on each ray, and return the rays that are not ended there."""
        found = verdict(rays, places)
        ended = found != ""
        beyond[rays[ended]], causes[rays[ended]] = places[ended], found[ended]
        going_on: IntArray = rays[~ended]
        near[going_on] = places[~ended]
        return going_on

    rays = np.arange(count)
    for k in range(1, _SAMPLES + 1):
        rays = kept(rays, np.full(len(rays), far * k / _SAMPLES))
        if not len(rays):
            break
    rays = np.flatnonzero(causes != "")
    for _ in range(_HALVINGS if len(rays) else 0):
        kept(rays, 0.5 * (near[rays] + beyond[rays]))
    return near, causes
