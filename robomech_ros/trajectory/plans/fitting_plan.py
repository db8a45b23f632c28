"""Plans within the allowed number of samples and seconds, sampled more coarsely where needed."""

from collections.abc import Callable
from typing import Any

from robomech_ros.errors import BadValueError
from robomech_ros.trajectory.limits import JointLimits
from robomech_ros.trajectory.paths.curve_arguments import as_positive
from robomech_ros.trajectory.plans.sampled_plan import SampledPlan
from robomech_ros.trajectory.plans.via_motions import sampled_through_points, through_points
from robomech_ros.typing import Array

_SHORTEST = "shortest duration within the scaled limits"


def fitting_plan(
    limits: JointLimits,
    points: Array,
    *,
    wanted_period: float,
    usual_period: float,
    max_points: int,
    max_duration: float,
    **options: Any,
) -> SampledPlan:
    """Plan through points (m, n), rad or m, in no more samples and seconds than there may be.

    The limits are those of a chain model or `Limits`; kept `Limits` spare their making. The wanted
    period is the largest time between two points (s) that was asked for; 0 = the usual one, or a
    longer one where the points would be too many. Between points the curve is the same. The options
    are those of `through_points`; errors are those of `sampled_through_points`, and BadValueError
    for a motion that takes too long.
    """
    return sampled_to_fit(
        lambda period: sampled_through_points(
            points, limits=limits, period=period, max_points=max_points, **options
        ),
        lambda: through_points(points, limits=limits, **options).duration,
        wanted_period=wanted_period,
        usual_period=usual_period,
        max_points=max_points,
        max_duration=max_duration,
    )


def sampled_to_fit(
    sampled: Callable[[float], SampledPlan],
    duration: Callable[[], float],
    *,
    wanted_period: float = 0.0,
    usual_period: float,
    max_points: int,
    max_duration: float,
) -> SampledPlan:
    """Sample a motion as finely as it may be.

    `sampled` returns the plan for a largest time between two points (s), `duration` that of the
    motion (s); the others are as for `fitting_plan`. Raises BadValueError for a motion that takes
    too long, or whose course changes more often than it may have points.
    """
    usual = as_positive("sample_period", usual_period)
    try:
        plan = sampled(wanted_period or usual)
    except BadValueError as error:
        if wanted_period or error.what != "sample_period":
            raise
        seconds = duration()
        check_duration(seconds, max_duration, _SHORTEST)
        # As many points as may be are left to the breaks of the curve.
        try:
            plan = sampled(2.0 * seconds / max_points)
        except BadValueError as again:
            if again.what != "sample_period":
                raise
            expected = f"at most {max_points}, the parameter max_points"
            raise BadValueError("points that the motion needs", "more", expected) from None
    check_duration(float(plan.waypoints.times[-1]), max_duration, _SHORTEST)
    return plan


def check_duration(seconds: float, longest: float, what: str = "duration") -> None:
    """Refuse a motion that takes longer (s) than a trajectory may."""
    if seconds > longest:
        expected = f"at most {longest:g} s, the parameter max_duration"
        raise BadValueError(what, float(f"{seconds:.9g}"), expected)
