"""Chains of groups, and the chain that is meant where a user names a group, links or nothing."""

import numpy as np
import pytest

from robomech_ros.errors import BadValueError, RobotDescriptionError, UnknownLinkError
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.robots import (
    Group,
    SemanticDescription,
    group_chain,
    groups_by_links,
    load_description,
    load_robot,
    load_srdf,
    main_chain,
)

LIMIT = '<limit lower="-2" upper="2" velocity="3" effort="4"/>'


def joint(name, kind, parent, child, inside=LIMIT, at="0 0 0.3"):
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="{at}"/><axis xyz="0 1 0"/>{inside}</joint>'
    )


def arm(side, y):
    return (
        joint(f"{side}_mount", "fixed", "torso", f"{side}_base", "", f"0 {y} 0.2")
        + joint(f"{side}_1", "revolute", f"{side}_base", f"{side}_upper")
        + joint(f"{side}_2", "revolute", f"{side}_upper", f"{side}_lower")
        + joint(f"{side}_end", "fixed", f"{side}_lower", f"{side}_tool", "")
        + joint(f"{side}_grip", "prismatic", f"{side}_tool", f"{side}_finger")
    )


def links(side):
    return [f"{side}_{part}" for part in ("base", "upper", "lower", "tool", "finger")]


TWO_ARMED = (
    '<robot name="two">'
    + "".join(f'<link name="{n}"/>' for n in ("world", "torso", *links("left"), *links("right")))
    + joint("turn", "revolute", "world", "torso")
    + arm("left", 0.2)
    + arm("right", -0.2)
    + "</robot>"
)
SRDF = """<robot name="two">
  <group name="left"><chain base_link="left_base" tip_link="left_tool"/></group>
  <group name="right"><chain base_link="right_base" tip_link="right_tool"/></group>
  <group name="left_hand"><joint name="left_grip"/></group>
  <group name="arms"><group name="left"/><group name="right"/></group>
  <group name="left_and_torso"><joint name="turn"/><group name="left"/></group>
  <end_effector name="hand" parent_link="left_tool" group="left_hand" parent_group="left"/>
  <group_state name="home" group="left">
    <joint name="left_1" value="0.5"/><joint name="left_2" value="0.6"/>
  </group_state>
  <group_state name="home" group="arms">
    <joint name="left_1" value="1.5"/><joint name="left_2" value="1.6"/>
    <joint name="right_1" value="-0.5"/><joint name="right_2" value="-0.6"/>
  </group_state>
  <group_state name="apart" group="arms">
    <joint name="left_1" value="1.1"/><joint name="left_2" value="1.2"/>
    <joint name="right_1" value="-1.1"/><joint name="right_2" value="-1.2"/>
  </group_state>
</robot>"""
ROBOT = load_description(TWO_ARMED)
SEMANTIC = load_srdf(SRDF, ROBOT)


@pytest.mark.parametrize(
    ("group", "link", "joints", "base", "tip"),
    [
        ("left", "", ("left_1", "left_2"), "left_base", "left_tool"),
        ("right", "", ("right_1", "right_2"), "right_base", "right_tool"),
        ("left", "left_upper", ("left_1",), "left_base", "left_upper"),
        ("left_hand", "", ("left_grip",), "left_tool", "left_finger"),
        ("arms", "right_tool", ("right_1", "right_2"), "right_base", "right_tool"),
        ("left_and_torso", "left_tool", ("turn", "left_1", "left_2"), "world", "left_tool"),
    ],
)
def test_a_group_has_its_own_chain(group, link, joints, base, tip):
    chain = group_chain(ROBOT, SEMANTIC.group(group), link)
    assert (chain.joint_names, chain.base, chain.tip) == (joints, base, tip)
    # The pose agrees with that of the tree.
    q = np.linspace(0.3, 0.7, chain.n)
    poses = ROBOT.link_poses(dict(zip(joints, q, strict=True)))
    expected = np.linalg.inv(poses[base]) @ poses[tip]
    np.testing.assert_allclose(forward_kinematics(chain, q), expected, atol=1e-12)


@pytest.mark.parametrize(
    ("group", "link", "error", "text"),
    [
        ("arms", "", BadValueError, "since it is no one chain: left_upper, left_lower, left_tool"),
        ("left", "right_tool", BadValueError, "joints of group 'left' move: left_upper"),
        ("left", "left_finger", BadValueError, "no joints but those of group 'left' move: not lef"),
        ("left", "left_base", BadValueError, "link is 'left_base', expected one that joints of"),
        ("left", "lefd_tool", UnknownLinkError, "did you mean 'left_tool'"),
    ],
)
def test_a_link_that_the_group_does_not_move_is_refused(group, link, error, text):
    with pytest.raises(error) as caught:
        group_chain(ROBOT, SEMANTIC.group(group), link)
    assert text in str(caught.value)


def test_an_empty_group_moves_nothing():
    with pytest.raises(BadValueError, match="no one chain: none"):
        group_chain(ROBOT, Group("none", (), ()))


def test_home_is_the_state_of_the_chains_own_group_else_of_a_larger_one():
    left = group_chain(ROBOT, SEMANTIC.group("left"))
    right = group_chain(ROBOT, SEMANTIC.group("right"))
    assert SEMANTIC.posture(left, "home").tolist() == [0.5, 0.6]
    assert SEMANTIC.posture(right, "home").tolist() == [-0.5, -0.6]
    assert SEMANTIC.posture(left, "apart").tolist() == [1.1, 1.2]
    assert SEMANTIC.postures(left) == ("home", "apart")
    with pytest.raises(BadValueError, match="posture is 'apard', expected one of home, apart"):
        SEMANTIC.posture(left, "apard")


def test_all_joints_have_a_home_that_of_their_smallest_group():
    assert SEMANTIC.home() == {"left_1": 0.5, "left_2": 0.6, "right_1": -0.5, "right_2": -0.6}
    far = SRDF.replace('<joint name="left_1" value="0.5"/>', '<joint name="left_1" value="2.5"/>')
    assert load_srdf(far, ROBOT).home()["left_1"] == 1.5
    assert SemanticDescription("none").home() == {}


def test_a_tool_is_what_is_mounted_at_the_end_of_a_chain():
    tools = [("left", "", ("left_grip",)), ("left", "left_upper", ()), ("right", "", ())]
    for group, link, joints in tools:
        chain = group_chain(ROBOT, SEMANTIC.group(group), link)
        assert SEMANTIC.tool_joints(chain) == joints
    # Also where its link is fixed to the last one, and none of its joints is on the chain.
    lower = ROBOT.chain("left_base", "left_lower")
    assert SEMANTIC.tool_joints(lower) == ("left_grip",)
    assert SEMANTIC.tool_joints(ROBOT.chain("left_base", "left_finger")) == ()


def test_the_main_chain_is_that_of_the_group_and_begins_at_its_home():
    chain = main_chain(ROBOT, SEMANTIC, group="right")
    assert (chain.base, chain.tip) == ("right_base", "right_tool")
    assert chain.home().tolist() == [-0.5, -0.6]
    assert main_chain(ROBOT, SEMANTIC, base="world", group="right").n == 3
    assert main_chain(ROBOT, SEMANTIC, tip="left_finger").joint_names[-1] == "left_grip"
    assert main_chain(ROBOT, SEMANTIC, tip="right_upper", group="right").n == 1
    with pytest.raises(BadValueError, match="group is 'arms', expected one that is a chain"):
        main_chain(ROBOT, SEMANTIC, group="arms")
    with pytest.raises(BadValueError, match="group is 'legs', expected one of left, right"):
        main_chain(ROBOT, SEMANTIC, group="legs")


def test_where_nothing_is_named_it_is_the_robots_own_tip_else_the_one_arm():
    with pytest.raises(RobotDescriptionError, match="or name one of the groups left, right, left_"):
        main_chain(ROBOT, SEMANTIC)
    lines = SRDF.splitlines()
    one = "\n".join([*lines[:2], lines[3], *lines[6:10], "</robot>"])
    chain = main_chain(ROBOT, load_srdf(one, ROBOT))
    assert (chain.base, chain.tip) == ("left_base", "left_tool")
    assert chain.home().tolist() == [0.5, 0.6]
    ur5e = load_description("ur5e")
    plain = main_chain(ur5e, SemanticDescription("ur5e"))
    assert (plain.base, plain.tip) == (load_robot("ur5e").base, "tool0")
    assert plain.home().tolist() == load_robot("ur5e").home().tolist()


def test_groups_may_be_given_by_their_links():
    groups = groups_by_links(ROBOT, ["left:left_base:left_tool", " whole : left_tool "])
    assert groups["left"] == SEMANTIC.group("left")
    assert groups["whole"].joints == ("turn", "left_1", "left_2")
    assert groups["whole"].ends == ("world", "left_tool")
    named = SEMANTIC.with_groups(groups)
    assert list(named.groups)[-1] == "whole"
    assert named.state("left", "home") == SEMANTIC.state("left", "home")


@pytest.mark.parametrize("entry", ["left", "left:", ":tool", "a:b:c:d", "left: :left_tool", ""])
def test_an_entry_of_another_form_is_refused(entry):
    with pytest.raises(BadValueError, match="expected name:tip_link or name:base_link:tip_link"):
        groups_by_links(ROBOT, [entry])


def test_an_entry_with_an_unknown_link_or_a_name_given_twice_is_refused():
    with pytest.raises(UnknownLinkError, match="lefttool"):
        groups_by_links(ROBOT, ["left:lefttool"])
    with pytest.raises(BadValueError, match="each name once"):
        groups_by_links(ROBOT, ["a:left_tool", "a:right_tool"])
