"""Paths as joints over a path coordinate: their check, and their sections between corners."""

from itertools import pairwise

import numpy as np

from robomech_ros.errors import BadValueError
from robomech_ros.spatial.arrays import check_kind
from robomech_ros.trajectory.curves.bounds import hull
from robomech_ros.trajectory.curves.checked_pieces import checked_pieces
from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial
from robomech_ros.trajectory.tolerances import PATH_STANDSTILL, PATH_STEP
from robomech_ros.typing import Array

_LARGEST_ORDER = 5
_MOST_PIECES = 100_000


def checked_path(path: PiecewisePolynomial) -> PiecewisePolynomial:
    """Check a path, and give it with plain arrays and without powers that nowhere occur."""
    expected = "a PiecewisePolynomial over the path coordinate"
    check_kind("path", path, PiecewisePolynomial, expected)
    curve = checked_pieces(path, "path", _LARGEST_ORDER)
    coefficients, pieces = curve.coefficients, curve.coefficients.shape[1]
    if pieces > _MOST_PIECES:
        raise BadValueError("number of pieces of the path", pieces, f"at most {_MOST_PIECES}")
    check_no_step(curve, 0, "the path", "no step: 0")
    used = np.flatnonzero(coefficients.any(axis=(1, 2)))
    order = int(used[-1]) if len(used) else 0
    kept = np.ascontiguousarray(coefficients[: max(order, 1) + 1])
    return PiecewisePolynomial(curve.breaks, kept)


def sections(curve: PiecewisePolynomial) -> list[PiecewisePolynomial]:
    """Divide a path at its corners, and leave out the parts where no joint moves."""
    moves = _moves(curve)
    corners = jump(curve, 1) | (moves[1:] != moves[:-1])
    ends = [0, *(np.flatnonzero(corners) + 1).tolist(), len(moves)]
    return [curve.between(first, last) for first, last in pairwise(ends) if moves[first]]


def jump(curve: PiecewisePolynomial, order: int) -> np.ndarray:
    """Find at which inner breaks a derivative steps by more than rounding, shape (s - 1,)."""
    coefficients = hull(curve, order)
    step = np.abs(coefficients[-1, :-1] - coefficients[0, 1:])
    size = np.abs(coefficients).max(axis=(0, 1))
    # Effect of the rounding of positions on a derivative over the shorter of both pieces.
    shorter = np.minimum(curve.spans[1:], curve.spans[:-1])[:, None]
    rounding = np.finfo(np.float64).eps * np.abs(curve.coefficients[0]).max(axis=0)
    allowed = PATH_STEP * size + 100.0 * rounding / shorter**order
    return (step > allowed).any(axis=1)


def _moves(curve: PiecewisePolynomial) -> np.ndarray:
    """Find in which pieces joints move by more than rounding, shape (s,)."""
    if len(curve.breaks) < 2:
        return np.zeros(1, bool)
    way = np.abs(hull(curve, 1)).max(axis=0) * curve.spans[:, None]
    rounding: Array = np.finfo(np.float64).eps * np.abs(curve.coefficients[0]).max(axis=0)
    return (way > np.maximum(rounding, PATH_STANDSTILL)).any(axis=1)


def check_no_step(curve: PiecewisePolynomial, order: int, what: str, expected: str) -> None:
    """Refuse a path of which a derivative, or itself, steps between two pieces."""
    stepping = jump(curve, order)
    if stepping.any():
        k, ends = int(np.argmax(stepping)) + 1, hull(curve, order)
        step = float(np.abs(ends[-1, k - 1] - ends[0, k]).max())
        where = float(curve.breaks[k])
        raise BadValueError(f"step of {what} at its coordinate {where:.9g}", step, expected)
