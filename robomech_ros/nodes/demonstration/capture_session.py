"""The demonstration of an arm in space: a body is captured, and the base reacts."""

from pathlib import Path

from robomech_interfaces.srv import Execute, PlanCartesian, PlanJoint, SolveIK
from robomech_ros.dynamics import FloatingChain
from robomech_ros.errors import BadValueError
from robomech_ros.nodes.demonstration.capture_task import CaptureTask, States
from robomech_ros.nodes.demonstration.client import EXECUTE, PLAN_JOINT, running_client
from robomech_ros.nodes.demonstration.pick_and_place import CARRYING, DemoArm
from robomech_ros.nodes.demonstration.postures import chain_with_limits
from robomech_ros.nodes.demonstration.report import Reporter, whole_motion, write_motion_page
from robomech_ros.nodes.process.launch_options import LaunchOptions
from robomech_ros.plotting.panels import Panel, plot_panels
from robomech_ros.robots import SerialChain, load_description
from robomech_ros.rvs.model.floating_tree import CAPTURED, CRAFT, floating_tree, free_joints
from robomech_ros.spatial import rotation_vector_from_matrix

_SERVICES = {
    "kinematics/solve_ik": SolveIK,
    "trajectory_planner/plan_cartesian": PlanCartesian,
    PLAN_JOINT: PlanJoint,
    EXECUTE: Execute,
    **CARRYING,
}


def demonstrate_capture(which: LaunchOptions, output: Path) -> None:
    """Capture a free body with an arm on a floating base, and prove it."""
    reporter = Reporter()
    chain, description = chain_with_limits(which, reporter.say), load_description(which.robot)
    base = description.floating_base
    if base is None:
        raise BadValueError("--robot", which.robot, "a robot with a floating base")
    arm, robot = DemoArm(chain), FloatingChain(chain, base)
    reporter.heading(f"{arm.title}, on a floating base of {base.mass:g} kg")
    with running_client(which.commands(), arm.joint_names, arm.units) as (suite, client):
        task = CaptureTask(client, robot, reporter)
        client.wait_until_up(_SERVICES)
        reporter.up(suite)
        task.run()
        reporter.heading("summary")
        task.prove()
    states = task.states()
    plot = _plot(chain, task, states, output)
    tree = floating_tree(description, base, task.captured)
    columns = free_joints(CRAFT, states.poses) | free_joints(CAPTURED, task.body_poses(states))
    columns |= dict(zip(chain.joint_names, states.q.T, strict=True))
    motion = whole_motion(tree, states.t, columns, task.marks)
    page = write_motion_page(output, chain.name, "a capture in space", tree, motion, chain.tip)
    reporter.finish(f"plot: {plot}", page)


def _plot(chain: SerialChain, task: CaptureTask, states: States, output: Path) -> Path:
    """Plot the motion of joints and base, and the momentum that robot and body share."""
    start, poses = states.t[0], states.poses
    turns = rotation_vector_from_matrix(poses[:, :3, :3])
    panels = (
        Panel("joints (rad)", chain.joint_names, states.q),
        Panel("base, position (m)", "xyz", poses[:, :3, 3]),
        Panel("base, rotation (rad)", ("about x", "about y", "about z"), turns),
        Panel("momentum (N s)", ("base", "arm", "free body", "all"), task.momenta(states)),
    )
    return plot_panels(
        output / f"{chain.name}.png",
        states.t - start,
        panels,
        title=f"{chain.name}: a capture in space; momentum along the velocity of the body",
        marks=[(instant - start, label) for instant, label in task.marks],
    )
