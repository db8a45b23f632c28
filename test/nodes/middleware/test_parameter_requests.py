"""Requests for parameters that their senders made wrong: answered, and no defect of the node."""

import pytest
from rcl_interfaces.msg import Log, Parameter, ParameterValue
from rcl_interfaces.srv import GetParameters, SetParameters, SetParametersAtomically
from rclpy.qos import DurabilityPolicy, QoSProfile

from robomech_ros.nodes.kinematics.node import KinematicsNode
from robomech_ros.nodes.middleware import bounded_requests

LATCHED = QoSProfile(depth=1000, durability=DurabilityPolicy.TRANSIENT_LOCAL)
GOOD = Parameter(name="use_sim_time", value=ParameterValue(type=1, bool_value=False))
BAD = Parameter(name="seed", value=ParameterValue(type=200))


@pytest.fixture
def node(graph):
    """Any node of ours, which serves nothing but parameters here."""
    return graph.start(KinematicsNode, robot_description="puma560")


def assert_blamed_on_the_sender(graph):
    said = []

    def logged(message):
        said.append(message.msg)
        return "its sender made the request wrong" in message.msg

    assert "\n" not in graph.receive(Log, "/rosout", LATCHED, logged).msg
    assert not [text for text in said if "please report" in text]


def test_a_type_that_there_is_not(graph, node):
    request = SetParameters.Request(parameters=[GOOD, BAD])
    answer = graph.call(SetParameters, "kinematics/set_parameters", request)
    assert [result.successful for result in answer.results] == [False, False]
    assert "'seed' of the type 200" in answer.results[1].reason
    request = SetParametersAtomically.Request(parameters=[GOOD, BAD])
    answer = graph.call(SetParametersAtomically, "kinematics/set_parameters_atomically", request)
    assert not answer.result.successful
    assert "'seed' of the type 200" in answer.result.reason
    assert_blamed_on_the_sender(graph)
    answer = graph.call(
        SetParameters, "kinematics/set_parameters", SetParameters.Request(parameters=[GOOD])
    )
    assert answer.results[0].successful


def test_more_than_can_be_read(graph, node, monkeypatch):
    monkeypatch.setattr(bounded_requests, "MOST_OBJECTS", 1000)
    request = GetParameters.Request(names=["seed"] * 2000)
    assert not graph.call(GetParameters, "kinematics/get_parameters", request).values
    assert_blamed_on_the_sender(graph)
    request = GetParameters.Request(names=["use_sim_time"])
    assert graph.call(GetParameters, "kinematics/get_parameters", request).values[0].type == 1
