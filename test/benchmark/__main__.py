"""Run every benchmark in one thread and print one table; `make bench` calls this."""

from __future__ import annotations

import argparse
import os
import platform
import sys
from importlib import import_module
from pathlib import Path

THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")
ONE_THREAD = dict.fromkeys(THREADS, "1")
GROUPS = (
    "spatial",
    "calibration",
    "forward",
    "kinetostatics",
    "inverse",
    "maps",
    "trajectory",
    "dynamics",
    "parallel",
    "walking",
    "hands",
    "collision",
    "rolling",
    "nodes",
    "view",
)
WITH_ROS = ("nodes", "view")
os.environ.update(ONE_THREAD)  # before numpy and numba are imported, below


def _measured(group: str, ros_python: Path) -> tuple[list, list[str]]:
    """Return the rows of a group, and remarks on them; some need the Python that has ROS."""
    bench = import_module(f"bench_{group}")
    found = bench.rows(ros_python) if group in WITH_ROS else bench.rows()
    return found if isinstance(found, tuple) else (found, [])


def main() -> int:
    """Measure what the arguments ask for, print it, and return 0."""
    parser = argparse.ArgumentParser(prog="make bench", description=__doc__)
    parser.add_argument(
        "--ros-python",
        type=Path,
        default=Path(sys.executable),
        help="Python that has the suite and rclpy (this one)",
    )
    parser.add_argument("--only", choices=GROUPS, help="one group of measurements")
    arguments = parser.parse_args()
    groups = [arguments.only] if arguments.only else GROUPS

    from table import missed, render

    rows, remarks = [], []
    for group in groups:
        found, said = _measured(group, arguments.ros_python)
        rows += found
        remarks += said

    load = os.getloadavg()[0]
    print(render(f"Python {platform.python_version()}, one thread, medians; load {load:.1f}", rows))
    print(*remarks, sep="\n")
    short = missed(rows)
    targets = sum(row.reached is not None for row in rows)
    print(f"\n{targets - len(short)} of {targets} targets reached")
    return 0


if __name__ == "__main__":
    sys.exit(main())
