"""Time-optimal motion along a given path within limits of joints, of the tip and of torques.

The square of the speed along the path is found on a grid of path coordinates by two passes of
small linear programs, from the end to the beginning and back (reachability analysis).  Unlike the
usual collocation, the limits are not imposed at the grid points only: in each cell they are
polynomials of the path coordinate, and all of their Bernstein coefficients are kept within the
limits.  So they hold between the grid points, and at points of the path where the inertia of
a joint vanishes (q' = 0), too.  The grid refines itself where that costs time.

References
----------
J. E. Bobrow, S. Dubowsky and J. S. Gibson, "Time-optimal control of robotic manipulators along
specified paths", International Journal of Robotics Research 4(3), 1985.
D. Verscheure, B. Demeulenaere, J. Swevers, J. De Schutter and M. Diehl, "Time-optimal path tracking
for robots: a convex optimization approach", IEEE Transactions on Automatic Control 54(10), 2009.
H. Pham and Q.-C. Pham, "A new approach to time-optimal path parameterization based on
reachability analysis", IEEE Transactions on Robotics 34(3), 2018.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.spatial.arrays import as_single
from robomech_ros.trajectory.curves.motion_to_rest import check_positions
from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial, lasting_pieces
from robomech_ros.trajectory.limits import JointLimits, Limits
from robomech_ros.trajectory.timing.jerk_smoothing import smoothed
from robomech_ros.trajectory.timing.path_limits import SpeedLimit, TorqueLimits, checked_list
from robomech_ros.trajectory.timing.path_sections import checked_path, sections
from robomech_ros.trajectory.timing.path_speed import fastest
from robomech_ros.trajectory.timing.speed_profile import PathLimits, TimeOptimal
from robomech_ros.trajectory.tolerances import SHORTEST_TRAJECTORY
from robomech_ros.typing import Array

# The pieces in time of a time-optimal motion give back the accelerations of the path up to this
# part.
TIMING_ACCURACY = 1e-7


def time_optimal(
    path: PiecewisePolynomial,
    limits: JointLimits | Any,
    *,
    path_speed: tuple[float, float] = (0.0, 0.0),
    speed_limits: SpeedLimit | Sequence[SpeedLimit] = (),
    torque_limits: TorqueLimits | Sequence[TorqueLimits] = (),
    jerk_smoothing: bool = False,
) -> TimeOptimal:
    """Pass a path in the shortest time within limits.

    Parameters
    ----------
    path : PiecewisePolynomial
        Joints over the path coordinate s instead of time, in any unit; quintic at most.  Where
        the first derivative steps (a corner) the motion stops; where the second one does, the
        acceleration steps.
    limits : JointLimits
        A chain model, `Limits`, or anything with the same attributes.  Velocity limits of every
        joint are needed; acceleration limits as well, unless there are torque limits.
    path_speed : tuple of float
        Rates of s at the start and at the end, in s over s; (0, 0) is from rest to rest.
    speed_limits : SpeedLimit or sequence of them
        Further speeds, such as those of the tip.
    torque_limits : TorqueLimits or sequence of them
        Torques as linear functions of the acceleration along the path.
    jerk_smoothing : bool
        Keep the jerk limits, too, which every joint must have then: the acceleration is
        continuous, and zero at both ends.  Not with `torque_limits`, from rest to rest only, and
        for paths whose second derivative is continuous between corners.  The duration is near the
        shortest, not the shortest itself.

    Returns
    -------
    TimeOptimal
        At least 1 ms long.  Without smoothing the acceleration steps, at both ends as well.

    Raises
    ------
    BadValueError
        If the path is none, or not continuous; if a path speed cannot be reached within the limits;
        if the torque limits, or the speed limits, allow no motion.
    MissingLimitsError
        If a joint lacks a limit that is needed.
    SeedOutsideLimitsError, LimitExceededError
        If the start, or another part of the path, is outside the position limits.

    Examples
    --------
    >>> from robomech_ros.trajectory import Limits, spline_through, time_optimal
    >>> limits = Limits(["turn", "lift"], velocity=1.0, acceleration=4.0)
    >>> points = [[0.0, 0.0], [0.5, 0.2], [1.0, 0.0]]
    >>> path = spline_through(points, times=[0.0, 0.5, 1.0], ends="natural")
    >>> motion = time_optimal(path.pieces, limits)
    >>> round(motion.duration, 3)
    1.25
    """
    curve = checked_path(path)
    known = Limits.of(limits)
    if curve.joints != len(known.joint_names):
        raise WrongSizeError("joints of the path", curve.joints, len(known.joint_names))
    speeds = checked_list("speed_limits", speed_limits, SpeedLimit)
    torques = checked_list("torque_limits", torque_limits, TorqueLimits)
    ends = as_single("path_speed", path_speed, (2,))
    if not (ends >= 0.0).all():
        raise BadValueError("path_speed", ends.tolist(), "two speeds, zero or above")
    begin, end = ends.tolist()
    known.require(*(("velocity",) if torques else ("velocity", "acceleration")))
    known.check_start(curve.coefficients[0, 0])
    check_positions(curve, curve.coefficients[0, 0], known)
    allowed = PathLimits(known.velocity, known.acceleration, speeds, torques)
    if not isinstance(jerk_smoothing, bool | np.bool_):
        raise BadValueError("jerk_smoothing", jerk_smoothing, "True or False")
    if jerk_smoothing:
        known.require("acceleration", "jerk")
        if torques:
            raise BadValueError("torque_limits", torques, "none, with jerk_smoothing")
        if begin or end:
            raise BadValueError("path_speed", (begin, end), "(0, 0), with jerk_smoothing")
    parts = sections(curve)
    motions = []
    for k, part in enumerate(parts):
        if jerk_smoothing:
            motions.append(smoothed(part, allowed, known.jerk))
        else:
            first, last = k == 0, k == len(parts) - 1
            profile = fastest(part, allowed, begin * first, end * last)
            timed = profile.timed(allowed.acceleration_scales, TIMING_ACCURACY)
            motions.append(timed.within(allowed.velocity, allowed.acceleration))
    return _joined(motions, curve)


def _joined(motions: list[TimeOptimal], curve: PiecewisePolynomial) -> TimeOptimal:
    """Put the motions through all sections one after the other; stand still where there is none."""
    if not motions:
        coefficients = curve.coefficients[:1, :1].copy()
        times = np.array([0.0, SHORTEST_TRAJECTORY])
        pieces = PiecewisePolynomial(times, coefficients)
        return TimeOptimal(pieces, curve.breaks[[0, -1]], np.zeros(2))
    end = motions[-1]
    starts: Array = np.cumsum([0.0, *(motion.pieces.duration for motion in motions)])
    instants = [m.pieces.breaks[:-1] + start for m, start in zip(motions, starts, strict=False)]
    pieces, lasting = lasting_pieces(
        np.append(np.concatenate(instants), starts[-1]),
        np.concatenate([m.pieces.coefficients for m in motions], axis=1),
    )
    kept = np.append(lasting, True)
    coordinates = np.concatenate([m.coordinates[:-1] for m in motions] + [end.coordinates[-1:]])
    speeds = np.concatenate([m.speeds[:-1] for m in motions] + [end.speeds[-1:]])
    slower = max(SHORTEST_TRAJECTORY / float(starts[-1]), 1.0)
    return TimeOptimal(pieces, coordinates[kept], speeds[kept]).stretched(slower)
