"""How the simulated robot is, for the diagnostics."""

from robomech_ros.execution.controller.follower import Phase
from robomech_ros.nodes.common.refusals import refusal_values
from robomech_ros.nodes.common.status_report import NodeCondition
from robomech_ros.nodes.joint_trajectory_controller.robot import SimulatedRobot

__all__ = ["robot_condition"]


def robot_condition(robot: SimulatedRobot) -> NodeCondition:
    """Describe the robot.

    A warning while the last trajectory that came was refused, or drives were at their limits since
    the last motion began.
    """
    with robot.lock:
        counts = robot.counts
        values = {
            "trajectories accepted": counts.accepted,
            "goals reached": counts.reached,
            "ended early": counts.ended_early,
            "last end": counts.last_end,
            **refusal_values(counts.refusal),
        }
        saturation = robot.saturation()
        if robot.dynamic:
            values["at effort limits"] = saturation
        summary = "; ".join(part for part in (_summary(robot), saturation) if part)
        return NodeCondition(summary, bool(counts.refusal.text or saturation), values)


def _summary(robot: SimulatedRobot) -> str:
    follower, refusal = robot.follower, robot.counts.refusal.text
    if refusal:
        return f"{follower.phase.value}; refused: {refusal}"
    if follower.phase is Phase.MOVING and follower.active is not None:
        return f"moving, {100.0 * follower.active.progress:.0f} % of the trajectory"
    if follower.waiting is not None:
        return f"{follower.phase.value}; a trajectory waits for its time"
    return follower.phase.value
