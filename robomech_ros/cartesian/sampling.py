"""Sampling of a motion of the tip, and its greatest length."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from robomech_ros.errors import BadValueError
from robomech_ros.spatial.arrays import positive_number, whole_number
from robomech_ros.trajectory import Limits, SampledPlan, discretise, verify
from robomech_ros.typing import Array

# A little finer than wanted: the fastest part may lie between two points.
_FINER = 0.95


@dataclass(frozen=True)
class Sampling:
    """Sampling of a motion, and its greatest length.

    Attributes
    ----------
    period : float
        Largest time between two samples (s); longer where they would be too many.
    max_points : int
        The most samples there may be.
    max_duration : float
        Longest motion (s); infinite for any.
    max_step : float
        Largest distance of the tip (m) between two samples; infinite for any.
    """

    period: float = 0.01
    max_points: int = 10_000
    max_duration: float = 3600.0
    max_step: float = math.inf

    def __post_init__(self) -> None:
        for name in ("period", "max_duration", "max_step"):
            object.__setattr__(
                self, name, positive_number(name, getattr(self, name), "a number above 0")
            )
        expected = "a whole number of at least 2"
        count = whole_number("max_points", self.max_points, expected, 2)
        object.__setattr__(self, "max_points", count)
        if math.isinf(self.period):
            raise BadValueError("period", self.period, "a finite time (s)")


def in_steps(
    tip_poses: Callable[[Array], Array], plan: SampledPlan, sampling: Sampling, limits: Limits
) -> SampledPlan:
    """Sample a plan finer where its points are farther apart than `max_step`.

    `tip_poses` returns poses (m, 4, 4) of the positions (m, n) of a plan.
    """
    step, most = sampling.max_step, sampling.max_points
    if math.isinf(step):
        return plan
    points = plan.waypoints
    places = tip_poses(points.positions)[:, :3, 3]
    apart = np.linalg.norm(np.diff(places, axis=0), axis=1)
    if apart.max(initial=0.0) <= step:
        return plan
    longest = float((apart / np.diff(points.times)).max(initial=0.0))
    try:
        finer = discretise(plan.trajectory, _FINER * step / longest, most)
    except BadValueError:
        expected = f"one for which {most} points, the parameter max_points, are enough"
        raise BadValueError("max_step", step, expected) from None
    report = verify(finer, limits, start=points.positions[0])
    report.require_ok()
    return replace(plan, waypoints=finer, verification=report)
