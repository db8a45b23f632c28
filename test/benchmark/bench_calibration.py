"""Hand-eye calibration against the seven methods of OpenCV, in cells of motions and noise.

OpenCV is left out where it is not installed.
"""

from __future__ import annotations

import sys
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
from table import Row
from timing import Work, interleave

from robomech_ros.calibration import hand_eye
from robomech_ros.spatial import inverse_pose, pose_error

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from hand_eye_cells import KINDS, samples

TRIALS = 50
POSES = (10, 20, 50)
NOISES = {"0.1 degrees, 0.5 mm": (0.1, 0.5e-3), "0.5 degrees, 2 mm": (0.5, 2e-3)}
TIME_LIMIT = 1000.0


def rows() -> list[Row]:
    """Measure and return the rows of the table."""
    return [_time(), *_cells("camera", 0.8), *_cells("camera and robot", 1.0)]


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


def _cells(who: str, ratio: float) -> list[Row]:
    """One row for rotation and one for position of every cell: medians, and the best peer's."""
    table = []
    for kind in KINDS:
        for count in POSES:
            for text, (angle, shift) in NOISES.items():
                noise = np.radians(angle), shift
                both = {"robot": noise} if who != "camera" else {}
                errors = _trials(count, kind, {"camera": noise, **both})
                what = f"hand-eye, {count} poses, {kind}, {who} {text}"
                for k, unit in enumerate(("degrees", "mm")):
                    medians = {
                        name: float(np.median([e[k] for e in all_]))
                        for name, all_ in errors.items()
                    }
                    ours = medians.pop("ours")
                    best = min(medians, key=lambda name: medians[name]) if medians else ""
                    peer = {"peer": medians[best], "peer_name": best} if best else {}
                    table.append(Row(what, ours, unit, ratio_limit=ratio, **peer))
    return table


def _trials(count: int, kind: str, noise: dict[str, Any]) -> dict[str, list[Any]]:
    rng = np.random.default_rng(7)
    errors: dict[str, list[Any]] = {}
    for _ in range(TRIALS):
        A, S, X, _ = samples(rng, count, kind, **noise)
        try:
            found = {"ours": hand_eye(A, S).sensor}
        except ValueError:
            found = {"ours": np.full((4, 4), np.nan)}
        if find_spec("cv2"):
            found |= _opencv(A, S)
        for name, pose in found.items():
            errors.setdefault(name, []).append(_error(X, pose))
    return errors


def _time() -> Row:
    noise = np.radians(0.1), 0.5e-3
    A, S, _, _ = samples(np.random.default_rng(1), 20, camera=noise)
    timing = interleave({"ours": Work(lambda: hand_eye(A, S), 1)})["ours"]
    return Row("hand-eye, 20 poses, with covariance", timing.median, limit=TIME_LIMIT)
