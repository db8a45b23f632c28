"""How long commands of rolling robots count that bringup starts, and what replaces that."""

from functools import partial
from pathlib import Path

import pytest
import yaml

from robomech_ros.nodes.common.parameters import table_rows
from robomech_ros.nodes.mobile_base.drives import INTERFACES
from robomech_ros.nodes.mobile_base.node import MobileBaseNode
from robomech_ros.nodes.mobile_base.settings import MobileBaseSettings
from robomech_ros.nodes.process.launch_options import LaunchOptions, config_file
from robomech_ros.rolling import list_rolling, rolling_robot

PARAMETER = "reference_timeout:=0.1"


def timeout(graph, words):
    """Return the time-out (s) of the node with these ROS arguments."""
    return graph.start(partial(MobileBaseNode, cli_args=words))._base.options.timeout


def timeout_by(graph, robot="mecanum", **given):
    """Return the time-out (s) of the node that bringup starts."""
    words = LaunchOptions(robot, kind="rolling", **given).commands()["mobile_base"]
    return timeout(graph, words[words.index("--ros-args") :])


def test_drives_whose_commands_count_for_one_update_have_a_file_of_their_own():
    for drive, interface in INTERFACES.items():
        files = config_file(f"mobile_base.{drive}")
        assert bool(files) is (interface.timeout == 0.0), drive
        for path in files[1:]:
            given = yaml.safe_load(Path(path).read_text("utf-8"))["/**"]["mobile_base"]
            names = {row.name for row in table_rows(MobileBaseSettings)}
            assert given["ros__parameters"].keys() == {interface.timeout_name} <= names


@pytest.mark.parametrize("robot", list_rolling())
def test_commands_of_every_robot_count_for_half_a_second_at_least(graph, robot):
    """Those of a mecanum base counted for one update: it moved by fits on a busy machine."""
    default = INTERFACES[rolling_robot(robot).drive].timeout
    assert timeout_by(graph, robot) == (default or 0.5)


def test_the_default_of_the_node_stays_that_of_ros2_controllers(graph):
    node = graph.start(MobileBaseNode, robot_description="mecanum")
    assert node._base.options.timeout == 0.0


@pytest.mark.parametrize(
    "given",
    [
        {"ros_args": ("-p", PARAMETER)},
        {"ros_args": ("-p", f"mobile_base:{PARAMETER}")},
        {"ros_args": ("-p", PARAMETER), "namespace": "left", "view": True},
    ],
)
def test_a_parameter_replaces_it(graph, given):
    assert timeout_by(graph, **given) == 0.1


@pytest.mark.parametrize(
    "text",
    [
        "/**: {ros__parameters: {reference_timeout: 0.1}}",
        "/**: {mobile_base: {ros__parameters: {reference_timeout: 0.1}}}",
        "mobile_base: {ros__parameters: {reference_timeout: 0.1}}",
    ],
)
@pytest.mark.parametrize("among_ros_args", [True, False])
def test_a_file_replaces_it(graph, tmp_path, text, among_ros_args):
    path = tmp_path / "own.yaml"
    path.write_text(text + "\n", encoding="utf-8")
    words = ("--params-file", str(path))
    given = {"ros_args": words} if among_ros_args else {"params_files": words[1:]}
    assert timeout_by(graph, **given) == 0.1


def test_what_comes_later_counts(graph, tmp_path):
    path = tmp_path / "own.yaml"
    text = "/**: {mobile_base: {ros__parameters: {reference_timeout: 0.3}}}\n"
    path.write_text(text, encoding="utf-8")
    given = {"params_files": (str(path),), "ros_args": ("-p", PARAMETER)}
    assert timeout_by(graph, **given) == 0.1


@pytest.mark.parametrize("view", [True, False])
@pytest.mark.parametrize(("given", "expected"), [((), 0.5), (("-p", PARAMETER), 0.1)])
def test_in_one_process_it_is_the_same(graph, view, given, expected):
    options = LaunchOptions("mecanum", kind="rolling", view=view, ros_args=given)
    with options.arguments_of_one_process() as words:
        assert timeout(graph, words) == expected
