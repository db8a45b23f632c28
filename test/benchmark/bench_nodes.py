"""The nodes as processes: start, round trip, a large batch, memory and processor time when idle."""

from __future__ import annotations

import json
import os
import statistics
import subprocess
from pathlib import Path

from table import Row

START_LIMIT = 2.5
ROUND_TRIP_RATIO = 1.3
BATCH_LIMIT = 3.0
MEMORY_LIMIT = 200.0
IDLE_LIMIT = 5.0
CONTROLLER_LIMIT = 15.0
CONTROLLER = "joint_trajectory_controller"
FIRST_DOMAIN, DOMAINS = 50, 10


def environment() -> dict[str, str]:
    """Return the environment for the suite's Python: this machine only, a domain of its own."""
    values = dict(os.environ)
    values.pop("_ROS_WHEELS_BOOTSTRAP_COMPLETE", None)
    values.pop("PYTHONPATH", None)
    values["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
    values.setdefault("ROS_DOMAIN_ID", str(FIRST_DOMAIN + os.getpid() % DOMAINS))
    return values


def rows(ros_python: Path) -> list[Row]:
    """Measure with the Python at `ros_python`, which has the suite installed."""
    script = Path(__file__).with_name("drive_nodes.py")
    finished = subprocess.run(
        [str(ros_python), str(script)], env=environment(), stdout=subprocess.PIPE, check=True
    )
    figures = json.loads(finished.stdout)
    low, ours, high = figures["round_trips"]["ours"]
    starts, batch = figures["start_seconds"], figures["batch"]
    batch_low, batch_median, batch_high = statistics.quantiles(batch["seconds"], n=4)
    batch_name = f"SolveIKBatch, 100,000 poses, {batch['solutions']:,} solutions, in 10 requests"
    table = [
        Row("IK service round trip, 8 solutions", ours, peer=figures["round_trips"]["bare"][1],
            peer_name="bare rclpy", spread=(high - low) / 2 / ours, ratio_limit=ROUND_TRIP_RATIO),
        Row("node start to first answer, warm", statistics.median(starts), "s",
            spread=(max(starts) - min(starts)) / 2 / statistics.median(starts),
            limit=START_LIMIT),
        Row(batch_name, batch_median, "s", spread=(batch_high - batch_low) / 2 / batch_median,
            limit=BATCH_LIMIT),
        Row("the same, largest memory of the node", batch["megabytes"], "MB"),
    ]  # fmt: skip
    for name, load in figures["idle"].items():
        limit = CONTROLLER_LIMIT if name == CONTROLLER else IDLE_LIMIT
        table.append(Row(f"{name}, resident", load["megabytes"], "MB", limit=MEMORY_LIMIT))
        table.append(Row(f"{name}, idle core", 100 * load["core"], "%", limit=limit))
    return table
