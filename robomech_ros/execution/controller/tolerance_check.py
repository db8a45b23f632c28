"""Holds a motion to its tolerances."""

import numpy as np

from robomech_ros.execution.controller.trajectory_goal import TrajectoryGoal
from robomech_ros.execution.joints import Joints, State
from robomech_ros.execution.motion_result import MotionResult
from robomech_ros.outcomes import Code
from robomech_ros.typing import Array


def verdict(
    goal: TrajectoryGoal, desired: State, actual: State, joints: Joints, timeout: float
) -> MotionResult | None:
    """Decide whether a motion has reached its goal, or must be given up.

    Parameters
    ----------
    goal : TrajectoryGoal
        What is being followed; that it has arrived is noted in it.
    desired : State
        Where its curve is now.
    actual : State
        Where the joints are.
    joints : Joints
        Their names.
    timeout : float
        How long after its end a trajectory may be under way, s; 0 = any time.

    Returns
    -------
    MotionResult or None
        None while there is nothing to decide; code 0 at the goal; else the code, and a text that
        names the joint, how far it is off, and the tolerance.
    """
    found = _held_to_tolerances(goal, desired, actual, joints)
    over = goal.time - goal.arrival
    if found is None and 0.0 < timeout < over:
        text = f"still not at its goal {over:.4g} s after its end, allowed are {timeout:g} s"
        return MotionResult(Code.TIMED_OUT, text)
    return found


def _held_to_tolerances(
    goal: TrajectoryGoal, desired: State, actual: State, joints: Joints
) -> MotionResult | None:
    over = goal.time - goal.arrival
    if over < 0.0:
        return _off_path(goal, desired, actual, joints)
    if not goal.arrived:
        found = _off_goal(goal, desired, actual, joints)
        if found is not None:
            return found if over > goal.tolerances.goal_time else None
        goal.arrived = True
    return MotionResult(Code.NONE, "") if over >= goal.braking else None


def _off_path(
    goal: TrajectoryGoal, desired: State, actual: State, joints: Joints
) -> MotionResult | None:
    allowed, code = goal.tolerances, Code.PATH_TOLERANCE
    off = desired.position - actual.position
    change = desired.velocity - actual.velocity
    push = desired.acceleration - actual.acceleration
    return (
        _complaint(code, "its path", off, allowed.path, joints)
        or _complaint(code, "the velocity of its path", change, allowed.path_velocity, joints, 1)
        or _complaint(
            code, "the acceleration of its path", push, allowed.path_acceleration, joints, 2
        )
    )


def _off_goal(
    goal: TrajectoryGoal, desired: State, actual: State, joints: Joints
) -> MotionResult | None:
    allowed, code = goal.tolerances, Code.GOAL_TOLERANCE
    rest = "the velocity at its goal" if goal.braking else "rest"
    off = desired.position - actual.position
    change = desired.velocity - actual.velocity
    push = desired.acceleration - actual.acceleration
    return (
        _complaint(code, "its goal", off, allowed.goal, joints)
        or _complaint(code, rest, change, allowed.velocity, joints, 1)
        or _complaint(code, "its last acceleration", push, allowed.goal_acceleration, joints, 2)
    )


def _complaint(
    code: int, what: str, difference: Array, allowed: Array | None, joints: Joints, order: int = 0
) -> MotionResult | None:
    """Name the joint that is worst, if it is off by more than allowed."""
    if allowed is None:
        return None
    off = np.abs(difference)
    worst = int(np.argmax(off - allowed))
    if off[worst] <= allowed[worst]:
        return None
    unit = joints.limits.unit(worst, order)
    unit = f" {unit}" if unit else ""
    return MotionResult(
        code,
        (
            f"joint '{joints.names[worst]}' is {off[worst]:.4g}{unit} off {what}, "
            f"the tolerance is {allowed[worst]:.4g}{unit}"
        ),
    )
