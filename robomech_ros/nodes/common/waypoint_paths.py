"""Paths in space through the waypoints of a request, in whose words their errors are told."""

import re

import numpy as np
from numpy.typing import NDArray

from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.spatial.poses import pose_error
from robomech_ros.trajectory import PosePath, arc_path, spline_path, straight_path

__all__ = ["path_through"]

Array = NDArray[np.float64]
# Poses nearer to the one before than this (rad, m) are the same waypoint.
_SAME = 1e-9
_KINDS = ("STRAIGHT", "SPLINE", "ARC")


def path_through(start: Array, waypoints: Array, kind: int) -> PosePath | None:
    """Lay a path from a pose through others.

    Parameters
    ----------
    start : ndarray, shape (4, 4)
        ``T_base_tip`` (m).
    waypoints : ndarray, shape (m, 4, 4)
    kind : int
        0 straight, 1 spline, 2 arcs, whose waypoints come in pairs (through, to).

    Returns
    -------
    PosePath or None
        None where all waypoints are the start.

    Raises
    ------
    WrongSizeError
        No waypoints, or arcs with half a pair.
    BadValueError
        An unknown kind, or poses between which there is no such path.
    """
    if not 0 <= kind < len(_KINDS):
        known = ", ".join(f"{name} ({number})" for number, name in enumerate(_KINDS))
        raise BadValueError("path", kind, f"one of {known}")
    if not len(waypoints):
        raise WrongSizeError("waypoints", 0, "at least one pose")
    if _KINDS[kind] == "ARC":
        if len(waypoints) % 2:
            raise WrongSizeError("waypoints", len(waypoints), "pairs of poses (through, to)")
        try:
            return arc_path(start, waypoints.reshape(-1, 2, 4, 4))
        except BadValueError as error:
            raise _of_arc(error) from None
    poses = np.concatenate([start[None], waypoints])
    apart = np.abs(pose_error(poses[1:], poses[:-1])).max(axis=1)
    kept = np.flatnonzero(np.append(True, apart > _SAME))
    distinct = poses[kept]
    if len(distinct) == 1:
        return None
    lay = straight_path if _KINDS[kind] == "STRAIGHT" else spline_path
    try:
        return lay(distinct)
    except BadValueError as error:
        raise _in_waypoints(error, kept, _KINDS[kind]) from None


def _waypoint(k: int) -> str:
    """Name a pose in words of a request, whose waypoints come after the start."""
    return f"waypoints[{k - 1}]" if k else "the start"


def _in_waypoints(error: BadValueError, kept: NDArray[np.int64], kind: str) -> BadValueError:
    """Name waypoints instead of poses of a path."""
    what = re.sub(r"poses\[(\d+)\]", lambda k: _waypoint(int(kept[int(k[1])])), error.what)
    expected = error.expected
    if kind == "SPLINE" and re.fullmatch(r"poses\[\d+\]", error.what):
        expected = f"{expected}; a STRAIGHT path (0) rests there instead"
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
