"""Plans that keep clear of the planning scene."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any, NoReturn

from robomech_ros.cartesian.path_checks import PathStopLimits
from robomech_ros.errors import DurationTooShortError
from robomech_ros.kinematics import tip_poses
from robomech_ros.nodes.common.messages.error_codes import OutcomeError
from robomech_ros.nodes.trajectory_planner.chain_motions import Planned
from robomech_ros.outcomes import Code
from robomech_ros.trajectory.plans.fitting_plan import sampled_to_fit
from robomech_ros.typing import Array

if TYPE_CHECKING:
    from robomech_ros.collision import MotionCheck, PlanningScene

# Options of a plan that a path around an obstacle has, too.
_KEPT = ("profile", "velocity_scale", "acceleration_scale", "jerk_scale", "max_points", "duration")


def plan_around(
    scene: "PlanningScene", plan: Callable[[], Any], points: Array, options: dict[str, Any]
) -> Any:
    """Return a plan if it is proved free of contact, else one around what is in the way.

    - ``points``: start, via points and goal (rad or m), shape (m, n).
    - ``options``: options of `fitting_plan`.

    Raises OutcomeError: a point is in contact, no path was found, or the via points have their own
    instants. DurationTooShortError: the motion takes longer than the wanted duration.
    """
    try:
        found = plan()
        check = scene.check_motion(found.sampled.waypoints)
        if check.certified:
            return found
        if options["at"] is not None:
            _refuse_instants(check)
    except DurationTooShortError:
        # The motion may have to lead around something, which takes longer.
        if options["at"] is not None:
            raise
    # Loaded where there is a scene.
    from robomech_ros.collision import NotFreeError, PlanStatus, path_through, timed_path

    path = path_through(scene, points)
    if path.status is not PlanStatus.SOLVED:
        late = path.status is PlanStatus.NO_PATH
        raise OutcomeError(Code.NO_PATH if late else Code.COLLISION, path.reason)
    most = options["max_duration"]
    kept = {name: options[name] for name in _KEPT}
    timed = partial(timed_path, scene, path.waypoints, **kept)
    try:
        sampled = sampled_to_fit(
            lambda period: timed(period=period),
            lambda: float(timed(period=most).waypoints.times[-1]),
            max_duration=most,
            **{name: options[name] for name in ("wanted_period", "usual_period", "max_points")},
        )
    except NotFreeError as error:
        raise OutcomeError(Code.COLLISION, str(error)) from None
    return Planned(sampled, partial(tip_poses, scene.chain, sampled.waypoints.positions))


def _refuse_instants(check: "MotionCheck") -> NoReturn:
    first, second = check.bodies
    how = "would" if not check.free else "may"
    text = f"'{first}' and '{second}' {how} touch at {check.parameter:.4g} s"
    advice = "to be led around obstacles, leave time_from_start of all via points at 0"
    raise OutcomeError(Code.COLLISION, f"{text}; {advice}")


def ending_before_contact(
    scene: "PlanningScene", start: Array, bounds: PathStopLimits
) -> PathStopLimits:
    """Add contact to the stop conditions of a path; OutcomeError if the start (n,) touches."""
    from robomech_ros.collision import stop_before_contact
    from robomech_ros.collision.planning import in_words

    if not scene.is_free(start):
        found = scene.clearance(start)
        text = f"the start is in contact: {in_words(found.bodies, found.distance)}"
        raise OutcomeError(Code.COLLISION, f"{text}; plan_joint leads out of it")
    return replace(bounds, checks=(*bounds.checks, stop_before_contact(scene)))
