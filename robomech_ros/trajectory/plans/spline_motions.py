"""Splines through points in joint space."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal, get_args

import numpy as np

from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.spatial.arrays import as_choice, real_number, shaped_array
from robomech_ros.trajectory.curves.compiled_sampling import PiecewiseMotion, sample_many
from robomech_ros.trajectory.curves.cubic_spline import CubicEnds, cubic_spline
from robomech_ros.trajectory.curves.knots import (
    SPACINGS,
    balanced_knots,
    knots_at,
    optimal_knots,
    spaced_knots,
)
from robomech_ros.trajectory.curves.motion_to_rest import check_positions, settled
from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial
from robomech_ros.trajectory.curves.quintic_spline import Ends, quintic_spline
from robomech_ros.trajectory.curves.time_scaling import checked_duration, fitted
from robomech_ros.trajectory.joint_points import check_increasing, joint_points
from robomech_ros.trajectory.limits import JointLimits, Limits
from robomech_ros.trajectory.sample import Sample
from robomech_ros.typing import Array, ArrayLike

_QUINTIC_ENDS = ("natural", "clamped", "rest", "periodic")
# Spacings that look at the limits.
_SEARCHES = {"balanced": balanced_knots, "optimal": optimal_knots}


@dataclass(frozen=True, eq=False)
class Spline(PiecewiseMotion):
    """A spline through points.

    Attributes
    ----------
    points : ndarray, shape (m, n)
        Joint values, rad or m.
    knots : ndarray, shape (m,)
        When each point is passed, in s.
    ends : str
        The conditions at its ends.
    pieces : PiecewisePolynomial
        The curve; between two knots there is one more break beside an end at rest of a cubic one.
    """

    points: Array
    knots: Array
    ends: CubicEnds
    pieces: PiecewisePolynomial

    def sample(self, t: ArrayLike) -> Sample:
        """Sample positions and derivatives, (n,) or (m, n), at instants (s), at rest outside."""
        sample = sample_many(self.pieces, t)
        return settled(sample, t, self.pieces, self.points[-1]) if self.ends == "rest" else sample


def spline_through(
    points: ArrayLike,
    *,
    times: ArrayLike | None = None,
    limits: JointLimits | Any = None,
    at: ArrayLike | None = None,
    spacing: str = "centripetal",
    ends: CubicEnds = "rest",
    degree: Literal[3, 5] = 3,
    slopes: ArrayLike | None = None,
    duration: float | None = None,
) -> Spline:
    r"""Interpolate points by a spline in time.

    The second derivatives at the knots :math:`x_k` of a cubic one follow from continuous slopes,

    .. math::

       \alpha_k s''_k + 2 (\alpha_k + \alpha_{k+1}) s''_{k+1} + \alpha_{k+1} s''_{k+2} =
       6 \left( \frac{s_{k+2} - s_{k+1}}{\alpha_{k+1}} - \frac{s_{k+1} - s_k}{\alpha_k} \right),
       \qquad \alpha_k = x_{k+1} - x_k,

    and from what is wanted at the ends.

    Parameters
    ----------
    points : array_like, shape (m, n)
        Joint values one after another, rad or m, m >= 2.
    times : array_like, shape (m,), optional
        When each is passed, in s, strictly increasing.  Without them the knots follow `spacing`,
        and the motion is as fast as `limits` allow or takes the wanted `duration`.
    limits : JointLimits, optional
        A chain model, `Limits`, or anything with the same attributes; needed without `times`:
        velocity and acceleration limits of every joint, and those jerk limits that are there.
        With `times` they are left to :func:`verify`.
    at : array_like, shape (m - 2,), optional
        Which part of the duration is over at each inner point, strictly between 0 and 1 and
        increasing, in place of `spacing`.
    spacing : str
        ``"uniform"``, ``"chord"`` (times proportional to distances), ``"centripetal"`` (to their
        roots), ``"balanced"`` (all segments as near to the limits as possible; cubic only) or
        ``"optimal"`` (the shortest motion within the limits; cubic only, takes long for many
        points).
    ends : str
        ``"rest"``: neither velocity nor acceleration, as a motion of a robot needs it;
        ``"clamped"``: velocities are `slopes`; ``"natural"``: no acceleration (of a quintic one
        no third and fourth derivative); ``"parabolic"`` (cubic only): constant acceleration in
        the first and in the last segment; ``"periodic"``: the motion goes on as it began.
    degree : int
        3 for continuous acceleration, 5 for continuous jerk and its derivative.
    slopes : array_like, shape (2, n), optional
        Velocities at clamped ends, rad/s or m/s, with `times` only; default zero.
    duration : float, optional
        Wanted duration in s, without `times`.

    Returns
    -------
    Spline
        With ``.duration``, ``.sample(t)``, ``.pieces`` and ``.knots``.

    Raises
    ------
    MissingLimitsError
        If a joint lacks a limit that is needed.
    SeedOutsideLimitsError, LimitExceededError
        If the first point, or another part of the curve, is outside the position limits.
    DurationTooShortError
        If the limits do not allow the wanted duration.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 6.6.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.trajectory import spline_through
    >>> points = np.array([[0.0], [1.0], [0.0]])
    >>> motion = spline_through(points, times=[0.0, 1.0, 2.0], ends="natural")
    >>> at = motion.sample(0.5)
    >>> at.position.round(6), at.velocity.round(6)
    (array([0.6875]), array([1.125]))
    """
    places = joint_points(points)
    _check_options(places, ends, degree, spacing)
    rates = _slopes(slopes, ends, places.shape[1], times is not None)
    if times is not None:
        for what, given in (("duration", duration), ("at", at)):
            if given is not None:
                raise BadValueError(what, given, "none, where times are given")
        knots = shaped_array("times", times, (len(places),)).copy()
        check_increasing("times", knots, " s")
        with np.errstate(all="ignore"):
            spline = _spline(places, knots, ends, degree, rates)
        if not np.isfinite(spline.pieces.coefficients).all():
            expected = "instants neither so near nor so far that numbers between them overflow"
            raise BadValueError("times", knots.tolist(), expected)
        return spline
    if limits is None:
        raise BadValueError("limits", None, "limits of the joints, where no times are given")
    allowed = Limits.of(limits)
    if len(allowed.joint_names) != places.shape[1]:
        raise WrongSizeError("joints of points", places.shape[1], len(allowed.joint_names))
    allowed.require("velocity", "acceleration")
    allowed.check_start(places[0])
    if at is not None:
        knots = knots_at(at, len(places))
    elif spacing in _SEARCHES:
        start = spaced_knots(places, "centripetal", allowed.velocity)
        knots = _SEARCHES[spacing](
            start, lambda times: _spline(places, times, ends, degree, rates).pieces, allowed
        )
    else:
        knots = spaced_knots(places, spacing, allowed.velocity)
    shape = _spline(places, knots, ends, degree, rates)
    pieces = fitted(shape.pieces, allowed, checked_duration(duration))
    check_positions(pieces, places[0], allowed)
    return Spline(places, shape.knots * (pieces.duration / shape.duration), ends, pieces)


def _check_options(places: Array, ends: str, degree: int, spacing: str) -> None:
    if real_number("degree", degree, "3 or 5") not in (3.0, 5.0):
        raise BadValueError("degree", degree, "3 or 5")
    as_choice("ends", ends, get_args(CubicEnds) if degree == 3 else _QUINTIC_ENDS)
    as_choice("spacing", spacing, SPACINGS)
    if spacing in _SEARCHES and degree != 3:
        raise BadValueError("spacing", spacing, "another one for degree 5")
    least = (4 if degree == 5 else 3) if ends in ("parabolic", "periodic") else 2
    if len(places) < least:
        raise WrongSizeError("points", places.shape, f"at least {least} points for {ends} ends")
    if ends == "periodic" and not np.array_equal(places[0], places[-1]):
        expected = f"the first point again, {places[0].tolist()}"
        raise BadValueError(f"points[{len(places) - 1}]", places[-1].tolist(), expected)


def _slopes(slopes: ArrayLike | None, ends: str, n: int, timed: bool) -> Array:
    if slopes is None:
        return np.zeros((2, n))
    if ends != "clamped" or not timed:
        raise BadValueError("slopes", slopes, "none, except for clamped ends with times")
    return shaped_array("slopes", slopes, (2, n))


def _spline(places: Array, knots: Array, ends: CubicEnds, degree: int, slopes: Array) -> Spline:
    if degree == 3:
        return Spline(places, knots, ends, cubic_spline(knots, places, ends, slopes))
    rates = np.stack([slopes, np.zeros_like(slopes)], axis=1)
    kind: Ends = "clamped" if ends == "rest" or ends == "parabolic" else ends
    return Spline(places, knots, ends, quintic_spline(knots, places, kind, rates))
