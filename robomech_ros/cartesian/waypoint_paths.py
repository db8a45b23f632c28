"""Pose paths from where the tip is through waypoints."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from typing import Literal, get_args

import numpy as np

from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.spatial.arrays import as_choice, held_rows, real_array
from robomech_ros.spatial.poses import as_pose
from robomech_ros.spatial.rotations.axis_angle import matrix_from_rotation_vector
from robomech_ros.spatial.screws.pose_conversions import pose_error
from robomech_ros.trajectory import PosePath, arc_path, spline_path, straight_path
from robomech_ros.trajectory.paths.partial_poses import least_turn
from robomech_ros.typing import Array, ArrayLike, IntArray

PathKind = Literal["straight", "spline", "arc"]
# Poses nearer to the one before than this (rad, m) are the same waypoint.
_SAME = 1e-9


def waypoint_path(
    start: ArrayLike,
    waypoints: ArrayLike,
    kind: PathKind = "straight",
    task_mask: Sequence[bool] | None = None,
) -> PosePath | None:
    """Lay a path from a pose through others.

    Waypoints that are where the one before is count once.

    Parameters
    ----------
    start : array_like, shape (4, 4)
        ``T_base_tip`` (m).
    waypoints : array_like, shape (m, 4, 4)
        Poses in the same base.
    kind : str
        ``"straight"``: lines; ``"spline"``: smooth through all; ``"arc"``: arcs, whose waypoints
        come in pairs (through, to).
    task_mask : sequence of six bool, optional
        As for `follow_path`.  Where it holds the position and frees the turn about one axis or
        all, orientations of waypoints count only as far as they are held.

    Returns
    -------
    PosePath or None
        With all the waypoints; None where they all are the start.

    Raises
    ------
    WrongSizeError
        No waypoints, or arcs with half a pair.
    BadValueError
        An unknown kind, invalid poses, or poses without such a path between them; the message
        names the waypoints.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.cartesian import waypoint_path
    >>> there = np.eye(4)
    >>> there[:3, 3] = 0.3, 0.0, 0.4
    >>> waypoint_path(np.eye(4), [there]).length
    0.5
    """
    as_choice("kind", kind, get_args(PathKind))
    if not real_array("waypoints", waypoints).size:
        raise WrongSizeError("waypoints", 0, "at least one pose")
    here, others = _checked("start", start, 2), _checked("waypoints", waypoints, 3)
    if task_mask is not None:
        others = _with_held_turns(here, others, held_rows("task_mask", task_mask))
    if kind == "arc":
        return replace(_arcs(here, others), waypoints=others)
    poses = np.concatenate([here[None], others])
    apart = np.abs(pose_error(poses[1:], poses[:-1])).max(axis=1)
    kept = np.flatnonzero(np.append(True, apart > _SAME))
    distinct = poses[kept]
    if len(distinct) == 1:
        return None
    lay = straight_path if kind == "straight" else spline_path
    try:
        return replace(lay(distinct), waypoints=others)
    except BadValueError as error:
        raise _in_waypoints(error, kept, kind) from None


def _checked(what: str, poses: ArrayLike, dimensions: int) -> Array:
    """Check poses, and give them with their rounding, which the paths remove."""
    if as_pose(poses, what=what).ndim != dimensions:
        expected = "(4, 4)" if dimensions == 2 else "(m, 4, 4)"
        raise WrongSizeError(what, np.shape(poses), expected)
    return np.asarray(poses, dtype=np.float64)


def _with_held_turns(start: Array, waypoints: Array, rows: IntArray) -> Array:
    """Turn each waypoint no farther from the one before than what is held needs."""
    if len(rows) not in (3, 5) or not np.isin((3, 4, 5), rows).all():
        return waypoints
    found, last = waypoints.copy(), start[:3, :3]
    for pose in found:
        last = matrix_from_rotation_vector(least_turn(pose[:3, :3], last, rows)) @ last
        pose[:3, :3] = last
    return found


def _arcs(start: Array, waypoints: Array) -> PosePath:
    if len(waypoints) % 2:
        raise WrongSizeError("waypoints", len(waypoints), "pairs of poses (through, to)")
    try:
        return arc_path(start, waypoints.reshape(-1, 2, 4, 4))
    except BadValueError as error:
        raise _of_arc(error) from None


def _waypoint(k: int) -> str:
    """Name a pose by its number; the first one is the start."""
    return f"waypoints[{k - 1}]" if k else "the start"


def _in_waypoints(error: BadValueError, kept: IntArray, kind: str) -> BadValueError:
    """Name waypoints instead of poses of a path."""
    what = re.sub(r"poses\[(\d+)\]", lambda k: _waypoint(int(kept[int(k[1])])), error.what)
    expected = error.expected
    if kind == "spline" and re.fullmatch(r"poses\[\d+\]", error.what):
        expected = f"{expected}; a straight path rests there instead"
    return BadValueError(what, error.value, expected)


def _of_arc(error: BadValueError) -> BadValueError:
    """Name waypoints instead of an arc and its three points or orientations."""
    arc = re.match(r"arc (\d+): ", error.what)
    if arc is None:
        return error
    names = [_waypoint(2 * int(arc[1]) + k) for k in range(3)]
    numbers = [int(k) for k in re.findall(r"\[(\d)\]", error.what)]
    if "rotations" in error.what:
        what = f"angle (rad) from {names[numbers[0]]} to {names[numbers[1]]}"
        return BadValueError(what, error.value, error.expected)
    if not numbers:
        return BadValueError(f"positions of {', '.join(names)}", error.value, error.expected)
    # The point after the last one of three is the first again.
    before, there = names[numbers[0] - 1], names[min(numbers[0], 2)]
    other = names[0] if numbers[0] > 2 else before
    return BadValueError(f"position of {there}", error.value, f"apart from that of {other}")
