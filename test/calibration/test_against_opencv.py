"""Medians of our errors against the best of seven methods of OpenCV on the same samples.

What OpenCV 4.14 does is kept in ``data/hand_eye_of_opencv.json``; ``python
test/benchmark/bench_calibration.py`` makes it anew where OpenCV is installed.
"""

import json
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "benchmark"))

import bench_calibration as bench

FIGURES = Path(__file__).resolve().parents[1] / "data" / "hand_eye_of_opencv.json"
THEIRS = json.loads(FIGURES.read_text("utf-8"))


CELLS = list(bench.cells())


# Every fifth cell: among them are both who may be noisy, every kind of motions and number of poses,
# and both noises.
@pytest.mark.slow
@pytest.mark.parametrize(
    "cell",
    [pytest.param(cell, marks=[pytest.mark.long] if k % 5 else []) for k, cell in enumerate(CELLS)],
    ids=str,
)
def test_no_cell_is_worse_than_its_best(cell):
    ours = bench.cell(*cell, peers=False)
    for unit, medians in zip(bench.UNITS, ours, strict=True):
        method, theirs = THEIRS[bench.cell_name(*cell)][unit]
        assert medians["ours"] <= bench.RATIOS[cell[0]] * theirs, (unit, method)


def test_every_cell_has_its_figures():
    assert list(THEIRS) == [bench.cell_name(*cell) for cell in CELLS]
    assert len(THEIRS) == 40
