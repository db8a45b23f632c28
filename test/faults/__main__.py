"""Have faults happen to every node in the midst of motions and requests; `make faults`.

The suite runs as processes of its own, the simulated robot at 500 Hz. What becomes of a motion or
a request reaches its caller in time; no two neighbouring joint states are farther apart than the
limits of velocity and acceleration allow; and the next motion works. The table says what came of
each fault.
"""

from __future__ import annotations

import argparse
import os
import re
import sys
from collections.abc import Iterator
from itertools import groupby
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), *(str(HERE.parent / name) for name in ("installed", "nodes/motion"))]

from bench import bench  # noqa: E402
from cases import ALL_NODES, Case, cases, judge  # noqa: E402
from session import Finding  # noqa: E402

from robomech_ros.nodes.process.discovery_range import stay_on_this_machine  # noqa: E402

_HEAD = (
    "| node | fault | caller | heard | after | velocity | acceleration | next motion |\n"
    "|---|---|---|---|---|---|---|---|"
)


def main() -> int:
    """Have the faults happen, print the table, and return 0 where nothing is wrong."""
    parser = argparse.ArgumentParser(prog="make faults", description=__doc__)
    parser.add_argument(
        "--robot", default="puma560", help="which robot (puma560), but for the gripper"
    )
    parser.add_argument("--only", default="", help="cases whose line has this regular expression")
    parser.add_argument(
        "--slack", type=float, default=1.0, help="how many times as long reasons may take (1)"
    )
    parser.add_argument("--list", action="store_true", help="name the cases and end")
    arguments = parser.parse_args()
    chosen = [case for case in cases() if re.search(arguments.only, case.name)]
    if arguments.list:
        print("\n".join(case.name for case in chosen))
        return 0
    stay_on_this_machine()
    print(_HEAD, flush=True)
    wrong = []
    for case, finding, why in findings(chosen, arguments.robot, arguments.slack):
        if finding is not None:
            print(row(case, finding), flush=True)
        if why:
            wrong.append(f"{case.name}: {why}")
            print(f"WRONG {wrong[-1]}", file=sys.stderr, flush=True)
    print(f"\n{len(chosen)} faults, {len(wrong)} of them with something wrong")
    return 1 if wrong or not chosen else 0


def findings(
    chosen: list[Case], robot: str, slack: float
) -> Iterator[tuple[Case, Finding | None, str]]:
    """Have faults happen; gives what came of each, and what is wrong with that."""
    log = os.environ.get("FAULTS_LOG", os.devnull)
    for (nodes, simulated, fingers), same in groupby(sorted(chosen, key=_kind), _kind):
        waiting = list(same)
        while waiting:
            options = {"simulated": simulated, "fingers": fingers, "log": log}
            with bench(robot, nodes, **options) as (session, works):
                while waiting:
                    case = waiting.pop(0)
                    try:
                        finding = session.strike(case.node, case.fault, works[case.caller])
                    except AssertionError as error:
                        yield case, None, str(error)
                        # Who knows in what state the suite is.
                        break
                    dead = session.processes.dead()
                    gone = f"{', '.join(dead)} ended by itself" if dead else ""
                    yield case, finding, gone or judge(case, finding, slack)


def _kind(case: Case) -> tuple[tuple[str, ...], bool, bool]:
    return case.nodes, case.node == ALL_NODES, case.fingers


def row(case: Case, finding: Finding) -> str:
    """Make a row of the table."""
    ratios = finding.ratios
    # The first clause of each.
    heard = "; then: ".join(text.split(";")[0] for text in finding.got)
    cells = (
        case.node,
        case.fault.name,
        case.caller,
        heard,
        f"{finding.after:.2f} s",
        f"{ratios.velocity:.4f}",
        f"{ratios.acceleration:.4f}",
        finding.next,
    )
    return f"| {' | '.join(cells)} |"


if __name__ == "__main__":
    raise SystemExit(main())
