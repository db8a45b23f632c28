"""Hand-eye calibration against the seven methods of OpenCV, in cells of motions and noise.

OpenCV is left out where it is not installed.  Run as a script this prints what its best method
does in every cell, which ``test/data/hand_eye_of_opencv.json`` keeps.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from importlib.util import find_spec
from itertools import product
from pathlib import Path
from time import process_time_ns
from typing import Any

import numpy as np
from table import Row
from timing import Work, interleave

from robomech_ros.calibration import hand_eye
from robomech_ros.spatial import inverse_pose, pose_error

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from hand_eye_cells import KINDS, samples

TRIALS = 200
POSES = (10, 20, 50)
NOISES = {"0.1 degrees, 0.5 mm": (0.1, 0.5e-3), "0.5 degrees, 2 mm": (0.5, 2e-3)}
# How much of the best peer's median error ours may be.
RATIOS = {"camera": 0.8, "camera and robot": 1.0, "robot": 1.1}
# With noise of the robot alone few samples are the difficult ones.
FEW = (5, 6)
UNITS = ("degrees", "mm")
TIME_LIMIT = 1000.0


def rows() -> list[Row]:
    """Measure and return the rows of the table."""
    return [_time(), *(row for cell in cells() for row in _cell_rows(*cell))]


def cells() -> Iterator[tuple[str, int, str, str]]:
    """Yield the noise source, number of poses, kind of motions and size of the noise."""
    for who, kinds, counts in (
        ("camera", KINDS, POSES),
        ("camera and robot", KINDS, POSES),
        ("robot", KINDS[:1], FEW),
    ):
        yield from ((who, n, kind, size) for kind, n, size in product(kinds, counts, NOISES))


def cell_name(who: str, count: int, kind: str, size: str) -> str:
    """Name of a cell in tables."""
    return f"hand-eye, {count} poses, {kind}, {who} {size}"


def _opencv(A: Any, S: Any) -> dict[str, Any]:
    """``T_hand_sensor`` by every method of OpenCV."""
    import cv2

    hand = list(A[:, :3, :3]), list(A[:, :3, 3])
    seen = list(S[:, :3, :3]), list(S[:, :3, 3])
    found = {
        name: cv2.calibrateHandEye(
            *hand, *seen, method=getattr(cv2, f"CALIB_HAND_EYE_{name.upper()}")
        )
        for name in ("Tsai", "Park", "Horaud", "Andreff", "Daniilidis")
    }
    back = inverse_pose(A)
    for name in ("Shah", "Li"):
        pose = cv2.calibrateRobotWorldHandEye(
            *seen,
            list(back[:, :3, :3]),
            list(back[:, :3, 3]),
            method=getattr(cv2, f"CALIB_ROBOT_WORLD_HAND_EYE_{name.upper()}"),
        )
        turn, shift = np.asarray(pose[2]), np.asarray(pose[3])
        found[name] = turn.T, -turn.T @ shift
    result = {}
    for name, (turn, shift) in found.items():
        result[name] = np.eye(4)
        result[name][:3, :3], result[name][:3, 3] = turn, np.ravel(shift)
    return result


def _error(truth: Any, found: Any) -> tuple[float, float]:
    try:
        error = pose_error(truth, found)
    except ValueError:
        return np.inf, np.inf
    return float(np.degrees(np.linalg.norm(error[:3]))), 1e3 * float(np.linalg.norm(error[3:]))


def _cell_rows(who: str, count: int, kind: str, size: str) -> list[Row]:
    """One row for rotation and one for position: medians, and the best peer's."""
    table = []
    for unit, medians in zip(UNITS, cell(who, count, kind, size), strict=True):
        ours = medians.pop("ours")
        best = min(medians, key=lambda name: medians[name]) if medians else ""
        peer = {"peer": medians[best], "peer_name": best} if best else {}
        what = cell_name(who, count, kind, size)
        table.append(Row(what, ours, unit, ratio_limit=RATIOS[who], **peer))
    return table


def cell(
    who: str, count: int, kind: str, size: str, *, peers: bool = True
) -> tuple[dict[str, float], dict[str, float]]:
    """Median rotation (degrees) and position (mm) errors of everybody in a cell."""
    angle, shift = NOISES[size]
    noise = {one: (np.radians(angle), shift) for one in who.split(" and ")}
    errors = _trials(count, kind, noise, peers and find_spec("cv2") is not None)
    turns, shifts = (
        {name: float(np.median([one[k] for one in all_])) for name, all_ in errors.items()}
        for k in range(2)
    )
    return turns, shifts


def _trials(count: int, kind: str, noise: dict[str, Any], peers: bool) -> dict[str, list[Any]]:
    rng = np.random.default_rng(7)
    errors: dict[str, list[Any]] = {}
    for _ in range(TRIALS):
        A, S, X, _ = samples(rng, count, kind, **noise)
        try:
            found = {"ours": hand_eye(A, S).sensor}
        except ValueError:
            found = {"ours": np.full((4, 4), np.nan)}
        if peers:
            found |= _opencv(A, S)
        for name, pose in found.items():
            errors.setdefault(name, []).append(_error(X, pose))
    return errors


def _time() -> Row:
    noise = np.radians(0.1), 0.5e-3
    A, S, _, _ = samples(np.random.default_rng(1), 20, camera=noise)
    work = Work(lambda: hand_eye(A, S), 1)
    timing = interleave({"ours": work}, clock=process_time_ns)["ours"]
    return Row("hand-eye, 20 poses, with covariance", timing.median, limit=TIME_LIMIT)


def _best_of_peers() -> dict[str, dict[str, tuple[str, float]]]:
    """Best method of OpenCV and its median error, of every cell and unit."""
    table: dict[str, dict[str, tuple[str, float]]] = {}
    for one in cells():
        medians = cell(*one)
        table[cell_name(*one)] = {}
        for unit, all_ in zip(UNITS, medians, strict=True):
            del all_["ours"]
            best = min(all_, key=lambda name: all_[name])
            table[cell_name(*one)][unit] = best, round(all_[best], 5)
    return table


if __name__ == "__main__":
    # What test/calibration/test_against_opencv.py compares with.
    print(json.dumps(_best_of_peers(), indent=1))
