"""Joint paths: joint values over a path coordinate, and motions along them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from robomech_ros.errors import BadValueError
from robomech_ros.numerics.nonlinear import bisected
from robomech_ros.spatial.arrays import check_kind
from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial
from robomech_ros.trajectory.paths.curve_arguments import as_parameters
from robomech_ros.trajectory.paths.pose_path import PosePath
from robomech_ros.trajectory.sample import Sample, Trajectory, checked_times
from robomech_ros.trajectory.tolerances import PARAMETER_SLACK
from robomech_ros.typing import Array, ArrayLike

# Speed of a time law, over its mean, that is rest where the path has a corner.
AT_REST = 1e-6

# Halvings of the duration to find when a stop is reached: to rounding.
_HALVINGS = 60


@dataclass(frozen=True, eq=False)
class JointPath:
    """Joint values of n joints as functions of a path coordinate s (m), from 0 to `length`.

    Attributes
    ----------
    pieces : PiecewisePolynomial
        Joint values (rad or m) over s.  Two derivatives are continuous, except for the second where
        the rate of the followed path's twist steps, and both at the stops.
    stops : ndarray, shape (k,)
        Coordinates (m) at which the first derivative steps: a motion must rest there.
    """

    pieces: PiecewisePolynomial
    stops: Array

    @property
    def length(self) -> float:
        """Last path coordinate (m)."""
        return float(self.pieces.breaks[-1])

    @property
    def joints(self) -> int:
        """Number of joints."""
        return self.pieces.joints

    def derivatives(self, s: ArrayLike) -> Array:
        """Joint values and their first three derivatives with respect to s.

        Parameters
        ----------
        s : array_like, shape () or (m,)
            Path coordinates (m); at an inner break the piece after it counts.

        Returns
        -------
        ndarray, shape (4, n) or (4, m, n)
            rad or m, over m to the power of the first index.
        """
        return np.stack(self.pieces.sample(as_parameters("s", s, 0.0, self.length)))

    def only(self, joints: Sequence[int]) -> JointPath:
        """Return the path of some joints, by their numbers."""
        return JointPath(self.pieces.of_joints(joints), self.stops)

    def until(self, s: float) -> JointPath:
        """Return the part from the start up to a coordinate (m), above 0 and at most `length`."""
        pieces = self.pieces
        last = int(np.searchsorted(pieces.breaks, s, side="left"))
        breaks = np.append(pieces.breaks[:last], s)
        return JointPath(
            PiecewisePolynomial(breaks, pieces.coefficients[:, :last].copy()),
            self.stops[self.stops < s],
        )

    def along(self, law: Trajectory) -> JointMotion:
        """Run along the path by a time law.

        Parameters
        ----------
        law : Trajectory
            Of one joint: the path coordinate (m) over time, from 0 to its duration, never going
            back; at rest at the `stops`.

        Raises
        ------
        BadValueError
            Not such a trajectory, one that leaves the path, or one that passes a stop moving; the
            message names the coordinate.
        """
        _check_law(self, law)
        return JointMotion(self, law)


@dataclass(frozen=True, eq=False)
class JointMotion:
    """A motion q(s(t)) along a joint path.

    Attributes
    ----------
    path : JointPath
    law : Trajectory
        s(t), of one joint (m).
    """

    path: JointPath
    law: Trajectory

    @property
    def duration(self) -> float:
        """Time from start to end, in s."""
        return self.law.duration

    def sample(self, t: ArrayLike) -> Sample:
        """Sample positions and derivatives by the chain rule.

        Parameters
        ----------
        t : array_like, shape () or (m,)
            Instants in s.

        Returns
        -------
        Sample
            Arrays of shape (n,) or (m, n).
        """
        times = checked_times(t)
        s, v, a, j = (np.atleast_2d(row) for row in self.law.sample(np.atleast_1d(times)))
        coordinate = np.clip(s[:, 0], 0.0, self.path.length)
        q, q1, q2, q3 = self.path.derivatives(coordinate)
        found = Sample(q, q1 * v, q2 * v**2 + q1 * a, q3 * v**3 + 3.0 * q2 * v * a + q1 * j)
        return found if times.ndim else Sample(*(row[0] for row in found))


def _check_law(path: JointPath, law: Trajectory) -> None:
    expected = "a trajectory of the path coordinate, with duration and sample(t)"
    if not (hasattr(law, "duration") and callable(getattr(law, "sample", None))):
        raise BadValueError("law", law, expected)
    ends = np.asarray(law.sample(np.array([0.0, law.duration])).position)
    if ends.shape != (2, 1):
        raise BadValueError("law", law, expected + " of one joint")
    slack = PARAMETER_SLACK * path.length
    for what, value in zip(("start", "end"), ends[:, 0], strict=True):
        if not -slack <= value <= path.length + slack:
            raise BadValueError(f"{what} of the law", float(value), f"from 0 to {path.length:.9g}")
    if ends[1, 0] < ends[0, 0]:
        raise BadValueError("end of the law", float(ends[1, 0]), f"at least {ends[0, 0]:.9g}")
    inside = path.stops[(path.stops > ends[0, 0] + slack) & (path.stops < ends[1, 0] - slack)]
    speeds = _speeds_at(law, inside)
    moving = np.abs(speeds) * law.duration > AT_REST * path.length
    if moving.any():
        k = int(np.argmax(moving))
        what = f"speed of the law at the stop s = {inside[k]:.9g}"
        raise BadValueError(what, float(speeds[k]), "0: the path has a corner there")


def _speeds_at(law: Trajectory, coordinates: Array) -> Array:
    """Speed with which a law passes coordinates, shape (m,)."""
    if not len(coordinates):
        return coordinates
    low, high = np.zeros(len(coordinates)), np.full(len(coordinates), law.duration)
    high = bisected(low, high, lambda t: law.sample(t).position[:, 0] < coordinates, _HALVINGS)[1]
    return law.sample(high).velocity[:, 0]


def check_follows(path: PosePath, joints: JointPath) -> None:
    """Check that a joint path, over the coordinate of a pose path, is no longer than that."""
    check_kind("path", path, PosePath, "a PosePath")
    check_kind("joints", joints, JointPath, "a JointPath")
    if joints.length > path.length:
        raise BadValueError("length of the joint path", joints.length, f"at most {path.length:.9g}")
