"""Verify the curve that a controller will follow, at the samples and everywhere between them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache, lru_cache
from typing import Any

import numpy as np
import numpy.typing as npt

from robomech_ros._kernels.timing.quintic import rounding_bounds
from robomech_ros.errors import BadValueError, LimitExceededError, WrongSizeError
from robomech_ros.spatial.arrays import as_choice, listed
from robomech_ros.trajectory.curves.bounds import extremes_and_steps
from robomech_ros.trajectory.curves.checked_pieces import checked_pieces
from robomech_ros.trajectory.curves.compiled_sampling import compiled, quintic_pieces
from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial
from robomech_ros.trajectory.limits import RATES, JointLimits, Limits, Rate
from robomech_ros.trajectory.plans.violations import Violation, end_violations, violations_between
from robomech_ros.trajectory.tolerances import LIMIT_SLACK, POSITION_SLACK
from robomech_ros.trajectory.waypoints import PiecewiseTrajectory, Waypoints
from robomech_ros.typing import Array

# Largest order of piecewise polynomials, as documented.
_LARGEST_ORDER = 9


@dataclass(frozen=True, eq=False)
class Verification:
    """Outcome of a verification.

    Attributes
    ----------
    peak_velocity_ratio, peak_acceleration_ratio, peak_jerk_ratio : ndarray, shape (n,)
        Largest magnitude anywhere on the curve over the limit, as far as it is certain in spite
        of the rounding of samples; 0 where there is no limit.  A step of the acceleration is an
        infinite jerk, which counts as a violation only if the profile promises none.
    violation : Violation or None
        The first one in time, None if there is none.
    largest_acceleration_step : ndarray, shape (n,)
        Largest step of the acceleration between two segments, rad/s^2 or m/s^2, as far as it is
        certain; rounding where the acceleration is continuous.
    """

    peak_velocity_ratio: Array
    peak_acceleration_ratio: Array
    peak_jerk_ratio: Array
    violation: Violation | None
    largest_acceleration_step: Array

    @property
    def ok(self) -> bool:
        """True if nothing is wrong."""
        return self.violation is None

    def require_ok(self) -> None:
        """Raise `LimitExceededError` if something is wrong."""
        if self.violation is not None:
            found = self.violation
            what = f"at t = {found.time:.6g} s {found.what}"
            raise LimitExceededError(what, found.joint, found.value, found.limit, found.unit)


def verify(
    trajectory: Waypoints | PiecewiseTrajectory | PiecewisePolynomial,
    limits: JointLimits | Any,
    *,
    start: npt.ArrayLike | None = None,
    start_tolerance: float = POSITION_SLACK,
    from_zero: bool = True,
    to_rest: bool = True,
    rates: Sequence[Rate] = RATES,
) -> Verification:
    """Verify that a trajectory begins, ends and stays as it must.

    Parameters
    ----------
    trajectory : Waypoints, PiecewiseTrajectory or PiecewisePolynomial
        Waypoints are interpolated as a controller does (linear, cubic or quintic).  Positions must
        not step, nor velocities where accelerations are limited, nor accelerations of a motion
        whose profile promises continuous ones.  Steps of velocity are not looked for where the
        curve is linear throughout; steps of the acceleration of waypoints and of mere pieces are
        no violation but reported as a figure.
    limits : JointLimits
        Position limits and those limits of `rates` that are finite are checked, within
        tolerances for rounding.
    start : array_like, shape (n,), optional
        Where the joints are, rad or m; the first position must be there.
    start_tolerance : float
        By how much it may differ, rad or m.
    from_zero : bool
        Whether the first instant must be t = 0.
    to_rest : bool
        Whether the last velocity and acceleration must be zero.
    rates : sequence of str
        Which of ``"velocity"``, ``"acceleration"`` and ``"jerk"`` to check against their limits.

    Returns
    -------
    Verification
        Peak ratios of all rates, and the first violation.

    Raises
    ------
    BadValueError, WrongSizeError
        If waypoints or pieces make no curve: times that do not increase, NaN, wrong shapes; or
        another option is not what it should be.

    Examples
    --------
    >>> from robomech_ros.robots import load_robot
    >>> from robomech_ros.trajectory import point_to_point, verify
    >>> puma = load_robot("puma560")
    >>> check = verify(point_to_point([0.0] * 6, [0.5] * 6, limits=puma, profile="poly345"), puma)
    >>> check.ok, bool(check.peak_velocity_ratio.max() <= 1.0)
    (True, True)
    """
    known, rates = Limits.of(limits), _checked_rates(rates)
    curve, doubts = _curve_and_doubts(trajectory, known, compiled=True)
    low, high, largest, last = extremes_and_steps(curve, doubts)
    wrong = list(end_violations(curve, known, start, start_tolerance, from_zero, to_rest, last))
    allowed, ratios = _allowed_steps(trajectory, curve, known, rates), np.empty((3, curve.joints))
    limits_of = known.lower, known.upper, known.rates, _tolerances(rates), allowed
    within = compiled("peaks", "within_bounds")
    if not within(low, high, largest, *limits_of, POSITION_SLACK, LIMIT_SLACK, ratios):
        wrong += violations_between(curve, known, doubts, allowed, rates)
    return Verification(ratios[0], ratios[1], ratios[2], _first(wrong), largest[2])


def first_violation(
    trajectory: Waypoints | PiecewiseTrajectory | PiecewisePolynomial,
    limits: JointLimits | Any,
    *,
    start: npt.ArrayLike | None = None,
    from_zero: bool = True,
    to_rest: bool = True,
    rates: Sequence[Rate] = RATES,
) -> Violation | None:
    """Find what is wrong first with a trajectory, as `verify` does, but without compiled code."""
    known, rates = Limits.of(limits), _checked_rates(rates)
    curve, doubts = _curve_and_doubts(trajectory, known)
    last = curve.sample(curve.breaks[-1])
    found = list(end_violations(curve, known, start, POSITION_SLACK, from_zero, to_rest, last))
    allowed = _allowed_steps(trajectory, curve, known, rates)
    return _first(found + violations_between(curve, known, doubts, allowed, rates))


def _checked_rates(rates: Sequence[Rate]) -> tuple[Rate, ...]:
    if rates is RATES:
        return RATES
    given = listed("rates", rates, f"a list of {', '.join(RATES)}")
    for rate in given:
        as_choice("one of rates", rate, RATES)
    return given


@cache
def _tolerances(rates: tuple[Rate, ...]) -> Array:
    """Return the largest ratios (3,) to limits, infinite for rates that are not checked."""
    return np.array([1.0 + LIMIT_SLACK if rate in rates else np.inf for rate in RATES])


def _first(found: list[Violation]) -> Violation | None:
    return min(found, key=lambda violation: violation.time, default=None)


def _curve_and_doubts(
    trajectory: Any, limits: Limits, compiled: bool = False
) -> tuple[PiecewisePolynomial, Array]:
    """Return the curve that is checked, and by how much rounding may change it."""
    doubts = None
    if isinstance(trajectory, Waypoints):
        given = trajectory.positions, trajectory.velocities, trajectory.accelerations
        found = quintic_pieces(trajectory.times, *given) if compiled else None
        curve, doubts = found or (trajectory.curve, None)
    elif isinstance(trajectory, PiecewisePolynomial):
        curve = checked_pieces(trajectory, "trajectory", _LARGEST_ORDER)
    elif isinstance(getattr(trajectory, "pieces", None), PiecewisePolynomial):
        curve = trajectory.pieces
        doubts = np.zeros((4, *curve.coefficients.shape[1:]))
    else:
        expected = "Waypoints, a PiecewisePolynomial, or a trajectory with pieces"
        raise BadValueError("trajectory", trajectory, expected)
    if curve.joints != len(limits.joint_names):
        raise WrongSizeError("joints of the trajectory", curve.joints, len(limits.joint_names))
    return curve, _rounding(curve) if doubts is None else doubts


def _allowed_steps(
    trajectory: object, curve: PiecewisePolynomial, limits: Limits, rates: tuple[Rate, ...]
) -> Array:
    """Find how far position, velocity and acceleration may step, shape (3, n)."""
    smooth = not getattr(trajectory, "ACCELERATION_STEPS", True)
    return _steps_within(limits, rates, bool(curve.coefficients[2:].any()), smooth)


@lru_cache(maxsize=16)
def _steps_within(limits: Limits, rates: tuple[Rate, ...], bent: bool, smooth: bool) -> Array:
    """Find the same of a curve that bends, and whose acceleration must not step."""
    allowed = np.full((3, len(limits.joint_names)), np.inf)
    allowed[0] = POSITION_SLACK
    limited = np.isfinite(limits.acceleration) & ("acceleration" in rates)
    for order, counts in enumerate((bent, smooth), 1):
        np.copyto(allowed[order], LIMIT_SLACK * limits.scales[order - 1], where=limited & counts)
    return allowed


def _rounding(curve: PiecewisePolynomial) -> Array:
    """Bound what the rounding of samples does to derivatives 0 to 3 of a curve, (4, s, n)."""
    bound = np.zeros((4, *curve.coefficients.shape[1:]))
    if len(curve.spans):
        known = np.abs(curve.coefficients[:3]).max(axis=1)
        q, v, half = np.pad(known, ((0, 3 - len(known)), (0, 0)))
        bound[:] = rounding_bounds(curve.spans[:, None], curve.breaks[1:, None], q, v, 2.0 * half)
    return bound
