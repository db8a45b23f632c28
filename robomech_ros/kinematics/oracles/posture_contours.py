"""Contours over joints 4 and 5 whose crossings are the postures of an arm, for pages and pictures.

Somebody points at a crossing, Newton-Gauss refines it, and the equations that are left over tell
whether it is a posture or spurious.

References
----------
Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 9.4.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robomech_ros.errors import BadValueError
from robomech_ros.kinematics.inverse.target import as_targets
from robomech_ros.kinematics.oracles.bivariate import PAIR, Intersection, measured, minors
from robomech_ros.kinematics.oracles.closure import ClosureEquations, circle, posture_of
from robomech_ros.numerics import bivariate, refine_root
from robomech_ros.numerics.grid_crossings import zero_curves
from robomech_ros.robots.chain import SerialChain

__all__ = ["Crossing", "PostureContours"]

Array = NDArray[np.float64]

# All three rows of six, those of the drawn pair first.
_ROWS = (*PAIR, *(rows for rows in combinations(range(6), 3) if rows not in PAIR))
# Points in each direction on which curves are followed, and on which minors are sized.
_DRAWN, _COARSE = 241, 25
# What a crossing leaves of the drawn minors, as part of their size, and a posture of the other
# equations, where contours touch: there a crossing is known to the root of the rounding, and its
# posture is this near (rad).
_CROSSED, _LEFT, _NEAR = 1e-9, 1e-4, 1e-3


@dataclass(frozen=True, eq=False)
class Crossing:
    """Where the two drawn contours cross.

    Parameters
    ----------
    angles : ndarray, shape (2,)
        Joints 4 and 5 (rad).
    path : ndarray, shape (k, 2)
        The steps from the estimate to it.
    left_over : float
        The greatest of the other minors, as part of its size, or what is left of
        ``cos^2 + sin^2 = 1`` for joint 3; 0 at a posture.
    posture : Intersection or None
        The posture with its conditioning; None where the crossing is spurious.
    """

    angles: Array
    path: Array
    left_over: float
    posture: Intersection | None


class PostureContours:
    """The contours of two minors for one pose of an arm of six revolute joints.

    Parameters
    ----------
    chain : SerialChain
    T : array_like, shape (4, 4)
        Target pose of the tip in the base (m).

    Raises
    ------
    BadValueError
        No arm of six revolute joints, or no pose.
    WrongSizeError, NonFiniteError
        No pose.
    """

    def __init__(self, chain: SerialChain, T: ArrayLike) -> None:
        self._equations = ClosureEquations.of(chain, as_targets(T)[0])
        angles = np.linspace(-np.pi, np.pi, _COARSE)
        values = self._minors(angles[:, None], angles[None, :])
        self._sizes = np.sqrt(np.mean(values**2, axis=(1, 2)))
        self._sizes[self._sizes == 0.0] = 1.0

    def curves(self) -> tuple[tuple[Array, ...], ...]:
        """Give the two contours over a turn of joints 4 and 5, in pieces (k, 2) (rad)."""
        angles = np.linspace(-np.pi, np.pi, _DRAWN)
        values = minors(self._equations, angles[:, None], angles[None, :], PAIR)
        return tuple(zero_curves(angles, angles, each) for each in values)

    def refine(self, estimate: ArrayLike) -> Crossing:
        """Refine an estimate of a crossing by Newton-Gauss.

        Parameters
        ----------
        estimate : array_like, shape (2,)
            Joints 4 and 5 (rad).

        Raises
        ------
        BadValueError
            The steps lead to no crossing, or no two finite numbers are given.
        WrongSizeError, NonFiniteError
            No two finite numbers.
        """
        end = refine_root(self._drawn, estimate)
        if np.abs(end.residual).max() > _CROSSED:
            raise BadValueError("estimate", estimate, "a place near a crossing of the contours")
        return self._crossing(end.x, end.path)

    def all(self) -> list[Crossing]:
        """Find all crossings, postures and spurious ones; takes some tenths of a second."""
        found = bivariate(self._drawn, period=2.0 * np.pi)
        return [self._crossing(each, each[None]) for each in found.crossings]

    def _minors(self, q4: Array, q5: Array) -> Array:
        return minors(self._equations, q4, q5, _ROWS)

    def _drawn(self, q4: Array, q5: Array) -> Array:
        values = minors(self._equations, q4, q5, PAIR)
        sizes: Array = self._sizes[:2].reshape(2, *[1] * (values.ndim - 1))
        return values / sizes

    def _crossing(self, angles: Array, path: Array) -> Crossing:
        turned = (angles + np.pi) % (2.0 * np.pi) - np.pi
        left = np.abs(self._minors(angles[:1], angles[1:])[:, 0] / self._sizes)[len(PAIR) :]
        G = np.einsum("eijk,j,k->ei", self._equations.free, *circle(angles).T)
        c, s = np.linalg.lstsq(G[:, :2], -G[:, 2], rcond=None)[0]
        off_circle = abs(c**2 + s**2 - 1.0) / (c**2 + s**2 + 1.0)
        left_over = float(max(left.max(), off_circle))
        if left_over > _LEFT:
            return Crossing(turned, path, left_over, None)
        q = posture_of(self._equations, float(np.arctan2(s, c)), *angles.tolist())
        if q is None or np.abs((q[3:5] - angles + np.pi) % (2.0 * np.pi) - np.pi).max() > _NEAR:
            return Crossing(turned, path, left_over, None)
        return Crossing(turned, path, left_over, measured(self._equations, q))
