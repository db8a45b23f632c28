"""Holds a motion to its tolerances."""

from collections.abc import Sequence

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

    None while there is nothing to decide; code 0 at the goal; else the code, and a text that names
    the joint, how far it is off, and the tolerance. That the goal has arrived is noted in it. It
    may be under way for a timeout (s) after its end; 0 = any time.
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
    over, allowed, off = goal.time - goal.arrival, goal.tolerances, desired - actual
    if over < 0.0:
        path = "its path", "the velocity of its path", "the acceleration of its path"
        limits = allowed.path, allowed.path_velocity, allowed.path_acceleration
        return _complaint(Code.PATH_TOLERANCE, path, off, limits, joints)
    if not goal.arrived:
        rest = "the velocity at its goal" if goal.braking else "rest"
        at_goal = "its goal", rest, "its last acceleration"
        limits = allowed.goal, allowed.velocity, allowed.goal_acceleration
        found = _complaint(Code.GOAL_TOLERANCE, at_goal, off, limits, joints)
        if found is not None:
            return found if over > allowed.goal_time else None
        goal.arrived = True
    return MotionResult(Code.NONE, "") if over >= goal.braking else None


def _complaint(
    code: int, whats: Sequence[str], off: State, limits: Sequence[Array | None], joints: Joints
) -> MotionResult | None:
    """Name the worst joint of the first of positions and rates that is off by more than allowed."""
    differences = off.position, off.velocity, off.acceleration
    for order, (what, difference, allowed) in enumerate(
        zip(whats, differences, limits, strict=True)
    ):
        if allowed is None:
            continue
        amounts = np.abs(difference)
        worst = int(np.argmax(amounts - allowed))
        if amounts[worst] <= allowed[worst]:
            continue
        unit = joints.limits.unit(worst, order)
        unit = f" {unit}" if unit else ""
        text = (
            f"joint '{joints.names[worst]}' is {amounts[worst]:.4g}{unit} off {what}, "
            f"the tolerance is {allowed[worst]:.4g}{unit}"
        )
        return MotionResult(code, text)
    return None
