"""Hands: closure, quality and contact forces, public calls.

No library on PyPI does it; goals are those that the project has set itself.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
from table import Row
from timing import Work, interleave

from robomech_ros.hands import (
    contact_forces,
    grasp_postures,
    grasp_quality,
    is_force_closed,
    load_hand,
)

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "hands"))
from grasps import CUBE, EQUATOR, TETRAHEDRON, on_sphere, random_sphere

# Microseconds.
CLOSURE, QUALITY, FORCES = 50.0, 50_000.0, 500.0


def rows() -> list[Row]:
    """Measure and return the rows of the table."""
    load = np.array([0.1, -0.2, 0.3, 0.5, 0.2, -1.0])
    found = []
    for count in (3, 6):
        grasp = random_sphere(np.random.default_rng(1), count, 0.8)
        what = f"{count} contacts, "
        found.append(_row(what + "force closure", lambda g=grasp: is_force_closed(g), CLOSURE))
        found.append(
            _row(what + "smallest forces", lambda g=grasp: contact_forces(g, load), FORCES)
        )
    grasps = {
        "cube": on_sphere(CUBE, 0.5),
        "tetrahedron": on_sphere(TETRAHEDRON, 0.5),
        "equator": on_sphere(EQUATOR, 0.3),
        **{f"{k} anywhere": random_sphere(np.random.default_rng(k), k, 0.8) for k in (4, 5, 6)},
    }
    for name, grasp in grasps.items():
        gap = "" if grasp_quality(grasp, length=1.0).certified else ", bounds not as close"
        call = lambda g=grasp: grasp_quality(g, length=1.0)  # noqa: E731
        found.append(_row(f"quality to 1e-4: {name}{gap}", call, QUALITY, rounds=5))
    hand, T = load_hand("three_fingered"), np.eye(4)
    T[2, 3] = 0.08
    touched = on_sphere(0.04 * EQUATOR, 0.5)
    found.append(_row("postures of three fingers", lambda: grasp_postures(hand, T, touched), None))
    return found


def _row(what: str, call: Callable[[], object], limit: float | None, rounds: int = 51) -> Row:
    time = interleave({"ours": Work(call, 1)}, rounds=rounds)["ours"]
    return Row(what, time.median, spread=time.spread, limit=limit)
