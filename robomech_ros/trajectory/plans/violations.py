"""Violations of a curve: at its ends, and the first of each kind between them."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from robomech_ros.spatial.arrays import as_flag, real_within, shaped_array
from robomech_ros.trajectory.curves.bounds import first_above, hull, steps
from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial
from robomech_ros.trajectory.limits import RATES, Limits, Rate
from robomech_ros.trajectory.tolerances import LIMIT_SLACK, POSITION_SLACK
from robomech_ros.typing import Array

_QUANTITIES = ("position", *RATES)


@dataclass(frozen=True)
class Violation:
    """First violation in a trajectory.

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
    unit : str
        Theirs; empty where it is not known.
    """

    what: str
    joint: str
    time: float
    value: float
    limit: float
    unit: str = ""

    @property
    def amount(self) -> float:
        """Distance of the value from the allowed range."""
        return abs(self.value - self.limit)

    def __str__(self) -> str:
        joint = f" of joint '{self.joint}'" if self.joint else ""
        limit = "limit" if self.what in _QUANTITIES else "wanted value"
        unit = f" {self.unit}" if self.unit else ""
        return (
            f"{self.what}{joint} is {self.value:.9g}{unit} at t = {self.time:.6g} s, "
            f"off its {limit} {self.limit:.9g}{unit} by {self.amount:.3g}{unit}"
        )


def violations_between(
    curve: PiecewisePolynomial, limits: Limits, doubts: Array, allowed: Array, rates: Sequence[Rate]
) -> list[Violation]:
    """List what is wrong between start and end, the first of each kind."""
    found = [
        *_bound_violations(curve, limits, 0, POSITION_SLACK),
        *_step_violations(curve, limits, doubts, allowed),
    ]
    for order, rate in enumerate(RATES, 1):
        if rate in rates:
            slack = LIMIT_SLACK * limits.rates[order - 1] + doubts[order]
            found += _bound_violations(curve, limits, order, slack)
    return found


def end_violations(
    curve: PiecewisePolynomial,
    limits: Limits,
    start: npt.ArrayLike | None,
    start_tolerance: float,
    from_zero: bool,
    to_rest: bool,
    last: Sequence[Array],
) -> Iterable[Violation]:
    """Yield what is wrong with the first and the last instant, whose rates are given."""
    expected = "a number of rad or m from 0 on"
    slack = real_within("start_tolerance", start_tolerance, expected, 0.0)
    from_zero, to_rest = as_flag("from_zero", from_zero), as_flag("to_rest", to_rest)
    begin, end = float(curve.breaks[0]), float(curve.breaks[-1])
    if from_zero and begin != 0.0:
        yield Violation("start time", "", begin, begin, 0.0, "s")
    if start is not None:
        wanted = shaped_array("start", start, (curve.joints,))
        first = curve.coefficients[0, 0]
        yield from _worst("start position", limits, 0, begin, first, wanted, slack)
    if to_rest:
        slacks, rest = LIMIT_SLACK * limits.scales, np.zeros(curve.joints)
        if (np.abs(last[1:3]) <= slacks[:2]).all():
            return
        for order, what in enumerate(("final velocity", "final acceleration"), 1):
            yield from _worst(what, limits, order, end, last[order], rest, slacks[order - 1])


def _worst(
    what: str,
    limits: Limits,
    order: int,
    time: float,
    values: Array,
    wanted: Array,
    slack: Array | float,
) -> Iterable[Violation]:
    excess = np.abs(values - wanted) - slack
    joint = int(excess.argmax()) if len(excess) else 0
    if len(excess) and not excess[joint] <= 0.0:
        name, unit = limits.joint_names[joint], limits.unit(joint, order)
        yield Violation(what, name, time, float(values[joint]), float(wanted[joint]), unit)


def _bound_violations(
    curve: PiecewisePolynomial, limits: Limits, order: int, slack: Array | float
) -> Iterable[Violation]:
    """Yield where a derivative first goes over its upper and its lower bound."""
    coefficients = hull(curve, order)
    rates = limits.rates[order - 1]
    bounds = (rates, -rates) if order else (limits.upper, limits.lower)
    for sign, bound in zip((1.0, -1.0), bounds, strict=True):
        place = first_above(sign * coefficients, sign * bound + slack)
        if place is not None:
            yield _described(curve, order, limits, place, sign, bound)


def _step_violations(
    curve: PiecewisePolynomial, limits: Limits, doubts: Array, allowed: Array
) -> Iterable[Violation]:
    """Yield the first step of each derivative that is larger than allowed for certain."""
    rounding = np.maximum(doubts[:3, 1:], doubts[:3, :-1])
    certain = np.maximum(np.abs(steps(curve, (0, 1, 2))) - rounding, 0.0)
    too_large = ~(certain <= allowed[:, None])
    for order in np.flatnonzero(too_large.any(axis=(1, 2))).tolist():
        places, joints = np.nonzero(too_large[order])
        k, joint = int(places[0]), int(joints[0])
        step = float(steps(curve, (order,))[0, k, joint])
        what, time = f"step of {_QUANTITIES[order]}", float(curve.breaks[k + 1])
        name, unit = limits.joint_names[joint], limits.unit(joint, order)
        yield Violation(what, name, time, step, 0.0, unit)


def _described(
    curve: PiecewisePolynomial,
    order: int,
    limits: Limits,
    place: tuple[int, int],
    sign: float,
    bound: Array,
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
    what, name, unit = _QUANTITIES[order], limits.joint_names[joint], limits.unit(joint, order)
    return Violation(what, name, time, float(values[worst]), float(bound[joint]), unit)
