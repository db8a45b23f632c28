"""Rolling robots from YAML: those that come along, and files that are wrong."""

from pathlib import Path

import numpy as np
import pytest

from robomech_ros.errors import BadValueError, RobotDescriptionError, UnknownRobotError
from robomech_ros.rolling import list_rolling, load_rolling, rolling_robot

GOOD = """
kind: rolling
name: cart
source: here
drive: diff
wheels:
  - {name: left, kind: fixed, position: [0.0, 0.2], radius: 0.1}
  - {name: right, kind: fixed, position: [0.0, -0.2], radius: 0.1}
"""


@pytest.mark.parametrize("name", list_rolling())
def test_robots_that_come_along(name):
    robot = rolling_robot(name)
    assert robot.base.name == name
    assert len(robot.source) > 40
    assert np.isfinite(robot.limits.jerk).all()
    assert load_rolling(name).names == robot.base.names


def test_a_robot_for_every_drive_that_the_issue_names():
    drives = {rolling_robot(name).drive for name in list_rolling()}
    assert drives == {"diff", "tricycle", "ackermann", "omni", "mecanum", "swerve"}


def test_a_document_and_a_path(tmp_path):
    path = tmp_path / "cart.yaml"
    path.write_text(GOOD, encoding="utf-8")
    for given in (GOOD, path, str(path)):
        assert load_rolling(given).driven == ("left", "right")
    assert not np.isfinite(rolling_robot(path).limits.velocity).any()


@pytest.mark.parametrize(
    ("old", "new", "text"),
    [
        ("kind: rolling", "kind: parallel", "kind: 'parallel', expected rolling"),
        ("drive: diff", "drive: tank", "drive: 'tank', expected diff or omni"),
        ("source: here", "source: 3", "source: '3', expected a text"),
        (
            "radius: 0.1}\n  - {name: right",
            "radius: x}\n  - {name: right",
            "wheels: 0: radius is 'x'",
        ),
        ("position: [0.0, -0.2]", "position: [0.1, -0.2]", "one common axle"),
        ("name: right, ", "name: left, ", "names that differ"),
        (", radius: 0.1}\n  - {name: right", ", radious: 0.1}\n  - {name: right", "unknown key"),
        ("drive: diff\n", "drive: diff\nlimits: {velocity: [1, 2]}\n", "velocity has shape"),
        ("drive: diff\n", "drive: diff\nlimits: {speed: 3}\n", "unknown key 'speed'"),
        ("drive: diff\n", "drive: diff\nbodies: {platform: {mass: 1}}\n", "missing key 'wheels'"),
        (
            "drive: diff\n",
            "drive: diff\nbodies: {platform: {mass: 1, inertia: 1}, wheels: {front: {}}}\n",
            "unknown key 'front'",
        ),
        (
            "drive: diff\n",
            "drive: diff\nbodies: {platform: {mass: 1, inertia: 1}, wheels: {all: {mass: -1}}}\n",
            "mass is -1",
        ),
    ],
)
def test_documents_that_are_wrong(old, new, text):
    assert old in GOOD
    with pytest.raises(RobotDescriptionError, match=text):
        load_rolling(GOOD.replace(old, new))


def test_names_that_are_none():
    with pytest.raises(UnknownRobotError, match="available: mecanum, ackermann"):
        load_rolling("mecanumm")
    with pytest.raises(BadValueError, match="a robot's name"):
        load_rolling(3)
    with pytest.raises(RobotDescriptionError, match="expected a file named"):
        load_rolling(Path("cart.urdf"))
