"""Curves in fewer pieces, where neighbouring pieces are nearly one polynomial."""

import numpy as np

from robomech_ros.trajectory.curves.bounds import hull
from robomech_ros.trajectory.curves.interpolation import interpolant
from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial
from robomech_ros.trajectory.limits import Limits
from robomech_ros.typing import BoolArray

# How far a quintic over two pieces may be off them where they meet, rad or m, and in parts of the
# acceleration limit.
_OFF, _OFF_ACCELERATION = 2e-8, 1e-4
# Passes over all pairs of neighbours; each halves their number at the most.
_PASSES = 24


def with_fewer_pieces(curve: PiecewisePolynomial, limits: Limits) -> PiecewisePolynomial:
    """Join neighbouring pieces of a motion where one quintic does for both.

    The acceleration must be continuous.  Position, velocity and acceleration stay what they are at
    every break that is left.  Breaks at which the jerk really steps are left, since the quintic
    over both sides would have more jerk than either.
    """
    waste = 0
    for k in range(_PASSES):
        joined = _pairs_joined(curve, k % 2, limits)
        waste = waste + 1 if len(joined.breaks) > 0.9 * len(curve.breaks) else 0
        curve = joined
        if waste == 2:
            break
    return curve


def _pairs_joined(curve: PiecewisePolynomial, first: int, limits: Limits) -> PiecewisePolynomial:
    """Join those pairs of pieces, from number `first` on, that nearly are one quintic."""
    breaks = curve.breaks
    ends = np.arange(first, len(breaks), 2)
    if len(ends) < 2:
        return curve
    rates = curve.sample(breaks)[:3]
    wide = interpolant(breaks[ends], *(values[ends] for values in rates))
    middle = wide.sample(breaks[ends[:-1] + 1])
    off = np.abs(middle.position - rates[0][ends[:-1] + 1])
    acceleration_off = np.abs(middle.acceleration - rates[2][ends[:-1] + 1])
    good = (off <= _OFF).all(axis=1)
    good &= (acceleration_off <= _OFF_ACCELERATION * limits.acceleration).all(axis=1)
    good &= _jerk_kept(curve, wide, first, limits)
    dropped = np.zeros(len(breaks), bool)
    dropped[ends[:-1] + 1] = good
    kept = ~dropped
    return interpolant(breaks[kept], *(values[kept] for values in rates))


def _jerk_kept(
    curve: PiecewisePolynomial, wide: PiecewisePolynomial, first: int, limits: Limits
) -> BoolArray:
    """Find the wide pieces with no more jerk than its limit, or than both that they replace."""
    count = wide.coefficients.shape[1]
    narrow = np.abs(hull(curve, 3)).max(axis=0)[first : first + 2 * count]
    before = narrow.reshape(count, 2, -1).max(axis=1)
    after = np.abs(hull(wide, 3)).max(axis=0)
    return (after <= np.maximum(before, limits.jerk)).all(axis=1)
