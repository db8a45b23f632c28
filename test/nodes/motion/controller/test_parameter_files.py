"""The parameter files in config/ name every parameter with its default."""

from dataclasses import fields
from pathlib import Path

import pytest
import yaml

from robomech_ros.nodes.joint_trajectory_controller.settings import ControllerSettings
from robomech_ros.nodes.servo.settings import ServoNodeSettings
from robomech_ros.nodes.trajectory_publisher.settings import PublisherSettings

CONFIG = Path(__file__).parents[4] / "config"
TABLES = {
    "joint_trajectory_controller": ControllerSettings,
    "trajectory_publisher": PublisherSettings,
    "servo": ServoNodeSettings,
}


@pytest.mark.parametrize("node", TABLES)
def test_values_are_the_defaults(node):
    text = (CONFIG / f"{node}.yaml").read_text(encoding="utf-8")
    given = yaml.safe_load(text)["/**"][node]["ros__parameters"]
    defaults = {entry.name: entry.default for entry in fields(TABLES[node]) if entry.default != ()}
    lists = {name: tuple(value) for name, value in given.items() if isinstance(value, list)}
    assert given | lists == defaults
