"""A move_group of a UR5e with shapes."""

import pytest
from move_group_client import Client
from shaped_arm import shaped_ur5e

from robomech_ros.nodes.move_group.node import MoveGroupNode


@pytest.fixture
def client(graph):
    robot = {"robot_description": shaped_ur5e(), "assume_limits": True}
    graph.start(MoveGroupNode, state_timeout=0.0, controller_timeout=0.5, **robot)
    return Client(graph)
