"""Waypoints of a trajectory at another pace than planned."""

import math
from dataclasses import replace

import numpy as np

from robomech_ros.execution.joints import paced_state
from robomech_ros.execution.time_scaling import TimeScaling
from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial
from robomech_ros.trajectory.waypoints import Waypoints
from robomech_ros.typing import Array

# Time between points while the pace changes, and what points are apart at least, s.
_PERIOD = 0.02
_NEAREST = 1e-3


def slowed_waypoints(waypoints: Waypoints, pace: float) -> Waypoints:
    """Give waypoints of the same path at a constant pace: times longer, rates lower."""
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
    """Give waypoints of what is left of a curve, by a scaling.

    Parameters
    ----------
    curve : PiecewisePolynomial
        What is executed, from t = 0 on.
    waypoints : Waypoints
        Those that it was made of.
    scaling : TimeScaling
        Where on the curve its execution is.
    lead : float
        Time of the first point, which is at the begin of the scaling, s.

    Returns
    -------
    Waypoints
        With velocities while the pace changes, since the accelerations of cubics follow where its
        rate steps; then with what `waypoints` has.  The last one is at rest, on the path where
        the scaling stops, else at its end.
    """
    over = float(scaling.times[-1])
    times = [*np.arange(0.0, over - _NEAREST, _PERIOD), over]
    after = [scaling.after(time) for time in times]
    states = [
        paced_state(curve.sample(min(place, curve.breaks[-1])), pace, rate)
        for place, pace, rate in after
    ]
    rows = [
        np.array([getattr(state, field) for state in states])
        for field in ("position", "velocity", "acceleration")
    ]
    rows[2][:-1] = math.nan
    if not scaling.pace:
        rows[1][-1], rows[2][-1] = 0.0, math.nan
        return _joined(np.array(times) + lead, rows, None)
    place = after[-1][0]
    left = waypoints.times > place + _NEAREST * scaling.pace
    rest = slowed_waypoints(waypoints.part(left), scaling.pace)
    if not left.any():
        # The end is nearer than points may be to each other.
        times[-1] = max(times[-1], float(times[-1]) + (curve.breaks[-1] - place) / scaling.pace)
        rows[0][-1] = waypoints.positions[-1]
        rows[1][-1], rows[2][-1] = 0.0, math.nan
        return _joined(np.array(times) + lead, rows, None)
    since = lead + times[-1] - place / scaling.pace
    later = replace(rest, times=rest.times + since)
    return _joined(np.array(times) + lead, rows, later)


def _joined(times: Array, rows: list[Array], later: Waypoints | None) -> Waypoints:
    """Put waypoints behind others; rows of NaN stand for what they lack."""
    if later is None:
        return Waypoints(times, *rows)
    lacking = np.full_like(later.positions, math.nan)
    velocities = lacking if later.velocities is None else later.velocities
    accelerations = lacking if later.accelerations is None else later.accelerations
    return Waypoints(
        np.concatenate([times, later.times]),
        np.vstack([rows[0], later.positions]),
        np.vstack([rows[1], velocities]),
        np.vstack([rows[2], accelerations]),
    )
