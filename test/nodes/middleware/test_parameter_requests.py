"""Malformed parameter requests are answered, and are no defect of the node."""

import pytest
from rcl_interfaces.msg import Log, Parameter, ParameterValue
from rcl_interfaces.srv import SetParameters, SetParametersAtomically
from rclpy.qos import DurabilityPolicy, QoSProfile

from robomech_ros.nodes.kinematics.node import KinematicsNode

LATCHED = QoSProfile(depth=1000, durability=DurabilityPolicy.TRANSIENT_LOCAL)
GOOD = Parameter(name="use_sim_time", value=ParameterValue(type=1, bool_value=False))
BAD = Parameter(name="seed", value=ParameterValue(type=200))


@pytest.fixture
def node(graph):
    """Any node of ours, which serves nothing but parameters here."""
    return graph.start(KinematicsNode, robot_description="puma560")


def assert_logged_in_one_line(graph):
    said = []

    def logged(message):
        said.append(message.msg)
        return "rejected a malformed request" in message.msg

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
    assert_logged_in_one_line(graph)
    answer = graph.call(
        SetParameters, "kinematics/set_parameters", SetParameters.Request(parameters=[GOOD])
    )
    assert answer.results[0].successful
