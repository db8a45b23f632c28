"""Simulated robots and others that publish their frames, in a domain of their own."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))

from display_cases import Listener

from robomech_ros.nodes.display import external_frames, robot_display
from robomech_ros.nodes.joint_trajectory_controller.node import JointTrajectoryControllerNode


@pytest.fixture(autouse=True)
def looking_often(monkeypatch):
    """Let nodes of this process look who else publishes more often, so that tests wait less."""
    monkeypatch.setattr(external_frames, "PERIOD", 0.1)
    monkeypatch.setattr(robot_display, "PERIOD", 0.1)
    monkeypatch.setattr(external_frames, "SILENCE", 1.0)


@pytest.fixture
def robot(graph):
    """Start a simulated robot with these parameters."""
    return lambda **parameters: graph.start(JointTrajectoryControllerNode, **parameters)


@pytest.fixture
def listener(graph):
    """Somebody who sees /tf, /tf_static and what nodes log."""
    return Listener(graph.client)
