"""Plans that keep clear of the planning scene."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

from robomech_ros.cartesian.path_checks import PathStopLimits
from robomech_ros.kinematics import tip_poses
from robomech_ros.nodes.common.error_codes import OutcomeError
from robomech_ros.nodes.trajectory_planner.chain_motions import Planned
from robomech_ros.outcomes import Code
from robomech_ros.typing import Array

if TYPE_CHECKING:
    from robomech_ros.collision import PlanningScene

# Options of a plan that a path around an obstacle has, too.
_KEPT = ("profile", "velocity_scale", "acceleration_scale", "jerk_scale", "max_points")


def plan_around(
    scene: "PlanningScene", plan: Callable[[], Any], points: Array, options: dict[str, Any]
) -> Any:
    """Return a plan if it is proved free of contact, else one around what is in the way.

    Parameters
    ----------
    scene : PlanningScene
    plan : callable
        Makes the plan.
    points : ndarray, shape (m, n)
        Start, via points and goal (rad or m).
    options : dict
        Of `fitting_plan`.

    Raises
    ------
    OutcomeError
        Start, goal or a plan through via points are in contact, or no path was found.
    """
    found = plan()
    check = scene.check_motion(found.sampled.waypoints)
    if check.certified:
        return found
    if len(points) > 2 or options["duration"] is not None:
        first, second = check.bodies
        how = "would" if not check.free else "may"
        what = "via points" if len(points) > 2 else "a duration"
        text = f"'{first}' and '{second}' {how} touch at {check.parameter:.4g} s"
        advice = f"a motion with {what} is not led around obstacles"
        raise OutcomeError(Code.COLLISION, f"{text}; {advice}")
    # Loaded where there is a scene.
    from robomech_ros.collision import NotFreeError, PlanStatus, timed_path

    path = scene.plan(points[0], points[-1])
    if path.status is not PlanStatus.SOLVED:
        late = path.status is PlanStatus.NO_PATH
        raise OutcomeError(Code.NO_PATH if late else Code.COLLISION, path.reason)
    kept = {name: options[name] for name in _KEPT}
    period = options["wanted_period"] or options["usual_period"]
    try:
        sampled = timed_path(scene, path.waypoints, period=period, **kept)
    except NotFreeError as error:
        raise OutcomeError(Code.COLLISION, str(error)) from None
    return Planned(sampled, partial(tip_poses, scene.chain, sampled.waypoints.positions))


def ending_before_contact(
    scene: "PlanningScene", start: Array, bounds: PathStopLimits
) -> PathStopLimits:
    """Let a path of the tool end before contact, too.

    Raises
    ------
    OutcomeError
        The start (n,) is in contact.
    """
    from robomech_ros.collision import stop_before_contact
    from robomech_ros.collision.planning import in_words

    if not scene.is_free(start):
        found = scene.clearance(start)
        text = f"the start is in contact: {in_words(found.bodies, found.distance)}"
        raise OutcomeError(Code.COLLISION, f"{text}; plan_joint leads out of it")
    return replace(bounds, checks=(*bounds.checks, stop_before_contact(scene)))
