"""Medians of our errors against those of the seven methods of OpenCV on the same samples."""

import sys
from pathlib import Path

import numpy as np
import pytest
from hand_eye_cells import KINDS

pytest.importorskip("cv2", reason="OpenCV is a peer, not a requirement")
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "benchmark"))

import bench_calibration

NOISE = np.radians(0.1), 0.5e-3


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("robot", [False, True], ids=["camera", "camera and robot"])
def test_no_cell_is_worse_than_its_best(kind, robot):
    noise = {"camera": NOISE} | ({"robot": NOISE} if robot else {})
    errors = bench_calibration._trials(20, kind, noise)
    medians = {name: np.median(rows, axis=0) for name, rows in errors.items()}
    best = np.min([row for name, row in medians.items() if name != "ours"], axis=0)
    assert len(medians) == 8
    assert (medians["ours"] <= best).all(), medians
