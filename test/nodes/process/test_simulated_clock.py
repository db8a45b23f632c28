"""Nodes that wait for simulated time say so."""

import time

import pytest
from builtin_interfaces.msg import Time
from rcl_interfaces.msg import Log
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from rosgraph_msgs.msg import Clock

from robomech_ros.nodes.process import simulated_clock

LATCHED = QoSProfile(depth=100, durability=DurabilityPolicy.TRANSIENT_LOCAL)
PATIENCE = 30.0


@pytest.fixture
def looking_soon(monkeypatch):
    monkeypatch.setattr(simulated_clock, "PERIOD", 0.1)
    monkeypatch.setattr(simulated_clock, "EVERY", 1)


def watched(**options):
    node = Node("watched", **options)
    simulated_clock.watch_for_simulated_time([node])
    return node


def test_a_clock_that_does_not_come_is_said_until_it_comes(graph, looking_soon):
    """Nothing said why: /joint_states were missing, and ~/execute did not answer."""
    node = graph.start(watched, use_sim_time=True)
    nobody = "use_sim_time is true, but nobody publishes '/clock': nothing moves"
    graph.receive(Log, "/rosout", LATCHED, lambda log: log.msg.startswith(nobody))
    publisher = graph.client.create_publisher(Clock, "/clock", 10)
    still = "use_sim_time is true, but the time on '/clock' is still 0: nothing moves"
    graph.receive(Log, "/rosout", LATCHED, lambda log: log.msg.startswith(still))
    (timer,) = node.timers
    deadline = time.monotonic() + PATIENCE
    while not timer.is_canceled():
        assert time.monotonic() < deadline, "it goes on looking"
        publisher.publish(Clock(clock=Time(sec=5)))
        time.sleep(0.05)


def test_the_time_of_the_machine_is_not_watched(graph, looking_soon):
    assert not list(graph.start(watched).timers)
