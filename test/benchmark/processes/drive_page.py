"""Measure a page of the view from outside, with the Python that has viser; print figures as JSON.

`bench_view.py` starts this script, which starts the server once more in a process of its own.
"""

from __future__ import annotations

import contextlib
import json
import math
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "rvs"))

from robomech_ros.rvs import view

ROBOT = "panda"
DRAGS = 150
DRAWN = 3
PATIENCE = 120.0


def serve() -> None:
    """Serve a page, and give its memory for every line on the input."""
    with view(ROBOT, port=0) as page:
        print(page.url, flush=True)
        for _ in sys.stdin:
            print(json.dumps({"megabytes": megabytes()}), flush=True)


def megabytes() -> float:
    """Return the resident memory of this process."""
    lines = Path("/proc/self/status").read_text(encoding="utf-8").splitlines()
    return next(float(line.split()[1]) for line in lines if line.startswith("VmRSS")) / 1024.0


class Served:
    """A server in a process of its own."""

    def __init__(self) -> None:
        command = [sys.executable, __file__, "serve"]
        pipes: dict[str, Any] = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE}
        self._process = subprocess.Popen(command, text=True, **pipes)
        self.url = self._process.stdout.readline().strip()

    def ask(self, what: str) -> dict[str, float]:
        """Ask for figures."""
        self._process.stdin.write(f"{what}\n")
        self._process.stdin.flush()
        return json.loads(self._process.stdout.readline())

    def close(self) -> None:
        """End it."""
        self._process.stdin.close()
        self._process.wait(PATIENCE)


@contextlib.contextmanager
def served() -> Iterator[Served]:
    """Serve for the time of the block."""
    server = Served()
    try:
        yield server
    finally:
        server.close()


def drags(server: Served) -> list[float]:
    """Drag the gizmo as a page does, and return the seconds until the ghosts are back."""
    import msgspec.msgpack
    from raw_client import Client, camera, gizmo, grip

    from robomech_ros.robots import load_robot
    from robomech_ros.rvs.model.arms.arm import ArmView
    from robomech_ros.rvs.page.node_space import placed

    pack = msgspec.msgpack.encode
    place = placed(ArmView(load_robot(ROBOT)).tip)
    seconds = []
    with Client(server).connect() as connection:
        connection.send(pack(camera()))
        receive_until(connection, b"/base/target")
        drain(connection)
        # The first browser.
        owner = "0"
        connection.send(pack(grip(owner)))
        for k in range(1, DRAGS + 1):
            position = place["position"] + [0.0, 0.05 * math.sin(0.3 * k), 0.0]
            begin = time.perf_counter()
            connection.send(pack(gizmo(position.tolist(), place["wxyz"].tolist(), owner)))
            receive_until(connection, b"batched_positions")
            seconds.append(time.perf_counter() - begin)
            drain(connection)
    return seconds


def receive_until(connection: Any, words: bytes) -> None:
    """Receive until a message has these words."""
    import zstandard

    while True:
        raw = connection.recv(timeout=PATIENCE)
        length = int.from_bytes(raw[8:16], "little")
        text = zstandard.ZstdDecompressor().decompress(raw[16 : 16 + length])
        if words in text:
            return


def drain(connection: Any) -> None:
    """Receive what else is on its way."""
    with contextlib.suppress(TimeoutError):
        while True:
            connection.recv(timeout=0.1)


def drawn(server: Served) -> list[float]:
    """Return the seconds from asking for a page to its robot being drawn; none without Chromium."""
    from chromium import Tab, chromium

    if chromium() is None:
        return []
    seconds = []
    for _ in range(DRAWN):
        tab = Tab("about:blank")
        try:
            tab.open(f"{server.url}&fixedDpr=1")
            tab.wait_for("__viserMutable.nodeRefFromName['/base/target']")
            tab.frames(2)
            # From when the page was asked for, on its own clock.
            seconds.append(tab.value("performance.now()") / 1e3)
        finally:
            tab.close()
    return seconds


def main() -> None:
    """Print all figures."""
    with served() as server:
        figures = {
            "drags": drags(server),
            "drawn": drawn(server),
            "megabytes": server.ask("memory")["megabytes"],
        }
    print(json.dumps(figures))


if __name__ == "__main__":
    serve() if sys.argv[1:] == ["serve"] else main()
