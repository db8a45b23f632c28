"""A second node of the same name is noticed."""

import pytest
from rcl_interfaces.msg import Log
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile

from robomech_ros.nodes.process import run

LATCHED = QoSProfile(depth=100, durability=DurabilityPolicy.TRANSIENT_LOCAL)


@pytest.fixture
def looking_soon(monkeypatch):
    monkeypatch.setattr(run, "LOOK_PERIOD", 0.2)


def watched(name):
    def make(**options):
        node = Node(name, **options)
        run.watch_for_duplicate_nodes([node])
        return node

    return make


def test_a_second_node_of_a_name_is_said(graph, looking_soon):
    graph.start(watched("twin"))
    graph.start(watched("twin"))
    expected = "another node '/twin' is in this domain: both answer the same services"
    graph.receive(Log, "/rosout", LATCHED, lambda log: log.msg.startswith(expected))


def test_nodes_of_other_namespaces_are_no_namesakes(graph, looking_soon, capfd):
    graph.start(watched("twin"), namespace="/left")
    right = graph.start(watched("twin"), namespace="/right")
    right.get_logger().info("both are here")
    graph.receive(Log, "/rosout", LATCHED, lambda log: log.msg == "both are here")
    again = graph.start(watched("other"))
    graph.start(watched("other"))
    graph.receive(Log, "/rosout", LATCHED, lambda log: "another node '/other'" in log.msg)
    assert "twin" not in capfd.readouterr().err.replace("[right.twin]: both are here", "")
    assert again
