"""How uncertain odometry is that trusts standing feet: each may slip a little as the trunk goes."""

from __future__ import annotations

import math

import numpy as np

from robomech_ros.nodes.common.odometry_frame import POSE, TWIST, full_covariance
from robomech_ros.typing import Array
from robomech_ros.walking import WalkUpdate


class Uncertainty:
    """Covariances of the place of the trunk in the plane, and of its twist.

    The motion of the trunk follows from the standing feet by least squares.  The way of each foot
    under the trunk has a variance in proportion to its length.

    Parameters
    ----------
    slip : float
        Variance of the way of a foot for each metre (m^2/m).
    """

    def __init__(self, slip: float) -> None:
        self._slip = slip
        self._pose, self._twist = np.zeros((3, 3)), np.zeros((3, 3))
        self._before: Array | None = None

    @property
    def pose(self) -> Array:
        """Covariance of the pose in message order: 36 numbers (m^2, m rad, rad^2)."""
        return full_covariance(self._pose, POSE)

    @property
    def twist(self) -> Array:
        """Covariance of the twist since the last moment, in the trunk: 36 numbers."""
        return full_covariance(self._twist, TWIST)

    def forget(self) -> None:
        """Forget where the trunk was; what is uncertain so far remains."""
        self._before = None

    def add(self, update: WalkUpdate, seconds: float) -> None:
        """Add what may have slipped since the last moment, so many seconds ago."""
        T = update.trunk
        here = np.array([T[0, 3], T[1, 3], math.atan2(T[1, 0], T[0, 0])])
        before, self._before = self._before, here
        if before is None or seconds <= 0.0:
            return
        c, s = math.cos(before[2]), math.sin(before[2])
        dx, dy = here[:2] - before[:2]
        step = np.array(
            [math.remainder(here[2] - before[2], 2.0 * math.pi), c * dx + s * dy, c * dy - s * dx]
        )
        away = (update.feet[update.contacts, :2] - before[:2]) @ np.array([[c, -s], [s, c]])
        rows = np.zeros((len(away), 2, 3))
        rows[:, 0, 0], rows[:, 1, 0] = -away[:, 1], away[:, 0]
        rows[:, 0, 1] = rows[:, 1, 2] = 1.0
        ways = np.linalg.norm(rows @ step, axis=1)
        solution = np.linalg.pinv(rows.reshape(-1, 3))
        spread = self._slip * (solution * np.repeat(ways, 2)) @ solution.T
        onward = np.array([[1.0, 0.0, -dy], [0.0, 1.0, dx], [0.0, 0.0, 1.0]])
        turned = np.array([[0.0, c, -s], [0.0, s, c], [1.0, 0.0, 0.0]])
        grown = onward @ self._pose @ onward.T + turned @ spread @ turned.T
        self._pose = 0.5 * (grown + grown.T)
        self._twist = spread / seconds**2
