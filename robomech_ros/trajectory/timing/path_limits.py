"""Limits along a path besides those of the joints: speeds of the tip, torques, and their like."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.spatial.arrays import (
    as_finite,
    check_finite,
    of_shape,
    real_array,
    real_number,
    shaped_array,
)
from robomech_ros.trajectory.limits import SMALLEST_LIMIT
from robomech_ros.typing import Array, ArrayLike

# A cell is sampled at these five places; the ends a little inside it, because the coefficients of
# a path may step where two of its pieces meet.
_INSIDE = 1e-9
_PLACES = np.array([_INSIDE, 0.25, 0.5, 0.75, 1.0 - _INSIDE])
# From the samples to the powers of the quartic through them.
_QUARTIC = np.linalg.inv(np.vander(np.linspace(0.0, 1.0, 5), increasing=True))


@dataclass(frozen=True, eq=False)
class PathFunction:
    """A function of the path coordinate, linear between places (m,) that do not decrease."""

    places: Array
    values: Array

    def __call__(self, s: Array) -> Array:
        """Return the values at path coordinates, of their shape."""
        return np.interp(s, self.places, self.values)


@dataclass(frozen=True, eq=False)
class SpeedLimit:
    """A speed that is proportional to the speed along the path, and its limit.

    For the tip of a robot on its way p(s), ``rate`` is ``|p'(s)|``; for the angular speed of the
    tip it is the magnitude of the angular velocity divided by that of s.

    Attributes
    ----------
    rate : callable or (array_like, array_like)
        Of path coordinates of shape (m,), the rates there, shape (m,): speed over the rate of
        the path coordinate.  Or two arrays of shape (m,), increasing path coordinates and the
        rates there; linear in between.
    limit : float
        Largest speed, m/s or rad/s.
    """

    rate: Any
    limit: float

    def __post_init__(self) -> None:
        expected = f"a number above 0, at least {SMALLEST_LIMIT:g}"
        limit = real_number("speed limit", self.limit, expected)
        if not limit >= SMALLEST_LIMIT:
            raise BadValueError("speed limit", limit, expected)
        object.__setattr__(self, "limit", limit)
        if not _is_function(self.rate):
            what, expected = "rate of a speed limit", "a pair of arrays: path coordinates and rates"
            where, (rates,) = _tables(what, self.rate, expected, [what], ())
            object.__setattr__(self, "rate", PathFunction(where, rates))

    def powers(self, nodes: Array) -> Array:
        """Return the rate over the limit in every cell, in powers of sigma, shape (m, 5)."""
        given = self.rate(_places(nodes))
        values = _checked("rate of a speed limit", given, (len(nodes) - 1, 5))
        return _in_powers(values / self.limit)


@dataclass(frozen=True, eq=False)
class TorqueLimits:
    r"""Limits of quantities that are linear in the acceleration along the path.

    .. math:: l_i \le a_i(s) \ddot s + b_i(s) \dot s^2 + c_i(s) \le u_i

    With the mass matrix M, Coriolis and centrifugal matrix C and gravity torques g of a robot on
    the path q(s), its joint torques have a = M q', b = M q'' + C(q, q') q' and c = g.

    Attributes
    ----------
    coefficients : callable or (array_like, array_like, array_like, array_like)
        Of path coordinates of shape (m,), a tuple of a, b and c there, each of shape (m, l).  Or
        four arrays: increasing path coordinates, shape (m,), and a, b and c there; linear in
        between.
    lower, upper : ndarray, shape (l,)
        The limits, N m or N.
    """

    coefficients: Any
    lower: Array
    upper: Array

    def __post_init__(self) -> None:
        lower = np.atleast_1d(real_array("lower torque limits", self.lower))
        upper = np.atleast_1d(real_array("upper torque limits", self.upper))
        if lower.ndim != 1 or lower.shape != upper.shape:
            raise WrongSizeError("upper torque limits", upper.shape, lower.shape)
        check_finite("lower torque limits", lower)
        check_finite("upper torque limits", upper)
        if not (lower < upper).all():
            k = int(np.argmin(upper - lower))
            expected = f"less than the upper one, {float(upper[k])!r}"
            raise BadValueError(f"lower torque limit [{k}]", float(lower[k]), expected)
        object.__setattr__(self, "lower", lower)
        object.__setattr__(self, "upper", upper)
        if not _is_function(self.coefficients):
            columns = _interpolated_columns(self.coefficients, len(lower))
            object.__setattr__(self, "coefficients", columns)

    @property
    def count(self) -> int:
        """Number of quantities."""
        return len(self.lower)

    def powers(self, nodes: Array) -> tuple[Array, Array, Array]:
        """Return a, b and c in every cell, scaled to limits of -1 and 1, each (m, l, 5)."""
        given = self.coefficients(_places(nodes))
        if not isinstance(given, tuple | list) or len(given) != 3:
            raise BadValueError("coefficients of torque limits", given, "a tuple of a, b and c")
        half, middle = 0.5 * (self.upper - self.lower), 0.5 * (self.upper + self.lower)
        shape = (len(nodes) - 1, 5, self.count)
        a, b, c = (
            _checked(f"{name} of torque limits", values, shape)
            for name, values in zip("abc", given, strict=True)
        )
        scaled = (a / half, b / half, (c - middle) / half)
        powers = tuple(_in_powers(np.moveaxis(values, 1, 2)) for values in scaled)
        return powers[0], powers[1], powers[2]


def largest_parts(speeds: Sequence[SpeedLimit], places: Array, rates: Array | float) -> Array:
    """Return the largest parts of limits that rates of the path coordinate take, shape (m,)."""
    parts = [np.zeros(len(places)), *(np.asarray(one.rate(places)) / one.limit for one in speeds)]
    return np.max(parts, axis=0) * rates


def checked_list(what: str, given: object, kind: type) -> list[Any]:
    """Return one limit or a sequence of them as a list."""
    if isinstance(given, kind):
        return [given]
    if not isinstance(given, Sequence) or not all(isinstance(one, kind) for one in given):
        raise BadValueError(what, given, f"a {kind.__name__} or a list of them")
    return list(given)


def _is_function(given: object) -> bool:
    return callable(given) and not isinstance(given, type)


def _places(nodes: Array) -> Array:
    """List the five sampled path coordinates of every cell, one cell after the other."""
    return (nodes[:-1, None] + np.diff(nodes)[:, None] * _PLACES).ravel()


def _checked(what: str, given: ArrayLike, shape: tuple[int, ...]) -> Array:
    return shaped_array(what, given, (shape[0] * shape[1], *shape[2:])).reshape(shape)


def _in_powers(values: Array) -> Array:
    """Turn five samples (..., 5) into the powers of the quartic through them."""
    return np.ascontiguousarray(values @ _QUARTIC.T)


def _tables(
    what: str, given: object, expected: str, names: Sequence[str], tail: tuple[int, ...]
) -> tuple[Array, list[Array]]:
    """Check path coordinates (m,), and named tables (m, *tail) of values there."""
    if not isinstance(given, tuple | list) or len(given) != len(names) + 1:
        raise BadValueError(what, given, f"a callable, or {expected}")
    where = as_finite(f"path coordinates of the {what}", given[0], ())
    if where.ndim != 1 or len(where) < 2 or not (np.diff(where) > 0.0).all():
        expected = "at least two increasing path coordinates"
        raise BadValueError(f"path coordinates of the {what}", where.tolist(), expected)
    tables = []
    for name, values in zip(names, given[1:], strict=True):
        tables.append(as_finite(name, values, ()))
        of_shape(name, tables[-1], (len(where), *tail))
    return where, tables


def _interpolated_columns(given: object, count: int) -> Callable[[Array], tuple[Array, ...]]:
    what, expected = "coefficients of torque limits", "four arrays: path coordinates, a, b and c"
    names = [f"{name} of torque limits" for name in "abc"]
    where, tables = _tables(what, given, expected, names, (count,))
    return lambda s: tuple(
        np.stack([np.interp(s, where, column) for column in table.T], axis=1) for table in tables
    )
