"""Holds a motion to its tolerances."""

import numpy as np

from robomech_ros.execution.job import Code, Job
from robomech_ros.execution.joints import Joints, State
from robomech_ros.trajectory.sample import FloatArray

__all__ = ["verdict"]


def verdict(job: Job, wanted: FloatArray, actual: State, joints: Joints) -> tuple[int, str] | None:
    """Decide whether a motion has reached its goal, or must be given up.

    Parameters
    ----------
    job : Job
        What is being followed.
    wanted : ndarray, shape (n,)
        Where its curve is now, rad or m.
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
    over = job.time - job.curve.duration
    if over < 0.0:
        off = np.abs(wanted - actual.position)
        return _complaint(Code.PATH_TOLERANCE, "its path", off, job.tolerances.path, joints)
    off = np.abs(job.goal - actual.position)
    speed = np.abs(actual.velocity)
    found = _complaint(
        Code.GOAL_TOLERANCE, "its goal", off, job.tolerances.goal, joints
    ) or _complaint(Code.GOAL_TOLERANCE, "rest", speed, job.tolerances.velocity, joints, "/s")
    if found is None:
        return int(Code.SUCCESS), ""
    return found if over > job.tolerances.goal_time else None


def _complaint(
    code: int, what: str, off: FloatArray, allowed: FloatArray, joints: Joints, per: str = ""
) -> tuple[int, str] | None:
    """Name the joint that is worst, if it is off by more than allowed."""
    worst = int(np.argmax(off - allowed))
    if off[worst] <= allowed[worst]:
        return None
    unit = ("rad" if joints.revolute[worst] else "m") + per
    return int(code), (
        f"joint '{joints.names[worst]}' is {off[worst]:.4g} {unit} off {what}, "
        f"the tolerance is {allowed[worst]:.4g} {unit}"
    )
