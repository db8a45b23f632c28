"""Holds a motion to its tolerances."""

import numpy as np

from robomech_ros.execution.controller.trajectory_goal import Job
from robomech_ros.execution.joints import Joints, State
from robomech_ros.outcomes import Code
from robomech_ros.trajectory.sample import FloatArray

__all__ = ["verdict"]


def verdict(job: Job, wanted: State, actual: State, joints: Joints) -> tuple[int, str] | None:
    """Decide whether a motion has reached its goal, or must be given up.

    Parameters
    ----------
    job : Job
        What is being followed; that it has arrived is noted in it.
    wanted : State
        Where its curve is now.
    actual : State
        Where the joints are.
    joints : Joints
        Their names.

    Returns
    -------
    tuple of int and str, or None
        None while there is nothing to decide; code 0 at the goal; else the code, and a text that
        names the joint, how far it is off, and the tolerance.
    """
    over = job.time - job.arrival
    if over < 0.0:
        return _off_path(job, wanted, actual, joints)
    if not job.arrived:
        found = _off_goal(job, wanted, actual, joints)
        if found is not None:
            return found if over > job.tolerances.goal_time else None
        job.arrived = True
    return (int(Code.NONE), "") if over >= job.braking else None


def _off_path(job: Job, wanted: State, actual: State, joints: Joints) -> tuple[int, str] | None:
    allowed, code = job.tolerances, Code.PATH_TOLERANCE
    off = wanted.position - actual.position
    change = wanted.velocity - actual.velocity
    push = wanted.acceleration - actual.acceleration
    return (
        _complaint(code, "its path", off, allowed.path, joints)
        or _complaint(code, "the velocity of its path", change, allowed.path_velocity, joints, "/s")
        or _complaint(
            code, "the acceleration of its path", push, allowed.path_acceleration, joints, "/s^2"
        )
    )


def _off_goal(job: Job, wanted: State, actual: State, joints: Joints) -> tuple[int, str] | None:
    allowed, code = job.tolerances, Code.GOAL_TOLERANCE
    rest = "the velocity at its goal" if job.braking else "rest"
    off = wanted.position - actual.position
    change = wanted.velocity - actual.velocity
    push = wanted.acceleration - actual.acceleration
    return (
        _complaint(code, "its goal", off, allowed.goal, joints)
        or _complaint(code, rest, change, allowed.velocity, joints, "/s")
        or _complaint(
            code, "its last acceleration", push, allowed.goal_acceleration, joints, "/s^2"
        )
    )


def _complaint(
    code: int,
    what: str,
    difference: FloatArray,
    allowed: FloatArray | None,
    joints: Joints,
    per: str = "",
) -> tuple[int, str] | None:
    """Name the joint that is worst, if it is off by more than allowed."""
    if allowed is None:
        return None
    off = np.abs(difference)
    worst = int(np.argmax(off - allowed))
    if off[worst] <= allowed[worst]:
        return None
    unit = ("rad" if joints.revolute[worst] else "m") + per
    return int(code), (
        f"joint '{joints.names[worst]}' is {off[worst]:.4g} {unit} off {what}, "
        f"the tolerance is {allowed[worst]:.4g} {unit}"
    )
