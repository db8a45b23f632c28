"""Splines through points in space."""

from __future__ import annotations

from typing import cast, get_args

import numpy as np

from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.spatial.arrays import as_choice, real_number, shaped_array
from robomech_ros.trajectory.curves.cubic_spline import cubic_spline
from robomech_ros.trajectory.curves.quintic_spline import Ends, quintic_spline
from robomech_ros.trajectory.paths.curve import PolynomialCurve
from robomech_ros.trajectory.paths.curve_arguments import as_breaks, as_points
from robomech_ros.trajectory.tolerances import COINCIDENT
from robomech_ros.typing import Array, ArrayLike

# Fewest points by degree and ends; of a closed curve the first point counts twice.
_FEWEST = {
    (3, "natural"): 2,
    (3, "clamped"): 2,
    (3, "periodic"): 4,
    (5, "natural"): 3,
    (5, "clamped"): 2,
    (5, "periodic"): 4,
}
# Power of the distance between neighbours that makes the distance of their knots.
_KNOTS = {"chord": 1.0, "centripetal": 0.5}


def spline_curve(
    points: ArrayLike,
    *,
    degree: int = 3,
    ends: Ends = "natural",
    knots: str | ArrayLike = "chord",
    end_rates: ArrayLike | None = None,
) -> PolynomialCurve:
    """Put a smooth curve through points.

    Parameters
    ----------
    points : array_like, shape (n, 3)
        In the order in which they are passed (m).  Of a closed curve the last equals the first.
    degree : int, optional
        3, with two continuous derivatives, or 5, with four.
    ends : str, optional
        ``natural``: of degree 3 no curvature at the ends (second derivative 0), of degree 5 third
        and fourth derivatives 0; ``clamped``: `end_rates`; ``periodic``: closed, and as smooth
        where it closes as elsewhere.
    knots : str or array_like, shape (n,), optional
        Parameters of the points, strictly increasing, or how to choose them: ``chord``, by the
        distances of the points (m), or ``centripetal``, by their square roots, which cuts sharp
        corners tighter.
    end_rates : array_like, shape (2, 3) or (2, 2, 3), optional
        Of clamped ends: first derivatives with respect to the parameter at the first and the last
        point; of degree 5 first and second derivatives at the first and at the last point.

    Raises
    ------
    BadValueError, WrongSizeError
        Points, knots or rates that are invalid or too few, neighbours that coincide, a curve that
        should close and does not, or an unknown degree or kind of ends.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., sections 6.6 and 11.4.
    """
    kind = as_ends(ends)
    order = real_number("degree", degree, "3 or 5")
    if order not in (3.0, 5.0):
        raise BadValueError("degree", degree, "3 or 5")
    places = as_points("points", points, _FEWEST[int(order), kind]).copy()
    if kind == "periodic":
        close(places)
    parameters = _knots(knots, places)
    rates = checked_end_rates(end_rates, kind, (2, 3) if order == 3.0 else (2, 2, 3))
    if order == 3.0:
        return PolynomialCurve(cubic_spline(parameters, places, kind, rates))
    return PolynomialCurve(quintic_spline(parameters, places, kind, rates))


def as_ends(value: object) -> Ends:
    """Check a kind of ends, or raise BadValueError with those there are."""
    return cast("Ends", as_choice("ends", value, get_args(Ends)))


def close(points: Array) -> None:
    """Put the last point on the first, where it is up to rounding, or raise BadValueError."""
    gap = float(np.linalg.norm(points[-1] - points[0]))
    if gap > COINCIDENT * max(1.0, float(np.abs(points).max())):
        what = f"points[{len(points) - 1}]"
        raise BadValueError(what, points[-1].tolist(), f"points[0], {points[0].tolist()}")
    points[-1] = points[0]


def _knots(given: str | ArrayLike, points: Array) -> Array:
    if isinstance(given, str):
        if given not in _KNOTS:
            raise BadValueError("knots", given, "numbers, or one of " + ", ".join(_KNOTS))
        apart = np.linalg.norm(np.diff(points, axis=0), axis=1) ** _KNOTS[given]
        return np.concatenate([[0.0], np.cumsum(apart)])
    knots = as_breaks("knots", given)
    if len(knots) != len(points):
        raise WrongSizeError("knots", len(knots), len(points))
    return knots


def checked_end_rates(
    given: ArrayLike | None,
    ends: Ends,
    shape: tuple[int, ...],
    expected: str = "derivatives at the ends, since they are clamped",
) -> Array | None:
    """Check rates at both ends, which clamped ends have and no others."""
    if ends != "clamped":
        if given is not None:
            raise BadValueError("end_rates", given, f"none, since the ends are {ends}")
        return None
    if given is None:
        raise BadValueError("end_rates", None, expected)
    return shaped_array("end_rates", given, shape)
