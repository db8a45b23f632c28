"""The demonstration of an arm in space: a body is captured, and the base reacts."""

from dataclasses import asdict
from pathlib import Path

from robomech_interfaces.srv import Execute, PlanCartesian, PlanJoint, SolveIK
from robomech_ros.dynamics import FloatingChain
from robomech_ros.errors import BadValueError
from robomech_ros.nodes.demonstration.capture_task import CaptureTask
from robomech_ros.nodes.demonstration.client import EXECUTE, PLAN_JOINT, running_client
from robomech_ros.nodes.demonstration.limits import Which, chain_with_limits
from robomech_ros.nodes.demonstration.pick_and_place import CARRYING, DemoArm
from robomech_ros.nodes.demonstration.report import Reporter, whole_motion, write_motion_page
from robomech_ros.nodes.demonstration.session import plot_recording
from robomech_ros.nodes.process.launch_options import LaunchOptions
from robomech_ros.robots import load_description
from robomech_ros.rvs.model.floating_tree import CAPTURED, CRAFT, floating_tree, free_joints

_SERVICES = {
    "kinematics/solve_ik": SolveIK,
    "trajectory_planner/plan_cartesian": PlanCartesian,
    PLAN_JOINT: PlanJoint,
    EXECUTE: Execute,
    **CARRYING,
}


def demonstrate_capture(which: Which, output: Path) -> None:
    """Capture a free body with an arm on a floating base, and prove it."""
    reporter = Reporter()
    chain, description = chain_with_limits(which, reporter.say), load_description(which.robot)
    base = description.floating_base
    if base is None:
        raise BadValueError("--robot", which.robot, "a robot with a floating base")
    arm, robot = DemoArm(chain), FloatingChain(chain, base)
    reporter.heading(f"{arm.title}, on a floating base of {base.mass:g} kg")
    commands = LaunchOptions(**asdict(which), servo=False).commands()
    with running_client(commands, arm.joint_names, arm.units) as (suite, client):
        task = CaptureTask(client, robot, reporter)
        client.wait_until_up(_SERVICES)
        reporter.up(suite)
        task.run()
        recording = client.recording()
        reporter.heading("summary")
        task.prove()
    plot = plot_recording(arm, task.marks, recording, output, "a capture in space")
    tree = floating_tree(description, base, task.captured)
    states = task.states()
    columns = free_joints(CRAFT, states.poses) | free_joints(CAPTURED, task.body_poses(states))
    columns |= dict(zip(chain.joint_names, states.q.T, strict=True))
    motion = whole_motion(tree, states.t, columns, task.marks)
    page = write_motion_page(output, chain.name, "a capture in space", tree, motion, chain.tip)
    reporter.finish(f"plot: {plot}", page)
