"""The present joint state, by name, from whoever publishes it."""

import numpy as np
import pytest
from rclpy.node import Node
from sensor_msgs.msg import JointState
from waiting import until

from robomech_ros.nodes.common.joints.joint_state_monitor import JointStateMonitor
from robomech_ros.nodes.common.messages.error_codes import NoStateError

NAMES = ("a", "b")
PATIENCE = 30.0


class Listener(Node):
    def __init__(self, **options):
        super().__init__("listener", **options)
        self.monitor = JointStateMonitor(self)


@pytest.fixture
def listener(graph):
    return graph.start(Listener)


@pytest.fixture
def publish(graph, listener):
    publisher = graph.client.create_publisher(JointState, "joint_states", 100)
    until(publisher.get_subscription_count)
    return lambda names, values: publisher.publish(
        JointState(name=list(names), position=[float(value) for value in values])
    )


def wait_for(listener, names, expected):
    until(lambda: np.array_equal(listener.monitor.positions(names), expected))


def test_nothing_is_known_at_first(listener):
    assert listener.monitor.positions(NAMES) is None
    with pytest.raises(NoStateError, match=r"joint\(s\) a, b: nothing received on '/joint_states'"):
        listener.monitor.require(NAMES)


def test_latest_state_in_any_order(listener, publish):
    for value in range(60):
        publish("ab", (value, -value))
    wait_for(listener, ("b", "a"), (-59.0, 59.0))
    np.testing.assert_array_equal(listener.monitor.require(NAMES), (59.0, -59.0))


def test_states_of_several_publishers_are_put_together(listener, publish):
    publish("a", [1])
    for value in range(20):
        publish("b", [value])
    wait_for(listener, NAMES, (1.0, 19.0))
    publish("a", [2])
    wait_for(listener, NAMES, (2.0, 19.0))


def test_news_are_counted_joint_by_joint(listener, publish):
    assert listener.monitor.update_count(NAMES) == 0
    publish("ab", (1, 2))
    wait_for(listener, NAMES, (1.0, 2.0))
    first = listener.monitor.update_count(NAMES)
    assert first > 0
    publish("a", [3])
    wait_for(listener, NAMES, (3.0, 2.0))
    assert listener.monitor.update_count(NAMES) == first
    assert listener.monitor.update_count("a") > first
    publish("b", [4])
    wait_for(listener, NAMES, (3.0, 4.0))
    assert listener.monitor.update_count(NAMES) > first


def test_useless_messages_are_passed_over(listener, publish):
    publish("ab", (1, 2))
    publish("ab", ())
    publish("ab", (3,))
    publish("ab", (np.nan, 4))
    wait_for(listener, NAMES, (1.0, 4.0))
    with pytest.raises(NoStateError, match=r"joint\(s\) c: .*the position of 'a' is nan"):
        listener.monitor.require(("a", "c"))
    publish("aba", (5, 6, 7))
    publish("b", [8])
    wait_for(listener, NAMES, (1.0, 8.0))
    with pytest.raises(NoStateError, match="could not be used: 'a' is in it twice"):
        listener.monitor.require("c")


def test_joints_of_others_are_named_where_one_is_missing(listener, publish):
    publish("ab", (1, 2))
    wait_for(listener, NAMES, (1.0, 2.0))
    with pytest.raises(NoStateError, match=r"joint\(s\) c: only a, b received"):
        listener.monitor.require(("a", "c"))
