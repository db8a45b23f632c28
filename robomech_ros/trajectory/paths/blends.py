"""Polylines with blended corners."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from robomech_ros.errors import BadValueError
from robomech_ros.spatial.arrays import as_choice
from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial
from robomech_ros.trajectory.paths.curve import PolynomialCurve
from robomech_ros.trajectory.paths.curve_arguments import as_points, as_positive
from robomech_ros.trajectory.tolerances import COINCIDENT, COLLINEAR, NEARLY_HALF_TURN
from robomech_ros.typing import Array, ArrayLike, BoolArray

Blend = Literal["circular", "parabolic", "quintic"]

# Where the inner control points of a quintic blend divide the way from its ends to the corner;
# with 3/8 and 6/8 the curvature rises to one peak, in the middle, at every angle.
_SPREAD = 0.375


@dataclass(frozen=True, eq=False)
class BlendedPolyline(PolynomialCurve):
    """Straight legs and blends, one after another; all of them are evaluated together.

    The parameter runs on from each to the next: on straight legs by their length (m), on arcs by
    the angle (rad), on other blends by the length of their control polygon (m). The pieces have the
    three coordinates (m), on an arc its centre; the radii (2, s, 3) are what an arc adds times the
    cosine and the sine of its angle (m), 0 on other pieces.
    """

    radii: Array

    def _rows(self, u: Array) -> Array:
        rows = super()._rows(u)
        last = len(self.breaks) - 2
        piece = np.minimum(np.searchsorted(self.breaks, u, side="right") - 1, last)
        angle = (u - self.breaks[piece])[:, None]
        cosine, sine = self.radii[:, piece]
        out = np.cos(angle) * cosine + np.sin(angle) * sine
        along = np.cos(angle) * sine - np.sin(angle) * cosine
        rows += np.stack([out, along, -out, -along, out])
        return rows


def blended_polyline(
    points: ArrayLike,
    *,
    radius: float | None = None,
    deviation: float | None = None,
    blend: Blend = "circular",
) -> BlendedPolyline:
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
    BlendedPolyline
        A blend takes at most half of each leg at its corner; there it is smaller than asked for.

    Raises
    ------
    BadValueError
        Not points, neighbours that coincide, a corner at which the way goes straight back, or not
        exactly one of radius and deviation, above 0.
    """
    as_choice("blend", blend, get_args(Blend))
    if (radius is None) == (deviation is None):
        raise BadValueError("radius, deviation", (radius, deviation), "exactly one of the two")
    size = as_positive("radius", radius) if deviation is None else None
    apart = as_positive("deviation", deviation) if radius is None else None
    places = as_points("points", points, 2)
    legs = np.diff(places, axis=0)
    lengths = np.linalg.norm(legs, axis=1)
    directions = legs / lengths[:, None]
    turns = _turns(directions)
    corners = np.flatnonzero(turns >= COLLINEAR) + 1
    turns = turns[corners - 1]
    cuts = _cuts(blend, 0.5 * turns, size, apart)
    cuts = np.minimum(cuts, 0.5 * np.minimum(lengths[corners - 1], lengths[corners]))
    short = cuts <= COINCIDENT * np.maximum(lengths[corners - 1], lengths[corners])
    if short.any():
        k = int(np.argmax(short))
        what = f"length (m) of the blend at points[{corners[k]}]"
        raise BadValueError(what, float(cuts[k]), "more than a billionth of its legs")
    before, after = (cuts[:, None] * directions[corners - k] for k in (1, 0))
    blends = _Blends(places[corners], before, after, turns)
    begins = np.concatenate([places[:1], blends.corners + after])
    ends = np.concatenate([blends.corners - before, places[-1:]])
    ways = np.linalg.norm(ends - begins, axis=1)
    kept = ways > COLLINEAR * lengths[np.append(corners - 1, -1)]
    rates = (ends - begins) / np.where(ways > 0.0, ways, 1.0)[:, None]
    straight = ways, np.stack([begins, rates])
    bent, radii = _arcs(blends) if blend == "circular" else _polynomials(blend, blends)
    return _alternating(straight, kept, bent, radii)


@dataclass(frozen=True, eq=False)
class _Blends:
    """Blends at c corners (c, 3), m, with the ways to them and from them, (c, 3), m.

    The ways go from the beginnings of the blends, and to their ends. The turns (c,) are the angles
    between them (rad).
    """

    corners: Array
    before: Array
    after: Array
    turns: Array


# Lengths (k,) of pieces in their parameter, and powers (d + 1, k, 3) of the parameter in them.
_Pieces = tuple[Array, Array]


def _turns(directions: Array) -> Array:
    """Angles between legs (rad), shape (n - 2,); refuse a way back."""
    before, after = directions[:-1], directions[1:]
    sines = np.linalg.norm(np.cross(before, after), axis=1)
    turns: Array = np.arctan2(sines, np.sum(before * after, axis=1))
    back = np.flatnonzero(turns > math.pi - NEARLY_HALF_TURN)
    if len(back):
        k = int(back[0])
        expected = "less than pi: a way straight back cannot be blended"
        what = f"angle (rad) between the legs at points[{k + 1}]"
        raise BadValueError(what, float(turns[k]), expected)
    return turns


def _cuts(blend: Blend, half: Array, radius: float | None, deviation: float | None) -> Array:
    """Return the lengths (c,) (m) that blends take of both legs at corners of 2 half (rad)."""
    sine, cosine = np.sin(half), np.cos(half)
    if blend == "circular":
        reach = sine / cosine if radius is not None else sine / (1.0 - cosine)
    elif blend == "parabolic":
        reach = sine / cosine**2 if radius is not None else 2.0 / sine
    elif radius is not None:
        reach = 38.4 * _SPREAD / (6.0 - 7.0 * _SPREAD) ** 2 * sine / cosine**2
    else:
        reach = 16.0 / (16.0 - 25.0 * _SPREAD) / sine
    return reach * (radius if radius is not None else deviation or 0.0)


def _arcs(blends: _Blends) -> tuple[_Pieces, Array]:
    """Centres of arcs, over their angles, and their radii (2, c, 3): to the beginning, along."""
    axes = np.cross(blends.before, blends.after)
    inward = np.cross(axes, blends.before)
    inward /= np.linalg.norm(inward, axis=1)[:, None]
    cuts = np.linalg.norm(blends.before, axis=1)
    sizes = (cuts / np.tan(0.5 * blends.turns))[:, None]
    centres = blends.corners - blends.before + sizes * inward
    along = sizes * blends.before / cuts[:, None]
    return (blends.turns, centres[None]), np.stack([-sizes * inward, along])


def _polynomials(blend: Blend, blends: _Blends) -> tuple[_Pieces, Array]:
    """Parabolas or quintics over the lengths of their control polygons; no radii (2, c, 3)."""
    parts = [0.0, 1.0] if blend == "parabolic" else [0.0, _SPREAD, 2.0 * _SPREAD]
    enter, leave = blends.corners - blends.before, blends.corners + blends.after
    front = [enter + part * blends.before for part in parts]
    back = [leave - part * blends.after for part in reversed(parts)]
    control = np.stack([*front, *(back[1:] if blend == "parabolic" else back)])
    degree = len(control) - 1
    spans = np.linalg.norm(np.diff(control, axis=0), axis=2).sum(axis=0)
    powers, differences = np.empty_like(control), control
    for i in range(degree + 1):
        powers[i] = math.comb(degree, i) * differences[0] / spans[:, None] ** i
        differences = np.diff(differences, axis=0)
    return (spans, powers), np.zeros((2, len(spans), 3))


def _alternating(
    straight: _Pieces, kept: BoolArray, bent: _Pieces, radii: Array
) -> BlendedPolyline:
    """Put the first leg, the first blend, the second leg and so on; legs that are not kept not."""
    legs, blends = len(straight[0]), len(bent[0])
    size = max(len(straight[1]), len(bent[1]))
    spans = np.empty(legs + blends)
    coefficients, turning = np.zeros((size, legs + blends, 3)), np.zeros((2, legs + blends, 3))
    for first, (lengths, powers) in ((0, straight), (1, bent)):
        spans[first::2] = lengths
        coefficients[: len(powers), first::2] = powers
    turning[:, 1::2] = radii
    there = np.ones(legs + blends, bool)
    there[::2] = kept
    breaks = np.concatenate([[0.0], np.cumsum(spans[there])])
    pieces = PiecewisePolynomial(breaks, np.ascontiguousarray(coefficients[:, there]))
    return BlendedPolyline(pieces, turning[:, there])
