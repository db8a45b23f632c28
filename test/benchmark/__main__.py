"""Run every benchmark in one thread and print one table; `make bench` calls this."""

from __future__ import annotations

import argparse
import os
import platform
import sys
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
    "nodes",
    "view",
)
os.environ.update(ONE_THREAD)  # before numpy and numba are imported, below


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
    if "spatial" in groups:
        import bench_spatial

        rows += bench_spatial.rows()
    if "calibration" in groups:
        import bench_calibration

        rows += bench_calibration.rows()
    if "forward" in groups:
        import bench_forward

        rows += bench_forward.rows()
    if "kinetostatics" in groups:
        import bench_kinetostatics

        rows += bench_kinetostatics.rows()
    if "inverse" in groups:
        import bench_inverse

        inverse_rows, inverse_remarks = bench_inverse.rows()
        rows += inverse_rows
        remarks += inverse_remarks
    if "maps" in groups:
        import bench_maps

        map_rows, map_remarks = bench_maps.rows()
        rows += map_rows
        remarks += map_remarks
    if "trajectory" in groups:
        import bench_trajectory

        trajectory_rows, trajectory_remarks = bench_trajectory.rows()
        rows += trajectory_rows
        remarks += trajectory_remarks
    if "dynamics" in groups:
        import bench_dynamics

        rows += bench_dynamics.rows()
    if "nodes" in groups:
        import bench_nodes

        rows += bench_nodes.rows(arguments.ros_python)
    if "view" in groups:
        import bench_view

        view_rows, view_remarks = bench_view.rows(arguments.ros_python)
        rows += view_rows
        remarks += view_remarks

    load = os.getloadavg()[0]
    print(render(f"Python {platform.python_version()}, one thread, medians; load {load:.1f}", rows))
    print(*remarks, sep="\n")
    short = missed(rows)
    targets = sum(row.reached is not None for row in rows)
    print(f"\n{targets - len(short)} of {targets} targets reached")
    return 0


if __name__ == "__main__":
    sys.exit(main())
