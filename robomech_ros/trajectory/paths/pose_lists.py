"""Paths through lists of poses: straight, along arcs, and smooth."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from robomech_ros._kernels.tolerances import LARGEST_LENGTH
from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.spatial.arrays import listed, of_shape
from robomech_ros.spatial.poses import as_pose
from robomech_ros.trajectory.curves.cubic_spline import cubic_spline
from robomech_ros.trajectory.curves.interpolation import interpolant
from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial
from robomech_ros.trajectory.paths.closed_form import arc_through
from robomech_ros.trajectory.paths.curve import FunctionCurve, PolynomialCurve, join_curves
from robomech_ros.trajectory.paths.curve_arguments import as_positive
from robomech_ros.trajectory.paths.orientation import (
    PiecewiseRotation,
    geodesic_orientation,
    turns_between,
)
from robomech_ros.trajectory.paths.orientation_spline import orientation_spline
from robomech_ros.trajectory.paths.pose_path import PosePath, pose_path
from robomech_ros.trajectory.tolerances import COINCIDENT
from robomech_ros.typing import Array, ArrayLike

# What a turn counts in the coordinate of a path through poses (m/rad): about the distance at which
# a tool of the usual size touches its work.
TURN_RADIUS = 0.1


def straight_path(poses: ArrayLike, *, radius: float = TURN_RADIUS) -> PosePath:
    """Go from pose to pose on straight lines, turning about a fixed axis on each.

    Parameters
    ----------
    poses : array_like, shape (n, 4, 4)
        ``T_base_tool``, at least two (m).  Neighbours may share the position or the orientation.
    radius : float, optional
        What a turn counts in the path coordinate (m/rad), above 0.

    Returns
    -------
    PosePath
        Its twist is constant on every leg; it steps at the poses between, which are its `stops`,
        unless a leg goes on as the one before.

    Raises
    ------
    BadValueError, WrongSizeError
        Not poses, fewer than two, equal neighbours, or neighbours of opposite orientations.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.trajectory import straight_path
    >>> start, goal = np.eye(4), np.eye(4)
    >>> goal[:3, 3] = [0.3, 0.4, 0.0]
    >>> path = straight_path([start, goal])
    >>> round(path.length, 6), path.sample(0.25).pose[:3, 3].round(6)
    (0.5, array([0.15, 0.2 , 0.  ]))
    """
    given, knots, weight = _checked(poses, radius)
    curve = PolynomialCurve(interpolant(knots, given[:, :3, 3]))
    return pose_path(curve, geodesic_orientation(given[:, :3, :3], knots), radius=weight)


def spline_path(poses: ArrayLike, *, radius: float = TURN_RADIUS) -> PosePath:
    """Go smoothly through poses: twist and derivative of the twist are continuous.

    The position is a natural cubic spline, the orientation the natural spline of
    `orientation_spline`, over the same knots, which are as far apart as the poses.

    Parameters
    ----------
    poses : array_like, shape (n, 4, 4)
        ``T_base_tool``, at least two (m).
    radius : float, optional
        What a turn counts in the path coordinate and in the distance of poses (m/rad), above 0.
    """
    given, knots, weight = _checked(poses, radius)
    curve = PolynomialCurve(cubic_spline(knots, given[:, :3, 3], "natural"))
    turning = orientation_spline(given[:, :3, :3], knots)
    try:
        return pose_path(curve, turning, radius=weight)
    except BadValueError:
        k = _turning_back(given)
        if k is None:
            raise
        expected = "a pose from which a smooth path need not go straight back, as it does here"
        raise BadValueError(f"poses[{k}]", given[k, :3, 3].tolist(), expected) from None


def _turning_back(poses: Array) -> int | None:
    """Find the inner pose at which the way goes straight back most nearly, if any."""
    legs = np.diff(poses[:, :3, 3], axis=0)
    along = (legs[1:] * legs[:-1]).sum(axis=1)
    lengths = np.linalg.norm(legs, axis=1)
    cosines = along / np.maximum(lengths[1:] * lengths[:-1], np.finfo(np.float64).tiny)
    if not len(cosines) or cosines.min() > 0.0:
        return None
    return int(np.argmin(cosines)) + 1


def arc_path(
    start: ArrayLike,
    pairs: Sequence[tuple[ArrayLike, ArrayLike]] | ArrayLike,
    *,
    radius: float = TURN_RADIUS,
) -> PosePath:
    """Go along circular arcs, each through one pose to another.

    On every arc the orientation is the natural spline through its three, over the angle of the
    arc, so that the pose in the middle is passed as it is given.

    Parameters
    ----------
    start : array_like, shape (4, 4)
        ``T_base_tool`` where the first arc begins (m).
    pairs : sequence of (through, to), array_like, shape (k, 2, 4, 4)
        For each arc a pose on it and its last one (m).
    radius : float, optional
        What a turn counts in the path coordinate (m/rad), above 0.

    Returns
    -------
    PosePath
        Its `stops` are the joints of arcs that do not go on smoothly into each other.

    Raises
    ------
    BadValueError
        Not poses or pairs, positions that coincide or lie on a line, or neighbours of opposite
        orientations.
    """
    weight = as_positive("radius", radius)
    poses = [_one_pose("start", start)]
    expected = "a list of at least one pair of poses (through, to)"
    for k, pair in enumerate(listed("pairs", pairs, expected)):
        both = listed(f"pairs[{k}]", pair, "two poses (through, to)")
        if len(both) != 2:
            raise WrongSizeError(f"pairs[{k}]", len(both), 2)
        poses += [_one_pose(f"pairs[{k}][{i}]", one) for i, one in enumerate(both)]
    if len(poses) < 3:
        raise BadValueError("pairs", [], expected)
    arcs = [_arc(k, poses[2 * k : 2 * k + 3]) for k in range(len(poses) // 2)]
    curve = join_curves([arc for arc, _ in arcs])
    turning = _joined_rotations([rotation for _, rotation in arcs], curve.starts)
    return pose_path(curve, turning, radius=weight)


def _arc(k: int, poses: list[Array]) -> tuple[FunctionCurve, PiecewiseRotation]:
    """Arc number k through three poses, and the orientation along it."""
    first, middle, last = (pose[:3, 3] for pose in poses)
    rotations = np.stack([pose[:3, :3] for pose in poses])
    try:
        curve = arc_through(first, middle, last)
        x, y, _ = (middle - curve.pose[:3, 3]) @ curve.pose[:3, :3]
        angle = math.atan2(float(y), float(x)) % math.tau
        turning = orientation_spline(rotations, [0.0, angle, float(curve.breaks[-1])])
    except BadValueError as error:
        raise BadValueError(f"arc {k}: {error.what}", error.value, error.expected) from None
    return curve, turning


def _joined_rotations(parts: list[PiecewiseRotation], starts: Array) -> PiecewiseRotation:
    """Put orientations one after another, each from its start on."""
    knots = [part.breaks[:-1] + begin for part, begin in zip(parts, starts, strict=False)]
    rotations = [part.rotations[:-1] for part in parts] + [parts[-1].rotations[-1:]]
    coefficients = np.concatenate([part.vectors.coefficients for part in parts], axis=1)
    breaks = np.concatenate([*knots, starts[-1:]])
    return PiecewiseRotation(np.concatenate(rotations), PiecewisePolynomial(breaks, coefficients))


def _one_pose(what: str, value: ArrayLike) -> Array:
    pose = of_shape(what, as_pose(value, what=what), (4, 4))
    _check_size(what, pose[None])
    return pose


def _checked(poses: ArrayLike, radius: float) -> tuple[Array, Array, float]:
    """Check poses; give them, knots as far apart as they are, and the radius."""
    weight = as_positive("radius", radius)
    given = as_pose(poses, what="poses")
    if given.ndim != 3 or len(given) < 2:
        raise WrongSizeError("poses", given.shape, "(n, 4, 4) with n at least 2")
    _check_size("poses", given)
    angles = np.linalg.norm(turns_between("poses", given[:, :3, :3]), axis=1)
    apart = np.hypot(np.linalg.norm(np.diff(given[:, :3, 3], axis=0), axis=1), weight * angles)
    size = max(float(np.ptp(given[:, :3, 3], axis=0).max()), weight)
    close = np.flatnonzero(apart <= COINCIDENT * size)
    if len(close):
        k = int(close[0])
        expected = f"a pose other than poses[{k}]"
        raise BadValueError(f"poses[{k + 1}]", given[k + 1].tolist(), expected)
    return given, np.concatenate([[0.0], np.cumsum(apart)]), weight


def _check_size(what: str, poses: Array) -> None:
    places = np.abs(poses[:, :3, 3])
    if places.max() > LARGEST_LENGTH:
        expected = f"coordinates of at most {LARGEST_LENGTH:g} m"
        raise BadValueError(f"position of {what}", float(places.max()), expected)
