"""Files with joint limits: both forms, and what is wrong with them."""

import math

import pytest

from robomech_ros.errors import RobotDescriptionError
from robomech_ros.nodes.common.joint_limits import read_joint_limits
from robomech_ros.nodes.common.parameters import ParameterError
from robomech_ros.robots import load_description

URDF = """<robot name="bare">
  <link name="base"/><link name="arm"/><link name="tip"/>
  <joint name="lift" type="prismatic"><parent link="base"/><child link="arm"/>
    <limit lower="-1" upper="1" velocity="2" effort="1"/></joint>
  <joint name="swing" type="continuous"><parent link="arm"/><child link="tip"/></joint>
</robot>"""


@pytest.fixture
def limited(tmp_path):
    """Give the joints of the robot by name, limited by a file with this text."""

    def load(text):
        file = tmp_path / "limits.yaml"
        file.write_text(text, encoding="utf-8")
        joints = read_joint_limits(str(file)).on(load_description(URDF)).joints
        return {joint.name: joint for joint in joints}

    return load


def test_limits_of_moveit(limited):
    joints = limited("""
joint_limits:
  lift: {has_velocity_limits: true, max_velocity: 3.0, has_acceleration_limits: true,
    max_acceleration: 5, has_deceleration_limits: true, max_deceleration: 4.0,
    has_position_limits: true, min_position: -2.0, max_position: 0.5}
  swing: {max_velocity: 1.5, has_acceleration_limits: false, max_acceleration: 0,
    has_jerk_limits: true, max_jerk: 30.0}
""")
    lift, swing = joints["lift"], joints["swing"]
    # Ranges and velocities only get narrower.
    assert (lift.lower, lift.upper, lift.velocity, lift.acceleration) == (-1.0, 0.5, 2.0, 4.0)
    assert math.isnan(lift.jerk)
    assert (swing.velocity, swing.jerk) == (1.5, 30.0)
    assert math.isnan(swing.acceleration)


def test_limits_as_beside_a_urdf(limited):
    joints = limited("{source: made up, joints: {swing: {acceleration: 5.0, jerk: 50.0}}}")
    assert (joints["swing"].acceleration, joints["swing"].jerk) == (5.0, 50.0)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("joint_limits: [1]", "expected joint names, each with its limits"),
        ("joint_limits: {lfit: {}}", "no joint 'lfit' in URDF string, which has: lift, swing"),
        ("joint_limits: {lift: {max_speed: 1.0}}", "unknown key 'max_speed'"),
        ("joint_limits: {lift: {max_velocity: fast}}", "max_velocity is 'fast', expected a number"),
        ("joint_limits: {lift: {max_jerk: .inf}}", "max_jerk is 'inf', expected a number"),
        ("joint_limits: {lift: {max_jerk: -1}}", "max_jerk is -1, expected a positive number"),
        ("joint_limits: {lift: {has_jerk_limits: true}}", "max_jerk is 'None', expected a number"),
        ("joint_limits: {lift: {has_jerk_limits: 1, max_jerk: 1}}", "is '1', expected a bool"),
        (
            "joint_limits: {lift: {min_position: 2.0, max_position: 3.0}}",
            "no position from 2 to 1 m, what this file and the robot have in common",
        ),
        ("{joint_limits: {}, more: 1}", "unknown key 'more'"),
        ("{source: none, joints: {lfit: {jerk: 1.0}}}", "joint 'lfit'"),
        ("- 1", "the top level is list"),
    ],
)
def test_what_is_wrong_is_named(limited, text, words):
    with pytest.raises(RobotDescriptionError) as caught:
        limited(text)
    assert "limits.yaml" in str(caught.value)
    assert words in str(caught.value)


@pytest.mark.parametrize(("name", "why"), [("no.yaml", "No such file"), ("", "not a regular file")])
def test_a_file_that_cannot_be_read(tmp_path, name, why):
    with pytest.raises(ParameterError, match="parameter 'joint_limits' is") as caught:
        read_joint_limits(str(tmp_path / name))
    assert why in str(caught.value)
