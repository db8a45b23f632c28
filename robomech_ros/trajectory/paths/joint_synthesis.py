"""Synthesis of joint paths by cubic splines through a number of postures."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from robomech_ros.errors import BadValueError
from robomech_ros.spatial.arrays import shaped_array, whole_number
from robomech_ros.spatial.screws.pose_conversions import pose_error
from robomech_ros.trajectory.curves.cubic_spline import cubic_spline
from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial, chained
from robomech_ros.trajectory.curves.quintic_spline import Ends
from robomech_ros.trajectory.paths.arms import Arm, as_arm
from robomech_ros.trajectory.paths.curve_arguments import as_parameters
from robomech_ros.trajectory.paths.joint_path import JointPath, check_follows
from robomech_ros.trajectory.paths.pose_path import PosePath, PoseSample
from robomech_ros.trajectory.paths.posture import corrected, posture
from robomech_ros.trajectory.paths.spline_curves import as_ends
from robomech_ros.typing import Array, ArrayLike

# Joint values (rad, m) that differ by less where a path closes are the same: what correcting each
# leaves open near a singularity.
CLOSED = 1e-6

_MOST_POSES = 100_000


def joint_spline(
    path: PosePath, arm: Arm, joints: JointPath, poses: int, *, ends: Ends = "clamped"
) -> JointPath:
    """Put cubic splines through the joint values at a number of poses of a path.

    The poses are spread evenly over each part of the path between two stops.  Between them the
    joints follow the splines and the pose is off the path; the error falls with the fourth power
    of the number of poses (with natural ends, near the ends, with the second).

    Parameters
    ----------
    path : PosePath
    arm : Arm
    joints : JointPath
        That follows the path on the branch wanted, as `track_path` gives it.
    poses : int
        How many in all; at least two, and three more between any two stops.
    ends : str, optional
        Of every part.  ``clamped``: with the exact first derivatives q' = J^-1 t';
        ``periodic``: for a closed path without stops; ``natural``: second derivatives 0.

    Raises
    ------
    BadValueError
        Not a path, an arm, a joint path that follows it or a number, or periodic ends of a path
        that does not close in the joints.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 11.4.
    """
    kind = as_ends(ends)
    check_follows(path, joints)
    as_arm(arm)
    least = (4 if kind == "periodic" else 2) + 3 * len(joints.stops)
    expected = f"a whole number from {least} to {_MOST_POSES}"
    count = whole_number("poses", poses, expected, least, _MOST_POSES)
    if kind == "periodic" and len(joints.stops):
        raise BadValueError("ends", ends, "clamped or natural, since the path has stops")
    edges = np.concatenate([[0.0], joints.stops, [joints.length]])
    parts = []
    for low, high in pairwise(edges):
        number = max(round(count * (high - low) / joints.length), 5 if len(edges) > 2 else 2)
        knots = np.linspace(low, high, number)
        parts.append(_part(path, arm, joints, knots, kind))
    return JointPath(chained(parts), joints.stops)


def tracking_error(path: PosePath, arm: Arm, joints: JointPath, s: ArrayLike) -> Array:
    """Measure how far the poses of a joint path are off a pose path.

    Parameters
    ----------
    path : PosePath
    arm : Arm
    joints : JointPath
    s : array_like, shape () or (m,)
        Path coordinates (m).

    Returns
    -------
    ndarray, shape (6,) or (m, 6)
        Rotation vector (rad) and displacement (m) from the actual pose to the one of the path, in
        the base frame.
    """
    check_follows(path, joints)
    as_arm(arm)
    inside = as_parameters("s", s, 0.0, min(path.length, joints.length))
    rows = joints.derivatives(np.atleast_1d(inside))[0]
    actual = np.empty((len(rows), 4, 4))
    for k, q in enumerate(rows):
        actual[k] = shaped_array("pose of the arm", arm.forward(q), (4, 4))
    errors = pose_error(path.sample(np.atleast_1d(inside)).pose, actual)
    return errors if inside.ndim else errors[0]


def _part(
    path: PosePath, arm: Arm, joints: JointPath, knots: Array, ends: Ends
) -> PiecewisePolynomial:
    """Spline between two stops; the rates at its ends are those from within."""
    at = knots.copy()
    at[-1] = np.nextafter(knots[-1], knots[0])
    places, guesses = path.sample(at), joints.derivatives(at)[0]
    rows = []
    for k, guess in enumerate(guesses):
        q = corrected(arm, guess, places.pose[k])
        if q is None:
            what = f"joint values at s = {knots[k]:.6g} m"
            raise BadValueError(what, guess.tolist(), "values on the path")
        rows.append(q)
    values, rates = np.stack(rows), None
    if ends == "periodic":
        gap = np.abs(values[-1] - values[0])
        if gap.max() > CLOSED:
            k = int(np.argmax(gap))
            what = f"joint {k} at the end of the path"
            raise BadValueError(what, float(values[-1, k]), f"{values[0, k]:.9g}, as at its start")
        values[-1] = values[0]
    elif ends == "clamped":
        firsts = [
            posture(arm, values[k], PoseSample(*(row[k] for row in places))).first for k in (0, -1)
        ]
        rates = np.stack(firsts)
    return cubic_spline(knots, values, ends, rates)
