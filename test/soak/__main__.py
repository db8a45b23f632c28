"""Use the suite for half an hour, and see what each node holds; `make soak`.

Requests to all services, plans, executions, cancellations and servo streams, from clients that come
and go.  Every request must be answered.  What a node holds after the first two minutes is what it
needs; at the end it may hold 2 MB more, and neither files nor threads.
"""

from __future__ import annotations

import argparse
import os
import sys
import time
from pathlib import Path

import rclpy
from rclpy.node import Node

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent / place) for place in ("fuzz", "", "nodes")] + [str(HERE)]

from load import Load  # noqa: E402
from memory import Usage  # noqa: E402
from running_suite import NODES, RunningSuite, running_suite  # noqa: E402

from robomech_ros.nodes.process.memory import PERIOD  # noqa: E402
from robomech_ros.robots import load_robot  # noqa: E402

_MINUTE = 60.0
# How often the load rests and the nodes are looked at, s, and how long nobody asks them anything
# before: clients that were killed are gone then, and memory has been given back.
_BETWEEN, _REST = 240.0, max(1.5 * PERIOD, 25.0)


def main() -> int:
    """Soak, report, and return 0 where nothing grows."""
    parser = argparse.ArgumentParser(prog="make soak", description=__doc__)
    parser.add_argument("--minutes", type=float, default=30.0, help="how long (30)")
    parser.add_argument(
        "--first", type=float, default=2.0, help="minutes in which nodes may still grow (2)"
    )
    parser.add_argument(
        "--rounds",
        type=int,
        default=8,
        help="and rounds at the least, which a slow machine needs to have asked for everything (8)",
    )
    parser.add_argument("--most", type=float, default=2.0, help="growth after them, in MB (2)")
    parser.add_argument("--seed", type=int, default=0, help="of the random numbers (0)")
    parser.add_argument("--robot", default="puma560", help="which robot (puma560)")
    parser.add_argument(
        "--wild", action="store_true", help="messages as hostile as those of make fuzz"
    )
    arguments = parser.parse_args()
    with running_suite(arguments.robot, log=os.environ.get("SOAK_LOG", os.devnull)) as suite:
        faults = soak(suite, arguments)
    if suite.exit_code:
        faults.append(f"bringup ended with exit code {suite.exit_code}")
    for fault in faults:
        print(f"FAULT {fault[:500]}")
    return 1 if faults else 0


def soak(suite: RunningSuite, arguments: argparse.Namespace) -> list[str]:
    """Use a running suite, and tell what is wrong."""
    rclpy.init(args=[])
    node = Node("soaker")
    suite.wait_until_ready(node)
    chain, options = load_robot(arguments.robot), {"wild": arguments.wild}
    load = Load(node, list(NODES), chain, arguments.seed, suite.alive, **options)
    began = time.monotonic()
    load.touch_everything()
    before = use(load, suite, began, arguments.first, arguments.rounds)
    after = use(load, suite, began, arguments.minutes, load.rounds + 1)
    report(load, before, after, time.monotonic() - began)
    node.destroy_node()
    rclpy.try_shutdown()
    silent = [f"{name} left {n} unanswered" for name, n in load.attack.outcome.unanswered.items()]
    return [*load.attack.outcome.faults, *silent, *grown(before, after, arguments.most)]


def use(
    load: Load, suite: RunningSuite, began: float, minutes: float, rounds: int
) -> dict[str, Usage]:
    """Work until so long after the beginning, and so many rounds, and give what the nodes hold."""
    held: dict[str, Usage] = {}
    until = began + minutes * _MINUTE

    def goes_on() -> bool:
        return suite.alive() and (time.monotonic() < until or load.rounds < rounds)

    while goes_on():
        look = time.monotonic() + _BETWEEN
        while goes_on() and time.monotonic() < look:
            load.round()
        held = looks(suite)
        own = ", ".join(f"{name} {usage.own:.1f}" for name, usage in held.items())
        minute = (time.monotonic() - began) / _MINUTE
        print(f"{minute:5.1f} min, {load.rounds} rounds, MB: {own}", flush=True)
    return held


def looks(suite: RunningSuite) -> dict[str, Usage]:
    """Look at every node, after it has given back what it does not need."""
    time.sleep(_REST)
    there = suite.processes() if suite.alive() else {}
    return {name: Usage.of(process) for name, process in there.items()}


def grown(before: dict[str, Usage], after: dict[str, Usage], most: float) -> list[str]:
    """Name what holds more than it may."""
    found = []
    for name in before.keys() - after.keys():
        found.append(f"{name} has ended")
    for name, usage in after.items():
        growth = usage.own - before[name].own
        if growth > most:
            found.append(f"{name} holds {growth:.1f} MB more, above {most:g} MB")
        if usage.files > before[name].files:
            found.append(f"{name} has {usage.files} open files, before {before[name].files}")
        if usage.threads > before[name].threads:
            found.append(f"{name} has {usage.threads} threads, before {before[name].threads}")
    return found


def report(load: Load, before: dict[str, Usage], after: dict[str, Usage], seconds: float) -> None:
    """Print what was done, and what the nodes held before and after it."""
    outcome = load.attack.outcome
    print(
        f"{outcome.answered + load.counts['calls']} requests answered, "
        f"{outcome.unanswered.total()} not, {outcome.messages} messages, {outcome.raw} byte "
        f"strings, in {seconds:.0f} s"
    )
    print(", ".join(f"{count} {what}" for what, count in sorted(load.counts.items())))
    for name, usage in after.items():
        print(f"{name}:\n  before {before[name]}\n  after  {usage}")
        print(f"  grown by {usage.own - before[name].own:.2f} MB")


if __name__ == "__main__":
    raise SystemExit(main())
