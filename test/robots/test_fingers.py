"""The joints of a gripper, and the width between its fingers."""

import numpy as np
import pytest

from robomech_ros.errors import BadValueError, UnknownJointError, UnknownLinkError
from robomech_ros.robots import load_description
from robomech_ros.robots.fingers import FingerOpening, finger_ends, finger_joints


def gripper(fingers):
    return f"""<robot name="arm">
  <link name="base"/><link name="wheel"/><link name="arm"/><link name="palm"/>
  <link name="a"/><link name="b"/>
  <joint name="wheel" type="continuous"><parent link="base"/><child link="wheel"/></joint>
  <joint name="arm" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 1 0"/>
    <origin xyz="0 0 0.5"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
  <joint name="mount" type="fixed"><parent link="arm"/><child link="palm"/>
    <origin xyz="0.3 0 0" rpy="0.3 0.2 0.1"/></joint>
  {fingers}</robot>"""


def slide(name, child, axis, more="", limits='lower="0" upper="0.04"'):
    return f"""<joint name="{name}" type="prismatic"><parent link="palm"/><child link="{child}"/>
  <origin xyz="0.05 0 0"/><axis xyz="{axis}"/><limit {limits} effort="20" velocity="0.2"/>
  {more}</joint>"""


SLIDES = gripper(
    slide("left", "a", "0 1 0") + slide("right", "b", "0 -1 0", '<mimic joint="left"/>')
)
APART = gripper(slide("left", "a", "0 1 0") + slide("right", "b", "0 -1 0"))
# Fingers of 0.1 m on hinges 0.04 m apart, closing by a quarter turn about x.
HINGES = gripper(
    """<joint name="left" type="revolute"><parent link="palm"/><child link="p"/>
  <origin xyz="0 0.02 0"/><axis xyz="1 0 0"/><limit lower="0" upper="0.8" effort="20" velocity="2"/>
  </joint><link name="p"/><link name="q"/>
  <joint name="right" type="revolute"><parent link="palm"/><child link="q"/>
  <origin xyz="0 -0.02 0"/><axis xyz="1 0 0"/><mimic joint="left" multiplier="-1"/>
  <limit lower="-0.8" upper="0" effort="20" velocity="2"/></joint>
  <joint name="left_tip" type="fixed"><parent link="p"/><child link="a"/>
  <origin xyz="0 0.08 0.06"/></joint>
  <joint name="right_tip" type="fixed"><parent link="q"/><child link="b"/>
  <origin xyz="0 -0.08 0.06"/></joint>"""
)


def opening(urdf, links=()):
    description = load_description(urdf)
    joints = finger_joints(description, description.chain(tip="palm"))
    return FingerOpening(description, joints, tuple(links) or finger_ends(description, joints))


def test_what_moves_behind_the_arm_is_the_gripper():
    description = load_description(SLIDES)
    chain = description.chain(tip="palm")
    assert [joint.name for joint in finger_joints(description, chain)] == ["left"]
    assert [j.name for j in finger_joints(load_description(APART), chain)] == ["left", "right"]
    assert [j.name for j in finger_joints(description, chain, ["wheel"])] == ["wheel"]
    assert finger_ends(description, finger_joints(description, chain)) == ("a", "b")


@pytest.mark.parametrize("name", ["arm", "right", "mount", "thumb"])
def test_joints_that_are_none_of_a_gripper(name):
    description = load_description(SLIDES)
    with pytest.raises(UnknownJointError, match=rf"'{name}'.*left"):
        finger_joints(description, description.chain(tip="palm"), [name])


@pytest.mark.parametrize("urdf", [SLIDES, APART])
def test_slides_are_open_twice_their_way(urdf):
    of = opening(urdf)
    assert of.closing == -1.0
    assert of.greatest == pytest.approx(0.08, abs=1e-15)
    for position in (0.0, 0.013, 0.04):
        assert of.width(position) == pytest.approx(2.0 * position, abs=1e-15)
        assert of.position(2.0 * position) == pytest.approx(position, abs=1e-15)


def test_hinges_close_as_their_angle_grows():
    of = opening(HINGES)
    assert of.closing == 1.0
    for angle in (0.0, 0.3, 0.8):
        # A point 0.1 m from its hinge, at atan2(0.06, 0.08) from y.
        at = np.arctan2(0.06, 0.08) + np.array([angle, 0.8])
        apart = 0.04 + 0.2 * np.cos(at)
        width = apart[0] - apart[1]
        assert of.width(angle) == pytest.approx(width, abs=1e-12)
        assert of.position(width) == pytest.approx(angle, abs=1e-9)


def robotiq_2f_85(upper):
    """Frames as in Kinova's robotiq_arg2f_85_model_macro.xacro (ros2_kortex, licence BSD)."""

    def finger(side, knuckle, y, turn, mimic):
        return f"""
  <joint name="{knuckle}" type="revolute"><parent link="palm"/><child link="{side}_knuckle"/>
  <origin xyz="0 {y} 0.054904" rpy="0 0 {turn}"/><axis xyz="1 0 0"/>
  <limit lower="0" upper="{upper}" velocity="2.0" effort="1000"/>{mimic}</joint>
  <joint name="{side}_outer" type="fixed"><parent link="{side}_knuckle"/>
  <child link="{side}_finger"/><origin xyz="0 0.0315 -0.0041"/></joint>
  <joint name="{side}_inner" type="revolute"><parent link="{side}_finger"/>
  <child link="{side}_inner_finger"/><origin xyz="0 0.0061 0.0471"/><axis xyz="1 0 0"/>
  <limit lower="-100" upper="100" velocity="2.0" effort="1000"/>
  <mimic joint="finger_joint" multiplier="-1"/></joint>
  <joint name="{side}_pad_joint" type="fixed"><parent link="{side}_inner_finger"/>
  <child link="{side}_pad"/><origin xyz="0 -0.0220203446692936 0.03242"/></joint>
  <joint name="{side}_bar_joint" type="revolute"><parent link="palm"/><child link="{side}_bar"/>
  <origin xyz="0 {0.415 * y} 0.06142" rpy="0 0 {turn}"/><axis xyz="1 0 0"/>
  <limit lower="0" upper="{upper}" velocity="2.0" effort="1000"/>
  <mimic joint="finger_joint"/></joint>
  """ + "".join(
            f'<link name="{side}_{part}"/>'
            for part in ("knuckle", "finger", "inner_finger", "pad", "bar")
        )

    left = finger("left", "finger_joint", -0.0306011, np.pi, "")
    right = finger("right", "right_joint", 0.0306011, 0.0, '<mimic joint="finger_joint"/>')
    return gripper(left + right).replace('<link name="a"/><link name="b"/>', "")


PADS = ("left_pad", "right_pad")


def test_the_stroke_of_robotiqs_2f_85_is_that_of_its_data_sheet():
    of = opening(robotiq_2f_85(0.8), PADS)
    assert [joint.name for joint in of.joints] == ["finger_joint"]
    assert of.greatest == pytest.approx(0.085, abs=1e-3)
    assert of.closing == 1.0
    widths = [of.width(angle) for angle in np.linspace(0.0, 0.8, 50)]
    assert np.all(np.diff(widths) < 0.0)
    with pytest.raises(BadValueError, match="left_bar.*two, one of each finger"):
        opening(robotiq_2f_85(0.8))


def test_limits_of_many_turns_end_where_the_fingers_meet():
    of = opening(robotiq_2f_85(100), PADS)
    # The origins of the pads, 6.35 mm thick, meet behind where the pads do, at 0.813 rad.
    assert of.width(0.0) == pytest.approx(0.085 + 0.00635, abs=2e-3)
    assert of.width(0.813) == pytest.approx(0.00635, abs=1e-3)
    for width in (0.01, 0.05, 0.09):
        assert 0.0 < of.position(width) < 0.88
        assert of.width(of.position(width)) == pytest.approx(width, abs=1e-9)


def test_what_has_no_width():
    with pytest.raises(BadValueError, match="from 0 to 0.08 m"):
        opening(SLIDES).position(0.09)
    with pytest.raises(BadValueError, match="two, one of each finger"):
        opening(SLIDES, ["a"])
    with pytest.raises(BadValueError, match="part from each other"):
        opening(SLIDES, ["a", "a"])
    with pytest.raises(UnknownLinkError, match="thumb"):
        opening(SLIDES, ["a", "thumb"])
    endless = HINGES.replace('type="revolute"', 'type="continuous"')
    with pytest.raises(BadValueError, match="limits at both ends"):
        opening(endless)
