"""SRDF: groups, end effectors, states; every name checked."""

import re
from pathlib import Path

import pytest
from counting import lines_executed

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
FIELD = Path(__file__).parents[1] / "data/field"


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


def test_states_of_groups_that_have_no_other_joints():
    semantic = load_srdf(SRDF, ROBOT)
    assert semantic.postures_of(["l"]) == {"open": "hand"}
    assert semantic.postures_of(["l", "a", "b"]) == {"open": "hand", "home": "arm"}
    assert semantic.postures_of(["a"]) == {}


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
        ('<group name="none"/>', "<xacro:macro_call/>", "expand it first"),
        ("<robot ", "<srdf ", "mismatched tag"),
    ],
)
def test_a_document_that_is_wrong_as_a_whole_is_refused(old, new, expected):
    assert old in SRDF
    with pytest.raises(RobotDescriptionError, match=expected) as caught:
        load_srdf(SRDF.replace(old, new, 1), ROBOT)
    assert caught.value.where.startswith("SRDF string")


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
        ('name="home" group="arm"', 'name="home" group="x"', "group_state 'home': group is 'x'"),
        ('name="home" group="arm"', 'group="arm"', "a group state without a name"),
        ('value="0.5"', 'value="0.5 1"', "joint 'a' is at '0.5 1', expected a finite number"),
        ('value="0.5"', 'value="\uff10.5"', "joint 'a' is at '\uff10.5', expected a finite number"),
        ('value="0.5"', 'value="$[pi]"', "expected a finite number, rad or m"),
        ('<joint name="a" value', '<joint name="z" value', "name is 'z', expected a joint"),
        ('"base" tip_link="flange"', '"one" tip_link="one"', "are both 'one', expected two links"),
    ],
)
def test_an_entry_that_is_wrong_is_named_with_its_line_and_left_out(old, new, expected):
    assert old in SRDF
    semantic = load_srdf(SRDF.replace(old, new, 1), ROBOT)
    assert any(re.search(expected, note) for note in semantic.notes)
    assert all(note.startswith("SRDF string: line ") for note in semantic.notes)
    # The rest is there: the group of the hand, or that of the arm with its state.
    assert {"hand", "arm"} & semantic.groups.keys()


def test_a_group_without_members_is_refused_only_where_it_is_used():
    semantic = load_srdf(SRDF.replace('tip_link="flange"', 'tip_link="flnge"'), ROBOT)
    assert list(semantic.groups) == ["all", "hand", "by_joints", "across", "none"]
    assert semantic.groups["all"].joints == ("l",)
    with pytest.raises(RobotDescriptionError, match="group 'arm'.*line 4: chain: tip_link is 'fln"):
        semantic.group("arm")
    assert semantic.states["hand"] == {"open": {"l": 0.04}}
    with pytest.raises(RobotDescriptionError, match="group 'arm'"):
        semantic.state("arm", "home")


def test_a_group_of_groups_that_are_left_out_is_left_out():
    more = '<group name="tools"><group name="claw"/></group><group name="two"><group name="tools"/>'
    semantic = load_srdf(SRDF.replace("</robot>", f"{more}</group></robot>"), ROBOT)
    assert set(semantic.left_out) == {"tools", "two"}
    with pytest.raises(RobotDescriptionError, match="group 'two'.*no group in it has a joint"):
        semantic.group("two")


def test_members_that_there_are_make_the_group_as_in_moveit():
    semantic = load_srdf(SRDF.replace('<joint name="b"/>', '<joint name="c"/>'), ROBOT)
    assert semantic.groups["by_joints"].joints == ("a",)
    assert "by_joints" not in semantic.left_out


def test_the_srdf_of_another_robot_is_refused_and_takes_no_time():
    states = "".join(f'<group_state name="s{i}" group="g{i}"/>' for i in range(20_000))
    with pytest.raises(RobotDescriptionError, match="more than 200 faults; expected the SRDF of"):
        load_srdf(f'<robot name="r">{states}</robot>', ROBOT)


def test_virtual_joints():
    semantic = load_srdf(SRDF, ROBOT)
    (virtual,) = semantic.virtual_joints
    assert (virtual.type, virtual.parent_frame, virtual.child_link) == ("fixed", "world", "base")
    other = load_srdf(SRDF.replace('child_link="base"', 'child_link="x"'), ROBOT)
    assert other.virtual_joints == ()
    assert "child_link is 'x', expected a link" in other.notes[0]


def test_an_srdf_of_arm_and_gripper_for_the_bare_arm():
    ur5e = load_description("ur5e")
    semantic = load_srdf(FIELD / "ur5e_with_a_group_too_many.srdf", ur5e)
    assert list(semantic.groups) == ["manipulator"]
    chain = ur5e.chain(*semantic.group("manipulator").ends)
    assert semantic.posture(chain, "up").tolist() == [0.0, -1.57, 0.0, -1.57, 0.0, 0.0]
    for words in ("joint 'knuckle_joint'", "group_state 'open'", "end_effector 'hand'"):
        assert sum(words in note for note in semantic.notes) == 1
    with pytest.raises(RobotDescriptionError, match="group 'gripper'.*name is 'knuckle_joint'"):
        semantic.group("gripper")


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


@pytest.mark.parametrize(
    ("old", "new", "note"),
    [
        ('group="hand" parent', 'group="claw" parent', "'gripper': group is 'claw'"),
        ('parent_group="arm"', 'parent_group="legs"', "parent_group is 'legs', expected a group"),
        ('parent_link="flange"', 'parent_link="x"', "parent_link is 'x', expected a link: base"),
        ('name="gripper" parent', "parent", "end_effector: an end effector without a name"),
        ('name="gripper" parent', 'name="" parent', "an end effector without a name"),
    ],
)
def test_end_effectors_that_cannot_be_are_left_out_and_named(old, new, note):
    assert old in SRDF
    semantic = load_srdf(SRDF.replace(old, new, 1), ROBOT)
    assert semantic.end_effectors == {}
    (text,) = semantic.notes
    assert note in text
    assert text.startswith("SRDF string: line 10: end_effector")
    assert text.endswith("; the end effector is left out")


def state(name, group="arm", **positions):
    joints = "".join(f'<joint name="{j}" value="{v}"/>' for j, v in positions.items())
    return f'<group_state name="{name}" group="{group}">{joints}</group_state>'


def with_states(*states):
    return load_srdf(SRDF.replace("</robot>", f"{''.join(states)}</robot>"), ROBOT)


@pytest.mark.parametrize(
    ("states", "why"),
    [
        ([state("far", a=2.5, b=0)], "joint 'a' is at 2.5 rad, outside its limits -2 to 2 rad"),
        ([state("far", a=1, b=1), state("far", a=1, b=1.1)], "given twice, with different posi"),
        (
            ['<group_state name="far" group="arm"><joint name="a" value="1"/>'
             '<joint name="a" value="-1"/></group_state>'],
            "joint 'a' is given twice, with different positions",
        ),
    ],
)  # fmt: skip
def test_a_state_where_the_robot_cannot_go_is_named_at_once_and_refused_when_used(states, why):
    semantic = with_states(*states)
    assert any(why in note and note.endswith("it cannot be used") for note in semantic.notes)
    assert all("group_state 'far' of group 'arm'" in note for note in semantic.notes)
    chain = ROBOT.chain("base", "flange")
    for use in (lambda: semantic.state("arm", "far"), lambda: semantic.posture(chain, "far")):
        with pytest.raises(RobotDescriptionError) as caught:
            use()
        assert caught.value.where == "state 'far' of group 'arm'"
        assert why in caught.value.why
    assert semantic.posture(chain, "home").tolist() == [0.5, -0.1]


def test_joints_of_other_groups_are_left_out_of_a_state():
    semantic = with_states(state("ready", a=0.1, b=0.2, l=0.04))
    assert semantic.state("arm", "ready") == {"a": 0.1, "b": 0.2}
    (note,) = semantic.notes
    assert "line 20: group_state 'ready' of group 'arm': " in note
    assert note.endswith("joint 'l' not of this group, and left out")


def test_a_state_may_leave_out_joints_but_is_then_no_posture_of_a_chain_with_them():
    semantic = with_states(state("half", a=0.1))
    assert semantic.state("arm", "half") == {"a": 0.1}
    (note,) = semantic.notes
    assert note.endswith("it gives no position of joint 'b'")
    with pytest.raises(BadValueError, match="expected positions of b, too"):
        semantic.posture(ROBOT.chain("base", "flange"), "half")


def test_the_same_state_twice_is_one():
    semantic = with_states(state("home", a=0.5, b=-0.1))
    assert semantic.state("arm", "home") == {"a": 0.5, "b": -0.1}
    (note,) = semantic.notes
    assert note.endswith("group 'arm': given twice")


def test_few_digits_mean_the_limit():
    semantic = with_states(state("end", a=2.00004, b=-2))
    assert semantic.state("arm", "end") == {"a": 2.0, "b": -2.0}
    assert semantic.notes == ()


def test_a_chain_from_tip_to_base_is_taken_from_base_to_tip():
    up = SRDF.replace('base_link="base" tip_link="flange"', 'base_link="flange" tip_link="base"')
    semantic = load_srdf(up, ROBOT)
    assert semantic.groups["arm"] == load_srdf(SRDF, ROBOT).groups["arm"]
    (note,) = semantic.notes
    assert "line 4: group 'arm': its chain runs up, from 'flange' to 'base'" in note


def long_chains(count):
    """A robot of so many joints, and a group of the chains from each of its links to the last."""
    joints = "".join(joint(f"j{i}", "revolute", f"l{i}", f"l{i + 1}") for i in range(count))
    links = "".join(f'<link name="l{i}"/>' for i in range(count + 1))
    robot = load_description(f'<robot name="r">{links}{joints}</robot>')
    chains = "".join(f'<chain base_link="l{i}" tip_link="l{count}"/>' for i in range(count))
    return f'<robot name="r"><group name="g">{chains}</group></robot>', robot


def test_thousands_of_long_chains_are_no_more_work_each_than_a_few():
    count = 2000
    group = load_srdf(*long_chains(count)).groups["g"]
    assert group.joints == tuple(f"j{i}" for i in range(count))
    assert group.ends == ("l0", f"l{count}")
    few, many = (lines_executed(load_srdf, *long_chains(count)) for count in (100, 400))
    assert many < 4.5 * few


@pytest.mark.slow
def test_more_members_than_any_robot_has_are_refused():
    inner = "".join(f'<group name="g{i}"><group name="g0"/></group>' for i in range(1, 20_000))
    links = "".join(f'<joint name="{name}"/>' for name in ("a", "b", "mount", "grip", "l") * 20)
    document = f'<robot name="r"><group name="g0">{links}</group>{inner}</robot>'
    assert len(load_srdf(document, ROBOT).groups) == 20_000
    count = 60
    joints = "".join(joint(f"j{i}", "revolute", f"l{i}", f"l{i + 1}") for i in range(count))
    names = "".join(f'<link name="l{i}"/>' for i in range(count + 1))
    long = load_description(f'<robot name="r">{names}{joints}</robot>')
    whole = f'<chain base_link="l0" tip_link="l{count}"/>'
    with pytest.raises(RobotDescriptionError, match="all groups together have more than 1000000"):
        load_srdf(f'<robot name="r"><group name="g0">{whole}</group>{inner}</robot>', long)
