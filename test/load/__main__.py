"""Load the installed suite: many calls of everything at once, and floods of messages; `make load`.

First each service is called, and each action given goals, by four processes at the same time: every
call must be answered. Then each topic that a node listens to is flooded with sensible messages,
with senseless ones, and with bytes that are none: all nodes must answer meanwhile and hold no more
memory afterwards. The robot must stay within its limits all the time, and execute a plan when it is
over.
"""

from __future__ import annotations

import argparse
import os
import re
import sys
import time
from pathlib import Path

import numpy as np
import rclpy
from rclpy.action import get_action_server_names_and_types_by_node
from rclpy.node import Node

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent / place) for place in ("fuzz", "", "nodes", "soak")] + [str(HERE)]

from caller import Burst  # noqa: E402
from clients import CLIENTS, Clients, client_processes  # noqa: E402
from flood import CONTENTS, Flood  # noqa: E402
from flooding import Asker, Flooding, flood_all, flooder, topics  # noqa: E402
from known_robot import known_arm  # noqa: E402
from robot_watch import Resets, Watch, why_it_does_not_move  # noqa: E402
from running_suite import NODES, RunningSuite, running_suite  # noqa: E402
from std_srvs.srv import Trigger  # noqa: E402
from valid import ValidMaker  # noqa: E402

from robomech_ros.nodes.process.run import Spinner  # noqa: E402
from robomech_ros.robots import load_robot  # noqa: E402

# What comes from rcl itself, with a queue of ten.
_OF_RCL = "/get_type_description"
# Names and their types.
Interfaces = list[tuple[str, str]]


def main() -> int:
    """Load the suite, report, and return 0 where nothing is wrong."""
    parser = argparse.ArgumentParser(prog="make load", description=__doc__)
    parser.add_argument("--count", type=int, default=1000, help="calls at once (1000)")
    parser.add_argument("--only", default="", help="regular expression: these services, topics")
    parser.add_argument("--seconds", type=float, default=10.0, help="of each flood (10)")
    parser.add_argument("--rate", type=float, default=1000.0, help="messages a second (1000)")
    parser.add_argument(
        "--most", type=float, default=20.0, help="growth by the same floods once more, in MB (20)"
    )
    parser.add_argument("--robot", default="puma560", help="which robot (puma560)")
    arguments = parser.parse_args()
    with running_suite(arguments.robot, log=os.environ.get("LOAD_LOG", os.devnull)) as suite:
        faults = load(suite, arguments)
    if suite.exit_code:
        faults.append(f"bringup ended with exit code {suite.exit_code}")
    for fault in faults[:50]:
        print(f"FAULT {fault[:500]}")
    return 1 if faults else 0


def load(suite: RunningSuite, arguments: argparse.Namespace) -> list[str]:
    """Load a running suite, and tell what is wrong."""
    rclpy.init(args=[])
    node = Node("loader")
    suite.wait_until_ready(node)
    chain = load_robot(arguments.robot)
    known = known_arm(chain)
    resets = Resets()
    watch, asker, spinner = Watch(node, known, resets), Asker(node), Spinner([node])
    spinner.start()
    faults: list[str] = []
    with client_processes(arguments.robot) as clients:
        called = [*services(node), *actions(node)]
        end_resets = resets.begin()
        faults += call_all(chosen(called, arguments), clients, asker, arguments.count)
        end_resets()
    with flooder(arguments.robot) as pipe:
        maker = ValidMaker(chain, np.random.default_rng(0))
        flooding = Flooding(suite, pipe, asker, maker)
        floods = [
            Flood(*topic, way, arguments.rate, arguments.seconds)
            for topic in chosen(topics(node), arguments)
            for way in CONTENTS
        ]
        faults += flood_all(floods, flooding, arguments.most)
    print(f"the robot moved at up to {watch.velocity:.3g} of its velocity limits")
    if suite.alive() and (why := why_it_does_not_move(asker, node, known)):
        faults.append(f"no motion is possible afterwards: {why}")
    if not suite.alive():
        faults.append("a node has ended")
    spinner.stop()
    node.destroy_node()
    rclpy.try_shutdown()
    return faults + [watch.fault] * bool(watch.fault)


def chosen(interfaces: Interfaces, arguments: argparse.Namespace) -> Interfaces:
    """Keep those that the regular expression of the command line finds."""
    return [entry for entry in interfaces if re.search(arguments.only, entry[0])]


def call_all(called: Interfaces, clients: Clients, asker: Asker, count: int) -> list[str]:
    """Call services and actions many times at once, print what came of it, and name faults."""
    print(f"{count} calls at once from {CLIENTS} processes: answered, of sent; codes; time")
    faults, total, began = [], Burst(), time.monotonic()
    for name, kind in called:
        # What is executed begins at home.
        for service in ("trajectory_publisher/cancel", "joint_trajectory_controller/reset"):
            asker(service, Trigger, Trigger.Request())
        burst = clients.call(name, kind, count)
        codes = ", ".join(f"{code}: {number}" for code, number in sorted(burst.codes.items()))
        print(f"{name}: {burst.answered} of {burst.sent} ({codes}) {burst.seconds:.2f} s")
        sys.stdout.flush()
        if burst.answered < burst.sent:
            faults.append(f"{name}: {burst.sent - burst.answered} not answered")
        faults += [f"{name}: {fault}" for fault in sorted(burst.faults)]
        total.add(burst)
    seconds = time.monotonic() - began
    print(f"{total.answered} of {total.sent} calls answered, in {seconds:.0f} s")
    return faults


def services(node: Node) -> Interfaces:
    """Name all services of all nodes, with their types."""
    return [
        (name, kinds[0])
        for owner in NODES
        for name, kinds in node.get_service_names_and_types_by_node(owner, node.get_namespace())
        if "/_action/" not in name and not name.endswith(_OF_RCL)
    ]


def actions(node: Node) -> Interfaces:
    """Name all actions of all nodes, with their types."""
    own = node.get_namespace()
    return [
        (name, kinds[0])
        for owner in NODES
        for name, kinds in get_action_server_names_and_types_by_node(node, owner, own)
    ]


if __name__ == "__main__":
    raise SystemExit(main())
