"""``robomech robots``: the robots known by name."""

import argparse
from collections.abc import Iterable
from textwrap import shorten

from rich.console import Console
from rich.markup import escape
from rich.table import Table

from robomech_ros.errors import RobomechError
from robomech_ros.hands import load_hand
from robomech_ros.kinematics.inverse.families.selection import family_of
from robomech_ros.parallel import load_tree_description
from robomech_ros.robots import PRISMATIC, list_robots, load_description
from robomech_ros.robots.robot_kinds import names_of
from robomech_ros.rolling import rolling_robot
from robomech_ros.walking import load_legged

_SHORT = 100


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("--full", action="store_true", help="do not shorten the sources")


def run(args: argparse.Namespace) -> int:
    """Print the table; returns 0, or 1 if a robot cannot be loaded."""
    # Never narrower than what a pipe's reader can use.
    console = Console()
    console = Console(width=None if console.is_terminal else 160)
    table = Table("name", "joints", "inverse kinematics", "source")
    code = 0
    rows = [(name, _arm) for name in list_robots()]
    rows += [(name, facts) for kind, facts in _FACTS.items() for name in names_of(kind)]
    for name, facts in rows:
        try:
            joints, family, source = facts(name)
            shown = source if args.full else shorten(source, _SHORT, placeholder=" ...")
            table.add_row(name, joints, family, shown)
        except RobomechError as error:
            table.add_row(name, "", "", f"cannot be loaded: {error}")
            code = 1
    console.print(table)
    return code


def _arm(name: str) -> tuple[str, str, str]:
    """Return the joints, the solver and the source of an arm."""
    description = load_description(name)
    chain = description.chain()
    return _letters(chain.types), family_of(chain).name, description.source or "none given"


def _parallel(name: str) -> tuple[str, str, str]:
    """Return limbs, family and source of a parallel robot; the drives are in brackets."""
    robot = load_tree_description(name)
    mechanism = robot.mechanism
    assert mechanism is not None
    limb = mechanism.limbs[0]
    letters = [
        f"[{letter}]" if joint in limb.actuated else letter
        for joint, letter in zip(limb.chain.joint_names, _letters(limb.chain.types), strict=True)
    ]
    joints = escape(f"{len(mechanism.limbs)} x {''.join(letters)}")
    return joints, "parallel", robot.description.source


def _rolling(name: str) -> tuple[str, str, str]:
    """Return the wheels, the drive and the source of a rolling robot."""
    robot = rolling_robot(name)
    base = robot.base
    wheels = f"{len(base.wheels)} wheels"
    if base.steered:
        wheels += f", {len(base.steered)} steered"
    return wheels, f"rolling: {robot.drive}", robot.source


def _hand(name: str) -> tuple[str, str, str]:
    hand = load_hand(name)
    limbs = [_letters(finger.types) for finger in hand.fingers]
    kinds = (f"{limbs.count(one)} x {one}" for one in dict.fromkeys(limbs))
    return ", ".join(kinds), "hand: by finger", hand.source


def _walking(name: str) -> tuple[str, str, str]:
    """Return the legs and the source of a walking machine."""
    robot = load_legged(name)
    return f"{len(robot.legs)} legs x {_letters(robot.legs[0].types)}", "walking", robot.source


def _letters(types: Iterable[int]) -> str:
    return "".join("P" if kind == PRISMATIC else "R" for kind in types)


# Facts of robots that are not arms, by their kind in ``robomech_ros.robots.robot_kinds.KINDS``.
_FACTS = {"parallel": _parallel, "rolling": _rolling, "hand": _hand, "walking": _walking}
