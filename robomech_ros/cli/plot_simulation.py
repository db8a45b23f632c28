"""``robomech plot-simulation``: the simulated motion of an arm over time."""

import argparse
from pathlib import Path
from typing import Any

import numpy as np

from robomech_ros.dynamics import inverse_dynamics, simulate
from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.plotting.simulations import plot_simulation
from robomech_ros.robots import SerialChain, load_description
from robomech_ros.robots.documents.numbers_in_text import number
from robomech_ros.trajectory.profiles.rest_to_rest import Polynomial4567
from robomech_ros.typing import Array

_ENDINGS = (".png", ".svg", ".pdf")
_SAMPLES = 401
# How fast the control of a motion to a goal takes differences away (rad/s).
_BANDWIDTH = 30.0


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("robot", help="name, or path of a URDF or YAML file")
    parser.add_argument("--base-link", default="", help="first link of the chain")
    parser.add_argument("--tip-link", default="", help="last link of the chain")
    joints: dict[str, Any] = {"nargs": "+", "type": number}
    parser.add_argument(
        "--joints", metavar="Q", help="positions at the start, rad or m (home)", **joints
    )
    parser.add_argument(
        "--velocities", metavar="V", help="rates at the start, rad/s or m/s (0)", **joints
    )
    drives = parser.add_mutually_exclusive_group()
    drives.add_argument(
        "--torques", metavar="TAU", help="constant drive torques, N m or N (0)", **joints
    )
    drives.add_argument(
        "--goal", metavar="Q", help="positions to move to by computed torque, rad or m", **joints
    )
    parser.add_argument("--duration", type=number, default=2.0, help="of the simulation, s (2)")
    parser.add_argument(
        "--gravity", nargs=3, type=number, default=(0.0, 0.0, -9.81), metavar=("X", "Y", "Z"),
        help="in the base, m/s^2 (0 0 -9.81)",
    )  # fmt: skip
    parser.add_argument("--title", help="figure title (default: robot name)")
    parser.add_argument(
        "--output", type=Path, default=Path("simulation.png"), help="png, svg or pdf"
    )


def run(args: argparse.Namespace) -> int:
    """Draw the picture; returns 0."""
    if args.output.suffix not in _ENDINGS:
        raise BadValueError("--output", str(args.output), "a file that ends with png, svg or pdf")
    chain = load_description(args.robot).chain(args.base_link or None, args.tip_link or None)
    start = chain.home() if args.joints is None else _values(args, "joints", chain)
    rates, constant = _values(args, "velocities", chain), _values(args, "torques", chain)
    motion = None
    if args.goal is not None:
        motion = Polynomial4567(start, _values(args, "goal", chain), args.duration)

    def torque(t: float, q: Array, qd: Array) -> Array:
        if motion is None:
            return constant
        at = motion.sample(t)
        back = _BANDWIDTH**2 * (at.position - q) + 2.0 * _BANDWIDTH * (at.velocity - qd)
        return inverse_dynamics(chain, q, qd, at.acceleration + back, gravity=args.gravity)

    times = np.linspace(0.0, max(args.duration, 0.0), _SAMPLES)
    found = simulate(chain, start, rates, torque, args.duration, gravity=args.gravity, times=times)
    torques = np.array([torque(*state) for state in zip(found.t, found.q, found.qd, strict=True)])
    title = chain.name if args.title is None else args.title
    path = plot_simulation(args.output, chain, found, torques, title=title)
    print(
        f"{path}: {found.t[-1]:.4g} s, {found.reason}; "
        f"largest torque {np.abs(torques).max():.4g}; work {found.work[-1]:.4g} J, "
        f"heat {found.heat[-1]:.4g} J, energy kept to {found.drift:.2g} J"
    )
    return 0


def _values(args: argparse.Namespace, option: str, chain: SerialChain) -> Array:
    """Return the numbers (n,) of an option, zeros without it."""
    given = getattr(args, option)
    if given is None:
        return np.zeros(chain.n)
    if len(given) != chain.n:
        names = ", ".join(chain.joint_names)
        raise WrongSizeError(f"--{option}", len(given), f"{chain.n}, one for each of {names}")
    return np.array(given)
