"""Waypoints of a trajectory at another pace than planned."""

import math

import numpy as np

from robomech_ros.execution.joints import paced_state
from robomech_ros.execution.time_scaling import TimeScaling
from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial
from robomech_ros.trajectory.waypoints import Waypoints

# Time between points while the pace changes, and what points are apart at least, s.
_PERIOD = 0.02
_NEAREST = 1e-3


def slowed_waypoints(waypoints: Waypoints, pace: float) -> Waypoints:
    """Return waypoints of the same path at a constant pace: times longer, rates lower."""
    velocities, accelerations = waypoints.velocities, waypoints.accelerations
    return Waypoints(
        waypoints.times / pace,
        waypoints.positions,
        None if velocities is None else velocities * pace,
        None if accelerations is None else accelerations * pace * pace,
    )


def paced_waypoints(
    curve: PiecewisePolynomial, waypoints: Waypoints, scaling: TimeScaling, lead: float
) -> Waypoints:
    """Return waypoints of what is left of a curve, which these waypoints made, by a scaling.

    The first point is at the begin of the scaling, after a lead (s). They have velocities while the
    pace changes, since the accelerations of cubics follow where its rate steps; then what
    ``waypoints`` has. The last one is at rest, on the path where the scaling stops, else at its
    end.
    """
    over = float(scaling.times[-1])
    times = [*np.arange(0.0, over - _NEAREST, _PERIOD), over]
    after = np.array([scaling.after(time) for time in times])
    sample = curve.sample(np.minimum(after[:, 0], curve.breaks[-1]))
    state = paced_state(sample, after[:, 1:2], after[:, 2:])
    rows = [state.position, state.velocity, state.acceleration]
    rows[2][:-1] = math.nan
    if not scaling.pace:
        rows[1][-1], rows[2][-1] = 0.0, math.nan
        return Waypoints(np.array(times) + lead, *rows)
    place = after[-1, 0]
    left = waypoints.times > place + _NEAREST * scaling.pace
    rest = slowed_waypoints(waypoints.part(left), scaling.pace)
    if not left.any():
        # The end is nearer than points may be to each other.
        times[-1] = max(times[-1], float(times[-1]) + (curve.breaks[-1] - place) / scaling.pace)
        rows[0][-1] = waypoints.positions[-1]
        rows[1][-1], rows[2][-1] = 0.0, math.nan
        return Waypoints(np.array(times) + lead, *rows)
    since = lead + times[-1] - place / scaling.pace
    lacking = np.full_like(rest.positions, math.nan)
    # Rows of NaN stand for what the rest lacks.
    later = (rest.positions, rest.velocities, rest.accelerations)
    joined = (
        np.vstack([row, lacking if values is None else values])
        for row, values in zip(rows, later, strict=True)
    )
    return Waypoints(np.concatenate([np.array(times) + lead, rest.times + since]), *joined)
