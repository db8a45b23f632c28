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
