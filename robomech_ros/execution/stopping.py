"""Slowing down on the planned path, as hard as the acceleration limits allow."""

import math

import numpy as np

from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial
from robomech_ros.trajectory.sample import Sample
from robomech_ros.typing import Array

# The pace never falls from 1 to 0 in less than this (s): a stop within one control cycle would
# be a step of velocity.
SHORTEST_STOP = 0.02
# Steps of the integration, s; and how many of them one update takes at most: after a gap of
# seconds between two updates accuracy is no matter.
_STEP = 0.0025
_MAX_STEPS = 400


def pace_drop(sample: Sample, pace: float, limit: Array) -> float:
    r"""Return how fast the pace along a curve may fall.

    The joints follow :math:`q(s(t))` with the pace :math:`\dot s = p \le 1`, so that their
    acceleration is :math:`q'' p^2 + q' \dot p`.  The path is kept, and speeds only fall.

    Parameters
    ----------
    sample : Sample
        The curve where the robot is: q' and q'' as velocity and acceleration.
    pace : float
        Present pace, 0 to 1.
    limit : ndarray, shape (n,)
        Acceleration limits, rad/s^2 or m/s^2.

    Returns
    -------
    float
        The largest :math:`-\dot p` (1/s) with which no joint exceeds its limit; 0 where the
        curve itself already takes all of it.
    """
    speed = np.abs(sample.velocity)
    spare = limit + np.sign(sample.velocity) * sample.acceleration * pace * pace
    # Joints that stand still do not mind.
    moving = speed > 1e-12
    if not moving.any():
        return 1.0 / SHORTEST_STOP
    drop = float(np.min(spare[moving] / speed[moving]))
    return min(max(drop, 0.0), 1.0 / SHORTEST_STOP)


def slowed_down(
    curve: PiecewisePolynomial, time: float, pace: float, span: float, limit: Array
) -> tuple[float, float, float]:
    """Let time pass while the pace falls as fast as it may (midpoint rule).

    Parameters
    ----------
    curve : PiecewisePolynomial
        What the joints follow.
    time : float
        Where on the curve they are, s.
    pace : float
        Present pace, 0 to 1.
    span : float
        How long to go on, s.
    limit : ndarray, shape (n,)
        Acceleration limits, rad/s^2 or m/s^2.

    Returns
    -------
    time, pace, drop : float
        Where on the curve they are then, the pace, and how fast it falls (1/s).
    """
    steps = min(max(math.ceil(span / _STEP), 1), _MAX_STEPS)
    step = span / steps
    drop = 0.0
    for _ in range(steps):
        if pace <= 0.0 or time >= curve.breaks[-1]:
            return time, 0.0, 0.0
        drop = pace_drop(curve.sample(time), pace, limit)
        halfway = max(pace - 0.5 * drop * step, 0.0)
        middle = time + 0.5 * (pace + halfway) * 0.5 * step
        drop = pace_drop(curve.sample(middle), halfway, limit)
        slower = pace - drop * step
        if slower <= 0.0:
            return time + 0.5 * pace * pace / drop, 0.0, 0.0
        time, pace = time + 0.5 * (pace + slower) * step, slower
    return time, pace, drop
