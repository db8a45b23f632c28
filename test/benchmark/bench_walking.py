"""Walking machines: one whole period of a walker, and stance by itself."""

from __future__ import annotations

from collections.abc import Callable
from itertools import count

import numpy as np
from table import Row
from timing import Work, interleave

from robomech_ros.walking import Walker, WalkingDynamics, foot_forces, load_legged, stability_margin

# Microseconds for a whole update of 18 joints.
UPDATE_LIMIT = 100.0
# Forces of four feet, and the dynamics of 18 joints.
FORCES_LIMIT, DYNAMICS_LIMIT = 500.0, 100.0
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
        *_forces(),
        _row("stability margin over three feet", lambda: stability_margin([0.0, 0.0], feet)),
    ]


def _row(what: str, call: Callable[[], object], units: int = 1, limit: float | None = None) -> Row:
    time = interleave({"ours": Work(call, units)}, rounds=51)["ours"]
    return Row(what, time.median, spread=time.spread, limit=limit)


def _forces() -> list[Row]:
    """Time forces that cones bound, and the dynamics of a hexapod on its feet and off them."""
    go1, hexapod = load_legged("go1"), load_legged("phantomx")
    pushed = [2.0, -3.0, 3.0, 50.0, 10.0, -110.0]
    dynamics, still = WalkingDynamics(hexapod), np.zeros(24)
    q, lift = hexapod.home, np.full(18, 0.1)
    return [
        _row(
            "forces of four feet, on the borders of their cones",
            lambda: foot_forces(go1, go1.home, pushed),
            limit=FORCES_LIMIT,
        ),
        _row(
            "hexapod: torques of a motion, 18 joints",
            lambda: dynamics.inverse(q, still, still),
            limit=DYNAMICS_LIMIT,
        ),
        _row(
            "hexapod: motion on planted feet, 18 joints",
            lambda: dynamics.planted_forward(q, still[:6], lift),
            limit=DYNAMICS_LIMIT,
        ),
    ]


def _walk(gait: str) -> Row:
    walker, turn = Walker(load_legged("phantomx"), gait=gait), count()

    def call() -> None:
        side = 1.0 if next(turn) % 10 < 5 else -1.0
        for k in range(PERIODS):
            if k % 50 == 0:
                walker.command([0.2 * side, 0.05 * side, 0.02])
            walker.update()

    return _row(f"a period of walking, 18 joints, {gait}", call, PERIODS, UPDATE_LIMIT)
