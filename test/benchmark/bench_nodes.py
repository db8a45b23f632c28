"""The nodes as processes: start, round trip, a large batch, memory and processor time when idle."""

from __future__ import annotations

import json
import os
import statistics
import subprocess
import tempfile
from pathlib import Path

from table import Row

START_LIMIT = 2.5
ROUND_TRIP_RATIO = 1.2
PLAN_RATIO = 1.35
BATCH_LIMIT = 3.0
MEMORY_LIMIT = 170.0
IDLE_LIMIT = 5.0
CONTROLLER_LIMIT = 15.0
SERVO_LIMIT = 15_000.0
CONTROLLER = "joint_trajectory_controller"
FIRST_DOMAIN, DOMAINS = 50, 10


def environment(bytecode: str) -> dict[str, str]:
    """Return the environment for the suite's Python: this machine only, a domain of its own.

    Python keeps its bytecode in the folder `bytecode`, as it does with any installation that it may
    write to: to compile the sources anew at every start takes longer than all the rest of it.
    """
    values = dict(os.environ)
    values.pop("_ROS_WHEELS_BOOTSTRAP_COMPLETE", None)
    values.pop("PYTHONPATH", None)
    values.pop("PYTHONDONTWRITEBYTECODE", None)
    values["PYTHONPYCACHEPREFIX"] = bytecode
    values["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
    values.setdefault("ROS_DOMAIN_ID", str(FIRST_DOMAIN + os.getpid() % DOMAINS))
    return values


def round_trip(what: str, quartiles: dict[str, list[float]], limit: float) -> Row:
    """Return the row of a service beside a bare one, from the quartiles in us."""
    low, ours, high = quartiles["ours"]
    bare, spread = quartiles["bare"][1], (high - low) / 2 / ours
    return Row(what, ours, peer=bare, peer_name="bare rclpy", spread=spread, ratio_limit=limit)


def cycle_rows(cycles: dict[str, dict[str, float]]) -> list[Row]:
    """Return the rows of the controller's cycles beside those of bare timers."""
    ours, peers = cycles["ours"], {"single": "bare timer", "events": "bare, EventsExecutor"}
    what = f"{CONTROLLER}, {ours['rate']:g} Hz for {ours['seconds']:g} s on one core, "
    figures = (("jitter", "jitter, 99th percentile", 1e6, "us"),
               ("missed", "missed cycles", 100.0, "%"),
               ("core", "share of the core", 100.0, "%"))  # fmt: skip
    return [
        Row(what + text, ours[field] * factor, unit,
            peer=cycles[peer][field] * factor, peer_name=peer_name)
        for field, text, factor, unit in figures
        for peer, peer_name in peers.items()
    ]  # fmt: skip


def rows(ros_python: Path) -> list[Row]:
    """Measure with the Python at `ros_python`, which has the suite installed."""
    script = Path(__file__).with_name("processes") / "drive_nodes.py"
    command = [str(ros_python), str(script)]
    with tempfile.TemporaryDirectory() as bytecode:
        finished = subprocess.run(
            command, env=environment(bytecode), stdout=subprocess.PIPE, check=True
        )
    figures = json.loads(finished.stdout)
    starts, batch = figures["start_seconds"], figures["batch"]
    batch_low, batch_median, batch_high = statistics.quantiles(batch["seconds"], n=4)
    batch_name = f"SolveIKBatch, 100,000 poses, {batch['solutions']:,} solutions, in 10 requests"
    trips, cycles = figures["round_trips"], figures["cycles"]
    table = [
        round_trip("IK service round trip, 8 solutions", trips["SolveIK"], ROUND_TRIP_RATIO),
        round_trip("PlanJoint round trip, 3-4-5", trips["PlanJoint"], PLAN_RATIO),
        Row("node start to first answer, warm", statistics.median(starts), "s",
            spread=(max(starts) - min(starts)) / 2 / statistics.median(starts),
            limit=START_LIMIT),
        Row(batch_name, batch_median, "s", spread=(batch_high - batch_low) / 2 / batch_median,
            limit=BATCH_LIMIT),
        Row("the same, largest memory of the node", batch["megabytes"], "MB"),
        *cycle_rows(cycles),
        Row("servo, 100 Hz, from a command to the stream that follows it",
            1e6 * figures["servo"]["median"], limit=SERVO_LIMIT),
        Row("the same, 99th percentile", 1e6 * figures["servo"]["largest_of_99"]),
        Row("the same, until the motion changes, two periods ahead of a message",
            1e6 * figures["servo"]["motion"]),
    ]  # fmt: skip
    for name, load in figures["idle"].items():
        limit = CONTROLLER_LIMIT if name == CONTROLLER else IDLE_LIMIT
        table.append(Row(f"{name}, resident", load["megabytes"], "MB", limit=MEMORY_LIMIT))
        table.append(Row(f"{name}, idle core", 100 * load["core"], "%", limit=limit))
    return table
