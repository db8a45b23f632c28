"""One run of the demonstration, from the start of the nodes to the plot."""

import time
from dataclasses import asdict
from pathlib import Path

import numpy as np

from robomech_interfaces.srv import Execute, PlanCartesian, PlanJoint, SolveFK, SolveIK
from robomech_ros.dynamics import mass_matrix
from robomech_ros.nodes.demonstration.client import EXECUTE, DemoClient, running_client
from robomech_ros.nodes.demonstration.limits import Which, chain_with_limits
from robomech_ros.nodes.demonstration.pick_and_place import (
    CARRYING,
    TRACKED,
    DemoArm,
    DemoRobot,
    PickAndPlace,
)
from robomech_ros.nodes.demonstration.report import Reporter, write_page
from robomech_ros.nodes.process.launch_options import LaunchOptions
from robomech_ros.parallel import load_tree_description
from robomech_ros.plotting.joint_motions import plot_motion
from robomech_ros.rvs import Motion, write_motion

# Rest before the first motion that the plot shows, s.
_LEAD_SECONDS = 0.25
_SERVICES = {
    "kinematics/solve_ik": SolveIK,
    "kinematics/solve_fk": SolveFK,
    "trajectory_planner/plan_joint": PlanJoint,
    "trajectory_planner/plan_cartesian": PlanCartesian,
    EXECUTE: Execute,
}


def demonstrate(which: Which, output: Path, payload: float | None = None) -> None:
    """Pick and place with a robot, and tell about it.

    Parameters
    ----------
    which : Which
        The robot, and what of it moves.
    output : Path
        Folder for the plot and the page.
    payload : float, optional
        Drives move the robot, and it carries this mass (kg) from pick to place; default none does.

    Raises
    ------
    RobomechError
        A step failed; the text says which and why.
    """
    reporter = Reporter()
    start = time.perf_counter()
    mechanism = load_tree_description(which.robot).mechanism
    if mechanism is not None:
        from robomech_ros.nodes.demonstration.demo_platform import DemoPlatform
        from robomech_ros.parallel import ParallelDynamics

        if payload is not None:
            ParallelDynamics(mechanism).mass_matrix(mechanism.home())
        robot: DemoRobot = DemoPlatform(mechanism)
    else:
        chain, notice = chain_with_limits(which)
        if notice:
            reporter.say(notice)
        if payload is not None:
            # A robot that cannot be simulated is refused here, once, instead of by a node.
            mass_matrix(chain, chain.midrange())
        robot = DemoArm(chain)
    reporter.heading(robot.title)
    begun = time.perf_counter()
    commands, joints = _commands(which, payload is not None), (robot.joint_names, robot.units)
    with running_client(commands, *joints) as (suite, client):
        client.wait_until_up(_SERVICES if payload is None else _SERVICES | CARRYING)
        reporter.say(f"up after {time.perf_counter() - begun:.1f} s, {suite.says}")
        task = PickAndPlace(client, robot, reporter, payload)
        if which.srdf:
            task.stands_at_home()
        task.run()
        if which.srdf:
            task.go_home()
        reporter.heading("summary")
        reporter.summary(task.legs)
        output.mkdir(parents=True, exist_ok=True)
        plot = _plot(robot, client, task, output)
        page = _page(which, robot, client, task, output)
    reporter.say(f"plot: {plot}")
    reporter.say(page)
    reporter.say(f"everything worked, in {time.perf_counter() - start:.1f} s")


def _commands(which: Which, dynamic: bool) -> dict[str, list[str]]:
    commands = LaunchOptions(**asdict(which), dynamic=dynamic, servo=False).commands()
    if dynamic:
        commands["joint_trajectory_controller"] += ["-p", f"path_tolerance:={TRACKED}"]
    return commands


def _page(
    which: Which, robot: DemoRobot, client: DemoClient, task: PickAndPlace, output: Path
) -> str:
    """Write the motion as a page, and say where; or why not."""
    times, q, _ = client.recording()
    keep = times >= _start(task)
    motion = Motion(robot.model, times[keep], q[keep], tuple(task.choices))
    description = load_tree_description(which.robot).description
    title = f"{robot.name}: pick and place"
    return write_page(
        output / f"{robot.name}.html",
        lambda path: write_motion(path, description, motion, title=title),
    )


def _start(task: PickAndPlace) -> float:
    """Return when what is worth a look begins (s): the robot waited for its first motion."""
    return max(task.marks[0][0] - _LEAD_SECONDS, 0.0)


def _plot(robot: DemoRobot, client: DemoClient, task: PickAndPlace, output: Path) -> Path:
    times, q, qd = client.recording()
    start = _start(task)
    keep, shown = times >= start, list(robot.shown)
    times, q, qd = times[keep] - start, q[keep][:, shown], qd[keep][:, shown]
    qdd = np.gradient(qd, times, axis=0)
    return plot_motion(
        output / f"{robot.name}.png",
        [robot.joint_names[k] for k in shown],
        times,
        (q, qd, qdd),
        title=f"{robot.name}: pick and place, as published on joint_states",
        prismatic=[robot.units[k] == "m" for k in shown],
        marks=[(instant - start, label) for instant, label in task.marks],
    )
