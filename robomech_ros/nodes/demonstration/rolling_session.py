"""The demonstration of a rolling robot: closed paths, driven across processes."""

from __future__ import annotations

import time
from pathlib import Path

import numpy as np

from robomech_ros.nodes.demonstration.client import DemoClient, running_client
from robomech_ros.nodes.demonstration.drive_task import Driven, DriveTask, paths_for
from robomech_ros.nodes.demonstration.report import Reporter, write_page
from robomech_ros.nodes.mobile_base.drives import INTERFACES
from robomech_ros.nodes.process.launch_options import LaunchOptions
from robomech_ros.plotting.drives import plot_paths
from robomech_ros.rolling import RollingRobot, WheelJoints, rolling_description, rolling_robot
from robomech_ros.rolling.tree import BASE_JOINTS
from robomech_ros.rvs import Choice, Motion, write_motion


def demonstrate(robot: str, output: Path) -> None:
    """Drive closed paths with a rolling robot, and tell about it.

    Parameters
    ----------
    robot : str
        Name or path.
    output : Path
        Folder for the plot and the page.

    Raises
    ------
    RobomechError
        A step failed; the text says which and why.
    """
    start = time.perf_counter()
    reporter, rolling = Reporter(), rolling_robot(robot)
    base = rolling.base
    reporter.heading(
        f"{base.name}: {rolling.drive} drive, {len(base.wheels)} wheels, {len(base.driven)} of "
        f"them driven, mobility {base.mobility.type}"
    )
    interface = INTERFACES[rolling.drive]
    commands = LaunchOptions(robot, kind="rolling").commands()
    names = WheelJoints.of(base).names
    with running_client(commands, names, ("rad",) * len(names)) as (suite, client):
        client.wait_until_up({})
        task = DriveTask(client, rolling, interface, reporter)
        task.wait_until_up()
        reporter.say(f"up after {time.perf_counter() - start:.1f} s, {suite.says}")
        radius, paths = paths_for(base)
        driven = [task.drive(path, radius) for path in paths]
        output.mkdir(parents=True, exist_ok=True)
        written = [
            f"plot: {_plot(base.name, task, driven, output)}",
            _page(rolling, client, task, driven, output),
        ]
    for line in written:
        reporter.say(line)
    reporter.say(f"everything worked, in {time.perf_counter() - start:.1f} s")


def _plot(name: str, task: DriveTask, driven: list[Driven], output: Path) -> Path:
    places = task.places
    ways = [places[(places[:, 0] >= one.begin) & (places[:, 0] <= one.end), 1:] for one in driven]
    return plot_paths(
        output / f"{name}.png",
        [one.path.name for one in driven],
        [one.path.places for one in driven],
        ways,
        title=f"{name}: closed paths, as published on simulated_base",
    )


def _page(
    robot: RollingRobot, client: DemoClient, task: DriveTask, driven: list[Driven], output: Path
) -> str:
    """Write the motion as a page, and say where; or why not."""
    times, turned, _ = client.recording()
    places = task.places
    times = times + client.began
    keep = (times >= max(driven[0].begin, places[0, 0])) & (times <= places[-1, 0])
    times, turned = times[keep], turned[keep]
    known = dict(zip(WheelJoints.of(robot.base).names, turned.T, strict=True))
    for name, column in zip(BASE_JOINTS, places.T[1:], strict=True):
        known[name] = np.interp(times, places[:, 0], column)
    description = rolling_description(robot.base)
    q = np.column_stack([known[name] for name in description.joint_names])
    choices = tuple(Choice(one.begin, one.path.name, "", ()) for one in driven)
    name = robot.base.name
    motion, title = Motion(description, times, q, choices), f"{name}: closed paths"
    return write_page(
        output / f"{name}.html",
        lambda path: write_motion(path, description, motion, title=title, trail="base_link"),
    )
