"""The calibration node alone in a domain of its own."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))

from camera_stage import Stage


@pytest.fixture
def stage(graph, tmp_path):
    """A node of which all frames are given, that saves in a folder of the test."""
    return Stage(graph, folder=str(tmp_path / "calibrations"))
