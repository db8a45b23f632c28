"""Make plans, and keep the worst of what is measured on them."""

from __future__ import annotations

import warnings
from dataclasses import dataclass, field

import numpy as np

from many_plans.cases import CASES, Planned
from robomech_ros.errors import RobomechError
from robomech_ros.trajectory.curves.bounds import extremes_and_steps
from robomech_ros.trajectory.limits import RATES

__all__ = ["ALLOWED", "Outcome", "measured", "rng_of", "run"]

# What is measured, and how much of it there may be: the excess over limits in parts of them;
# misses of points and steps of the position in rad or m and in parts of 1 + the largest position;
# steps of velocity and acceleration, and misses of them at the ends, in parts of their limits.
# Phases of constant jerk last longer or shorter by the rounding of their instants: where they are
# a millionth of the duration, that shows in accelerations.
ALLOWED = {
    "excess": 1e-9,
    "missed": 1e-9,
    "step of q": 1e-9,
    "step of v": 1e-9,
    "step of a": 1e-8,
    "rates at ends": 1e-8,
}
# Of the rounding of a position, twice at each end of a piece.
_ROUNDED = 4.0 * float(np.finfo(float).eps)
_INSIDE = np.array([0.0, 0.1, 0.25, 0.5, 0.75, 0.9])


@dataclass
class Outcome:
    """Result of the plans of one profile.

    Attributes
    ----------
    plans, refused : int
        How many there are, and how many requests were refused.
    worst : dict
        By what is measured, the largest value and the number of its plan.
    faults : list of str
        What is wrong, each with the number of its plan.
    reasons : dict
        Of refusals, by their exception, the number of the first plan.
    """

    plans: int = 0
    refused: int = 0
    worst: dict[str, tuple[float, int]] = field(default_factory=dict)
    faults: list[str] = field(default_factory=list)
    reasons: dict[str, tuple[int, str]] = field(default_factory=dict)


def rng_of(profile: str, seed: int, number: int) -> np.random.Generator:
    """Return the random numbers of one plan, whatever is planned before it."""
    return np.random.default_rng([list(CASES).index(profile), seed, number])


def run(profile: str, count: int, seed: int = 0, first: int = 0) -> Outcome:
    """Make plans of one profile, and measure them."""
    outcome = Outcome()
    for number in range(first, first + count):
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                planned = CASES[profile](rng_of(profile, seed, number))
                values = measured(planned)
        except RobomechError as error:
            outcome.refused += 1
            outcome.reasons.setdefault(type(error).__name__, (number, str(error)))
            continue
        except Exception as error:
            outcome.faults.append(f"plan {number}: {type(error).__name__}: {error}")
            continue
        outcome.plans += 1
        for what, value in values.items():
            if not value <= outcome.worst.get(what, (-1.0, 0))[0]:
                outcome.worst[what] = value, number
            if not value <= ALLOWED[what]:
                outcome.faults.append(f"plan {number}: {what} {value:.3g}")
    return outcome


def measured(planned: Planned) -> dict[str, float]:
    """Measure a plan.

    Raises
    ------
    AssertionError
        Numbers are not finite, or breaks do not increase.
    """
    pieces = planned.motion.pieces
    assert np.isfinite(pieces.breaks).all() and np.isfinite(pieces.coefficients).all()
    spans = np.diff(pieces.breaks)
    assert (spans > 0.0).all(), f"breaks {int((spans <= 0.0).sum())} times do not increase"
    assert pieces.breaks[0] == 0.0 and pieces.breaks[-1] == planned.motion.duration
    scale = 1.0 + np.abs(planned.points).max()
    low, high, steps, _ = extremes_and_steps(pieces)
    rates = np.where(np.isfinite(planned.limits.rates), planned.limits.rates, np.inf)
    peaks = np.maximum(np.maximum(-low, high)[1:], _sampled_peaks(planned))
    kept = [RATES.index(rate) for rate in planned.rates]
    values = {
        "excess": float((peaks / rates)[kept].max()) - 1.0,
        "missed": _missed(planned) / scale,
        "step of q": float(steps[0].max()) / scale,
        "step of v": float(
            (np.maximum(steps[1] - _ROUNDED * scale / spans.min(), 0.0) / rates[0]).max()
        ),
        "rates at ends": _missed_rates(planned),
    }
    if planned.smooth > 1:
        values["step of a"] = float((steps[2] / rates[1]).max())
    return values


def _sampled_peaks(planned: Planned) -> np.ndarray:
    """Sample the rates as callers do, at breaks, just before them, and between them."""
    breaks = planned.motion.pieces.breaks
    inner = (breaks[:-1, None] + np.diff(breaks)[:, None] * _INSIDE).ravel()
    instants = np.concatenate([inner, np.nextafter(breaks, 0.0), breaks[-1:]])
    sample = planned.motion.sample(instants)
    assert all(np.isfinite(values).all() for values in sample)
    return np.stack([np.abs(values).max(axis=0) for values in sample[1:]])


def _missed(planned: Planned) -> float:
    """Find by how much the motion misses its points."""
    knots = getattr(planned.motion, "knots", np.array([0.0, planned.motion.duration]))
    assert (np.diff(knots) >= 0.0).all()
    return float(np.abs(planned.motion.sample(knots).position - planned.points).max())


def _missed_rates(planned: Planned) -> float:
    """Find by how much the curve misses its rates at both ends, in parts of their limits."""
    pieces, worst = planned.motion.pieces, 0.0
    for order, wanted in enumerate(planned.ends, 1):
        if wanted is not None:
            limit = planned.limits.rates[order - 1]
            powers = pieces.derivative(order)
            last = pieces.breaks[-1] - pieces.breaks[-2]
            final = (powers[:, -1] * last ** np.arange(len(powers))[:, None]).sum(axis=0)
            found = np.stack([powers[0, 0], final])
            worst = max(worst, float((np.abs(found - wanted) / limit).max()))
    return worst
