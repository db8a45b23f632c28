"""Nodes that wait for the robot say so, to whoever asks."""

import pytest
from rcl_interfaces.msg import Log
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String
from std_srvs.srv import Trigger

from robomech_ros.nodes.common import readiness
from robomech_ros.nodes.common.robot.robot_description import LATCHED
from robomech_ros.nodes.dynamics.node import DynamicsNode
from robomech_ros.nodes.kinematics.node import KinematicsNode
from robomech_ros.nodes.trajectory_publisher.node import TrajectoryPublisherNode
from robomech_ros.robots import load_description


def ready(graph, node):
    answer = graph.ask(Trigger, f"{node}/ready")
    return answer.success, answer.message


def test_a_node_without_a_robot_says_what_it_waits_for(graph, monkeypatch):
    monkeypatch.setattr(readiness, "REMINDER", 0.1)
    graph.start(KinematicsNode)
    success, text = ready(graph, "kinematics")
    assert not success
    assert text.startswith("waiting for the robot on topic '/robot_description' (a latched")
    assert "by the parameter robot_description of '/kinematics'" in text
    latched = QoSProfile(depth=100, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    warning = 30
    graph.receive(Log, "/rosout", latched, lambda log: log.msg == text and log.level == warning)
    publisher = graph.client.create_publisher(String, "robot_description", LATCHED)
    publisher.publish(String(data="<robot name='none'/>"))
    graph.receive(Log, "/rosout", latched, lambda log: "unusable robot" in log.msg)
    success, text = ready(graph, "kinematics")
    assert not success and text.startswith("unusable robot on '/robot_description': ")
    urdf = load_description("ur5e").where
    with open(urdf, encoding="utf-8") as file:
        publisher.publish(String(data=file.read()))
    graph.receive(Log, "/rosout", latched, lambda log: log.msg.startswith("ready: "))
    assert ready(graph, "kinematics") == (True, "ready")


@pytest.mark.parametrize(
    ("kind", "name", "parameters"),
    [
        (DynamicsNode, "dynamics", {"robot_description": "puma560"}),
        (TrajectoryPublisherNode, "trajectory_publisher", {}),
    ],
)
def test_a_node_that_has_what_it_needs_is_ready(graph, kind, name, parameters):
    graph.start(kind, **parameters)
    assert ready(graph, name) == (True, "ready")
