"""Odometry: the pose of a base from what its wheels have rolled, and how well it is known."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from robomech_ros.errors import BadValueError
from robomech_ros.rolling.arcs import moved, slope_by_pose
from robomech_ros.rolling.argument_checks import duration, one_vector
from robomech_ros.rolling.base import RollingBase
from robomech_ros.spatial.arrays import check_kind, real_number
from robomech_ros.typing import Array, ArrayLike

# Places and weights of Gauss over [0, 1]: exact for the growth of the covariance on a straight way.
_PLACES = 0.5 + np.array([-0.5, 0.0, 0.5]) * math.sqrt(0.6)
_WEIGHTS = np.array([5.0, 8.0, 5.0]) / 18.0


@dataclass(frozen=True, kw_only=True)
class OdometryNoise:
    """Uncertainty of the travel of each wheel.

    Parameters
    ----------
    travel : float
        Variance of the way of a wheel for each metre that it rolls (m^2/m).
    slip : float
        Variance for each metre by which wheels contradict each other (m^2/m).
    """

    travel: float = 1e-5
    slip: float = 1e-2

    def __post_init__(self) -> None:
        for name in ("travel", "slip"):
            value = real_number(name, getattr(self, name), "a number from 0 (m^2/m)")
            if not 0.0 <= value < math.inf:
                raise BadValueError(name, value, "a number from 0 (m^2/m)")
            object.__setattr__(self, name, value)


@dataclass(frozen=True, eq=False)
class Odometry:
    """Pose of a base by the rolling of its wheels.

    Attributes
    ----------
    pose : ndarray, shape (3,)
        x, y (m) and heading (rad) in the frame of odometry.
    covariance : ndarray, shape (3, 3)
        Covariance of the pose (m^2, m rad, rad^2), in the frame of odometry.
    twist : ndarray, shape (3,)
        ``[omega, v_x, v_y]`` over the last step (rad/s, m/s), in the axes of the base.
    twist_covariance : ndarray, shape (3, 3)
        Of the twist.
    slip : float
        By how much the wheels contradict each other (m/s).
    """

    pose: Array
    covariance: Array
    twist: Array
    twist_covariance: Array
    slip: float

    @classmethod
    def at(cls, pose: ArrayLike = (0.0, 0.0, 0.0)) -> Odometry:
        """Begin at a pose that is known: x, y (m) and heading (rad)."""
        return cls(
            one_vector("pose", pose, 3).copy(), np.zeros((3, 3)), np.zeros(3), np.zeros((3, 3)), 0.0
        )


def advance_odometry(
    base: RollingBase,
    odometry: Odometry,
    rates: ArrayLike,
    dt: float,
    *,
    steering: ArrayLike | None = None,
    noise: OdometryNoise | None = None,
) -> Odometry:
    r"""Move odometry by what the wheels did in a step.

    The pose is exact for constant rates.  The covariance follows

    .. math::

       P' = F P F^T + \int F_s Q F_s^T \, ds, \qquad Q = B \, \mathrm{diag}(q) \, B^T

    with the least-squares solution B of the wheels' equations and the variances q of the wheels'
    ways, which grow with the way and with the slip.  It does not depend on how a straight way is
    cut into steps.

    Parameters
    ----------
    base : RollingBase
    odometry : Odometry
        Before the step.
    rates : array_like, shape (k,)
        Rates of the driven wheels (rad/s).
    dt : float
        How long the step takes (s).
    steering : array_like, shape (s,), optional
        Steering angles (rad).  Default 0.
    noise : OdometryNoise, optional
        Default that of :class:`OdometryNoise`.

    References
    ----------
    Siegwart, Nourbakhsh and Scaramuzza, Introduction to Autonomous Mobile Robots, 2nd ed.,
    section 5.2.4.

    Examples
    --------
    >>> from robomech_ros.rolling import Odometry, advance_odometry, differential_drive
    >>> base = differential_drive(radius=0.1, track=0.4)
    >>> after = advance_odometry(base, Odometry.at(), [5.0, 5.0], 2.0)
    >>> after.pose.tolist(), after.covariance.diagonal().round(7).tolist()
    ([1.0, 0.0, 0.0], [5e-06, 4.67e-05, 0.000125])
    """
    check_kind("base", base, RollingBase, "a RollingBase")
    check_kind("odometry", odometry, Odometry, "an Odometry, such as Odometry.at()")
    time = duration("dt", dt)
    noise = OdometryNoise() if noise is None else noise
    check_kind("noise", noise, OdometryNoise, "an OdometryNoise")
    given = one_vector("rates", rates, len(base.driven))
    angles = None if steering is None else one_vector("steering", steering, len(base.steered))
    twist, slip = base.body_twist(given, angles)
    told = base.measured_rows(angles)
    solution = np.linalg.pinv(told)
    # Sideways a wheel slips by as much as the base goes.
    ways = np.abs(told @ twist) * time
    ways[len(given) :] = float(np.linalg.norm(twist[1:])) * time
    ways[: len(given)] = np.abs(given * base.driven_radii) * time
    variances = noise.travel * ways + noise.slip * float(slip) * time
    spread = solution @ (variances[:, None] * solution.T)
    heading, step = float(odometry.pose[2]), twist * time
    by_pose = slope_by_pose(heading, step)
    covariance = by_pose @ odometry.covariance @ by_pose.T
    for place, weight in zip(_PLACES, _WEIGHTS, strict=True):
        # An error here turns with the base, and all that follows.
        there = moved(odometry.pose, place * step)
        c, s = np.cos(there[2]), np.sin(there[2])
        turned = np.array([[0.0, c, -s], [0.0, s, c], [1.0, 0.0, 0.0]])
        onward = slope_by_pose(float(there[2]), (1.0 - place) * step)
        by_error = onward @ turned
        covariance = covariance + weight * by_error @ spread @ by_error.T
    pose = moved(odometry.pose, step)
    covariance = 0.5 * (covariance + covariance.T)
    return Odometry(pose, covariance, twist, np.asarray(spread / time**2), float(slip))
