"""Polylines with blended corners."""

import math
from typing import Literal, get_args

import numpy as np
import numpy.typing as npt

from robomech_ros._kernels.tolerances import COINCIDENT, COLLINEAR, NEARLY_HALF_TURN
from robomech_ros.errors import BadValueError
from robomech_ros.trajectory.paths.closed_form import arc_about, line
from robomech_ros.trajectory.paths.curve import (
    Curve,
    JoinedCurve,
    PolynomialCurve,
    as_points,
    as_positive,
    join_curves,
)
from robomech_ros.trajectory.piecewise import PiecewisePolynomial
from robomech_ros.trajectory.sample import FloatArray

__all__ = ["Blend", "blended_polyline"]

Blend = Literal["circular", "parabolic", "quintic"]

# Where the inner control points of a quintic blend divide the way from its ends to the corner;
# with 3/8 and 6/8 the curvature rises to one peak, in the middle, at every angle.
_SPREAD = 0.375


def blended_polyline(
    points: npt.ArrayLike,
    *,
    radius: float | None = None,
    deviation: float | None = None,
    blend: Blend = "circular",
) -> JoinedCurve:
    """Go straight from point to point and round the corners off.

    Parameters
    ----------
    points : array_like, shape (n, 3)
        Ends and corners (m).
    radius : float, optional
        Least radius of curvature of every blend (m).
    deviation : float, optional
        How far every blend passes from its corner (m); exactly one of the two is given.
    blend : str, optional
        ``circular``: an arc; ``parabolic``: a parabola.  Of both the direction is continuous, the
        curvature steps at their ends.  ``quintic``: direction and curvature are continuous, which
        makes the curve C2 in its arc length.

    Returns
    -------
    JoinedCurve
        A blend takes at most half of each leg at its corner; there it is smaller than asked for.

    Raises
    ------
    BadValueError, WrongSizeError, NonFiniteError
        Not points, neighbours that coincide, a corner at which the way goes straight back, or
        not exactly one of radius and deviation, above 0.
    """
    if not isinstance(blend, str) or blend not in get_args(Blend):
        raise BadValueError("blend", blend, "one of " + ", ".join(get_args(Blend)))
    if (radius is None) == (deviation is None):
        raise BadValueError("radius, deviation", (radius, deviation), "exactly one of the two")
    size = as_positive("radius", radius) if deviation is None else None
    apart = as_positive("deviation", deviation) if radius is None else None
    places = as_points("points", points, 2)
    legs = np.diff(places, axis=0)
    lengths = np.linalg.norm(legs, axis=1)
    directions = legs / lengths[:, None]
    curves: list[Curve] = []
    begin = places[0]
    for k in range(1, len(places) - 1):
        turn = _turn(k, directions[k - 1], directions[k])
        if turn < COLLINEAR:
            continue
        cut = _cut(blend, 0.5 * turn, size, apart)
        cut = min(cut, 0.5 * lengths[k - 1], 0.5 * lengths[k])
        if cut <= COINCIDENT * max(lengths[k - 1], lengths[k]):
            what = f"length (m) of the blend at points[{k}]"
            raise BadValueError(what, float(cut), "more than a billionth of its legs")
        enter, leave = places[k] - cut * directions[k - 1], places[k] + cut * directions[k]
        if np.linalg.norm(enter - begin) > COLLINEAR * lengths[k - 1]:
            curves.append(line(begin, enter))
        curves.append(_corner(blend, enter, places[k], leave, turn))
        begin = leave
    if np.linalg.norm(places[-1] - begin) > COLLINEAR * lengths[-1]:
        curves.append(line(begin, places[-1]))
    return join_curves(curves)


def _turn(k: int, before: FloatArray, after: FloatArray) -> float:
    """Angle between two legs (rad); refuse a way back."""
    turn = math.atan2(float(np.linalg.norm(np.cross(before, after))), float(before @ after))
    if turn > math.pi - NEARLY_HALF_TURN:
        expected = "less than pi: a way straight back cannot be blended"
        raise BadValueError(f"angle (rad) between the legs at points[{k}]", turn, expected)
    return turn


def _cut(blend: Blend, half: float, radius: float | None, deviation: float | None) -> float:
    """How much of both legs (m) a blend takes at a corner that turns by 2 half (rad)."""
    sine, cosine = math.sin(half), math.cos(half)
    if blend == "circular":
        reach = sine / cosine if radius is not None else sine / (1.0 - cosine)
    elif blend == "parabolic":
        reach = sine / cosine**2 if radius is not None else 2.0 / sine
    elif radius is not None:
        reach = 38.4 * _SPREAD / (6.0 - 7.0 * _SPREAD) ** 2 * sine / cosine**2
    else:
        reach = 16.0 / (16.0 - 25.0 * _SPREAD) / sine
    return reach * (radius if radius is not None else deviation or 0.0)


def _corner(
    blend: Blend, enter: FloatArray, corner: FloatArray, leave: FloatArray, turn: float
) -> Curve:
    before, after = corner - enter, leave - corner
    if blend == "circular":
        axis = np.cross(before, after)
        inward = np.cross(axis, before)
        radius = np.linalg.norm(before) / math.tan(0.5 * turn)
        return arc_about(enter + radius * inward / np.linalg.norm(inward), axis, enter, turn)
    if blend == "parabolic":
        return _bezier(np.stack([enter, corner, leave]))
    parts = np.array([0.0, _SPREAD, 2.0 * _SPREAD])[:, None]
    return _bezier(np.concatenate([enter + parts * before, leave - parts[::-1] * after]))


def _bezier(control: FloatArray) -> PolynomialCurve:
    """Polynomial with control points (d + 1, 3), on a range as long as their polygon."""
    degree = len(control) - 1
    span = float(np.linalg.norm(np.diff(control, axis=0), axis=1).sum())
    powers, differences = np.empty((degree + 1, 1, 3)), control
    for i in range(degree + 1):
        powers[i, 0] = math.comb(degree, i) * differences[0] / span**i
        differences = np.diff(differences, axis=0)
    return PolynomialCurve(PiecewisePolynomial(np.array([0.0, span]), powers))
