"""Sample piecewise polynomials at many instants, by compiled code.

Planners do so; a controller, which samples one instant at a time, does without compiled code and
has :meth:`PiecewisePolynomial.sample`.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from importlib import import_module
from typing import Any

import numpy as np

from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial
from robomech_ros.trajectory.sample import Sample, checked_times
from robomech_ros.typing import Array, ArrayLike


@cache
def compiled(module: str, kernel: str) -> Callable[..., Any]:
    """Load a kernel of trajectories, to be called with contiguous arrays of its very types."""
    from robomech_ros._kernels.compiling.jit import direct

    return direct(getattr(import_module(f"robomech_ros._kernels.timing.{module}"), kernel))


def sample_many(curve: PiecewisePolynomial, t: ArrayLike) -> Sample:
    """Sample positions and derivatives at instants (s), shape () or (m,)."""
    times = checked_times(t)
    if not times.ndim:
        return curve.sample(times)
    rates = np.empty((4, len(times), curve.joints))
    given = map(np.ascontiguousarray, (curve.breaks, curve.coefficients, times))
    compiled("samples", "sample_pieces")(*given, rates)
    return Sample(*rates)


def quintic_pieces(times: Any, *rates: Any) -> tuple[PiecewisePolynomial, Array] | None:
    """Interpolate as `interpolant` does, and bound what rounding does to the curve, (4, s, n).

    Return None unless `times` (m,), m at least 2, and positions, velocities and accelerations (m,
    n) are there, all of them finite.
    """
    given = (times, *rates)
    if not all(type(one) is np.ndarray and one.dtype == np.float64 for one in given):
        return None
    shape = (*times.shape, *rates[0].shape[1:])
    if len(shape) != 2 or shape[0] < 2 or any(rate.shape != shape for rate in rates):
        return None
    found, through = np.empty((10, shape[0] - 1, shape[1])), compiled("samples", "quintic_pieces")
    if not through(*map(np.ascontiguousarray, given), found[:6], found[6:]):
        return None
    return PiecewisePolynomial(times.copy(), found[:6]), found[6:]


def divided(curve: PiecewisePolynomial, breaks: Array) -> PiecewisePolynomial:
    """Write a curve over finer breaks (s + 1,)."""
    size, _, joints = curve.coefficients.shape
    local = np.empty((len(breaks) - 1, joints, size))
    given = map(np.ascontiguousarray, (curve.breaks, curve.coefficients, breaks))
    compiled("constraint_rows", "local_path")(*given, local)
    return PiecewisePolynomial(breaks, np.ascontiguousarray(local.transpose(2, 0, 1)))


class PiecewiseMotion:
    """A motion along a piecewise polynomial, from t = 0 on."""

    pieces: PiecewisePolynomial

    @property
    def duration(self) -> float:
        """Time from start to end, in s."""
        return self.pieces.duration

    def sample(self, t: ArrayLike) -> Sample:
        """Sample positions and derivatives, (n,) or (m, n), at instants (s), shape () or (m,).

        Before 0 the joints rest at the start, after the end at the goal. Where the acceleration
        steps, the later one counts.
        """
        return sample_many(self.pieces, t)
