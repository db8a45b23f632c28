"""Whether a robot that is where a loop ends has gone along it at all."""

import numpy as np

from robomech_ros.execution.client.execution_request import ExecutionRequest
from robomech_ros.execution.client.position_check import joint_distance
from robomech_ros.execution.joints import JointKinds
from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial
from robomech_ros.typing import Array

# A loop is looked at in so many places; a way out of less than this (rad, m) counts for none.
_PLACES = 200
_NOTICEABLE = 0.01
# What of the planned way out must be seen: joint states come at intervals.
_SEEN = 0.5


class Excursion:
    """Watches how far a robot goes away from where it began.

    Parameters
    ----------
    delivery : ExecutionRequest
        What was sent.
    curve : PiecewisePolynomial
        What the robot should follow, from where it is.
    position : ndarray, shape (n,)
        Where the robot was then, rad or m.
    kinds : JointKinds
        Of its joints.
    """

    def __init__(
        self,
        delivery: ExecutionRequest,
        curve: PiecewisePolynomial,
        position: Array,
        kinds: JointKinds,
    ) -> None:
        self._names, self._kinds, self._start = delivery.names, kinds, position
        places = curve.sample(np.linspace(0.0, float(curve.breaks[-1]), _PLACES)).position
        self._planned = np.max(joint_distance(places, position, kinds.continuous), axis=0)
        self._back = joint_distance(delivery.goal, position, kinds.continuous)
        self._seen = np.zeros(len(position))

    def look(self, position: Array) -> None:
        """Note where the robot is, rad or m."""
        away = joint_distance(position, self._start, self._kinds.continuous)
        self._seen = np.maximum(self._seen, away)

    def missing(self, tolerance: float) -> str:
        """Say what a robot that stands at the end of a loop has left out; empty for nothing.

        Parameters
        ----------
        tolerance : float
            How near to the start the end of a loop is, rad or m.
        """
        joint = int(np.argmax(self._planned))
        planned, seen = float(self._planned[joint]), float(self._seen[joint])
        if planned <= _NOTICEABLE or seen >= _SEEN * planned or np.max(self._back) > tolerance:
            return ""
        unit = f" {self._kinds.units[joint]}" if self._kinds.units[joint] else ""
        return (
            "the robot is where the trajectory begins and ends, but has not gone along it: joint "
            f"'{self._names[joint]}' was at most {seen:.3g}{unit} away, planned are "
            f"{planned:.3g}{unit}"
        )
