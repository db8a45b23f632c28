"""Files with joint limits: both forms, and what is wrong with them."""

import math
from pathlib import Path

import numpy as np
import pytest

from robomech_ros.errors import RobotDescriptionError
from robomech_ros.execution.joints import Joints
from robomech_ros.nodes.common.joints.joint_limits import read_joint_limits, with_assumed_rates
from robomech_ros.nodes.common.parameters import ParameterError
from robomech_ros.robots import load_description
from robomech_ros.trajectory.limits import Limits

URDF = """<robot name="bare">
  <link name="base"/><link name="arm"/><link name="tip"/>
  <joint name="lift" type="prismatic"><parent link="base"/><child link="arm"/>
    <limit lower="-1" upper="1" velocity="2" effort="1"/></joint>
  <joint name="swing" type="continuous"><parent link="arm"/><child link="tip"/></joint>
</robot>"""


PILZ = Path(__file__).parents[2] / "data/field/joint_limits_pilz.yaml"
SPEED = '<limit velocity="1.5" effort="1"/>'
LAYOUTS = [
    ("robot_description_planning",),
    ("/**", "ros__parameters", "robot_description_planning"),
    ("move_group", "ros__parameters"),
    ("/**", "move_group", "ros__parameters", "robot_description_planning"),
]


@pytest.fixture
def limited(tmp_path):
    """Return the joints of the robot by name, limited by a file with this text."""

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
        ("joint_limits: {lift: {max_speed: 1.0}}", "unknown key 'max_speed'"),
        ("joint_limits: {lift: {max_velocity: fast}}", "max_velocity is 'fast', expected a"),
        ("joint_limits: {lift: {max_jerk: .inf}}", "max_jerk is 'inf', expected a finite number"),
        ("joint_limits: {lift: {max_jerk: -1}}", "max_jerk limit is -1, expected a positive"),
        ("joint_limits: {lift: {has_jerk_limits: true}}", "max_jerk is 'None', expected a"),
        ("joint_limits: {lift: {has_jerk_limits: 1, max_jerk: 1}}", "is 1, expected true or false"),
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


PLAIN = """
joint_limits:
  lift: {has_acceleration_limits: yes, max_acceleration: 5.0, has_jerk_limits: off, max_jerk: 0}
"""


@pytest.mark.parametrize("within", [(), *LAYOUTS])
@pytest.mark.parametrize("words", [("yes", "off"), ("on", "no"), ("True", "FALSE"), ("Yes", "Off")])
def test_layouts_and_booleans_of_ros(limited, within, words):
    text = PLAIN.replace("yes", words[0]).replace("off", words[1])
    for key in reversed(within):
        text = f"{key}:\n" + "".join(f"  {line}\n" for line in text.splitlines())
    lift = limited(text)["lift"]
    assert lift.acceleration == 5.0
    assert math.isnan(lift.jerk)


def test_decelerations_as_pilz_writes_them():
    ur5e = load_description("ur5e")
    joints = {joint.name: joint for joint in read_joint_limits(str(PILZ)).on(ur5e).joints}
    assert (joints["elbow_joint"].velocity, joints["elbow_joint"].acceleration) == (2.0, 3.0)


def test_joints_that_the_robot_does_not_have_are_noted_and_left_out(tmp_path):
    file = tmp_path / "limits.yaml"
    file.write_text("joint_limits: {finger: {max_velocity: 1}, lift: {max_velocity: 1}}")
    description = read_joint_limits(str(file)).on(load_description(URDF))
    assert description.joints[0].velocity == 1.0
    (note,) = description.notes
    assert "no joint 'finger' in URDF string, which has: lift, swing; it is left out" in note


def test_limits_that_are_assumed_and_the_file_to_copy(tmp_path):
    bare = load_description(URDF.replace('continuous">', 'continuous">' + SPEED))
    completed, notice, text = with_assumed_rates(bare)
    assert "full speed in 0.25 s" in notice
    for joint, speed in zip(completed.joints, (2.0, 1.5), strict=True):
        assert (joint.acceleration, joint.jerk) == (speed / 0.25, speed / 0.25 / 0.1)
    file = tmp_path / "copied.yaml"
    file.write_text(text)
    again, nothing, _ = with_assumed_rates(read_joint_limits(str(file)).on(bare))
    assert nothing == ""
    assert [(one.acceleration, one.jerk) for one in again.joints] == [(8.0, 80.0), (6.0, 60.0)]


def test_the_planner_and_the_controller_assume_the_same_accelerations():
    """The planner assumed full speed in 0.25 s, the servo and the controller in 0.2 s."""
    bare = load_description(URDF.replace('continuous">', 'continuous">' + SPEED))
    completed, _, _ = with_assumed_rates(bare)
    speeds = [joint.velocity for joint in bare.joints]
    executed = Joints.of(Limits([joint.name for joint in bare.joints], speeds))
    np.testing.assert_array_equal(
        executed.acceleration, [joint.acceleration for joint in completed.joints]
    )


def test_what_is_given_is_kept_and_nothing_is_assumed_without_a_velocity():
    description = load_description(URDF.replace('effort="1"', 'effort="1" acceleration="3"'))
    completed, _, text = with_assumed_rates(description)
    lift, swing = completed.joints
    assert (lift.acceleration, lift.jerk) == (3.0, 30.0)
    assert math.isnan(swing.acceleration) and "swing" not in text
