"""The browser view: what it costs while a robot moves, what a drag takes, and drawing the page."""

from __future__ import annotations

import json
import statistics
import subprocess
import tempfile
from pathlib import Path
from typing import Any

from bench_nodes import environment
from table import Row

CORE_LIMIT = 10.0
DRAG_LIMIT = 30.0
DRAWN_LIMIT = 5.0


def figures(ros_python: Path, script: str) -> dict[str, Any]:
    """Return what a script beside this one measures, in the environment of the suite."""
    command = [str(ros_python), str(Path(__file__).with_name("processes") / script)]
    with tempfile.TemporaryDirectory() as bytecode:
        finished = subprocess.run(
            command, env=environment(bytecode), stdout=subprocess.PIPE, check=True
        )
    found: dict[str, Any] = json.loads(finished.stdout.splitlines()[-1])
    return found


def rows(ros_python: Path) -> tuple[list[Row], list[str]]:
    """Measure with the Python at `ros_python`, which has the suite installed; rows and remarks."""
    running, page = figures(ros_python, "drive_view.py"), figures(ros_python, "drive_page.py")
    as_set, as_told = running["as set"], running["as told"]
    what = f"rvs, 7 joints at 60 Hz and a page, for {as_set['seconds']:.0f} s, share of a core"
    low, drag, high = statistics.quantiles([1e3 * one for one in page["drags"]], n=4)
    table = [
        Row(what, 100.0 * as_set["core"], "%", limit=CORE_LIMIT),
        Row("rvs, the same, drawn at 60 Hz", 100.0 * as_told["core"], "%"),
        Row("view, a drag of the gizmo to its ghosts back at a client", drag, "ms",
            spread=(high - low) / 2 / drag, limit=DRAG_LIMIT),
        Row("view, resident memory of the server", page["megabytes"], "MB"),
    ]  # fmt: skip
    if not page["drawn"]:
        return table, ["the page of the view was not drawn: no Chromium here"]
    seconds = statistics.median(page["drawn"])
    what = "view, page drawn by headless Chromium in software"
    return [*table, Row(what, seconds, "s", limit=DRAWN_LIMIT)], []
