"""Walking machines: one whole period of a walker, and stance by itself."""

from __future__ import annotations

from collections.abc import Callable
from itertools import count

import numpy as np
from table import Row
from timing import Work, interleave

from robomech_ros.walking import Walker, load_legged, stability_margin

# Microseconds for a whole update of 18 joints.
UPDATE_LIMIT = 100.0
PERIODS = 200


def rows() -> list[Row]:
    """Measure and return the rows of the table."""
    hexapod = load_legged("phantomx")
    q, feet = hexapod.home, hexapod.feet(hexapod.home)[::2, :2]
    twist = np.array([0.0, 0.0, 0.2, 0.05, 0.0, 0.0])
    return [
        *(_walk(gait) for gait in ("wave", "ripple", "tripod")),
        _row(
            "hexapod: joint rates for a twist, feet still", lambda: hexapod.stance_rates(q, twist)
        ),
        _row("stability margin over three feet", lambda: stability_margin([0.0, 0.0], feet)),
    ]


def _row(what: str, call: Callable[[], object], units: int = 1, limit: float | None = None) -> Row:
    time = interleave({"ours": Work(call, units)}, rounds=51)["ours"]
    return Row(what, time.median, spread=time.spread, limit=limit)


def _walk(gait: str) -> Row:
    walker, turn = Walker(load_legged("phantomx"), gait=gait), count()

    def call() -> None:
        side = 1.0 if next(turn) % 10 < 5 else -1.0
        for k in range(PERIODS):
            if k % 50 == 0:
                walker.command([0.2 * side, 0.05 * side, 0.02])
            walker.update()

    return _row(f"a period of walking, 18 joints, {gait}", call, PERIODS, UPDATE_LIMIT)
