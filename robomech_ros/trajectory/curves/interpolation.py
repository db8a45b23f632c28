"""Curves through waypoints, by the rule of ros2_control's joint_trajectory_controller.

A segment between two waypoints is quintic where both have velocities and accelerations, cubic
where both have velocities, and linear otherwise.
"""

from __future__ import annotations

import math

import numpy as np

from robomech_ros._kernels.timing.quintic import upper_coefficients
from robomech_ros.errors import BadValueError, NonFiniteError, WrongSizeError
from robomech_ros.spatial.arrays import check_finite, real_array
from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial
from robomech_ros.typing import Array, ArrayLike, BoolArray

Selection = BoolArray | slice


def interpolant(
    times: ArrayLike,
    positions: ArrayLike,
    velocities: ArrayLike | None = None,
    accelerations: ArrayLike | None = None,
) -> PiecewisePolynomial:
    """Interpolate waypoints: linear, cubic or quintic by the data that is there.

    Parameters
    ----------
    times : array_like, shape (m,)
        Instants of the waypoints in s, strictly increasing, m >= 1.
    positions : array_like, shape (m, n)
        Joint values, rad or m.
    velocities : array_like, shape (m, n), optional
        rad/s or m/s.  A row of NaN says that this waypoint has none.
    accelerations : array_like, shape (m, n), optional
        rad/s^2 or m/s^2, with a row of NaN likewise.  They count only where both ends of a
        segment have velocities as well.

    Returns
    -------
    PiecewisePolynomial
        With ``.sample(t)``; before the first and after the last waypoint the joints rest.  One
        waypoint alone gives joints that stand still.

    Raises
    ------
    BadValueError
        If the times do not increase strictly.
    """
    breaks = _times(times)
    places = _rows("positions", positions, len(breaks), None, may_lack=False)
    joints = places.shape[1]
    if len(breaks) == 1:
        return PiecewisePolynomial(breaks, places[None])
    rates = _rows("velocities", velocities, len(breaks), joints, may_lack=True)
    changes = _rows("accelerations", accelerations, len(breaks), joints, may_lack=True)
    spans = (breaks[1:] - breaks[:-1])[:, None]
    rise = places[1:] - places[:-1]
    cubic = _given_at_both_ends(rates)
    quintic = cubic & _given_at_both_ends(changes)
    order = 5 if quintic.any() else 3 if cubic.any() else 1
    coefficients = np.zeros((order + 1, len(spans), joints))
    coefficients[0] = places[:-1]
    if not cubic.all():
        coefficients[1, ~cubic] = rise[~cubic] / spans[~cubic]
    if not (quintic | ~cubic).all():
        _fill_cubic(coefficients, _selection(cubic & ~quintic), rise, spans, rates)
    if quintic.any():
        _fill_quintic(coefficients, _selection(quintic), rise, spans, rates, changes)
    return PiecewisePolynomial(breaks, coefficients)


def _times(times: ArrayLike) -> Array:
    breaks = real_array("times", times).copy()
    if breaks.ndim != 1 or not len(breaks):
        raise WrongSizeError("times", breaks.shape, "(m,) with at least one instant")
    check_finite("times", breaks)
    later = breaks[1:] > breaks[:-1]
    if not later.all():
        k = int(later.argmin()) + 1
        earlier = f"more than {breaks[k - 1]:.9g} s, the time of the waypoint before it"
        raise BadValueError(f"time of waypoint {k}", float(breaks[k]), earlier)
    return breaks


def _rows(
    what: str, values: ArrayLike | None, count: int, joints: int | None, *, may_lack: bool
) -> Array:
    """Check rows of joint values; rows of NaN altogether (or no rows) may stand for none."""
    if values is None:
        return np.full((count, joints or 0), math.nan)
    rows = real_array(what, values).copy()
    if rows.ndim != 2 or len(rows) != count or (joints is not None and rows.shape[1] != joints):
        raise WrongSizeError(what, rows.shape, (count, "n" if joints is None else joints))
    finite = np.isfinite(rows)
    if finite.all():
        return rows
    acceptable = finite.all(axis=1)
    if may_lack:
        acceptable |= np.isnan(rows).all(axis=1)
    if not acceptable.all():
        row = int(np.flatnonzero(~acceptable)[0])
        raise NonFiniteError(f"{what} of waypoint {row}", rows[row])
    return rows


def _given_at_both_ends(rows: Array) -> BoolArray:
    if not rows.shape[1]:
        return np.zeros(len(rows) - 1, dtype=np.bool_)
    given = ~np.isnan(rows[:, 0])  # a row that lacks one number lacks all
    return given[:-1] & given[1:]


def _selection(rows: BoolArray) -> Selection:
    """Index that picks the rows, without a copy where it picks all."""
    return slice(None) if rows.all() else rows


def _fill_cubic(
    coefficients: Array, where: Selection, rise: Array, spans: Array, rates: Array
) -> None:
    h, d = spans[where], rise[where]
    v0, v1 = rates[:-1][where], rates[1:][where]
    coefficients[1, where] = v0
    coefficients[2, where] = (3.0 * d / h - 2.0 * v0 - v1) / h
    coefficients[3, where] = (v0 + v1 - 2.0 * d / h) / h**2


def _fill_quintic(
    coefficients: Array, where: Selection, rise: Array, spans: Array, rates: Array, changes: Array
) -> None:
    v0, v1 = rates[:-1][where], rates[1:][where]
    a0, a1 = changes[:-1][where], changes[1:][where]
    coefficients[1, where] = v0
    coefficients[2, where] = a0 / 2.0
    upper = upper_coefficients(spans[where], rise[where], v0, v1, a0, a1)
    for power, values in enumerate(upper, 3):
        coefficients[power, where] = values
