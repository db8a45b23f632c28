"""One polynomial from rest to rest through a few via points, such as lift-off and set-down.

References
----------
J. Angeles, *Fundamentals of Robotic Mechanical Systems*, 4th ed., section 6.5.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from robomech_ros.spatial.arrays import as_choice
from robomech_ros.trajectory.curves.bounds import extremes
from robomech_ros.trajectory.curves.knots import knots_at, spaced_knots
from robomech_ros.trajectory.curves.motion_to_rest import MotionThrough, check_positions
from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial
from robomech_ros.trajectory.curves.time_scaling import checked_duration, fitted
from robomech_ros.trajectory.joint_points import joint_points
from robomech_ros.trajectory.limits import JointLimits, Limits
from robomech_ros.trajectory.profiles.laws import POLY345, POLY4567
from robomech_ros.trajectory.tolerances import POSITION_SLACK
from robomech_ros.typing import Array, ArrayLike

# The motions without via points.
_LAWS = {"poly345": POLY345, "poly4567": POLY4567}
# Through more points polynomials swing too far out.
MOST_VIAS = 2
# Free instants are sought by logarithms of the spans between points over the last one: on a grid of
# so many values for one and for two of them, up to this one, then on grids around the best so far,
# each finer than the one before by this factor, down to a part in 1e4 of a span.
_GRID = {1: 49, 2: 19}
_FARTHEST = 9.0
# More (s) than any duration within limits.
_OUTSIDE = 1e100
# Coefficients up to so many times the largest distance lose no more than four digits of it; those
# of fast motions are below a hundred times.
_LARGEST_SWING = 1e4
_FINER = 0.45
_REFINEMENTS = 11


@dataclass(frozen=True, eq=False)
class ViaPolynomial(MotionThrough):
    """A single polynomial through via points."""


def via_polynomial(
    points: ArrayLike,
    *,
    limits: JointLimits | Any,
    profile: str = "poly345",
    at: ArrayLike | None = None,
    duration: float | None = None,
) -> ViaPolynomial:
    r"""Plan from rest to rest through up to two via points along one polynomial.

    Every via point raises the degree of the profile's polynomial by one.

    With m points the degree is m + 3 for ``poly345`` and m + 5 for ``poly4567``; the coefficients
    solve

    .. math::

       s(\tau_k) = s_k, \qquad s^{(i)}(0) = s^{(i)}(1) = 0, \quad i = 1, 2 \text{ (and } 3).

    Parameters
    ----------
    points : array_like, shape (m, n)
        Start, via points, and goal, rad or m; m from 2 to 4.
    limits : JointLimits
        A chain model, `Limits`, or anything with the same attributes; velocity and acceleration
        limits of every joint, and those jerk limits that are there.
    profile : str
        ``"poly345"`` (no velocity and acceleration at the ends), or ``"poly4567"`` (no jerk
        either).
    at : array_like, shape (m - 2,), optional
        Which part of the duration is over at each via point, strictly between 0 and 1 and
        increasing; default where the motion is fastest, among those inside the position limits.
    duration : float, optional
        Wanted duration in s; None for the shortest within the limits.

    Raises
    ------
    MissingLimitsError
        If a joint lacks a velocity or acceleration limit.
    SeedOutsideLimitsError, LimitExceededError
        If the start, or another part of the motion, is outside the position limits.
    DurationTooShortError
        If the limits do not allow the wanted duration.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 6.5.

    Examples
    --------
    >>> from robomech_ros.trajectory import Limits, via_polynomial
    >>> limits = Limits(["lift"], velocity=1.0, acceleration=4.0)
    >>> motion = via_polynomial([[0.0], [0.7], [1.0]], limits=limits, at=[0.5], duration=4.0)
    >>> motion.sample(2.0).position.round(6)
    array([0.7])
    """
    as_choice("profile", profile, tuple(_LAWS))
    allowed = Limits.of(limits)
    places = joint_points(points, len(allowed.joint_names), MOST_VIAS + 2)
    allowed.require("velocity", "acceleration")
    allowed.check_start(places[0])
    knots = _fastest(places, profile, allowed) if at is None else knots_at(at, len(places))
    unit = _through(places, knots[None], profile)
    pieces = fitted(unit, allowed, checked_duration(duration))
    check_positions(pieces, places[0], allowed)
    return ViaPolynomial(places[-1], pieces, knots * pieces.duration)


def _fastest(places: Array, profile: str, limits: Limits) -> Array:
    """Find the knots (m,), from 0 to 1, of the fastest polynomial inside the position limits."""
    vias = len(places) - 2
    best = spaced_knots(places, "centripetal", limits.velocity)
    if vias == 0 or not (places != places[0]).any():
        return best
    axis = np.linspace(-_FARTHEST, _FARTHEST, _GRID[vias])
    centre, grid = np.zeros(vias), _grid(axis, vias)
    shortest = _costs(places, best[None], profile, limits)[0]
    for round_ in range(_REFINEMENTS):
        spans = np.exp(np.append(centre + grid, np.zeros((len(grid), 1)), axis=1))
        knots = np.append(np.zeros((len(grid), 1)), np.cumsum(spans, axis=1), axis=1)
        knots /= knots[:, -1:]
        costs = _costs(places, knots, profile, limits)
        k = int(np.argmin(costs))
        if costs[k] < shortest:
            best, shortest = knots[k], costs[k]
        # The last spans are equal to none: centripetal knots are a start like any other.
        centre = np.log(np.diff(best)[:-1] / (1.0 - best[-2]))
        step = (axis[1] - axis[0]) * _FINER**round_
        grid = _grid(step * np.linspace(-1.0, 1.0, 5), vias)
    return best


def _grid(axis: Array, dimensions: int) -> Array:
    """Return all points with coordinates of an axis, shape (k, dimensions)."""
    return np.stack(np.meshgrid(*[axis] * dimensions), axis=-1).reshape(-1, dimensions)


def _costs(places: Array, knots: Array, profile: str, limits: Limits) -> Array:
    """Shortest durations (k,) in s by k choices of knots (k, m).

    Behind all of them come those that leave the position limits, the farther the later, and those
    that rounding would lead past the points.
    """
    unit = _through(places, knots, profile)
    low, high = (values.reshape(4, len(knots), -1) for values in extremes(unit))
    ratios = np.maximum(np.maximum(-low, high), 0.0)[1:] / limits.rates[:, None]
    costs = (ratios ** (1.0 / np.arange(1.0, 4.0))[:, None, None]).max(axis=(0, 2))
    below = np.minimum(limits.lower, places[0]) - low[0]
    outside = np.maximum(below, high[0] - np.maximum(limits.upper, places[0])).max(axis=1)
    swing = np.abs(unit.coefficients[1:]).reshape(-1, *low.shape[1:]).max(axis=(0, 2))
    swing /= np.abs(places - places[0]).max()
    outside = np.maximum(outside, np.where(swing > _LARGEST_SWING, swing, 0.0))
    return np.where(outside > POSITION_SLACK, _OUTSIDE * (1.0 + outside), costs)


def _through(places: Array, knots: Array, profile: str) -> PiecewisePolynomial:
    """Lay polynomials over a duration of 1 through places (m, n), for k choices of knots (k, m).

    Their joints stand side by side, k n of them.  To the motion without via points a product is
    added, of a polynomial that vanishes at the ends with its derivatives, and of one, by Newton's
    differences, that corrects the values at the via points.
    """
    # The motion from 0 to 1 by powers of the part of the duration that is over, and how many
    # derivatives vanish at both ends.
    law = _LAWS[profile].pieces.coefficients[:, 0, 0]
    resting = len(law) // 2 - 1
    choices, vias = len(knots), len(places) - 2
    way = places[-1] - places[0]
    inner = knots[:, 1:-1, None]
    straight = inner ** (resting + 1) * np.polynomial.polynomial.polyval(inner, law[resting + 1 :])
    vanishing = (inner * (1.0 - inner)) ** (resting + 1)
    needed = (places[1:-1] - places[0] - straight * way) / vanishing
    solved = np.zeros((len(law) + vias, choices, places.shape[1]))
    solved[: len(law)] = law[:, None, None] * way
    ends = np.polynomial.polynomial.polypow([0.0, 1.0, -1.0], resting + 1)
    slope = 0.0
    if vias == 2:
        slope = (needed[:, 1] - needed[:, 0]) / (inner[:, 1] - inner[:, 0])
        solved[1 : len(ends) + 1] += ends[:, None, None] * slope
    if vias:
        solved[: len(ends)] += ends[:, None, None] * (needed[:, 0] - slope * inner[:, 0])
    solved[0] = places[0]
    return PiecewisePolynomial(np.array([0.0, 1.0]), solved.reshape(len(solved), 1, -1))
