"""Attack the installed suite with random requests, goals, messages and bytes; `make fuzz`.

Robots may be of any kind.  Every request must be answered, never with 900, no node may log a defect
of its own, and what succeeds must have finite numbers where the interface allows no others; so must
all that is published.  A request is unanswered a minute after the last answer; only the time in
which this process looks for answers counts.  The robot must obey its limits of position and
velocity all the time, whatever faults its simulated joints get, and may jump only home, while
a reset is asked for.  Loops stay closed.  The robot must execute a plan when all is over.  One on
wheels or legs must not move by spoilt commands before, and must follow a twist when it is over.
"""

from __future__ import annotations

import argparse
import os
import sys
import time
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import rclpy
from rclpy.node import Node

from robomech_ros.nodes.process.run import Spinner

# Defects in the log that are shown, and how much of each.
_MOST, _SHOWN = 5, 3000
HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent), str(HERE.parent / "nodes")]

from attack import WITH_FAULTS, Attack, Outcome  # noqa: E402
from known_robot import KnownRobot, known_robot  # noqa: E402
from messages import MessageMaker  # noqa: E402
from outputs import OutputWatch, commands_of, why_it_does_not_drive, why_it_moved  # noqa: E402
from robot_watch import Watch, why_it_does_not_move  # noqa: E402
from running_suite import RunningSuite, running_suite  # noqa: E402


def report(outcome: Outcome, seconds: float) -> None:
    """Print what came of it."""
    for service, codes in sorted(outcome.codes.items()):
        counts = ", ".join(f"{code}: {count}" for code, count in sorted(codes.items()))
        print(f"{service}: {codes.total()} ({counts})")
    print(
        f"{outcome.answered} requests answered, {outcome.unanswered.total()} not, "
        f"{outcome.messages} messages, {outcome.raw} byte strings, in {seconds:.0f} s"
    )
    for service, count in outcome.unanswered.items():
        print(f"UNANSWERED {service}: {count}")
    for fault in outcome.faults[:20]:
        print(f"FAULT {fault[:500]}")


def main() -> int:
    """Attack, report, and return 0 where nothing is wrong."""
    parser = argparse.ArgumentParser(prog="make fuzz", description=__doc__)
    parser.add_argument("--count", type=int, default=100_000, help="things sent (100000)")
    parser.add_argument("--seed", type=int, default=0, help="of the random numbers (0)")
    parser.add_argument("--robot", default="puma560", help="which robot (puma560)")
    arguments = parser.parse_args()
    with TemporaryDirectory() as folder:
        log = Path(os.environ.get("FUZZ_LOG", f"{folder}/log"))
        with running_suite(arguments.robot, log=str(log)) as suite:
            robot = known_robot(arguments.robot)
            faults = attack_suite(suite, robot, arguments.count, arguments.seed)
        defects = defects_in(log.read_text(encoding="utf-8", errors="replace"))
    for defect in defects:
        print(f"FAULT in the log: {defect}")
    if suite.exit_code:
        print(f"FAULT bringup ended with exit code {suite.exit_code}")
    return 1 if faults or defects or suite.exit_code else 0


def defects_in(log: str) -> list[str]:
    """Return the first few defects that nodes report of themselves, each with its traceback."""
    parts = log.split("please report")[1:]
    return [part[:_SHOWN] for part in parts[:_MOST]]


def attack_suite(suite: RunningSuite, robot: KnownRobot, count: int, seed: int) -> bool:
    """Attack a running suite; says whether something was wrong."""
    rng = np.random.default_rng(seed)
    rclpy.init(args=[])
    node = Node("attacker")
    suite.wait_until_ready(node)
    maker = MessageMaker(rng, robot)
    attack = Attack(node, list(suite.nodes), maker, rng, suite.alive, WITH_FAULTS)
    # Those who watch have a thread of their own: messages and answers must not delay one another.
    watcher = Node("watcher")
    watch = Watch(watcher, robot, attack.resets)
    outputs = OutputWatch(watcher, suite.nodes, node.get_name())
    spinner = Spinner([watcher])
    spinner.start()
    faults, goes = attack.outcome.faults, {"walker", "mobile_base"} & set(suite.nodes)
    began = time.monotonic()
    commands = commands_of(attack.topics)
    if goes and (why := why_it_moved(commands, maker, outputs, attack.spin_once)):
        faults.append(why)
    attack.run(count)
    attack.mend()
    why = ""
    if suite.alive() and goes:
        why = why_it_does_not_drive(attack.topics, outputs, attack.spin_once)
    elif suite.alive() and "trajectory_planner" in suite.nodes:
        why = why_it_does_not_move(attack.call, node, robot, "servo" in suite.nodes)
    spinner.stop()
    watcher.destroy_node()
    faults += outputs.faults + [one for one in (watch.fault, why) if one]
    report(attack.outcome, time.monotonic() - began)
    print(f"{outputs.seen} published messages looked at, of {len(outputs.latest)} topics")
    print(
        f"{watch.seen} joint states, {watch.wrong} of them wrong, at up to {watch.velocity:.6g} "
        "of the velocity limits"
    )
    node.destroy_node()
    rclpy.try_shutdown()
    return bool(attack.outcome.faults or attack.outcome.unanswered)


if __name__ == "__main__":
    raise SystemExit(main())
