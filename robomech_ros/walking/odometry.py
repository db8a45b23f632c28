"""Odometry of the trunk, from the joints of the stance legs."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.spatial import as_pose
from robomech_ros.spatial.arrays import as_finite, check_kind, of_shape
from robomech_ros.spatial.poses import assembled
from robomech_ros.typing import Array, ArrayLike, BoolArray
from robomech_ros.walking.robot import LeggedRobot

# Feet that tell all of a motion, and feet that tell it but for turns about the line between them.
_ENOUGH, _FEWEST = 3, 2
# Part of the greatest singular value below which one is zero.
_ZERO = 1e-9


def leg_odometry(
    robot: LeggedRobot, q: ArrayLike, contacts: ArrayLike, *, start: ArrayLike | None = None
) -> tuple[Array, Array]:
    """Follow the trunk over the ground, on feet that do not slip.

    Between two samples the feet that stand at both of them are where they were; if those are fewer
    than three, as where one tripod takes over from another, the feet that stand at either of them.
    Two feet do not tell how the trunk turns about the line between them: the least turn is taken,
    which is right for a trunk that stays level, as in the trot.

    Parameters
    ----------
    robot : LeggedRobot
    q : array_like, shape (m, 3 k)
        All joints (rad or m), sample by sample.
    contacts : array_like of bool, shape (m, k)
        Which feet stand.
    start : array_like, shape (4, 4), optional
        Pose of the trunk over the ground (m) at first; default the identity.

    Returns
    -------
    trunk : ndarray, shape (m, 4, 4)
        Poses of the trunk over the ground (m), the ones with which the feet slip least.
    slip : ndarray, shape (m,)
        Root of the sum of the squares of the ways (m) by which the feet slip since the sample
        before.

    Raises
    ------
    BadValueError, WrongSizeError
        Not such arrays, fewer than two feet, or more of them on one line.

    References
    ----------
    K. S. Arun, T. S. Huang, S. D. Blostein: Least-squares fitting of two 3-D point sets. IEEE
    Transactions on Pattern Analysis and Machine Intelligence 9 (1987), 698-700.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.walking import Walker, leg_odometry, load_legged
    >>> robot = load_legged("phantomx")
    >>> walker = Walker(robot, timeout=10.0)
    >>> walker.command([0.0, 0.05, 0.0])
    >>> updates = [walker.update() for _ in range(400)]
    >>> q = np.array([update.q for update in updates])
    >>> trunk, _ = leg_odometry(robot, q, [update.contacts for update in updates])
    >>> round(float(trunk[-1, 0, 3]), 3) == round(float(updates[-1].trunk[0, 3]), 3)
    True
    """
    check_kind("robot", robot, LeggedRobot, "a LeggedRobot")
    rows = as_finite("q", q, (robot.n,))
    if rows.ndim != 2 or not len(rows):
        raise WrongSizeError("q", rows.shape, f"(m, {robot.n})")
    stands = of_shape("contacts", _flags(contacts), (len(rows), len(robot.legs)))
    first = np.eye(4) if start is None else as_pose(start)
    feet = np.stack(
        [
            forward_kinematics(leg, rows[:, 3 * k : 3 * k + 3])[:, :3, 3]
            for k, leg in enumerate(robot.legs)
        ],
        axis=1,
    )
    trunk, slip = np.tile(first, (len(rows), 1, 1)), np.zeros(len(rows))
    for j in range(1, len(rows)):
        planted = stands[j - 1] & stands[j]
        if planted.sum() < _ENOUGH:
            planted = stands[j - 1] | stands[j]
        names = [leg for leg, one in zip(robot.leg_names, planted, strict=True) if one]
        moved, slip[j] = _moved(feet[j - 1, planted], feet[j, planted], names, j)
        trunk[j] = trunk[j - 1] @ moved
    return trunk, slip


def _flags(contacts: ArrayLike) -> BoolArray:
    try:
        stands = np.asarray(contacts)
    except ValueError:
        stands = np.empty(0)
    if stands.dtype != np.bool_:
        raise BadValueError("contacts", contacts, "true or false for each foot and sample")
    return stands


def _moved(before: Array, after: Array, names: list[str], sample: int) -> tuple[Array, float]:
    """Return the pose in which points (n, 3) are where they were, and how far they are from it."""
    what = f"feet that stand at sample {sample}"
    if len(before) < _FEWEST:
        raise BadValueError(what, names, f"{_FEWEST} or more")
    a, b = before - before.mean(axis=0), after - after.mean(axis=0)
    if len(a) == _FEWEST:
        a, b = a[:1], b[:1]
    else:
        values = np.linalg.svd(a, compute_uv=False)
        if values[1] <= _ZERO * values[0]:
            raise BadValueError(what, names, "feet that are not on one line")
    R = Rotation.align_vectors(a, b)[0].as_matrix()
    off = float(np.linalg.norm(a - b @ R.T))
    return assembled(R, before.mean(axis=0) - R @ after.mean(axis=0)), off
