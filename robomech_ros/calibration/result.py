"""Result of a hand-eye calibration."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robomech_ros.printing import Printed
from robomech_ros.typing import Array, BoolArray


@dataclass(frozen=True)
class HandEyeNoise:
    """Noise of the samples of a calibration, as standard deviations of each coordinate.

    Attributes
    ----------
    rotation : float
        Of the rotations of robot and sensor together (rad).
    position : float
        Of their positions together (m).
    robot_share : float
        The robot's part of the variance of the rotations, from 0 to 1.
    """

    rotation: float
    position: float
    robot_share: float


@dataclass(frozen=True, eq=False)
class HandEyeResult(Printed):
    """Poses of a sensor and its target.

    Attributes
    ----------
    sensor : ndarray, shape (4, 4)
        ``T_hand_sensor``, or ``T_base_sensor`` of a sensor that stands beside the robot.
    target : ndarray, shape (4, 4)
        ``T_base_target``, or ``T_hand_target``.
    covariance : ndarray, shape (6, 6)
        Of ``spatial.pose_error(sensor, truth)``: rotation vector (rad), then position (m), both
        in the frame that ``sensor`` is expressed in.  The noise is estimated from few samples;
        the covariance is widened so that its ellipsoid of 95 % by the chi-square distribution
        has the truth in 95 % of calibrations.
    residuals : ndarray, shape (n, 2)
        Of each sample: angle (rad) and distance (m) between the target as the sensor sees it and
        as the result predicts it.
    inlier : ndarray of bool, shape (n,)
        False where a sample contradicts the others; it was left out.
    weak_directions : ndarray, shape (k, 3)
        Unit vectors, in the frame of ``sensor``'s parent, along which its position is known five
        times worse than along the best; the worst first.
    free_directions : ndarray, shape (k, 3)
        Unit vector, in the same frame, of the common rotation axis if all axes are parallel; else
        k = 0.  The position along it is not determined and set to 0, with a deviation of 20 times
        the mean distance of the hand's poses.  Not the ``free_directions`` of a servo, which are
        coordinates that a task leaves open.
    noise : HandEyeNoise
        As estimated, or as given.
    mount : str
        ``"eye-in-hand"`` or ``"eye-to-hand"``.
    information : ndarray, shape (12, 12)
        Inverse covariance of rotations and shifts of sensor and target about their own axes.
    robot_poses : ndarray, shape (n, 4, 4)
        ``T_base_hand`` of the samples.
    """

    sensor: Array
    target: Array
    covariance: Array
    residuals: Array
    inlier: BoolArray
    weak_directions: Array
    free_directions: Array
    noise: HandEyeNoise
    mount: str
    information: Array
    robot_poses: Array

    @property
    def outliers(self) -> tuple[int, ...]:
        """Indices of the samples that were left out."""
        return tuple(int(i) for i in np.flatnonzero(~self.inlier))

    @property
    def determined_covariance(self) -> Array:
        """Covariance of the position (m^2), zero along free directions, (3, 3)."""
        kept = np.eye(3) - self.free_directions.T @ self.free_directions
        return kept @ self.covariance[3:, 3:] @ kept

    @property
    def rotation_deviation(self) -> float:
        """Standard deviation of the sensor's rotation about the worst axis (rad)."""
        return _largest_deviation(self.covariance[:3, :3])

    @property
    def position_deviation(self) -> float:
        """Standard deviation of the sensor's position along the worst direction (m)."""
        return _largest_deviation(self.covariance[3:, 3:])

    @property
    def determined_deviation(self) -> float:
        """Standard deviation of the position along the worst direction that is not free (m)."""
        return _largest_deviation(self.determined_covariance)


def _largest_deviation(covariance: Array) -> float:
    return float(np.sqrt(np.linalg.eigvalsh(covariance)[-1]))


def sensor_covariance(information: Array, sensor: Array) -> Array:
    """Covariance (6, 6) of the sensor's pose, in its parent's axes, of an information (12, 12)."""
    scale = 1.0 / np.sqrt(np.diag(information))
    own = (np.linalg.inv(information * np.outer(scale, scale)) * np.outer(scale, scale))[:6, :6]
    axes = np.zeros((6, 6))
    axes[:3, :3] = axes[3:, 3:] = sensor[:3, :3]
    both = axes @ own @ axes.T
    return np.asarray(0.5 * (both + both.T))
