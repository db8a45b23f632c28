"""Ten foreign clients of move_group at once, while objects come and go; `make clients`.

Each client is a process of its own that plans and executes with MoveIt's services and actions.
Every goal must be answered, no node may end, no message about an object may be lost, and no state
that the robot publishes may touch an object that was announced early enough for braking.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent), str(HERE.parent / "soak"), str(HERE)]

from changer import Changer  # noqa: E402
from judge import judge  # noqa: E402
from memory import Usage  # noqa: E402
from moveit_msgs.srv import GetPlanningScene  # noqa: E402
from shaped_arm import shaped_ur5e  # noqa: E402

from robomech_ros.collision import PlanningScene  # noqa: E402
from robomech_ros.nodes.demonstration.client import DemoClient, running_client  # noqa: E402
from robomech_ros.nodes.demonstration.suite import DemoFailedError, Suite  # noqa: E402
from robomech_ros.nodes.process.launch_options import LaunchOptions  # noqa: E402
from robomech_ros.robots import SerialChain, load_description  # noqa: E402

# An object that is announced so long before (s) must be braked for: the node looks for changes
# every 0.1 s, the robot stops from full speed within 0.35 s, and messages take their time.
EARLY = 0.8
_SERVICES = {"get_planning_scene": GetPlanningScene}
_MIDDLE = np.array([-0.2, -1.2, 1.6, -1.9, -1.5708, 0.0])
_SPAN = np.array([1.0, 0.4, 0.5, 0.4, 0.5, 1.0])
_PATIENCE, _END = 60.0, 90.0


def main() -> int:
    """Run, report, and return 0 if nothing went wrong."""
    parser = argparse.ArgumentParser(prog="make clients", description=__doc__)
    parser.add_argument("--seconds", type=float, default=180.0, help="how long (180)")
    parser.add_argument("--clients", type=int, default=10, help="how many (10)")
    parser.add_argument("--seed", type=int, default=0, help="of the random numbers (0)")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        urdf = Path(folder) / "arm.urdf"
        urdf.write_text(shaped_ur5e(), encoding="utf-8")
        faults = run(urdf, arguments)
    for fault in faults[:20]:
        print(f"FAULT {fault[:500]}")
    print(f"{len(faults)} faults" if faults else "everything worked")
    return 1 if faults else 0


def run(urdf: Path, arguments: argparse.Namespace) -> list[str]:
    """Start the nodes and the clients, and tell what is wrong."""
    chain = load_description(str(urdf)).chain()
    commands = LaunchOptions(robot=str(urdf), servo=False, move_group=True).commands()
    try:
        with running_client(commands, chain.joint_names, chain.units) as (suite, client):
            client.wait_until_up(_SERVICES)
            return use(suite, client, chain, arguments)
    except DemoFailedError as error:
        return [str(error)]


def use(
    suite: Suite, client: DemoClient, chain: SerialChain, arguments: argparse.Namespace
) -> list[str]:
    """Let the clients work while objects change, and judge what the robot has published."""
    # Sent again until it is answered; by then the nodes know this process.
    client.ask("get_planning_scene", GetPlanningScene.Request())
    movers = [started(chain, arguments, number) for number in range(arguments.clients)]
    changer = Changer(client.node, np.random.default_rng(arguments.seed))
    began = time.monotonic()
    while any(one.poll() is None for one in movers):
        suite.check()
        if time.monotonic() > began + arguments.seconds + _END:
            break
        time.sleep(0.1)
    changer.timer.cancel()
    seconds = time.monotonic() - began
    faults = reported(movers)
    faults += lost(client, changer)
    for name, process in suite.group.processes.items():
        print(f"{name}: {Usage.of(process.pid)}")
    times, q, _ = client.recording()
    verdict = judge(PlanningScene(chain), times + client.began, q, changer.history, EARLY)
    moving = float(np.abs(np.diff(q, axis=0)).max(axis=1).astype(bool).mean())
    print(f"{changer.count} changes of objects in {seconds:.0f} s, {len(q)} states of the robot")
    print(f"it moved in {moving:.0%} of them")
    print(
        f"{verdict.checked} pairs of a state and an object that was announced {EARLY:g} s before: "
        f"{len(verdict.faults)} contacts, else at least {verdict.nearest * 1e3:.2f} mm"
    )
    print(
        f"{verdict.late} contacts with objects that were announced later, at most "
        f"{verdict.latest:.3f} s before"
    )
    return [*faults, *verdict.faults]


def started(
    chain: SerialChain, arguments: argparse.Namespace, number: int
) -> subprocess.Popen[str]:
    """Start a client."""
    given = {
        "seed": 1000 * arguments.seed + number,
        "seconds": arguments.seconds,
        "names": list(chain.joint_names),
        "middle": _MIDDLE.tolist(),
        "span": _SPAN.tolist(),
    }
    command = [sys.executable, str(HERE / "mover.py"), json.dumps(given)]
    return subprocess.Popen(command, stdout=subprocess.PIPE, text=True)


def reported(movers: list[subprocess.Popen[str]]) -> list[str]:
    """Print what became of all goals, and name those without an answer."""
    outcomes: Counter[str] = Counter()
    faults, longest = [], 0.0
    for number, one in enumerate(movers):
        if one.poll() is None:
            one.kill()
        text = one.communicate()[0]
        if one.returncode:
            faults.append(f"client {number} ended with exit code {one.returncode}")
            continue
        report: dict[str, Any] = json.loads(text.splitlines()[-1])
        outcomes.update(report["outcomes"])
        longest = max(longest, report["longest"])
        faults += [
            f"client {number}: {n} {what} unanswered" for what, n in report["unanswered"].items()
        ]
    print(f"{outcomes.total()} answers, the last after {longest:.1f} s:")
    print("\n".join(f"  {count:5d} {what}" for what, count in sorted(outcomes.items())))
    return faults


def lost(client: DemoClient, changer: Changer) -> list[str]:
    """Compare the objects of the node with those that were announced."""
    names: set[str] = set()

    def same() -> bool:
        nonlocal names
        scene = client.ask("get_planning_scene", GetPlanningScene.Request()).scene
        names = {one.id for one in scene.world.collision_objects}
        return names == changer.names

    if client.wait(same, _PATIENCE):
        return []
    return [f"the node has {sorted(names)}, announced were {sorted(changer.names)}"]


if __name__ == "__main__":
    raise SystemExit(main())
