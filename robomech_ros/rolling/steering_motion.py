"""Motion of steered wheels whose axles meet in one centre of rotation.

A base whose steered wheels leave one centre has the twist ``t = b eta`` with its size eta and a
twist b of unit size.  With coordinates N of the twists that fixed wheels allow, ``b = N n`` for a
unit vector n.  Steering turns it along P, ``dn/dt = P sigma``, with as many rates sigma as the
degree of steerability.  A wheel with the rows c sideways and r forward keeps ``c b = 0``, so that
its steering rate is ``c N P sigma / (r b)``.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from robomech_ros.errors import BadValueError, InconsistentDataError, SingularPostureError
from robomech_ros.rolling.argument_checks import one_vector
from robomech_ros.rolling.base import RollingBase
from robomech_ros.rolling.constraints import drive_rows, side_rows
from robomech_ros.rolling.steering import free_twists
from robomech_ros.spatial.arrays import check_kind, real_array
from robomech_ros.typing import Array, ArrayLike

# Directions that differ by less than this part are the same.
_SAME = 1e-9


@dataclass(frozen=True, eq=False)
class SteeringMotion:
    """Angles of s steered wheels, with their rates and accelerations.

    Attributes
    ----------
    angles : ndarray, shape (s,)
        In rad.
    rates : ndarray, shape (s,), optional
        In rad/s.  Default 0.
    accelerations : ndarray, shape (s,), optional
        In rad/s^2.  Default 0.
    """

    angles: Array
    rates: Array = None  # type: ignore[assignment]
    accelerations: Array = None  # type: ignore[assignment]

    def __post_init__(self) -> None:
        count = real_array("angles", self.angles).size
        for name in ("angles", "rates", "accelerations"):
            value = getattr(self, name)
            array = np.zeros(count) if value is None else one_vector(name, value, count)
            object.__setattr__(self, name, array)


class IndependentRates(NamedTuple):
    """Independent rates u (m,), and what they shape.

    ``shape`` (3 + s, m) and its rate lead from u to the twist and the steering rates.  Columns of
    ``frame`` (3, m) are twists: with steered wheels b, then those towards which steering turns it.
    """

    rates: Array
    shape: Array
    shape_rate: Array
    frame: Array


def steering_along(
    base: RollingBase,
    twist: ArrayLike,
    acceleration: ArrayLike,
    jerk: ArrayLike = (0.0, 0.0, 0.0),
    *,
    near: ArrayLike | None = None,
) -> SteeringMotion:
    """Compute how steered wheels turn while the twist of their base changes.

    Parameters
    ----------
    base : RollingBase
    twist, acceleration, jerk : array_like, shape (3,)
        ``[omega, v_x, v_y]`` (rad/s, m/s) and the rates of its components.  From rest, the wheels
        have the direction of the acceleration, and do not turn.
    near : array_like, shape (s,), optional
        Angles (rad) to stay near to.  Default 0.

    Returns
    -------
    SteeringMotion

    Raises
    ------
    SingularPostureError
        A wheel is at the centre of rotation, and would have to turn at once.
    LimitExceededError
        A wheel would have to be steered beyond its limits.

    Examples
    --------
    >>> from robomech_ros.rolling import load_rolling, steering_along
    >>> found = steering_along(load_rolling("tricycle"), [0.0, 1.0, 0.0], [0.5, 0.0, 0.0])
    >>> found.angles.tolist(), found.rates.round(6).tolist()
    ([0.0], [0.626])
    """
    check_kind("base", base, RollingBase, "a RollingBase")
    start = None if near is None else one_vector("near", near, len(base.steered))
    v, a, j = (
        one_vector(what, value, 3)
        for what, value in (("twist", twist), ("acceleration", acceleration), ("jerk", jerk))
    )
    angles = base.steering_angles(v if v.any() else a, start)
    if not v.any():
        return SteeringMotion(angles)
    sides, rolls = _rows(base, angles)
    speeds = _speeds(base, rolls, v)
    rates = sides @ a / speeds
    return SteeringMotion(angles, rates, (sides @ j - 2.0 * rates * (rolls @ a)) / speeds)


def independent_rates(
    base: RollingBase, twist: Array, steering: SteeringMotion, *, strict: bool = True
) -> IndependentRates:
    """Find the independent rates of a base in motion, and the matrix that they shape it by.

    Without strict, a twist (3,) and steering that the wheels cannot give become the nearest.
    """
    free = free_twists(base.axle)
    if not base.steered:
        return IndependentRates(np.linalg.pinv(free) @ twist, free, np.zeros_like(free), free)
    # Turns in m/s at the farthest wheel: sizes do not mix units.
    free[:, 0] /= max(np.abs(wheel.position).max() for wheel in base.wheels)
    sides, rolls = _rows(base, steering.angles)
    unit = _common_direction(sides @ free, steering.angles, strict)
    across = np.linalg.svd(unit[None])[2][1:].T
    b, turned = free @ unit, free @ across
    speeds = _speeds(base, rolls, b)
    S = sides @ turned / speeds[:, None]
    frame = np.column_stack([b, turned])
    sigma = np.linalg.pinv(S) @ steering.rates
    # Rates of b, r b and c N P; those of n and P are P sigma and -n sigma^T.
    b_rate, spins = turned @ sigma, (S @ sigma)[:, None]
    turned_rate = -np.outer(b, sigma)
    speed_rates = rolls @ b_rate
    S_rate = sides @ turned_rate - spins * (rolls @ turned) - speed_rates[:, None] * S
    S_rate /= speeds[:, None]
    m = free.shape[1]
    shape, shape_rate = np.zeros((2, 3 + len(S), m))
    shape[:3, 0], shape[3:, 1:] = b, S
    shape_rate[:3, 0], shape_rate[3:, 1:] = b_rate, S_rate
    rates = np.concatenate([np.linalg.pinv(frame)[:1] @ twist, sigma])
    if strict:
        _require_given(shape @ rates, twist, steering)
    return IndependentRates(rates, shape, shape_rate, frame)


def _rows(base: RollingBase, angles: Array) -> tuple[Array, Array]:
    """Return the rows (s, 3) of steered wheels: how fast they slip sideways, and roll (m/s)."""
    wheels = base.steered_wheels
    directions = angles + np.array([wheel.heading for wheel in wheels])
    return side_rows(wheels, directions), drive_rows(wheels, directions)


def _speeds(base: RollingBase, rolls: Array, twist: Array) -> Array:
    """Return how fast steered wheels roll (m/s), which must not be 0."""
    speeds = np.asarray(rolls @ twist)
    for name, speed in zip(base.steered, speeds, strict=True):
        if abs(speed) <= _SAME * np.abs(twist).max():
            expected = "a centre of rotation away from its pivot"
            raise SingularPostureError(f"steering of {name}", float(speed), expected)
    return speeds


def _common_direction(rows: Array, angles: Array, strict: bool) -> Array:
    """Return the unit vector (M,) that rows (s, M) of steered wheels take nearest to zero."""
    M = rows.shape[1]
    _, values, axes = np.linalg.svd(np.concatenate([rows, np.zeros((M, M))]))
    if values[M - 2] <= _SAME:
        expected = "wheels whose axles are not all on one line"
        raise SingularPostureError("steering", angles.tolist(), expected)
    if strict and values[M - 1] > _SAME:
        expected = "angles (rad) at which the axles of all wheels meet, as steering_angles gives"
        raise InconsistentDataError("steering", angles.tolist(), expected)
    return np.asarray(axes[-1])


def _require_given(found: Array, twist: Array, steering: SteeringMotion) -> None:
    """Refuse a twist or rates of steering that differ from those (3 + s,) that wheels can give."""
    for what, near, given in (
        ("twist", found[:3], twist),
        ("rates of steering", found[3:], steering.rates),
    ):
        if np.abs(near - given).max() > _SAME * max(1.0, np.abs(given).max()):
            angles = np.asarray(steering.angles).tolist()
            expected = f"one that the wheels can give at {angles} rad, such as {near.tolist()}"
            raise BadValueError(what, given.tolist(), expected)
