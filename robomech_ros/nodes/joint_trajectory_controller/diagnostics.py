"""State of the simulated robot, for the diagnostics."""

from robomech_ros.execution.controller.follower import Phase
from robomech_ros.nodes.common.messages.rejection_status import refusal_values
from robomech_ros.nodes.common.status_report import NodeHealth
from robomech_ros.nodes.joint_trajectory_controller.commanded_joints import CommandedJoints
from robomech_ros.nodes.joint_trajectory_controller.gripper.gripper import Gripper
from robomech_ros.nodes.joint_trajectory_controller.robot import SimulatedRobot


def robot_condition(robot: SimulatedRobot) -> NodeHealth:
    """Describe the robot.

    A warning while the last trajectory that came was refused, while its state may not be published,
    or if drives were at their limits since the last motion began.
    """
    with robot.lock:
        values = _values(robot)
        saturation = robot.simulated_joints.saturation(robot.joint_names)
        if robot.dynamic:
            values["at effort limits"] = saturation
        wrong = [part for part in (robot.fault, saturation) if part]
        summary = "; ".join((_summary(robot), *wrong))
        return NodeHealth(summary, bool(robot.counts.refusal.text or wrong), values)


def gripper_condition(gripper: Gripper) -> NodeHealth:
    """Describe the gripper; a warning while what came last was refused."""
    with gripper.lock:
        values = {**_values(gripper), "pressing": ", ".join(gripper.pressing())}
        return NodeHealth(_summary(gripper), bool(gripper.counts.refusal.text), values)


def _values(joints: CommandedJoints) -> dict[str, object]:
    counts = joints.counts
    return {
        "trajectories accepted": counts.accepted,
        "goals reached": counts.reached,
        "ended early": counts.ended_early,
        "last end": counts.last_end,
        **refusal_values(counts.refusal),
    }


def _summary(joints: CommandedJoints) -> str:
    follower, refusal = joints.follower, joints.counts.refusal.text
    if refusal:
        return f"{follower.phase.value}; refused: {refusal}"
    if follower.phase is Phase.MOVING and follower.active is not None:
        return f"moving, {100.0 * follower.active.progress:.0f} % of the trajectory"
    if follower.waiting is not None:
        return f"{follower.phase.value}; a trajectory waits for its time"
    return follower.phase.value
