"""Descriptions that come by a topic are documents; they never make a node read a file."""

import pytest
from rcl_interfaces.msg import Log
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String
from std_srvs.srv import Trigger

from robomech_ros.nodes.common.robot.robot_description import LATCHED
from robomech_ros.nodes.kinematics.node import KinematicsNode
from robomech_ros.robots import load_description

ROSOUT = QoSProfile(depth=100, durability=DurabilityPolicy.TRANSIENT_LOCAL)
SECRET = "name: hunter2\nrows: 3\n"


@pytest.fixture
def secret(tmp_path):
    path = tmp_path / "secret.yaml"
    path.write_text(SECRET)
    return str(path)


def logged(graph, part):
    found = graph.receive(Log, "/rosout", ROSOUT, lambda log: part in log.msg)
    return found.msg


def test_a_path_is_refused_unread_and_the_node_waits_on(graph, secret):
    graph.start(KinematicsNode)
    publisher = graph.client.create_publisher(String, "robot_description", LATCHED)
    publisher.publish(String(data=secret))
    text = logged(graph, "unusable robot on '/robot_description'")
    assert "expected the text of a URDF; names and files are for the parameter" in text
    assert "hunter2" not in text
    answer = graph.ask(Trigger, "kinematics/ready")
    assert not answer.success and "hunter2" not in answer.message
    publisher.publish(String(data=load_description("ur5e").document))
    logged(graph, "ready: ")
    assert graph.ask(Trigger, "kinematics/ready").success


def test_a_path_is_no_srdf_either(graph, secret):
    graph.start(KinematicsNode, robot_description="ur5e")
    publisher = graph.client.create_publisher(String, "robot_description_semantic", LATCHED)
    publisher.publish(String(data=secret))
    text = logged(graph, "unusable SRDF on '/robot_description_semantic'")
    assert text.endswith("ignored: it is no XML")
