"""Rotations from each representation to each other, many in one compiled loop."""

from __future__ import annotations

from itertools import permutations
from typing import NoReturn

import numpy as np

from robomech_ros._kernels.compiling.jit import direct
from robomech_ros._kernels.spatial import conversions, representations as kinds
from robomech_ros._kernels.spatial.conversions import STATUSES
from robomech_ros._kernels.spatial.rates import SINGULAR
from robomech_ros._kernels.spatial.tolerances import UNIT_NORM
from robomech_ros.errors import BadValueError
from robomech_ros.spatial.arrays import as_finite
from robomech_ros.spatial.matrices import as_rotation
from robomech_ros.spatial.rotations.unit_quaternions import unit_quaternion
from robomech_ros.spatial.rows import as_rows, common_shape, row_name
from robomech_ros.typing import Array, ArrayLike

_convert = direct(conversions.convert)

_LETTERS = "xyz"
_ORDERS = tuple("".join(three) for three in permutations(_LETTERS, 3)) + tuple(
    a + b + a for a, b in permutations(_LETTERS, 2)
)
# Euler angles: capitals for moving axes, small letters for fixed ones.
SEQUENCES = tuple(order.upper() for order in _ORDERS) + _ORDERS
_NAMES: dict[str, int] = {
    "matrix": kinds.MATRIX,
    "quaternion": kinds.QUATERNION,
    "axis-angle": kinds.AXIS_ANGLE,
    "rotation-vector": kinds.ROTATION_VECTOR,
    "rodrigues-vector": kinds.RODRIGUES_VECTOR,
    "linear-invariants": kinds.LINEAR_INVARIANTS,
} | {
    name: kinds.EULER
    + sum(_LETTERS.index(letter) * 3**i for i, letter in enumerate(name.lower()))
    + (27 if name.islower() else 0)
    for name in SEQUENCES
}
# Representations of a rotation: six by name, and Euler angles by their sequence.
REPRESENTATIONS = tuple(_NAMES)
_FOUR = (kinds.QUATERNION, kinds.AXIS_ANGLE, kinds.LINEAR_INVARIANTS)


def tail_of(kind: int) -> tuple[int, ...]:
    """Return the shape of one rotation of a kind."""
    if kind == kinds.MATRIX:
        return (3, 3)
    return (4,) if kind in _FOUR else (3,)


def kind_of(what: str, name: object) -> int:
    """Look up what kernels call a representation."""
    if isinstance(name, str) and name in _NAMES:
        return _NAMES[name]
    known = [one for one in REPRESENTATIONS if one not in SEQUENCES]
    raise BadValueError(
        what, name, f"one of {', '.join(known)}, or Euler angles: {', '.join(SEQUENCES)}"
    )


def sequence_kind(sequence: object) -> int:
    """Look up what kernels call Euler angles of a sequence."""
    if isinstance(sequence, str) and sequence in SEQUENCES:
        return _NAMES[sequence]
    raise BadValueError(
        "sequence", sequence, f"one of {', '.join(SEQUENCES)} (capitals: moving axes)"
    )


def convert_rotation(value: ArrayLike, source: str, target: str) -> Array:
    """Convert rotations from any representation to any other.

    All meet in the unit quaternion, at which no digit is lost: neither near the identity nor near
    half turns.

    ===================== ============= ==========================================================
    representation        shape         numbers
    ===================== ============= ==========================================================
    ``matrix``            (..., 3, 3)   proper orthogonal Q
    ``quaternion``        (..., 4)      Euler-Rodrigues parameters r = e sin(phi/2), r0 = cos(phi/2)
    ``axis-angle``        (..., 4)      natural invariants e, phi
    ``rotation-vector``   (..., 3)      e phi
    ``rodrigues-vector``  (..., 3)      e tan(phi/2); none for half turns
    ``linear-invariants`` (..., 4)      q = e sin(phi), q0 = cos(phi); no rotation from a half turn
    ``ZYX`` and the like  (..., 3)      Euler angles, one of :data:`SEQUENCES`
    ===================== ============= ==========================================================

    Parameters
    ----------
    value : array_like
        Rotations, of the shape in the table, angles in rad.
    source, target : str
        Names of the table.

    Returns
    -------
    ndarray
        Of the shape in the table; angles phi in [0, pi], quaternions with r0 >= 0.

    Raises
    ------
    BadQuaternionError, BadValueError, WrongSizeError
        The numbers stand for no rotation, or the target has none for it.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 2.3 and app. A.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.spatial import convert_rotation
    >>> np.round(convert_rotation([0.0, 0.0, np.pi / 2.0], "rotation-vector", "ZYX"), 4)
    array([1.5708, 0.    , 0.    ])
    """
    given = kind_of("source", source)
    return converted(source.replace("-", " "), value, given, kind_of("target", target))


def rotation_rows(what: str, value: ArrayLike, kind: int) -> tuple[Array, tuple[int, ...]]:
    """Return rotations of a kind as rows and their batch shape."""
    tail = tail_of(kind)
    return as_rows(what, value, tail, 9 if kind == kinds.MATRIX else tail[0])


def represented(value: ArrayLike, name: str) -> tuple[str, int, Array, tuple[int, ...]]:
    """Return what messages call a representation, its kind, rows of a value, and their batch."""
    kind, what = kind_of("representation", name), name.replace("-", " ")
    return what, kind, *rotation_rows(what, value, kind)


def converted(what: str, value: ArrayLike, source: int, target: int) -> Array:
    """Convert rotations from one kind to another, or raise what is wrong with them."""
    rows, shape = rotation_rows(what, value, source)
    tail = tail_of(target)
    out = np.empty((len(rows), 9 if target == kinds.MATRIX else tail[0]))
    status = _convert(source, target, rows, out)
    if status:
        raise_bad_rotation(what, rows, shape, source, status)
    return out.reshape(shape + tail)


def converted_axis_angle(axis: ArrayLike, angle: ArrayLike, target: int) -> Array:
    """Convert axes (..., 3) and angles (...) to another kind."""
    e, phi = as_finite("axis", axis, (3,)), as_finite("angle", angle, ())
    rows = np.empty((*common_shape("axis and angle", e.shape[:-1], phi.shape), 4))
    rows[..., :3], rows[..., 3] = e, phi
    return converted("axis and angle", rows, kinds.AXIS_ANGLE, target)


def raise_bad_rotation(
    what: str, rows: Array, shape: tuple[int, ...], kind: int, status: int
) -> NoReturn:
    """Say what a compiled loop found wrong with a row of rotations."""
    row, fault = divmod(int(status), STATUSES)
    given = rows.reshape(shape + tail_of(kind))
    index, where = row_name(row, shape) if row < len(rows) else ((), "")
    value = given[index].tolist()
    if fault == kinds.HALF_TURN:
        raise BadValueError(
            f"rotation of {what}{where}", value, "less than a half turn, which has no such numbers"
        )
    if fault == SINGULAR:
        raise BadValueError(
            f"{what}{where}", value, "a rotation at which the rates are defined, not a singular one"
        )
    as_finite(what, given, tail_of(kind))
    if kind == kinds.MATRIX:
        as_rotation(given, what=what)
    elif kind == kinds.QUATERNION:
        unit_quaternion(given)
    elif kind == kinds.AXIS_ANGLE and not any(value[:3]):
        raise BadValueError(f"axis{where}", value[:3], "a vector that is not zero")
    elif kind == kinds.LINEAR_INVARIANTS:
        raise BadValueError(f"{what}{where}", value, f"norm 1 within {UNIT_NORM:g}")
    raise BadValueError(f"{what}{where}", value, "numbers that do not overflow")
