"""Orientations along a path: constant, by geodesics, and by the Frenet frame of the path."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np

from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.spatial.arrays import of_shape
from robomech_ros.spatial.matrices import as_rotation
from robomech_ros.spatial.rotations.axis_angle import (
    matrix_from_rotation_vector,
    rotation_vector_from_matrix,
)
from robomech_ros.spatial.rotations.rates import angular_motion
from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial
from robomech_ros.trajectory.paths.curve import Curve, as_curve
from robomech_ros.trajectory.paths.curve_arguments import as_breaks, as_parameters
from robomech_ros.trajectory.paths.frenet import frenet_serret
from robomech_ros.trajectory.tolerances import NEARLY_HALF_TURN
from robomech_ros.typing import Array, ArrayLike

# Turn (rad) of a moving frame within the least interval looked at that is a jump.
TURN_STEP = 1e-3

# Samples of the Frenet frame in each part between breaks.
_PLACES = 64


class OrientationSample(NamedTuple):
    """Orientation at m parameters, and how it changes with the parameter.

    Attributes
    ----------
    rotation : ndarray, shape (m, 3, 3)
        ``R_base_tool``.
    velocity : ndarray, shape (m, 3)
        Angular velocity omega in the base frame (rad per unit of the parameter).
    acceleration : ndarray, shape (m, 3)
        Its derivative.
    """

    rotation: Array
    velocity: Array
    acceleration: Array


class Orientation(Protocol):
    """An orientation as a function of a parameter, the same as that of a curve."""

    @property
    def breaks(self) -> Array:
        """Ends of the range and places where a derivative steps; empty if it has no ends."""

    def turning(self, u: Array) -> OrientationSample:
        """Orientation and its rates at parameters, shape (m,)."""


@dataclass(frozen=True, eq=False)
class PiecewiseRotation:
    """Orientations ``R_base_tool`` (n, 3, 3) at knots, and what is between them.

    In segment k the rotation vector (rad) from ``rotations[k]``, in its own axes, is a polynomial
    of the parameter.
    """

    rotations: Array
    vectors: PiecewisePolynomial

    @property
    def breaks(self) -> Array:
        """The knots, shape (n,)."""
        return self.vectors.breaks

    def turning(self, u: Array) -> OrientationSample:
        """Orientation and its rates at parameters, shape (m,)."""
        inside = as_parameters("parameter", u, float(self.breaks[0]), float(self.breaks[-1]))
        segment = np.searchsorted(self.breaks, inside, side="right") - 1
        base = self.rotations[np.minimum(segment, len(self.breaks) - 2)]
        theta, rate, second, _ = self.vectors.sample(inside)
        omega, alpha = angular_motion(theta, "rotation-vector", rate, second)
        rotation = base @ matrix_from_rotation_vector(theta)
        return OrientationSample(rotation, applied(base, omega), applied(base, alpha))


@dataclass(frozen=True, eq=False)
class ConstantOrientation:
    """The same orientation everywhere."""

    rotation: Array

    @property
    def breaks(self) -> Array:
        """None."""
        return np.empty(0)

    def turning(self, u: Array) -> OrientationSample:
        """Orientation, and rates of zero, at parameters, shape (m,)."""
        still = np.zeros((len(u), 3))
        return OrientationSample(np.broadcast_to(self.rotation, (len(u), 3, 3)), still, still)


@dataclass(frozen=True, eq=False)
class FrenetOrientation:
    """The Frenet frame of a curve, over its parameter, with a constant rotation after it.

    The offset (3, 3) is the tool in the frame [e_t e_n e_b].
    """

    curve: Curve
    offset: Array

    @property
    def breaks(self) -> Array:
        """Those of the curve."""
        return self.curve.breaks

    def turning(self, u: Array) -> OrientationSample:
        """Orientation and its rates at parameters, shape (m,).

        omega = s' delta and alpha = s'' delta + s'^2 delta', with the Darboux vector delta and the
        arc length s: the mixed terms of the frame's own rates cancel.
        """
        frenet = frenet_serret(self.curve, u)
        r = self.curve.derivatives(u)
        speed = frenet.speed[:, None]
        growth = np.sum(r[1] * r[2], axis=-1, keepdims=True) / speed
        alpha = growth * frenet.darboux + speed**2 * frenet.darboux_rate
        return OrientationSample(frenet.frame @ self.offset, speed * frenet.darboux, alpha)


def constant_orientation(rotation: ArrayLike) -> ConstantOrientation:
    """Keep an orientation.

    Parameters
    ----------
    rotation : array_like, shape (3, 3)
        ``R_base_tool``.
    """
    return ConstantOrientation(_one_rotation("rotation", rotation))


def geodesic_orientation(rotations: ArrayLike, knots: ArrayLike) -> PiecewiseRotation:
    r"""Turn from orientation to orientation about fixed axes (SLERP), in step with the parameter.

    .. math:: R(u) = R_k \exp \left( \sigma\, \mathrm{CPM}(v) \right), \qquad 0 \le \sigma \le 1

    with the rotation vector v of :math:`R_k^T R_{k+1}`.

    Parameters
    ----------
    rotations : array_like, shape (n, 3, 3)
        ``R_base_tool``, at least two.
    knots : array_like, shape (n,)
        Parameters at which they are reached; the angle grows in proportion between them.

    Raises
    ------
    BadValueError
        Not rotations or not knots, or neighbours opposite to each other: 180 degrees apart no axis
        is shorter than another.
    """
    given, parameters = as_rotations("rotations", rotations, knots)
    turns = turns_between("rotations", given)
    rates = turns / np.diff(parameters)[:, None]
    pieces = PiecewisePolynomial(parameters, np.stack([np.zeros_like(rates), rates]))
    return PiecewiseRotation(given, pieces)


def frenet_orientation(curve: Curve, offset: ArrayLike | None = None) -> FrenetOrientation:
    """Move a tool with the Frenet frame of a curve.

    Parameters
    ----------
    curve : Curve
        Curved enough that its normal is continuous; straight parts keep the normal from before.
    offset : array_like, shape (3, 3), optional
        ``R_frenet_tool``, the tool in the frame [e_t e_n e_b]; that frame itself if not given.

    Raises
    ------
    BadValueError
        No curve or no rotation, or the frame jumps: at an inflection, at a corner, or where a
        straight part ends in a bend to another side. The message names the place and the angle.
    """
    curve = as_curve("curve", curve)
    turn = np.eye(3) if offset is None else _one_rotation("offset", offset)
    _check_continuous(curve)
    return FrenetOrientation(curve, turn)


def as_rotations(what: str, rotations: ArrayLike, knots: ArrayLike) -> tuple[Array, Array]:
    """Check rotations (n, 3, 3), at least two, and as many knots."""
    given = as_rotation(rotations, what=what)
    if given.ndim != 3 or len(given) < 2:
        raise WrongSizeError(what, given.shape, "(n, 3, 3) with n at least 2")
    parameters = as_breaks("knots", knots)
    if len(parameters) != len(given):
        raise WrongSizeError("knots", len(parameters), len(given))
    return given, parameters


def turns_between(what: str, rotations: Array) -> Array:
    """Rotation vectors (n - 1, 3) from each to the next, in its own axes; refuse opposite ones."""
    turns = rotation_vector_from_matrix(np.swapaxes(rotations[:-1], -1, -2) @ rotations[1:])
    angles = np.linalg.norm(turns, axis=-1)
    opposite = np.flatnonzero(angles > np.pi - NEARLY_HALF_TURN)
    if len(opposite):
        k = int(opposite[0])
        raise BadValueError(
            f"angle (rad) from {what}[{k}] to {what}[{k + 1}]",
            float(angles[k]),
            "less than pi: between opposite orientations the axis is not defined; put one between",
        )
    return turns


def _one_rotation(what: str, value: ArrayLike) -> Array:
    return of_shape(what, as_rotation(value, what=what), (3, 3))


def _check_continuous(curve: Curve) -> None:
    """Refuse a curve whose frame jumps, between any two places however near to each other."""
    breaks = curve.breaks
    inner = breaks[:-1, None] + np.diff(breaks)[:, None] * (np.arange(_PLACES) / _PLACES)
    places = np.append(inner.ravel(), breaks[-1])
    # The last place before every break is looked at by itself: jumps are there most of all.
    before = np.nextafter(breaks[1:-1], breaks[:-2])
    places = np.sort(np.append(places, before))
    low, high = places[:-1], places[1:]
    while len(low):
        jumps = _angle(curve, low, high) > TURN_STEP
        low, high = low[jumps], high[jumps]
        middle = 0.5 * (low + high)
        least = (middle <= low) | (middle >= high)
        if least.any():
            k = np.flatnonzero(least)[[np.argmin(low[least])]]
            what = f"turn (rad) of the Frenet frame at parameter {high[k[0]]:.9g}"
            expected = "none: the frame jumps there, and no tool can follow it"
            raise BadValueError(what, float(_angle(curve, low[k], high[k])[0]), expected)
        low, high = np.append(low, middle), np.append(middle, high)


def _angle(curve: Curve, low: Array, high: Array) -> Array:
    """Angle (rad) between the frames at pairs of places."""
    between = (
        np.swapaxes(frenet_serret(curve, low).frame, -1, -2) @ frenet_serret(curve, high).frame
    )
    return np.linalg.norm(rotation_vector_from_matrix(between), axis=-1)


def applied(matrices: Array, vectors: Array) -> Array:
    """Products of matrices (m, 3, 3) with vectors (m, 3), one by one."""
    return (matrices @ vectors[..., None])[..., 0]
