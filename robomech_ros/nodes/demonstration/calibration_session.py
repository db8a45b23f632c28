"""One run of `robomech calibrate-demo`, from the start of the nodes to the picture."""

import json
from importlib.util import find_spec
from pathlib import Path

import numpy as np

from robomech_interfaces.srv import ListSamples, SaveCalibration
from robomech_ros.calibration import hand_eye
from robomech_ros.nodes.calibration.settings import MOUNT_OF_TYPE
from robomech_ros.nodes.common.messages.pose_messages import matrix_from_pose
from robomech_ros.nodes.demonstration.calibration_task import SERVICES, CalibrationTask
from robomech_ros.nodes.demonstration.camera import (
    CAMERA,
    HAND_TOPIC,
    MARKER,
    MARKER_TOPIC,
    SimulatedCamera,
    scene_of,
)
from robomech_ros.nodes.demonstration.client import DemoClient, running_client
from robomech_ros.nodes.demonstration.postures import chain_with_limits, pick_and_place
from robomech_ros.nodes.demonstration.report import Reporter, write_page
from robomech_ros.nodes.process.launch_options import LaunchOptions
from robomech_ros.plotting.calibrations import plot_calibration
from robomech_ros.robots import SerialChain, load_description
from robomech_ros.rvs import write_calibration


def demonstrate_calibration(
    robot: str, calibration_type: str, samples: int, noise: tuple[float, float], output: Path
) -> None:
    """Find a simulated camera with a simulated robot, and tell how near the truth that is.

    - ``calibration_type``: ``"eye_in_hand"`` or ``"eye_on_base"``.
    - ``noise``: deviation of each coordinate of the camera's rotations (rad) and positions (m).
    - ``output``: folder for the picture and the files of the calibration.
    """
    reporter = Reporter()
    which = LaunchOptions(robot, servo=False, calibration=True)
    chain = chain_with_limits(which, reporter.say)
    output = output.resolve()
    mount = MOUNT_OF_TYPE[calibration_type]
    reporter.heading(f"{chain.name}: where is the camera? ({mount})")
    on_tf = find_spec("tf2_msgs") is not None
    commands = _commands(which, calibration_type, output, on_tf)
    with running_client(commands, chain.joint_names, chain.units) as (suite, client):
        client.wait_until_up(SERVICES)
        reporter.up(suite)
        reporter.say(
            f"the camera's noise: {noise[1] * 1e3:g} mm and {noise[0] * 1e3:g} "
            f"mrad in each coordinate; it speaks {'on /tf' if on_tf else 'on topics'}, and "
            "once takes the target for one that is turned by 90 degrees"
        )
        start, _ = pick_and_place(chain)
        scene = scene_of(chain, start, mount == "eye-in-hand")
        camera = SimulatedCamera(client, chain, scene, noise, on_tf)
        task = CalibrationTask(client, chain, camera, scene, reporter)
        task.run(start, samples)
        _report(client, task, chain, reporter, output)
        reporter.finish(_page(client, robot, chain, mount, output))


def _commands(
    which: LaunchOptions, calibration_type: str, output: Path, on_tf: bool
) -> dict[str, list[str]]:
    commands = which.commands()
    parameters = {
        "calibration_type": calibration_type,
        "tracking_base_frame": CAMERA,
        "tracking_marker_frame": MARKER,
        "name": "calibration",
        "folder": str(output),
    }
    if not on_tf:
        parameters |= {"robot_topic": HAND_TOPIC, "tracking_topic": MARKER_TOPIC}
    for name, value in parameters.items():
        commands["calibration"] += ["-p", f"{name}:={json.dumps(value)}"]
    return commands


def _report(
    client: DemoClient, task: CalibrationTask, chain: SerialChain, reporter: Reporter, output: Path
) -> None:
    """Print what was found, save and draw it."""
    last, answer = task.progress[-1], task.answer
    reporter.heading("summary")
    reporter.say(answer.summary)
    reporter.say("covariance of x y z, then of rotations about x y z (mm and mrad, squared):")
    for row in 1e6 * np.reshape(answer.covariance, (6, 6)):
        reporter.say(" ".join(f"{value:9.4f}" for value in row))
    distance = float(np.sqrt(last.squared_distance))
    reporter.say(
        f"the truth is {distance:.2f} deviations from the result; 95 of 100 calibrations are "
        "within 3.55"
    )
    for path in client.call("calibration/save", SaveCalibration.Request(name=chain.name)).files:
        reporter.say(f"saved: {path}")
    picture = plot_calibration(
        output / f"{chain.name}_calibration.png",
        [step.count for step in task.progress],
        np.array([step.error for step in task.progress]),
        np.array([step.covariance for step in task.progress]),
        residuals=np.column_stack((answer.rotation_residuals, answer.position_residuals)),
        inlier=np.array(answer.inlier),
        title=f"{chain.name}: a camera found with noise, and with one wrong sample",
    )
    reporter.say(f"plot: {picture}")


def _page(client: DemoClient, robot: str, chain: SerialChain, mount: str, output: Path) -> str:
    listed = client.call("calibration/list_samples", ListSamples.Request())
    hand, tracking = (
        np.array([matrix_from_pose(pose) for pose in poses.poses])
        for poses in (listed.robot, listed.tracking)
    )
    result, title = hand_eye(hand, tracking, mount=mount), f"{chain.name}: where is the camera?"
    description = load_description(robot)
    return write_page(
        output / f"{chain.name}_calibration.html",
        lambda path: write_calibration(path, description, chain, result, tracking, title=title),
    )
