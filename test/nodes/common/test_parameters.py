"""The declarative table of parameters: checks at start and at run time, descriptors, help."""

import math
from dataclasses import dataclass
from typing import Any

import pytest
from rcl_interfaces.msg import ParameterType
from rcl_interfaces.srv import DescribeParameters, GetParameters, ListParameters, SetParameters
from rclpy.node import Node
from rclpy.parameter import Parameter

from robomech_ros.nodes.common.parameters import (
    NodeParameters,
    ParameterError,
    parameter,
    table_rows,
)
from robomech_ros.nodes.dynamics.node import DynamicsNode
from robomech_ros.nodes.joint_trajectory_controller.node import JointTrajectoryControllerNode
from robomech_ros.nodes.kinematics.node import KinematicsNode
from robomech_ros.nodes.servo.node import ServoNode
from robomech_ros.nodes.trajectory_planner.node import TrajectoryPlannerNode
from robomech_ros.nodes.trajectory_publisher.node import TrajectoryPublisherNode

NODES = [
    DynamicsNode,
    JointTrajectoryControllerNode,
    KinematicsNode,
    ServoNode,
    TrajectoryPlannerNode,
    TrajectoryPublisherNode,
]


@dataclass(frozen=True)
class Table:
    rate: float = parameter(100.0, "How often", (1.0, 1000.0, "Hz"))
    count: int = parameter(3, "How many", (1, None))
    method: str = parameter("fast", "How", choices=("fast", "slow"))
    tolerances: tuple[float, ...] = parameter((), "How close", (0.0, None))
    scale: float = parameter(1.0, "How much", (0.0, 2.0), read_only=False)
    enabled: bool = parameter(True, "Whether")
    names: tuple[str, ...] = parameter((), "Which")


class TableNode(Node):
    SETTINGS = Table

    def __init__(self, **options: Any) -> None:
        super().__init__("table", **options)
        self.changes: list[Table] = []
        self.parameters = NodeParameters(self, Table, self.changes.append)


def test_defaults(graph):
    assert graph.start(TableNode).parameters.settings == Table()


def test_given_values_arrive_in_the_declared_type(graph):
    node = graph.start(TableNode, rate=50, count=7, method="slow", tolerances=[1, 2])
    settings = node.parameters.settings
    assert (settings.rate, settings.count, settings.method) == (50.0, 7, "slow")
    assert settings.tolerances == (1.0, 2.0)
    assert type(settings.rate) is float
    assert node.get_parameter("rate").value == 50.0


@pytest.mark.parametrize(
    ("name", "value", "allowed"),
    [
        ("rate", 0.5, "a number from 1 to 1000 Hz"),
        ("rate", math.nan, "a number from 1 to 1000 Hz"),
        ("rate", math.inf, "a number from 1 to 1000 Hz"),
        ("rate", "fast", "a number from 1 to 1000 Hz"),
        ("rate", True, "a number from 1 to 1000 Hz"),
        ("count", 0, "an integer of at least 1"),
        ("count", 2.0, "an integer of at least 1"),
        ("method", "medium", "one of 'fast', 'slow'"),
        ("method", 5, "one of 'fast', 'slow'"),
        ("tolerances", [0.1, -0.1], "a list of numbers, each of at least 0"),
        ("tolerances", ["a"], "a list of numbers, each of at least 0"),
        ("tolerances", 0.1, "a list of numbers, each of at least 0"),
        ("enabled", 1, "true or false"),
        ("names", [1.0], "a list of strings"),
        ("names", "one", "a list of strings"),
        ("names", 5, "a list of strings"),
        ("names", True, "a list of strings"),
    ],
)
def test_a_wrong_value_at_start_names_parameter_value_and_what_is_allowed(
    graph, name, value, allowed
):
    with pytest.raises(ParameterError) as caught:
        graph.start(TableNode, **{name: value})
    assert caught.value.name == name
    assert str(caught.value) == f"parameter '{name}' is {value!r}; allowed is {allowed}"


@pytest.mark.parametrize("kind", NODES, ids=lambda kind: kind.__name__)
def test_a_node_that_refuses_a_parameter_can_be_destroyed(graph, kind):
    made = []

    class Kept(kind):
        def __init__(self, **options: Any) -> None:
            made.append(self)
            super().__init__(**options)

    with pytest.raises(ParameterError):
        graph.start(Kept, groups=5)
    made[0].destroy_node()


def set_parameter(graph: Any, name: str, value: Any) -> Any:
    request = SetParameters.Request(parameters=[Parameter(name, value=value).to_parameter_msg()])
    return graph.call(SetParameters, "table/set_parameters", request).results[0]


def test_run_time_change(graph):
    node = graph.start(TableNode)
    assert set_parameter(graph, "scale", 0.5).successful
    assert node.parameters.settings.scale == 0.5
    assert node.changes == [Table(scale=0.5)]


@pytest.mark.parametrize(
    ("name", "value", "reason"),
    [
        ("rate", 50.0, "read-only"),
        ("scale", 3.0, "out of range"),
        ("scale", math.nan, "out of range"),
        ("scale", "much", "type"),
    ],
)
def test_refused_run_time_change(graph, name, value, reason):
    node = graph.start(TableNode)
    result = set_parameter(graph, name, value)
    assert not result.successful
    assert reason in result.reason
    assert node.parameters.settings == Table()
    assert node.changes == []


def test_lists_of_strings(graph):
    node = graph.start(TableNode, names=["one", "two"])
    assert node.parameters.settings.names == ("one", "two")
    assert node.get_parameter("names").value == ["one", "two"]
    empty = graph.start(TableNode, namespace="other")
    assert empty.parameters.settings.names == ()
    request = DescribeParameters.Request(names=["names"])
    (found,) = graph.call(
        DescribeParameters, "other/table/describe_parameters", request
    ).descriptors
    assert found.type == ParameterType.PARAMETER_STRING_ARRAY
    assert found.additional_constraints == "a list of strings"


def test_descriptors(graph):
    graph.start(TableNode)
    request = DescribeParameters.Request(names=["rate", "count", "method", "scale", "tolerances"])
    answer = graph.call(DescribeParameters, "table/describe_parameters", request)
    rate, count, method, scale, tolerances = answer.descriptors
    assert (rate.description, rate.type) == ("How often [Hz]", ParameterType.PARAMETER_DOUBLE)
    assert (rate.floating_point_range[0].from_value, rate.floating_point_range[0].to_value) == (
        1.0,
        1000.0,
    )
    assert rate.read_only
    assert count.integer_range[0].from_value == 1
    assert method.additional_constraints == "one of 'fast', 'slow'"
    assert not scale.read_only
    assert tolerances.type == ParameterType.PARAMETER_DOUBLE_ARRAY


def test_every_parameter_has_a_value_to_be_asked_for(graph):
    node = graph.start(TableNode)
    names = [row.name for row in table_rows(Table)]
    answer = graph.ask(GetParameters, "table/get_parameters", names=names)
    values = dict(zip(names, answer.values, strict=True))
    assert values["tolerances"].type == ParameterType.PARAMETER_DOUBLE_ARRAY
    assert list(values["tolerances"].double_array_value) == []
    assert values["rate"].double_value == 100.0
    assert node.get_parameter("tolerances").value == []
    assert node.parameters.settings == Table()


@pytest.mark.parametrize("kind", NODES, ids=lambda kind: kind.__name__)
def test_all_parameters_of_a_node_are_dumped_at_once(graph, kind):
    """As `ros2 param dump` does."""
    name = graph.start(kind).get_name()
    listed = graph.ask(ListParameters, f"{name}/list_parameters")
    names = listed.result.names
    assert {row.name for row in table_rows(kind.SETTINGS)} <= set(names)
    answer = graph.ask(GetParameters, f"{name}/get_parameters", names=names)
    assert len(answer.values) == len(names)
    unset = ParameterType.PARAMETER_NOT_SET
    assert not [n for n, value in zip(names, answer.values, strict=True) if value.type == unset]


def test_rows_say_everything():
    rows = {row.name: row for row in table_rows(Table)}
    assert list(rows) == ["rate", "count", "method", "tolerances", "scale", "enabled", "names"]
    assert rows["rate"].allowed == "a number from 1 to 1000 Hz"
    assert rows["tolerances"].default == ()
