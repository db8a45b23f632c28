"""Launch files and commands of the pages name executables, nodes and parameters that exist."""

import ast
import re
from dataclasses import fields
from importlib import import_module
from pathlib import Path

import pytest
from rclpy.node import Node

from robomech_ros.nodes.common.parameters import table_rows
from robomech_ros.nodes.process.entry_points import NODE_MODULES
from robomech_ros.nodes.process.launch_options import LaunchOptions

ROOT = Path(__file__).parents[3]
PAGE = (ROOT / "doc" / "launch.md").read_text(encoding="utf-8")
FILES = re.findall(r"^```py\n(.*?)^```", PAGE, re.DOTALL | re.MULTILINE)


def settings_of(node):
    """The table of parameters of a node, by its name."""
    classes = vars(import_module(NODE_MODULES[node])).values()
    kinds = [c for c in classes if isinstance(c, type) and issubclass(c, Node) and c is not Node]
    (kind,) = [c for c in kinds if c.__module__ == NODE_MODULES[node]]
    return kind.SETTINGS


def literal(source, name):
    """The value that a file assigns to a name."""
    for statement in ast.parse(source).body:
        if isinstance(statement, ast.Assign) and ast.unparse(statement.targets[0]) == name:
            return ast.literal_eval(statement.value)
    raise AssertionError(f"no {name}")


@pytest.mark.parametrize("source", FILES)
def test_files_are_python_and_describe_a_launch(source):
    names = [s.name for s in ast.parse(source).body if isinstance(s, ast.FunctionDef)]
    assert names == ["generate_launch_description"]


def test_nodes_and_parameters_exist():
    nodes = literal(FILES[1], "NODES")
    assert {node for _, node, _ in nodes} == set(LaunchOptions().nodes)
    shared = re.findall(r'^        "(\w+)": ParameterValue', FILES[1], re.MULTILINE)
    assert shared == ["robot_description", "frame_prefix"]
    setup = (ROOT / "setup.py").read_text(encoding="utf-8")
    for executable, node, own in nodes:
        assert f'"{executable}"' in setup
        table = settings_of(node)
        known = {field.name: field.type for field in fields(table)}
        assert known.keys() >= {*shared, *own}
        assert table_rows(table)


def test_parameters_in_commands_of_the_pages_exist():
    commands = [
        (page.name, *found)
        for page in [ROOT / "README.md", *(ROOT / "doc").glob("*.md")]
        for found in re.findall(
            r"^(?:ros2 run robomech_ros )?(\w+)_node (.*(?:\\\n.*)*)", page.read_text("utf-8"), re.M
        )
    ]
    named = [
        (page, node, name)
        for page, node, arguments in commands
        for name in re.findall(r"-p (\w+):=", arguments)
    ]
    assert {page for page, *_ in named} >= {"README.md", "real_robot.md", "servo.md"}
    for page, executable, name in named:
        node = executable.replace("joint_state_simulator", "joint_trajectory_controller")
        known = {field.name for field in fields(settings_of(node))}
        assert name in known, f"{page}: {node} has no parameter {name}"
