"""Contours over joints 4 and 5 whose crossings are the postures of an arm, for pages and pictures.

Somebody points at a crossing, Newton-Gauss refines it, and the equations that are left over tell
whether it is a posture or spurious.

References
----------
Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 9.4.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from robomech_ros.errors import BadValueError
from robomech_ros.kinematics.equations.closure import closure_equations
from robomech_ros.kinematics.equations.postures import posture_of
from robomech_ros.kinematics.oracles.bivariate import PAIR, Intersection, measured, minors
from robomech_ros.numerics import CurveCrossing, CurvePair
from robomech_ros.robots.chain import SerialChain
from robomech_ros.typing import Array, ArrayLike

# All three rows of six.
MINORS = tuple(combinations(range(6), 3))
# Residual of a posture in the other equations where contours touch: there a crossing is known to
# the root of the rounding, and its posture is this near (rad).
_LEFT, _NEAR = 1e-4, 1e-3


@dataclass(frozen=True, eq=False)
class Crossing:
    """Crossing of the two drawn contours.

    Parameters
    ----------
    angles : ndarray, shape (2,)
        Joints 4 and 5 (rad), from -pi to pi.
    path : ndarray, shape (k, 2)
        The steps from the estimate to it.
    left_over : float
        The greatest of the other minors, as part of its size, or what is left of
        ``cos^2 + sin^2 = 1`` for joint 3; 0 at a posture.
    across : float
        Angle (rad) at which the contours cross; near 0 the posture is nearly singular.
    posture : Intersection or None
        The posture with its conditioning; None where the crossing is spurious.
    """

    angles: Array
    path: Array
    left_over: float
    across: float
    posture: Intersection | None


class PostureContours:
    """The contours of two minors for one pose of an arm of six revolute joints.

    Parameters
    ----------
    chain : SerialChain
    T : array_like, shape (4, 4)
        Target pose of the tip in the base (m).
    pair : sequence of two of ``MINORS``, optional
        The two minors, each by its three rows of six, from 0.
    """

    def __init__(
        self, chain: SerialChain, T: ArrayLike, *, pair: Sequence[Sequence[int]] = PAIR
    ) -> None:
        drawn = _pair(pair)
        self._equations = closure_equations(chain, T)
        self._drawn = drawn
        others = [rows for rows in MINORS if rows not in drawn]
        self._curves = CurvePair(
            lambda q4, q5: minors(self._equations, q4, q5, drawn),
            others=lambda q4, q5: minors(self._equations, q4, q5, others),
            period=2.0 * np.pi,
        )

    def curves(self) -> tuple[tuple[Array, ...], ...]:
        """Return the two contours over a turn of joints 4 and 5, in pieces (k, 2) (rad)."""
        return self._curves.curves()

    def refine(self, estimate: ArrayLike) -> Crossing:
        """Refine an estimate of a crossing by Newton-Gauss.

        Parameters
        ----------
        estimate : array_like, shape (2,)
            Joints 4 and 5 (rad).
        """
        return self._judged(self._curves.refine(estimate))

    def all(self) -> list[Crossing]:
        """Find all crossings, postures and spurious ones; takes some tenths of a second."""
        return [self._judged(each) for each in self._curves.all()]

    def _judged(self, crossing: CurveCrossing) -> Crossing:
        angles = crossing.point
        G = self._equations.three_columns(*angles)
        c, s = np.linalg.lstsq(G[:, :2], -G[:, 2], rcond=None)[0]
        off_circle = abs(c**2 + s**2 - 1.0) / (c**2 + s**2 + 1.0)
        left_over = float(max(crossing.left_over, off_circle))
        known = (angles, crossing.path, left_over, crossing.angle)
        if left_over > _LEFT:
            return Crossing(*known, None)
        q = posture_of(self._equations, float(np.arctan2(s, c)), *angles.tolist())
        if q is None or np.abs((q[3:5] - angles + np.pi) % (2.0 * np.pi) - np.pi).max() > _NEAR:
            return Crossing(*known, None)
        return Crossing(*known, measured(self._equations, q, self._drawn))


def _pair(pair: Sequence[Sequence[int]]) -> tuple[tuple[int, ...], ...]:
    expected = "two different rows of three out of 0 to 5, each increasing"
    try:
        rows = tuple(tuple(each) for each in pair)
    except TypeError:
        raise BadValueError("pair", pair, expected) from None
    if len(rows) != 2 or rows[0] == rows[1] or not all(each in MINORS for each in rows):
        raise BadValueError("pair", pair, expected)
    return rows
