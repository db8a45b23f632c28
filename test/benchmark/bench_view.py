"""The browser view: what it costs while a robot moves."""

from __future__ import annotations

import json
import subprocess
import tempfile
from pathlib import Path

from bench_nodes import environment
from table import Row

CORE_LIMIT = 10.0


def rows(ros_python: Path) -> list[Row]:
    """Measure with the Python at `ros_python`, which has the suite installed."""
    command = [str(ros_python), str(Path(__file__).with_name("drive_view.py"))]
    with tempfile.TemporaryDirectory() as bytecode:
        finished = subprocess.run(
            command, env=environment(bytecode), stdout=subprocess.PIPE, check=True
        )
    figures = json.loads(finished.stdout.splitlines()[-1])
    what = f"rvs, 7 joints at 60 Hz and a page, for {figures['seconds']:.0f} s, share of a core"
    return [Row(what, 100.0 * figures["core"], "%", limit=CORE_LIMIT)]
