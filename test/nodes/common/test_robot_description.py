"""The robot of a node: its chains to any link, and the frames fixed to its base."""

import numpy as np
import pytest
from two_armed import SRDF, URDF, joints_of

from robomech_ros.errors import BadValueError, RobotDescriptionError, UnknownLinkError
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.nodes.common.robot.robot_description import RobotModel, RobotSettings
from robomech_ros.robots import load_description, load_srdf

BRANCHED = """
<robot name="branched">
  <link name="world"/><link name="base"/><link name="arm"/><link name="hand"/><link name="finger"/>
  <link name="mast"/><link name="camera"/>
  <joint name="mounting" type="fixed"><parent link="world"/><child link="base"/>
    <origin xyz="0 0 1" rpy="0 0 1.5707963267948966"/></joint>
  <joint name="shoulder" type="revolute"><parent link="base"/><child link="arm"/>
    <axis xyz="0 0 1"/><limit lower="-1" upper="1" velocity="1" effort="1"/></joint>
  <joint name="wrist" type="revolute"><parent link="arm"/><child link="hand"/>
    <origin xyz="1 0 0"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="1" velocity="1" effort="1"/></joint>
  <joint name="grip" type="prismatic"><parent link="hand"/><child link="finger"/>
    <axis xyz="1 0 0"/><limit lower="0" upper="0.1" velocity="1" effort="1"/></joint>
  <joint name="post" type="fixed"><parent link="base"/><child link="mast"/>
    <origin xyz="0 2 0"/></joint>
  <joint name="pan" type="revolute"><parent link="mast"/><child link="camera"/>
    <axis xyz="0 0 1"/><limit lower="-1" upper="1" velocity="1" effort="1"/></joint>
</robot>
"""
LEFT = RobotSettings(base_link="left_base", tip_link="left_tool")


@pytest.fixture
def model():
    return RobotModel(load_description(BRANCHED), RobotSettings(base_link="base", tip_link="hand"))


def test_chain_and_joints(model):
    assert model.chain.joint_names == ("shoulder", "wrist")
    assert model.joint_names == ("shoulder", "wrist", "grip", "pan")
    assert model.chain_to("") is model.chain
    assert model.chain_to("hand") is model.chain


def test_chain_to_links_on_the_way_beyond_and_beside(model):
    assert model.chain_to("arm").joint_names == ("shoulder",)
    assert model.chain_to("finger").joint_names == ("shoulder", "wrist", "grip")
    assert model.chain_to("camera").joint_names == ("pan",)
    assert model.chain_to("finger") is model.chain_to("finger")
    mast = forward_kinematics(model.chain_to("mast"), np.empty(0))
    np.testing.assert_allclose(mast[:3, 3], (0.0, 2.0, 0.0))


def test_chain_to_nowhere(model):
    with pytest.raises(UnknownLinkError, match="unknown link 'hnad'") as caught:
        model.chain_to("hnad")
    assert set(caught.value.available) == set(model.description.links)
    with pytest.raises(RobotDescriptionError, match="no joint moves between link 'base' and"):
        model.chain_to("world")


def test_frames_fixed_to_the_base_up_and_down_the_tree(model):
    assert set(model.fixed_frames) == {"base", "world", "mast"}
    np.testing.assert_array_equal(model.fixed_frames["base"], np.eye(4))
    np.testing.assert_allclose(model.fixed_frames["mast"][:3, 3], (0.0, 2.0, 0.0))
    world = model.fixed_frames["world"]
    expected = np.array([[0, 1, 0, 0], [-1, 0, 0, 0], [0, 0, 1, -1], [0, 0, 0, 1]])
    np.testing.assert_allclose(world, expected, atol=1e-15)


def test_a_posture_of_the_arm_serves_links_of_its_hand():
    description = load_description(URDF)
    joints = "".join(f'<joint name="{name}" value="0.5"/>' for name in joints_of("left"))
    state = f'<group_state name="up" group="left_arm">{joints}</group_state></robot>'
    semantic = load_srdf(SRDF.replace("</robot>", state), description)
    model = RobotModel(description, LEFT, semantic)
    for link, q in (
        ("left_link_2", [0.5] * 2),
        ("left_tool", [0.5] * 6),
        ("finger", [0.5] * 6 + [0.0]),
    ):
        np.testing.assert_array_equal(model.posture(model.chain_to(link), "up"), q)
    with pytest.raises(BadValueError, match="posture is 'down', expected one of home, far, up"):
        model.posture(model.chain_to("finger"), "down")


@pytest.mark.parametrize("by_topic", [False, True])
def test_home_of_an_srdf_serves_links_behind_the_arm_wherever_it_comes_from(by_topic):
    """By topic, the arm was at the robot's own home for a finger, at the SRDF's for the tip."""
    description = load_description(URDF)
    semantic = load_srdf(SRDF, description)
    known = None if by_topic else semantic
    model = RobotModel(description, LEFT, known)
    model.learn(semantic)
    tip = model.posture(model.chain_to("left_tool"), "home")
    np.testing.assert_array_equal(tip, semantic.posture(model.chain, "home"))
    finger = model.posture(model.chain_to("finger"), "home")
    np.testing.assert_array_equal(finger, [*tip, 0.02])
