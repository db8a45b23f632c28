"""Goals and results of GripperCommand, by the value that moves a gripper."""

from typing import Any

from robomech_ros.robots.gripper import GripperModel


def gripper_goal(gripper: GripperModel, value: float) -> Any:
    """Make the GripperCommand goal of a width (m) or position; BadValueError outside the range."""
    from control_msgs.action import GripperCommand

    goal = GripperCommand.Goal()
    goal.command.position = gripper.position(value)
    return goal


def gripper_outcome(gripper: GripperModel, result: Any) -> tuple[str, bool]:
    """Describe the position of a gripper after a command, and whether it is the goal.

    - ``result``: GripperCommand.Result.
    """
    value = gripper.value({gripper.joints[0].name: result.position})
    wide = " wide" if gripper.opening is not None else ""
    # Rounding of a closed gripper is no width.
    at = f"{round(value, 6) + 0.0:.4g} {gripper.unit}{wide}"
    if result.reached_goal:
        return at, True
    if result.stalled:
        return f"stopped by something at {at}", False
    return f"the motion ended early, at {at}", False
