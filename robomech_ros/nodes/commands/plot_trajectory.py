"""``robomech plot-trajectory``: a planned trajectory over time, from a topic or a file."""

import argparse
import sys
from pathlib import Path

import numpy as np

from robomech_ros.errors import BadValueError, UnknownJointError
from robomech_ros.errors.formatting import counted
from robomech_ros.nodes.commands.call import EXIT_NO_ANSWER, seconds_to_wait
from robomech_ros.plotting.joint_motions import plot_motion
from robomech_ros.robots import load_description
from robomech_ros.robots.description import RobotDescription
from robomech_ros.trajectory import Waypoints
from robomech_ros.typing import Array

_TOPIC = "trajectory_planner/planned_trajectory"
# Instants at which curves are drawn, beside the points of the trajectory.
_INSTANTS = 3000
_ENDINGS = (".png", ".svg", ".pdf")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument(
        "file",
        nargs="?",
        type=Path,
        help="YAML of a JointTrajectory, or of a response that contains one; default: the topic",
    )
    parser.add_argument("--topic", default=_TOPIC, help=f"latched topic to take it from ({_TOPIC})")
    parser.add_argument(
        "--timeout", type=seconds_to_wait, default=10.0, help="seconds to wait for the topic (10)"
    )
    parser.add_argument(
        "--robot", default="", help="name, or path of a URDF or YAML file, whose limits are drawn"
    )
    parser.add_argument("--joint-limits", default="", help="YAML file with missing limits")
    parser.add_argument("--title", default="", help="figure title")
    parser.add_argument(
        "--output", type=Path, default=Path("trajectory.png"), help="png, svg or pdf"
    )


def run(args: argparse.Namespace) -> int:
    """Draw the picture; returns 0, or 3 where no trajectory came."""
    from robomech_ros.nodes.commands.trajectory_source import from_file, from_topic, waypoints_of
    from robomech_ros.nodes.common.joints.joint_limits import read_joint_limits

    if args.output.suffix not in _ENDINGS:
        raise BadValueError("--output", str(args.output), "a file that ends with png, svg or pdf")
    if args.joint_limits and not args.robot:
        raise BadValueError("--joint-limits", args.joint_limits, "a robot as well: --robot")
    robot = load_description(args.robot) if args.robot else None
    if robot is not None and args.joint_limits:
        robot = read_joint_limits(args.joint_limits).on(robot)
    message = from_file(args.file) if args.file else from_topic(args.topic, args.timeout)
    if message is None:
        text = f"nothing came on topic '{args.topic}' within {args.timeout:g} s"
        print(f"robomech plot-trajectory: {text}; has a plan been made?", file=sys.stderr)
        return EXIT_NO_ANSWER
    names = list(message.joint_names)
    points = waypoints_of(message)
    times, curves = _curves(points)
    limits, prismatic = _of_robot(robot, names) if robot is not None else ([], None)
    path = plot_motion(
        args.output,
        names,
        times,
        curves,
        title=args.title,
        prismatic=prismatic,
        limits=limits[: len(curves)],
    )
    count = counted(len(names), "joint")
    print(f"{path}: {count}, {counted(len(points.times), 'point')}, {points.times[-1]:g} s")
    return 0


def _curves(points: Waypoints) -> tuple[Array, list[Array]]:
    """Sample what a controller makes of the points; without velocities, no more than these."""
    curve = points.curve
    first, last = points.times[[0, -1]]
    times = np.union1d(points.times, np.linspace(first, last, _INSTANTS))
    sample = curve.sample(times)
    count = 4 if len(curve.coefficients) > 2 else 2
    return times, [np.asarray(values) for values in sample[:count]]


def _of_robot(
    robot: RobotDescription, names: list[str]
) -> tuple[list[tuple[Array, Array]], list[bool]]:
    """Find the limits of positions and of three rates, and which joints slide."""
    known = {joint.name: joint for joint in robot.joints if joint.moves}
    for name in names:
        if name not in known:
            raise UnknownJointError(name, list(known))
    joints = [known[name] for name in names]
    rates = [
        np.array([getattr(joint, rate) for joint in joints], dtype=float)
        for rate in ("velocity", "acceleration", "jerk")
    ]
    ranges = [np.array([getattr(joint, side) for joint in joints]) for side in ("lower", "upper")]
    limits = [(ranges[0], ranges[1]), *((-rate, rate) for rate in rates)]
    return limits, [joint.type == "prismatic" for joint in joints]
