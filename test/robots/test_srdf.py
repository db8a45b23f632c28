"""SRDF: groups, end effectors, states; every name checked."""

import pytest

from robomech_ros.errors import BadValueError, RobotDescriptionError
from robomech_ros.robots import DisabledCollision, EndEffector, load_description, load_srdf

LIMIT = '<limit lower="-2" upper="2" velocity="3" effort="4"/>'


def joint(name, kind, parent, child, inside=LIMIT):
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f"{inside}</joint>"
    )


LINKS = ("base", "one", "two", "flange", "hand", "left", "right")
URDF = (
    '<robot name="r">'
    + "".join(f'<link name="{name}"/>' for name in LINKS)
    + joint("a", "revolute", "base", "one")
    + joint("b", "revolute", "one", "two")
    + joint("mount", "fixed", "two", "flange", "")
    + joint("grip", "fixed", "flange", "hand", "")
    + joint("l", "prismatic", "hand", "left")
    + joint("r", "prismatic", "hand", "right", f'{LIMIT}<mimic joint="l"/>')
    + "</robot>"
)
SRDF = """<?xml version="1.0"?>
<robot name="r" xmlns:xacro="http://ros.org/wiki/xacro">
  <group name="all"><group name="arm"/><group name="hand"/></group>
  <group name="arm"><chain base_link="base" tip_link="flange"/></group>
  <group name="hand"><link name="hand"/><link name="left"/><joint name="r"/></group>
  <group name="by_joints"><joint name="virtual"/><joint name="b"/><joint name="a"/></group>
  <group name="across"><chain base_link="left" tip_link="right"/></group>
  <group name="none"/>
  <virtual_joint name="virtual" type="fixed" parent_frame="world" child_link="base"/>
  <end_effector name="gripper" parent_link="flange" group="hand" parent_group="arm"/>
  <group_state name="home" group="arm">
    <joint name="a" value="0.5"/><joint name="b" value=" -1e-1 "/>
    <joint name="virtual" value="0 0 0"/><joint name="mount" value="0"/>
  </group_state>
  <group_state name="open" group="hand"><joint name="l" value="0.04"/></group_state>
  <passive_joint name="r"/>
  <disable_collisions link1="one" link2="two" reason="Adjacent"/>
  <disable_collisions link1="one" link2="camera_of_another_robot" reason="Never"/>
  <disable_collisions link1="base" link2="one"/>
</robot>
"""
ROBOT = load_description(URDF)


def test_groups_are_made_of_chains_joints_links_and_groups():
    semantic = load_srdf(SRDF, ROBOT)
    assert semantic.name == "r"
    groups = semantic.groups
    assert groups["arm"].joints == ("a", "b")
    assert groups["arm"].links == ("one", "two", "flange")
    assert groups["arm"].ends == ("base", "flange")
    assert groups["hand"].joints == ("l",)
    assert groups["hand"].links == ("hand", "left", "right")
    assert groups["hand"].ends is None
    assert groups["all"].joints == ("a", "b", "l")
    assert groups["all"].ends is None
    assert groups["by_joints"].joints == ("a", "b")
    assert groups["by_joints"].ends == ("base", "two")
    assert groups["across"].links == ("left", "right")
    assert (groups["none"].joints, groups["none"].ends) == ((), None)
    assert ROBOT.chain(*semantic.group("arm").ends).joint_names == ("a", "b")


def test_end_effectors_states_and_disabled_collisions():
    semantic = load_srdf(SRDF, ROBOT)
    assert semantic.end_effectors == {"gripper": EndEffector("gripper", "hand", "flange", "arm")}
    assert semantic.states["arm"] == {"home": {"a": 0.5, "b": -0.1}}
    assert semantic.state("hand", "open") == {"l": 0.04}
    assert semantic.disabled_collisions == (
        DisabledCollision("one", "two", "Adjacent"),
        DisabledCollision("base", "one", ""),
    )


def test_a_file_says_the_same(tmp_path):
    path = tmp_path / "r.srdf"
    path.write_text(f"\n{SRDF}")
    assert load_srdf(path, ROBOT) == load_srdf(str(path), ROBOT) == load_srdf(SRDF, ROBOT)


def test_unknown_groups_and_states_are_answered_with_the_known_ones():
    semantic = load_srdf(SRDF, ROBOT)
    with pytest.raises(BadValueError, match="group is 'legs', expected one of all, arm, hand"):
        semantic.group("legs")
    with pytest.raises(BadValueError, match="state of group 'arm' is 'up', expected one of home"):
        semantic.state("arm", "up")
    with pytest.raises(BadValueError, match="state of group 'all' is 'up', expected none"):
        semantic.state("all", "up")


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ('tip_link="flange"', 'tip_link="flnge"', "tip_link is 'flnge' .did you mean 'flange'"),
        ('<link name="left"/>', '<link name="finger"/>', "line 5: link 'finger': name is 'finger'"),
        (
            '<joint name="b"/>',
            '<joint name="c"/>',
            "expected a joint: a, b, mount, grip, l, r, virt",
        ),
        ('<group name="hand"/>', '<group name="hands"/>', "name is 'hands' .did you mean 'hand'"),
        ('<group name="arm"/>', '<group name="all"/>', "contains itself: all -> all"),
        ('<group name="none"/>', '<group name="arm"/>', "group 'arm': given twice"),
        ('<group name="none"/>', "<group/>", "a group without a name"),
        ('group="hand" parent', 'group="claw" parent', "'gripper': group is 'claw'"),
        ('parent_group="arm"', 'parent_group="legs"', "parent_group is 'legs', expected a group"),
        ('parent_link="flange"', 'parent_link="x"', "parent_link is 'x', expected a link: base"),
        ('name="home" group="arm"', 'name="home" group="x"', "group_state 'home': group is 'x'"),
        ('name="home" group="arm"', 'group="arm"', "a state without a name"),
        ('value="0.5"', 'value="0.5 1"', "joint 'a': value is '0.5 1', expected a finite number"),
        ('value="0.5"', 'value="$[pi]"', "expected a finite number, rad or m"),
        ('<joint name="a" value', '<joint name="z" value', "name is 'z', expected a joint"),
        ('"base" tip_link="flange"', '"one" tip_link="one"', "are both 'one', expected two links"),
        ('<group name="none"/>', "<xacro:macro_call/>", "expand it first"),
        ("<robot ", "<srdf ", "mismatched tag"),
    ],
)
def test_what_is_wrong_is_named_with_its_line(old, new, expected):
    assert old in SRDF
    with pytest.raises(RobotDescriptionError, match=expected) as caught:
        load_srdf(SRDF.replace(old, new, 1), ROBOT)
    assert caught.value.where.startswith("SRDF string")


def test_hostile_documents_and_what_is_none():
    entity = '<!DOCTYPE r [<!ENTITY x "y">]><robot name="r"/>'
    with pytest.raises(RobotDescriptionError, match="document type declaration"):
        load_srdf(entity, ROBOT)
    with pytest.raises(RobotDescriptionError, match="the root element is <sdf>, expected <robot>"):
        load_srdf("<sdf/>", ROBOT)
    with pytest.raises(RobotDescriptionError, match="(?i)no such file"):
        load_srdf("missing.srdf", ROBOT)
    for nothing in (None, "", 3):
        with pytest.raises(BadValueError, match="expected the text of an SRDF, or a path"):
            load_srdf(nothing, ROBOT)
