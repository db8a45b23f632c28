"""The demonstration of a rolling robot: closed paths, driven across processes."""

from pathlib import Path

import numpy as np

from robomech_ros.nodes.demonstration.client import DemoClient, running_client
from robomech_ros.nodes.demonstration.drive_task import Driven, DriveTask, paths_for
from robomech_ros.nodes.demonstration.report import Reporter, whole_motion, write_motion_page
from robomech_ros.nodes.mobile_base.drives import INTERFACES
from robomech_ros.nodes.process.launch_options import LaunchOptions
from robomech_ros.plotting.drives import plot_paths
from robomech_ros.rolling import RollingRobot, WheelJoints, rolling_description, rolling_robot
from robomech_ros.rolling.tree import BASE_JOINTS


def demonstrate(robot: str, output: Path) -> None:
    """Drive closed paths with a rolling robot, and tell about it."""
    reporter, rolling = Reporter(), rolling_robot(robot)
    base = rolling.base
    reporter.heading(
        f"{base.name}: {rolling.drive} drive, {len(base.wheels)} wheels, {len(base.driven)} of "
        f"them driven, mobility {base.mobility.type}"
    )
    commands = LaunchOptions(robot, kind="rolling").commands()
    names = WheelJoints.of(base).names
    with running_client(commands, names, ("rad",) * len(names)) as (suite, client):
        client.wait_until_up({})
        task = DriveTask(client, rolling, INTERFACES[rolling.drive], reporter)
        task.wait_until_up()
        reporter.up(suite)
        radius, paths = paths_for(base)
        driven = [task.drive(path, radius) for path in paths]
        plot = _plot(base.name, task, driven, output)
        page = _page(rolling, client, task, driven, output)
    reporter.finish(f"plot: {plot}", page)


def _plot(name: str, task: DriveTask, driven: list[Driven], output: Path) -> Path:
    poses = task.poses
    return plot_paths(
        output / f"{name}.png",
        [one.path.name for one in driven],
        [one.path.places for one in driven],
        [poses[(poses[:, 0] >= one.begin) & (poses[:, 0] <= one.end), 1:] for one in driven],
        title=f"{name}: closed paths, as published on simulated_base",
    )


def _page(
    robot: RollingRobot, client: DemoClient, task: DriveTask, driven: list[Driven], output: Path
) -> str:
    times, turned, _ = client.recording()
    poses = task.poses
    times = times + client.began
    keep = (times >= max(driven[0].begin, poses[0, 0])) & (times <= poses[-1, 0])
    times, turned = times[keep], turned[keep]
    known = dict(zip(WheelJoints.of(robot.base).names, turned.T, strict=True))
    for name, column in zip(BASE_JOINTS, poses.T[1:], strict=True):
        known[name] = np.interp(times, poses[:, 0], column)
    description = rolling_description(robot.base)
    marks = [(one.begin, one.path.name) for one in driven]
    motion = whole_motion(description, times, known, marks)
    return write_motion_page(
        output, robot.base.name, "closed paths", description, motion, "base_link"
    )
