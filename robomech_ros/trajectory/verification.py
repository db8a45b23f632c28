"""Verify the curve that a controller will follow, at the samples and everywhere between them."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from robomech_ros._kernels import tolerances
from robomech_ros.errors import BadValueError, LimitExceededError, WrongSizeError
from robomech_ros.spatial.arrays import real_array
from robomech_ros.trajectory.bounds import extremes, first_above, hull
from robomech_ros.trajectory.given_pieces import checked_pieces
from robomech_ros.trajectory.limits import RATES, JointLimits, Limits, Rate
from robomech_ros.trajectory.piecewise import PiecewisePolynomial
from robomech_ros.trajectory.sample import FloatArray
from robomech_ros.trajectory.waypoints import PiecewiseTrajectory, Waypoints

__all__ = ["Verification", "Violation", "verify"]

QUANTITIES = ("position", *RATES)
# Of piecewise polynomials, as they are documented.
_LARGEST_ORDER = 9


@dataclass(frozen=True)
class Violation:
    """What is wrong first with a trajectory.

    Attributes
    ----------
    what : str
        ``"position"``, ``"velocity"``, ``"acceleration"``, ``"jerk"``, ``"start time"``,
        ``"start position"``, ``"final velocity"`` or ``"final acceleration"``.
    joint : str
        The joint; empty for ``"start time"``.
    time : float
        When, in s on the clock of the trajectory.
    value, limit : float
        What it is and what it may be at most (or should be), rad or m and s.
    """

    what: str
    joint: str
    time: float
    value: float
    limit: float

    @property
    def amount(self) -> float:
        """How far the value is from what is allowed."""
        return abs(self.value - self.limit)

    def __str__(self) -> str:
        joint = f" of joint '{self.joint}'" if self.joint else ""
        limit = "limit" if self.what in QUANTITIES else "wanted value"
        return (
            f"{self.what}{joint} is {self.value:.9g} at t = {self.time:.6g} s, "
            f"off its {limit} {self.limit:.9g} by {self.amount:.3g}"
        )


@dataclass(frozen=True, eq=False)
class Verification:
    """Outcome of a verification.

    Attributes
    ----------
    peak_velocity_ratio, peak_acceleration_ratio, peak_jerk_ratio : ndarray, shape (n,)
        Largest magnitude anywhere on the curve over the limit, as far as it is certain in spite
        of the rounding of samples; 0 where there is no limit.
    violation : Violation or None
        The first one in time, None if there is none.
    """

    peak_velocity_ratio: FloatArray
    peak_acceleration_ratio: FloatArray
    peak_jerk_ratio: FloatArray
    violation: Violation | None

    @property
    def ok(self) -> bool:
        """Whether nothing is wrong."""
        return self.violation is None

    def require_ok(self) -> None:
        """Raise `LimitExceededError` if something is wrong."""
        if self.violation is not None:
            found = self.violation
            what = f"at t = {found.time:.6g} s {found.what}"
            raise LimitExceededError(what, found.joint, found.value, found.limit)


def verify(
    trajectory: Waypoints | PiecewiseTrajectory | PiecewisePolynomial,
    limits: JointLimits | Any,
    *,
    start: npt.ArrayLike | None = None,
    start_tolerance: float = tolerances.POSITION_SLACK,
    from_zero: bool = True,
    to_rest: bool = True,
    rates: Sequence[Rate] = RATES,
) -> Verification:
    """Verify that a trajectory begins, ends and stays as it must.

    Parameters
    ----------
    trajectory : Waypoints, PiecewiseTrajectory or PiecewisePolynomial
        Waypoints are interpolated as a controller does (linear, cubic or quintic).  Positions must
        not step, nor velocities where accelerations are limited.  Not seen are steps of velocity
        of a curve that is linear throughout, and of acceleration.
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
    BadValueError, NonFiniteError, WrongSizeError
        If waypoints or pieces make no curve: times that do not increase, NaN, wrong shapes.
    """
    known = Limits.of(limits)
    curve, rounding = _curve_of(trajectory)
    if curve.joints != len(known.joint_names):
        raise WrongSizeError("joints of the trajectory", curve.joints, len(known.joint_names))
    doubts = [_rounding(curve, order) if rounding else None for order in range(4)]
    ratios = {
        rate: _peak(curve, order, doubts[order]) / getattr(known, rate)
        for order, rate in enumerate(RATES, 1)
    }
    found = list(_ends(curve, known, start, start_tolerance, from_zero, to_rest))
    found += _position_violations(curve, known)
    found += _steps(curve, known, 0, np.full(curve.joints, tolerances.POSITION_SLACK), doubts[0])
    if "acceleration" in rates and curve.coefficients[2:].any():
        slack = tolerances.LIMIT_SLACK * np.where(np.isfinite(known.velocity), known.velocity, 1.0)
        slack[np.isinf(known.acceleration)] = np.inf
        found += _steps(curve, known, 1, slack, doubts[1])
    for order, rate in enumerate(RATES, 1):
        if rate in rates and (ratios[rate] > 1.0 + tolerances.LIMIT_SLACK).any():
            found += _rate_violations(curve, known, order, rate, doubts[order])
    first = min(found, key=lambda violation: violation.time, default=None)
    return Verification(ratios["velocity"], ratios["acceleration"], ratios["jerk"], first)


def _curve_of(
    trajectory: Waypoints | PiecewiseTrajectory | PiecewisePolynomial,
) -> tuple[PiecewisePolynomial, bool]:
    """Find the curve, and whether it comes from samples and so carries their rounding."""
    if isinstance(trajectory, Waypoints):
        return trajectory.curve, True
    if isinstance(trajectory, PiecewisePolynomial):
        return checked_pieces(trajectory, "trajectory", _LARGEST_ORDER), True
    pieces = getattr(trajectory, "pieces", None)
    if not isinstance(pieces, PiecewisePolynomial):
        expected = "Waypoints, a PiecewisePolynomial, or a trajectory with pieces"
        raise BadValueError("trajectory", trajectory, expected)
    return pieces, False


def _peak(curve: PiecewisePolynomial, order: int, doubt: FloatArray | None) -> FloatArray:
    low, high = extremes(curve, order, doubt)
    return np.maximum(np.maximum(-low, high), 0.0)


def _ends(
    curve: PiecewisePolynomial,
    limits: Limits,
    start: npt.ArrayLike | None,
    start_tolerance: float,
    from_zero: bool,
    to_rest: bool,
) -> Iterable[Violation]:
    """Yield what is wrong with the first and the last instant."""
    begin, end = float(curve.breaks[0]), float(curve.breaks[-1])
    if from_zero and begin != 0.0:
        yield Violation("start time", "", begin, begin, 0.0)
    if start is not None:
        wanted = real_array("start", start)
        if wanted.shape != (curve.joints,):
            raise WrongSizeError("start", wanted.shape, (curve.joints,))
        first = curve.coefficients[0, 0]
        yield from _worst(
            "start position", limits.joint_names, begin, first, wanted, start_tolerance
        )
    if to_rest:
        last = curve.sample(end)
        for what, values, scale in (
            ("final velocity", last.velocity, limits.velocity),
            ("final acceleration", last.acceleration, limits.acceleration),
        ):
            slack = tolerances.LIMIT_SLACK * np.where(np.isfinite(scale), scale, 1.0)
            yield from _worst(what, limits.joint_names, end, values, np.zeros(len(values)), slack)


def _worst(
    what: str,
    names: Sequence[str],
    time: float,
    values: FloatArray,
    wanted: FloatArray,
    slack: FloatArray | float,
) -> Iterable[Violation]:
    excess = np.abs(values - wanted) - slack
    joint = int(np.argmax(excess)) if len(excess) else 0
    if len(excess) and not excess[joint] <= 0.0:
        yield Violation(what, names[joint], time, float(values[joint]), float(wanted[joint]))


def _position_violations(curve: PiecewisePolynomial, limits: Limits) -> Iterable[Violation]:
    low, high = extremes(curve, 0)
    slack = tolerances.POSITION_SLACK
    if not ((low < limits.lower - slack) | (high > limits.upper + slack)).any():
        return
    coefficients = hull(curve, 0)
    for sign, bound in ((1.0, limits.upper), (-1.0, limits.lower)):
        place = first_above(sign * coefficients, sign * bound + slack)
        if place is not None:
            yield _described(curve, 0, limits.joint_names, place, sign, bound)


def _steps(
    curve: PiecewisePolynomial,
    limits: Limits,
    order: int,
    slack: FloatArray,
    doubt: FloatArray | None,
) -> Iterable[Violation]:
    """Yield the first step of a derivative between segments that is over a slack (n,)."""
    coefficients = hull(curve, order)
    steps = coefficients[0, 1:] - coefficients[-1, :-1]
    if doubt is not None:
        slack = slack + np.maximum(doubt[1:], doubt[:-1])
    places, joints = np.nonzero(~(np.abs(steps) <= slack))
    if len(places):
        k, joint = int(places[0]), int(joints[0])
        what, time = f"step of {QUANTITIES[order]}", float(curve.breaks[k + 1])
        yield Violation(what, limits.joint_names[joint], time, float(steps[k, joint]), 0.0)


def _rate_violations(
    curve: PiecewisePolynomial, limits: Limits, order: int, rate: Rate, doubt: FloatArray | None
) -> Iterable[Violation]:
    bound = getattr(limits, rate)
    allowed = bound * (1.0 + tolerances.LIMIT_SLACK)
    if doubt is not None:
        allowed = allowed + doubt
    coefficients = hull(curve, order)
    for sign in (1.0, -1.0):
        place = first_above(sign * coefficients, allowed)
        if place is not None:
            yield _described(curve, order, limits.joint_names, place, sign, sign * bound)


def _rounding(curve: PiecewisePolynomial, order: int) -> FloatArray:
    """Bound what the rounding of samples to floating point does to a derivative, shape (s, n).

    The quintic through samples h apart multiplies errors of position by up to 60 / h^3 in its
    jerk, errors of velocity by up to 36 / h^2 and so on; the factors here lie above all of them.
    """
    if not len(curve.spans):
        return np.zeros(curve.coefficients.shape[1:])
    eps, h = np.finfo(np.float64).eps, curve.spans[:, None]
    position, velocity, acceleration = (
        np.abs(curve.derivative(k)[0]).max(axis=0, initial=0.0) for k in range(3)
    )
    late = np.abs(curve.breaks[1:])[:, None]
    bound: FloatArray = (
        240.0 * eps * (position + velocity * late) / h**order
        + 120.0 * eps * velocity / h ** (order - 1)
        + 20.0 * eps * acceleration / h ** max(order - 2, 0)
    )
    return bound


def _described(
    curve: PiecewisePolynomial,
    order: int,
    names: Sequence[str],
    place: tuple[int, int],
    sign: float,
    bound: FloatArray,
) -> Violation:
    """Describe the worst of one joint in one segment."""
    segment, joint = place
    coefficients = curve.derivative(order)[:, segment, joint]
    span = float(curve.spans[segment]) if len(curve.spans) else 0.0
    turns = np.roots((coefficients * np.arange(len(coefficients)))[:0:-1])
    real = turns[np.abs(turns.imag) <= 1e-9 * (1.0 + np.abs(turns.real))].real
    instants = np.concatenate([[0.0, span], real[(real > 0.0) & (real < span)]])
    values = np.polyval(coefficients[::-1], instants)
    worst = int(np.argmax(sign * values))
    time = float(curve.breaks[segment] + instants[worst])
    return Violation(
        QUANTITIES[order], names[joint], time, float(values[worst]), float(bound[joint])
    )
