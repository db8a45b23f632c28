"""One run of the demonstration, from the start of the nodes to the plot."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from robomech_interfaces.srv import Execute, PlanCartesian, PlanJoint, SolveFK, SolveIK
from robomech_ros.dynamics import mass_matrix
from robomech_ros.nodes.demonstration.client import EXECUTE, PLAN_JOINT, running_client
from robomech_ros.nodes.demonstration.pick_and_place import (
    CARRYING,
    TRACKED,
    DemoArm,
    DemoRobot,
    PickAndPlace,
)
from robomech_ros.nodes.demonstration.postures import chain_with_limits
from robomech_ros.nodes.demonstration.report import Reporter, write_motion_page
from robomech_ros.nodes.process.launch_options import LaunchOptions
from robomech_ros.parallel import load_tree_description
from robomech_ros.plotting.joint_motions import plot_motion
from robomech_ros.rvs import Motion
from robomech_ros.typing import Array

# Rest before the first motion that the plot shows, s.
_LEAD_SECONDS = 0.25
_SERVICES = {
    "kinematics/solve_ik": SolveIK,
    "kinematics/solve_fk": SolveFK,
    PLAN_JOINT: PlanJoint,
    "trajectory_planner/plan_cartesian": PlanCartesian,
    EXECUTE: Execute,
}


def demonstrate(which: LaunchOptions, output: Path, payload: float | None = None) -> None:
    """Pick and place with a robot, and tell about it.

    - ``payload``: drives move the robot, and it carries this mass (kg) from pick to place; default
      none does.
    """
    reporter = Reporter()
    mechanism = load_tree_description(which.robot).mechanism
    if mechanism is not None:
        from robomech_ros.nodes.demonstration.demo_platform import DemoPlatform
        from robomech_ros.parallel import ParallelDynamics

        if payload is not None:
            ParallelDynamics(mechanism).mass_matrix(mechanism.home())
        robot: DemoRobot = DemoPlatform(mechanism)
    else:
        chain = chain_with_limits(which, reporter.say)
        if payload is not None:
            # A robot that cannot be simulated is refused here, once, instead of by a node.
            mass_matrix(chain, chain.midrange())
        robot = DemoArm(chain)
    reporter.heading(robot.title)
    dynamic = payload is not None
    commands = replace(which, dynamic=dynamic).commands()
    if dynamic:
        commands["joint_trajectory_controller"] += ["-p", f"path_tolerance:={TRACKED}"]
    with running_client(commands, robot.joint_names, robot.units) as (suite, client):
        client.wait_until_up(_SERVICES | CARRYING if dynamic else _SERVICES)
        reporter.up(suite)
        task = PickAndPlace(client, robot, reporter, payload)
        if which.srdf:
            task.stands_at_home()
        task.run()
        if which.srdf:
            task.go_home()
        reporter.heading("summary")
        reporter.summary(task.legs)
        times, q, qd = client.recording()
    # The robot waited for its first motion.
    start = max(task.marks[0][0] - _LEAD_SECONDS, 0.0)
    keep = times >= start
    times, q, qd = times[keep], q[keep], qd[keep]
    recording = times, q, qd
    plot = plot_recording(robot, task.marks, recording, output, "pick and place")
    motion = Motion(robot.model, times, q, tuple(task.choices))
    description = load_tree_description(which.robot).description
    page = write_motion_page(output, robot.name, "pick and place", description, motion)
    reporter.finish(f"plot: {plot}", page)


def plot_recording(
    robot: DemoRobot,
    marks: Sequence[tuple[float, str]],
    recording: tuple[Array, Array, Array],
    output: Path,
    title: str,
) -> Path:
    """Plot the recorded joint states, with marks at times (s); return the file."""
    times, q, qd = recording
    start, shown = times[0], list(robot.shown)
    qd = qd[:, shown]
    return plot_motion(
        output / f"{robot.name}.png",
        [robot.joint_names[k] for k in shown],
        times - start,
        (q[:, shown], qd, np.gradient(qd, times, axis=0)),
        title=f"{robot.name}: {title}, as published on joint_states",
        prismatic=[robot.units[k] == "m" for k in shown],
        marks=[(instant - start, label) for instant, label in marks],
    )
