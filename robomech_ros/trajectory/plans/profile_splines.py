"""Splines at rest at both ends, as near as possible to a law of motion.

A natural spline through points of a law has no acceleration at its ends, but a velocity.  With the
conditions of rest the values at its knots are chosen instead, such that the deviation from the law
is least in the Euclidean norm; it is linear in them.

References
----------
J. Angeles, *Fundamentals of Robotic Mechanical Systems*, 4th ed., section 6.6.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from robomech_ros.errors import WrongSizeError
from robomech_ros.spatial.arrays import as_choice, as_finite, whole_number
from robomech_ros.trajectory.curves.cubic_spline import cubic_spline
from robomech_ros.trajectory.limits import JointLimits
from robomech_ros.trajectory.plans.spline_motions import Spline, spline_through
from robomech_ros.trajectory.profiles.laws import CYCLOIDAL, POLY345, POLY4567, Law
from robomech_ros.typing import Array, ArrayLike

_LAWS = {"poly345": POLY345, "poly4567": POLY4567, "cycloidal": CYCLOIDAL}
_MOST_KNOTS = 1000
# Samples of the deviation in each segment: the middles of so many equal parts.
_PARTS = 16


def spline_like(
    q0: ArrayLike,
    q1: ArrayLike,
    *,
    limits: JointLimits | Any,
    profile: str = "poly4567",
    knots: int = 7,
    duration: float | None = None,
) -> Spline:
    """Plan from rest to rest by the cubic spline that is most like a law of motion.

    Parameters
    ----------
    q0, q1 : array_like, shape (n,)
        Start and goal, rad or m.
    limits : JointLimits
        As for `spline_through`.
    profile : str
        ``poly345``, ``poly4567`` or ``cycloidal``.
    knots : int
        How many knots there are, evenly spaced, both ends among them; 3 at least.
    duration : float, optional
        Wanted duration in s; None for the shortest within the limits.

    Returns
    -------
    Spline
        With ends at rest, where the outermost segments are divided into halves.

    Raises
    ------
    RobomechError
        As `spline_through` does, and BadValueError for an unknown profile or number of knots.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 6.6.
    """
    law = _LAWS[as_choice("profile", profile, tuple(_LAWS))]
    expected = f"a whole number from 3 to {_MOST_KNOTS}"
    count = whole_number("knots", knots, expected, 3, _MOST_KNOTS)
    start, goal = as_finite("start", q0, ()), as_finite("goal", q1, ())
    if start.ndim != 1 or start.shape != goal.shape:
        raise WrongSizeError("goal", goal.shape, start.shape if start.ndim == 1 else "(n,)")
    values = _least_deviation(law, count)[:, None]
    points = (1.0 - values) * start + values * goal
    return spline_through(points, limits=limits, spacing="uniform", duration=duration)


def _least_deviation(law: Law, count: int) -> Array:
    """Values (count,) at even knots of the spline from 0 to 1 that is nearest to a law."""
    x = np.linspace(0.0, 1.0, count)
    tau = (np.arange(_PARTS * (count - 1)) + 0.5) / (_PARTS * (count - 1))
    # Column k is the spline with value 1 at knot k and 0 at the others.
    unit = cubic_spline(x, np.eye(count), "rest").sample(tau).position
    inner = np.linalg.lstsq(unit[:, 1:-1], law.progress(tau) - unit[:, -1], rcond=None)[0]
    return np.concatenate([[0.0], inner, [1.0]])
