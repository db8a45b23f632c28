"""End points of joint paths: the last position with acceptable joint values."""

from collections.abc import Callable

import numpy as np

from robomech_ros.numerics.nonlinear import bisected
from robomech_ros.trajectory.curves.bounds import first_above, hull
from robomech_ros.trajectory.limits import Limits
from robomech_ros.trajectory.paths.joint_path import JointPath
from robomech_ros.trajectory.paths.tracking_result import PathCut, PathTrackingStatus
from robomech_ros.trajectory.tolerances import POSITION_SLACK
from robomech_ros.typing import Array, BoolArray

# Places looked at along a path at least, and halvings between two of them.
PLACES, _HALVINGS = 500, 40
# How far outside its limits a joint may be at these places, and between them (rad or m).
_SLACK, _SLACK_BETWEEN = 1e-9, 0.5 * POSITION_SLACK
# How far beyond its last good place a path is looked at for the joint to blame, as its part.
_BEYOND = 1e-6


def last_valid_coordinate(
    joints: JointPath,
    wrong: Callable[[Array], BoolArray],
    *,
    count: int = PLACES,
    part: tuple[float, float] | None = None,
) -> float | None:
    """Find the coordinate (m) of the last place before something is wrong for the first time.

    `wrong` tells for joint values (m, n) which rows are wrong, (m,).  From the first wrong one of
    `count` places, along the path or a part of it, the search goes on by halving; None without any.
    """
    places = np.linspace(*(part or (0.0, joints.length)), count + 1)
    bad = np.flatnonzero(wrong(joints.derivatives(places)[0]))
    if not len(bad):
        return None
    high = float(places[bad[0]])
    low = float(places[max(int(bad[0]) - 1, 0)])

    def good(s: float) -> bool:
        return not wrong(joints.derivatives(np.array([s]))[0])[0]

    return float(bisected(low, high, good, _HALVINGS if bad[0] else 0)[0])


def limit_cut(joints: JointPath, limits: Limits) -> PathCut | None:
    """Find where a joint leaves its position limits, also for less than a step of the search.

    A start that is outside by no more than the slack of a start may stay where it is.
    """
    first = joints.derivatives(0.0)[0]
    lower, upper = (
        np.where(np.abs(first - limit) <= POSITION_SLACK, outer(limit, first), limit)
        for limit, outer in ((limits.lower, np.minimum), (limits.upper, np.maximum))
    )

    def excess(q: Array) -> Array:
        return np.maximum(lower - q, q - upper)

    def outside(q: Array) -> BoolArray:
        return np.asarray((excess(q) > _SLACK).any(axis=1))

    s = last_valid_coordinate(joints, outside)
    between = _part_outside(joints.until(s) if s else joints, lower, upper) if s != 0.0 else None
    if between is not None:
        inside = last_valid_coordinate(joints, outside, part=between)
        s = s if inside is None else inside
    if s is None:
        return None
    beyond = min(s + _BEYOND * joints.length, joints.length)
    joint = int(np.argmax(excess(joints.derivatives(beyond)[0])))
    text = f"joint '{limits.joint_names[joint]}' would leave its limits"
    return PathCut(s, PathTrackingStatus.LIMIT, text, joint)


def _part_outside(joints: JointPath, lower: Array, upper: Array) -> tuple[float, float] | None:
    """Find the first piece (m, m) of a joint path that is outside limits (n,) for sure."""
    coefficients, breaks = hull(joints.pieces, 0), joints.pieces.breaks
    above = first_above(coefficients, upper + _SLACK_BETWEEN)
    below = first_above(-coefficients, -lower + _SLACK_BETWEEN)
    first = min((place[0] for place in (above, below) if place is not None), default=None)
    return None if first is None else (float(breaks[first]), float(breaks[first + 1]))
