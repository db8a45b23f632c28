"""``robomech calibrate-demo``: find a simulated camera with a simulated robot."""

import argparse
import math
from pathlib import Path

from robomech_ros.errors import BadValueError
from robomech_ros.nodes.commands.demo import run_demonstration
from robomech_ros.robots import load_robot
from robomech_ros.robots.documents.numbers_in_text import integer, number

_TYPES = ("eye_in_hand", "eye_on_base")
# A wrong sample is told by the others from eight on, where one of them is wrong.
_LEAST_SAMPLES, _MOST_SAMPLES = 8, 40
_MOST_NOISE = 0.05


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("--robot", default="ur5e", help="name or path of a robot (ur5e)")
    parser.add_argument(
        "--type",
        default=_TYPES[0],
        choices=_TYPES,
        help="camera mount: on the hand, or fixed with a target on the hand (eye_in_hand)",
    )
    parser.add_argument(
        "--samples", type=integer, default=12, help="number of samples, one of which is wrong (12)"
    )
    for part, default, unit in (("rotation", 2e-3, "rad"), ("position", 5e-4, "m")):
        text = f"standard deviation of each {part} coordinate of the camera, {unit} ({default:g})"
        parser.add_argument(f"--{part}-noise", type=number, default=default, help=text)
    parser.add_argument(
        "--output",
        type=Path,
        default=Path("demo_output"),
        help="folder for the plot and the calibration files (demo_output)",
    )


def run(args: argparse.Namespace) -> int:
    """Run the demonstration; returns 0 if every step of it succeeded, else 1."""
    if not _LEAST_SAMPLES <= args.samples <= _MOST_SAMPLES:
        raise BadValueError("--samples", args.samples, f"{_LEAST_SAMPLES} to {_MOST_SAMPLES}")
    noise = args.rotation_noise, args.position_noise
    for option, value in zip(("--rotation-noise", "--position-noise"), noise, strict=True):
        if not (math.isfinite(value) and 0.0 <= value <= _MOST_NOISE):
            raise BadValueError(option, value, f"0 to {_MOST_NOISE:g}")
    load_robot(args.robot)

    def demonstration() -> None:
        from robomech_ros.nodes.demonstration import calibration_session as session

        session.demonstrate_calibration(args.robot, args.type, args.samples, noise, args.output)

    return run_demonstration("calibrate-demo", args.robot, "calibration", demonstration)
