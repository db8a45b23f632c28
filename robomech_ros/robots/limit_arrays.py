"""Limits of joints in the shapes in which callers write them."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from robomech_ros.errors import BadValueError, MissingLimitsError, NonFiniteError, WrongSizeError
from robomech_ros.errors.formatting import counted
from robomech_ros.robots.entry_checks import check_name
from robomech_ros.spatial.arrays import real_array
from robomech_ros.typing import Array, BoolArray

# Largest angle (rad) of a description, since doubles beyond it no longer hold a solution to 1e-9
# with room; limits of joints beyond it (rad or m) are what exporters write for none, as in 1e16.
LARGEST_ANGLE = 1e5


KEYS = ("lower", "upper", "velocity", "acceleration", "jerk", "effort")
_RATES = KEYS[2:]
_MISSING = {"lower": -np.inf, "upper": np.inf, **dict.fromkeys(_RATES, np.nan)}
_IS_NONE = np.frompyfunc(lambda entry: entry is None, 1, 1)
_FORMS = "pairs (lower, upper) of shape {shape}, or a mapping with keys among " + ", ".join(KEYS)


def limit_arrays(limits: Mapping[str, ArrayLike] | ArrayLike | None, n: int) -> dict[str, Any]:
    """Read limits of n joints, rad or m over powers of s, N m or N.

    - ``limits``: pairs of position limits, shape (n, 2), or a mapping of ``lower``, ``upper``,
      ``velocity``, ``acceleration``, ``jerk``, ``effort`` to arrays of shape (n,) or to one number
      for all joints. None, for all or for an entry, is no limit.
    - ``n``: number of joints.

    Returns an array (n,) for each key; where there is no limit infinite positions, NaN else.
    """
    if limits is None:
        limits = {}
    if not isinstance(limits, Mapping):
        limits = _from_pairs(limits, n)
    for key in limits:
        if key not in KEYS:
            raise BadValueError("key of limits", key, "one of " + ", ".join(KEYS))
    return {key: _row(key, limits.get(key), n) for key in KEYS}


def _from_pairs(limits: ArrayLike, n: int) -> dict[str, Array]:
    expected = _FORMS.format(shape=(n, 2))
    pairs = _with_missing("limits", limits, np.nan, expected)
    if pairs.shape != (n, 2):
        raise WrongSizeError("limits", pairs.shape, expected)
    given = np.array(limits, dtype=object)
    columns = [given[:, 0].tolist(), given[:, 1].tolist()]
    return {key: _row(key, column, n) for key, column in zip(KEYS, columns, strict=False)}


def _row(key: str, value: ArrayLike | None, n: int) -> Array:
    what = f"limits {key}"
    expected = f"a number for each joint, or one for all ({counted(n, 'joint')}); None is no limit"
    row = _with_missing(what, value, _MISSING[key], expected)
    if row.shape not in ((), (n,)):
        raise WrongSizeError(what, row.shape, f"({n},), or one number for all joints")
    return row * np.ones(n)


def _with_missing(what: str, value: Any, missing: float, expected: str) -> Array:
    """Return numbers as float64 with ``missing`` in the place of None."""
    try:
        entries = np.array(value, dtype=object)
    except (TypeError, ValueError):
        raise BadValueError(what, value, expected) from None
    none = np.asarray(_IS_NONE(entries), dtype=bool)
    try:
        return real_array(what, np.where(none, missing, entries).tolist())
    except BadValueError:
        raise BadValueError(what, value, expected) from None


def position_limits(lower: ArrayLike, upper: ArrayLike) -> tuple[Any, Any]:
    """Turn limits so far out that they stand for none into infinite ones (rad or m)."""
    lower, upper = np.asarray(lower, dtype=np.float64), np.asarray(upper, dtype=np.float64)
    return (
        np.where(lower <= -LARGEST_ANGLE, -np.inf, lower)[()],
        np.where(upper >= LARGEST_ANGLE, np.inf, upper)[()],
    )


def check_limits(joint_names: tuple[str, ...], limits: Mapping[str, Array]) -> None:
    """Refuse limits that no joint can keep.

    - ``joint_names``: n joints.
    - ``limits``: arrays (n,) by the six kinds of limits.
    """
    for key in ("lower", "upper"):
        if np.isnan(limits[key]).any():
            raise NonFiniteError(f"limits {key}", limits[key])
    lower, upper = limits["lower"], limits["upper"]
    bad = (lower > upper) | (lower >= LARGEST_ANGLE) | (upper <= -LARGEST_ANGLE)
    for k in np.flatnonzero(bad):
        pair = (float(lower[k]), float(upper[k]))
        expected = f"lower <= upper, and positions between -{LARGEST_ANGLE:g} and {LARGEST_ANGLE:g}"
        raise BadValueError(f"position limits of joint '{joint_names[k]}'", pair, expected)
    for key in _RATES:
        for k in np.flatnonzero(limits[key] <= 0.0):
            what = f"{key} limit of joint '{joint_names[k]}'"
            raise BadValueError(what, float(limits[key][k]), "a positive number, or none (NaN)")


def require_limits(
    kind: str, joint_names: Sequence[str], limits: Mapping[str, Array], continuous: BoolArray
) -> None:
    """Raise MissingLimitsError where a joint lacks a limit; see :meth:`SerialChain.require_limits`.

    Of positions, joints that are ``continuous``, shape (n,), lack nothing.
    """
    check_name("kind of limit", kind)
    if kind == "position":
        both = np.isfinite(limits["lower"]) & np.isfinite(limits["upper"])
        missing = ~both & ~continuous
    elif kind in _RATES:
        missing = ~np.isfinite(limits[kind])
    else:
        expected = "position, velocity, acceleration, jerk or effort"
        raise BadValueError("kind of limit", kind, expected)
    if missing.any():
        names = [name for name, lacks in zip(joint_names, missing, strict=True) if lacks]
        raise MissingLimitsError(kind, names)
