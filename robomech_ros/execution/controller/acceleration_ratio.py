"""Accelerations that a trajectory demands of the joints, as multiples of their limits."""

from dataclasses import dataclass

import numpy as np

from robomech_ros.execution.controller.curve_parts import highest_accelerations
from robomech_ros.execution.controller.joining import STANDING, completed, without_turns
from robomech_ros.execution.joints import Joints, State, approached
from robomech_ros.execution.rejections import AccelerationRefusedError
from robomech_ros.trajectory.waypoints import Waypoints

# What ends within this time (s) may be a message of a stream, whose sender corrects itself with the
# next one: servo nodes send positions and velocities for the next 10 to 100 ms.
STREAM = 0.2
# More than this part over a limit is worth a word: planners exceed limits by less through the
# rounding of their samples.
_NOTICED = 0.01


@dataclass(frozen=True)
class AccelerationRatio:
    """The largest acceleration of a curve, as a multiple of its limit (rad/s^2 or m/s^2).

    The time is since the start of the trajectory (s); the unit is empty where it is not known.
    """

    joint: str
    time: float
    value: float
    limit: float
    unit: str = ""

    @property
    def ratio(self) -> float:
        """Ratio to the limit."""
        return abs(self.value) / self.limit

    @property
    def remarkable(self) -> bool:
        """True if it exceeds the limit by more than rounding of planners."""
        return self.ratio > 1.0 + _NOTICED

    def __str__(self) -> str:
        unit = f" {self.unit}" if self.unit else ""
        return (
            f"the acceleration of joint '{self.joint}' is {self.value:.4g}{unit} at "
            f"t = {self.time:.6g} s, {self.ratio:.3g} times its limit {self.limit:.4g}{unit}"
        )

    def require(self, allowed: float) -> None:
        """Raise AccelerationRefusedError for more than so many times the limit; 0 = any."""
        if 0.0 < allowed * (1.0 + _NOTICED) < self.ratio:
            raise AccelerationRefusedError(
                str(self), self.joint, self.value, self.limit, allowed, self.unit
            )


def acceleration_ratio_of(
    waypoints: Waypoints, present: State, joints: Joints, late: float
) -> AccelerationRatio | None:
    """Find the largest acceleration of the interpolated curve, compared with its limit.

    None where nothing accelerates, or no joint has a limit. Linear pieces, between points without
    velocities, do not count: their corners have no finite acceleration, and ros2_control follows
    them, too. The way to a first point later than now counts where the robot stands and the
    trajectory is in time, not late by some time (s).
    """
    velocities = waypoints.velocities
    if velocities is None or np.isnan(velocities).all():
        return None
    known = completed(waypoints, present)
    standing = bool(np.max(np.abs(present.velocity)) <= STANDING)
    if known.times[0] > 0.0 and standing and not late:
        curve = approached(known, without_turns(known.positions, present, joints), present)
    else:
        curve = known.curve
    if len(curve.breaks) < 2:
        return None
    values, times = highest_accelerations(curve)
    ratios = np.abs(values) / joints.limits.acceleration
    piece, joint = map(int, np.unravel_index(int(np.argmax(ratios)), ratios.shape))
    if not ratios[piece, joint]:
        return None
    return AccelerationRatio(
        joints.names[joint],
        float(times[piece, joint]),
        float(values[piece, joint]),
        float(joints.limits.acceleration[joint]),
        joints.limits.unit(joint, 2),
    )
