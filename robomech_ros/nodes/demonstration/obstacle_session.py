"""One run of the demonstration with obstacles, from the start of the nodes to the plot."""

from dataclasses import replace
from pathlib import Path

from robomech_ros.collision import PlanningScene
from robomech_ros.nodes.demonstration.client import running_client
from robomech_ros.nodes.demonstration.obstacle_cell import PADS, arrange_cell, robot_with_bodies
from robomech_ros.nodes.demonstration.obstacle_task import CLEARANCE, SERVICES, CarryAround
from robomech_ros.nodes.demonstration.pick_and_place import DemoArm
from robomech_ros.nodes.demonstration.postures import chain_with_limits
from robomech_ros.nodes.demonstration.report import Reporter
from robomech_ros.nodes.demonstration.session import plot_recording
from robomech_ros.nodes.process.launch_options import LaunchOptions

# Nodes of bringup that this demonstration starts.
_NODES = ("joint_trajectory_controller", "trajectory_planner", "move_group")


def demonstrate_obstacles(which: LaunchOptions, output: Path) -> None:
    """Carry a part around a wall, and prove that nothing touched anything.

    - ``output``: folder for the plot, and for the URDF of a robot without collision geometry.
    """
    reporter = Reporter()
    files = robot_with_bodies(which.robot, which.srdf, output, CLEARANCE)
    which = replace(which, robot=files.robot, srdf=files.srdf)
    chain = chain_with_limits(which, reporter.say)
    arm = DemoArm(chain)
    reporter.heading(arm.title)
    if files.notice:
        reporter.say(files.notice)
    scene = PlanningScene(chain, srdf=which.srdf or None)
    for link, why in scene.unchecked.items():
        reporter.say(f"link '{link}' is not checked: {why}")
    cell = arrange_cell(scene, chain.home(), CLEARANCE)
    options = replace(which, move_group=True, ros_args=("-p", f"clearance:={CLEARANCE}"))
    commands = {name: words for name, words in options.commands().items() if name in _NODES}
    with running_client(commands, arm.joint_names, arm.units) as (suite, client):
        client.wait_until_up(SERVICES)
        reporter.up(suite)
        reporter.say(
            f"the part is held {cell.gripper * 1e3:.0f} mm from '{chain.tip}', and stands on pads "
            f"of {PADS * 1e3:g} mm"
        )
        task = CarryAround(client, scene, cell, reporter)
        task.run()
        reporter.heading("summary")
        for leg in task.legs:
            first, second = leg.nearest.bodies
            reporter.say(
                f"{leg.name}: {leg.duration:.2f} s, {leg.states} published states, least distance "
                f"{leg.nearest.distance * 1e3:.2f} mm ('{first}' and '{second}')"
            )
        recording = client.recording()
    plot = plot_recording(arm, task.marks, recording, output, "pick and place around a wall")
    reporter.finish(f"plot: {plot}")
