"""How far a platform can be moved or turned from a pose, and which limb ends it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.parallel.kinetostatics.limb_geometry import limbs_at, motions_of, poses_of
from robomech_ros.parallel.kinetostatics.pose_limits import PoseLimits, as_branches, limits_at
from robomech_ros.parallel.kinetostatics.pose_samples import size_of
from robomech_ros.parallel.library import ParallelRobot
from robomech_ros.parallel.planar import Planar3RPR
from robomech_ros.parallel.stewart_gough import StewartGough
from robomech_ros.spatial.arrays import as_finite
from robomech_ros.spatial.poses import assembled
from robomech_ros.spatial.rotations.axis_angle import matrix_from_rotation_vector

__all__ = [
    "TYPE_2",
    "PlatformWorkspace",
    "platform_orientation_workspace",
    "platform_position_workspace",
]

Array = NDArray[np.float64]

TYPE_2 = "type 2 singularity"

_ANGULAR = 3
# Poses that are looked at along each direction, and halvings between two of them.
_SAMPLES, _HALVINGS = 64, 45
_DIRECTIONS, _MOST_DIRECTIONS = 256, 100_000
_GOLDEN_ANGLE = np.pi * (3.0 - np.sqrt(5.0))
# Robots without strokes: how far they are looked at, of their size.
_FARTHEST = 4.0


@dataclass(frozen=True, eq=False)
class PlatformWorkspace:
    """How far a platform gets from a pose, along directions or by turns about axes.

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
        """Give which part of the directions each cause ends, the largest first."""
        names, counts = np.unique(self.causes, return_counts=True)
        order = np.argsort(-counts, kind="stable")
        return {str(names[k]): float(counts[k] / len(self.causes)) for k in order}


def platform_position_workspace(
    robot: ParallelRobot,
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
    robot : StewartGough, Delta, Planar3RPR or Planar3RRR
        One that moves to places.
    T : array_like, shape (4, 4)
        ``T_base_platform``, or a shorter form as for :func:`velocity_matrices`.
    branches : str, optional
        Of the limbs, such as "---"; default any, and then singularities of type 2, which depend on
        them, end nothing.  Robots with legs have none.
    directions : int or array_like, shape (k, 3), optional
        How many, evenly all round in the space or the plane, or which, in the base.

    Returns
    -------
    PlatformWorkspace

    Raises
    ------
    BadValueError, WrongSizeError, NonFiniteError
        As for :func:`pose_limits`; the pose is excluded itself, or singular; a robot that only
        turns; not directions.

    See Also
    --------
    platform_orientation_workspace : turns about a position.
    pose_limits : single poses.

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
    if not any(k >= _ANGULAR for k in motions_of(robot)):
        raise BadValueError("robot", type(robot).__name__, "one whose platform moves to places")
    planar = motions_of(robot) == (2, 3, 4)
    rays = _directions(directions, "xy" if planar else "xyz")
    if planar and rays[:, 2].any():
        raise BadValueError("directions", rays.tolist(), "directions in the plane z = 0")
    return _explored(robot, T, branches, rays, turns=False)


def platform_orientation_workspace(
    robot: ParallelRobot,
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
    robot : StewartGough, Planar3RPR, Planar3RRR or Spherical3RRR
        One that turns.
    T : array_like, shape (4, 4)
        ``T_base_platform``, or a shorter form as for :func:`velocity_matrices`.
    branches : str, optional
        As for :func:`platform_position_workspace`.
    directions : int or array_like, shape (k, 3), optional
        Axes of the turns in the base: how many, evenly all round, or which; planar robots turn
        both ways about z.

    Returns
    -------
    PlatformWorkspace

    Raises
    ------
    BadValueError, WrongSizeError, NonFiniteError
        As for :func:`platform_position_workspace`; a robot that only translates.

    See Also
    --------
    platform_position_workspace : places with one orientation.
    """
    motions = motions_of(robot)
    if not any(k < _ANGULAR for k in motions):
        raise BadValueError("robot", type(robot).__name__, "one whose platform turns")
    planar = motions == (2, 3, 4)
    rays = _directions(directions, "z" if planar else "xyz")
    if planar and rays[:, :2].any():
        raise BadValueError("directions", rays.tolist(), "turns about z")
    return _explored(robot, T, branches, rays, turns=True)


def _directions(given: int | ArrayLike, axes: str) -> Array:
    """Check directions, or spread them along an axis, in a plane or in the space."""
    if not isinstance(given, int | np.integer) or isinstance(given, bool):
        rays = as_finite("directions", given, (3,))
        norms = np.linalg.norm(rays, axis=-1, keepdims=True)
        if rays.ndim != 2 or not len(rays):
            raise WrongSizeError("directions", rays.shape, "(k, 3)")
        if not (norms > 0.0).all():
            raise BadValueError("directions", rays.tolist(), "none of them zero")
        return np.asarray(rays / norms)
    if not 1 <= given <= _MOST_DIRECTIONS:
        why = f"a number from 1 to {_MOST_DIRECTIONS:,}"
        raise BadValueError("directions", given, why)
    if axes == "z":
        return np.array([[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]])
    k = np.arange(given)
    if axes == "xy":
        angle = 2.0 * np.pi * k / given
        return np.stack((np.cos(angle), np.sin(angle), 0.0 * angle), axis=1)
    z, angle = 1.0 - (2.0 * k + 1.0) / given, _GOLDEN_ANGLE * k
    radius = np.sqrt(1.0 - z * z)
    return np.stack((radius * np.cos(angle), radius * np.sin(angle), z), axis=1)


def _poses(centre: Array, turns: bool, directions: Array, distances: Array) -> Array:
    """Give the poses (k, 4, 4) at distances along directions."""
    steps = distances[:, None] * directions
    if not turns:
        T = np.tile(centre, (len(steps), 1, 1))
        T[:, :3, 3] += steps
        return T
    R = matrix_from_rotation_vector(steps) @ centre[:3, :3]
    return assembled(R, np.broadcast_to(centre[:3, 3], steps.shape))


def _explored(
    robot: ParallelRobot, T: ArrayLike, branches: str | None, rays: Array, *, turns: bool
) -> PlatformWorkspace:
    centre, mode = poses_of(robot, T), as_branches(robot, branches)
    if centre.shape != (4, 4):
        raise WrongSizeError("pose", centre.shape, (4, 4))
    first = limits_at(robot, centre[None], mode)
    if not first.inside[0]:
        why = f"one within the limits, not {first.cause[0]} by {first.excess[0]:.3g}"
        raise BadValueError("pose to begin with", centre.tolist(), why)
    sided = mode is not None or isinstance(robot, StewartGough | Planar3RPR)
    side = _side(robot, centre[None], first)[0] if sided else 0.0
    if sided and side == 0.0:
        why = "a pose that is not singular: no side of it is known"
        raise BadValueError("pose to begin with", centre.tolist(), why)

    def verdict(which: NDArray[np.int64], distances: Array) -> NDArray[np.str_]:
        poses = _poses(centre, turns, rays[which], distances)
        found = limits_at(robot, poses, mode)
        cause = found.cause.astype(np.dtype("U40"))
        if sided:
            kept = np.flatnonzero(found.inside)
            own = PoseLimits(*(part[kept] for part in vars(found).values()))
            crossed = _side(robot, poses[kept], own) != side
            cause[kept[crossed]] = TYPE_2
        return cause

    free = isinstance(robot, StewartGough | Planar3RPR) and robot.strokes is None
    far = np.pi if turns else (_FARTHEST if free else 1.0) * size_of(robot)
    if not turns and not free:
        far += float(np.linalg.norm(centre[:3, 3]))
    distances, causes = _ends(verdict, len(rays), far)
    return PlatformWorkspace(centre, turns, rays, distances, causes)


def _side(robot: ParallelRobot, poses: Array, found: PoseLimits) -> Array:
    """Give the sign (k,) of the determinant of K for the platform's motions."""
    K = limbs_at(robot, poses, found.q).rows()[0]
    return np.asarray(np.sign(np.linalg.det(K[..., list(motions_of(robot))])))


def _ends(
    verdict: Callable[[NDArray[np.int64], Array], NDArray[np.str_]], count: int, far: float
) -> tuple[Array, NDArray[np.str_]]:
    """Find the first place along each of some rays that is excluded, and why."""
    near, beyond = np.zeros(count), np.full(count, far)
    causes = np.full(count, "", dtype="U40")
    open_rays = np.arange(count)
    for k in range(1, _SAMPLES + 1):
        here = np.full(len(open_rays), far * k / _SAMPLES)
        found = verdict(open_rays, here)
        ended = found != ""
        beyond[open_rays[ended]], causes[open_rays[ended]] = here[ended], found[ended]
        near[open_rays[~ended]] = here[~ended]
        open_rays = open_rays[~ended]
        if not len(open_rays):
            break
    rays = np.flatnonzero(causes != "")
    for _ in range(_HALVINGS if len(rays) else 0):
        middle = 0.5 * (near[rays] + beyond[rays])
        found = verdict(rays, middle)
        ended = found != ""
        beyond[rays[ended]], causes[rays[ended]] = middle[ended], found[ended]
        near[rays[~ended]] = middle[~ended]
    return near, causes
