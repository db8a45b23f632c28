"""``robomech plot``: a picture of all postures in which an arm takes a pose."""

import argparse
import math
import sys
from pathlib import Path

from robomech_ros.errors import BadValueError, SeedOutsideLimitsError
from robomech_ros.errors.formatting import counted
from robomech_ros.kinematics import forward_kinematics, inverse_kinematics
from robomech_ros.plotting.postures import plot_postures
from robomech_ros.robots import SerialChain, load_description, load_semantics, main_chain
from robomech_ros.robots.documents.numbers_in_text import number
from robomech_ros.spatial import pose_from_position_quaternion

EXIT_NONE = 1


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("robot", help="name, or path of a URDF or YAML file")
    parser.add_argument("--base-link", default="", help="first link of the chain")
    parser.add_argument("--tip-link", default="", help="last link of the chain")
    parser.add_argument("--srdf", default="", help="SRDF with groups and named states")
    parser.add_argument("--group", default="", help="group of the SRDF to draw")
    pose = parser.add_mutually_exclusive_group(required=True)
    names = ("X", "Y", "Z", "QX", "QY", "QZ", "QW")
    pose.add_argument(
        "--pose", nargs=7, type=number, metavar=names, help="pose of the tip in the base, m"
    )
    pose.add_argument(
        "--joints", nargs="+", type=number, metavar="Q", help="joint positions, rad or m"
    )
    pose.add_argument("--posture", help="named posture that defines the pose, such as home")
    parser.add_argument("--ignore-limits", action="store_true", help="also beyond joint limits")
    parser.add_argument("--title", help="figure title (default: robot name)")
    eye = "camera direction as seen from the base, degrees"
    parser.add_argument("--azimuth", type=number, default=-60.0, help=f"{eye} (-60)")
    parser.add_argument("--elevation", type=number, default=25.0, help=f"{eye} (25)")
    parser.add_argument("--output", type=Path, default=Path("postures.png"), help="png, svg or pdf")


def run(args: argparse.Namespace) -> int:
    """Draw the picture; returns 0, or 1 where no posture takes the pose."""
    for name in ("azimuth", "elevation"):
        if not math.isfinite(getattr(args, name)):
            raise BadValueError(f"--{name}", getattr(args, name), "a finite angle in degrees")
    if args.output.suffix not in (".png", ".svg", ".pdf"):
        raise BadValueError("--output", str(args.output), "a file that ends with png, svg or pdf")
    description = load_description(args.robot)
    known = load_semantics(description, args.srdf)
    chain = main_chain(description, known, args.base_link, args.tip_link, args.group)
    if args.posture is not None:
        T = forward_kinematics(chain, known.posture(chain, args.posture))
    elif args.joints:
        T = forward_kinematics(chain, args.joints)
        _warn_of_limits(chain, args.joints)
    else:
        T = pose_from_position_quaternion(args.pose[:3], args.pose[3:])
    result = inverse_kinematics(chain, T, respect_limits=not args.ignore_limits)
    if not len(result):
        print(f"robomech plot: {result.reason}", file=sys.stderr)
        return EXIT_NONE
    title = chain.name if args.title is None else args.title
    angles = {"azimuth": math.radians(args.azimuth), "elevation": math.radians(args.elevation)}
    path = plot_postures(args.output, chain, result.q, title=title, **angles)
    more = "these are all" if result.complete else "there may be more"
    print(f"{path}: {counted(len(result), 'posture')}; {more}")
    return 0


def _warn_of_limits(chain: SerialChain, q: list[float]) -> None:
    """Name joints beyond their limits: the posture itself is not among those that are drawn."""
    for name, value, lower, upper in zip(
        chain.joint_names, q, chain.lower, chain.upper, strict=True
    ):
        if not lower <= value <= upper:
            outside = SeedOutsideLimitsError(name, value, lower, upper, "--joints")
            print(f"robomech plot: warning: {outside}", file=sys.stderr)
