"""One polynomial from rest to rest through a few via points, such as lift-off and set-down.

References
----------
J. Angeles, *Fundamentals of Robotic Mechanical Systems*, 4th ed., section 6.5.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from robomech_ros.spatial.arrays import as_choice
from robomech_ros.trajectory.curves.knots import knots_at, spaced_knots
from robomech_ros.trajectory.curves.motion_to_rest import MotionThrough, check_positions
from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial
from robomech_ros.trajectory.curves.time_scaling import checked_duration, fitted
from robomech_ros.trajectory.joint_points import joint_points
from robomech_ros.trajectory.limits import JointLimits, Limits
from robomech_ros.trajectory.sample import FloatArray

__all__ = ["MOST_VIAS", "ViaPolynomial", "via_polynomial"]

# Derivatives that vanish at both ends.
_RESTING = {"poly345": 2, "poly4567": 3}
# Through more points polynomials swing too far out.
MOST_VIAS = 2


@dataclass(frozen=True, eq=False)
class ViaPolynomial(MotionThrough):
    """A single polynomial through via points."""


def via_polynomial(
    points: npt.ArrayLike,
    *,
    limits: JointLimits | Any,
    profile: str = "poly345",
    at: npt.ArrayLike | None = None,
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
        increasing; default by the roots of the distances.
    duration : float, optional
        Wanted duration in s; None for the shortest within the limits.

    Returns
    -------
    ViaPolynomial

    Raises
    ------
    WrongSizeError, NonFiniteError, BadValueError
        If points or options are invalid.
    MissingLimitsError
        If a joint lacks a velocity or acceleration limit.
    SeedOutsideLimitsError, LimitExceededError
        If the start, or another part of the motion, is outside the position limits.
    DurationTooShortError
        If the limits do not allow the wanted duration.

    See Also
    --------
    through_points : by splines and other profiles, too.

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
    resting = _RESTING[as_choice("profile", profile, tuple(_RESTING))]
    allowed = Limits.of(limits)
    places = joint_points(points, len(allowed.joint_names), MOST_VIAS + 2)
    allowed.require("velocity", "acceleration")
    allowed.check_start(places[0])
    if at is None:
        knots = spaced_knots(places, "centripetal", allowed.velocity)
    else:
        knots = knots_at(at, len(places))
    unit = _through(places, knots, resting)
    pieces = fitted(unit, allowed, checked_duration(duration))
    check_positions(pieces, places[0], allowed)
    return ViaPolynomial(places[-1], pieces, knots * pieces.duration)


def _through(places: FloatArray, knots: FloatArray, resting: int) -> PiecewisePolynomial:
    """Solve for the coefficients over a duration of 1."""
    degree = 2 * resting + len(places) - 1
    powers = np.arange(degree + 1)
    rows = [knots[:, None] ** powers]
    right = [places - places[0]]
    for order in range(1, resting + 1):
        falling = np.array([math.perm(int(i), order) for i in powers], dtype=np.float64)
        exponents = np.maximum(powers - order, 0)
        rows.append(falling * np.array([[0.0], [1.0]]) ** exponents)
        right.append(np.zeros((2, places.shape[1])))
    solved = np.linalg.solve(np.concatenate(rows), np.concatenate(right))
    solved[: resting + 1] = 0.0
    solved[0] = places[0]
    return PiecewisePolynomial(np.array([0.0, 1.0]), solved[:, None, :])
