"""Habits of makers' SRDFs, each in the smallest document that has it.

The documents are our own; the comment names where the habit was found (repository: file).
"""

import numpy as np
import pytest

from robomech_ros.errors import RobotDescriptionError
from robomech_ros.robots import group_chain, load_description, load_srdf, main_chain


def urdf(*joints):
    """Make a robot from (name, type, parent, child, inside)."""
    links = dict.fromkeys(link for _, _, parent, child, _ in joints for link in (parent, child))
    text = "".join(f'<link name="{link}"/>' for link in links)
    for name, kind, parent, child, inside in joints:
        text += (
            f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
            f'<origin xyz="0 0 0.2"/><axis xyz="0 {int(name[-1] in "246")} '
            f'{int(name[-1] not in "246")}"/>{inside}</joint>'
        )
    return load_description(f'<robot name="r">{text}</robot>')


def limit(lower, upper):
    return f'<limit lower="{lower}" upper="{upper}" velocity="1" effort="1"/>'


def state(name, group, positions):
    joints = "".join(f'<joint name="{j}" value="{v}"/>' for j, v in positions.items())
    return f'<group_state name="{name}" group="{group}">{joints}</group_state>'


PANDA_LIMITS = [
    (-2.8973, 2.8973),
    (-1.7628, 1.7628),
    (-2.8973, 2.8973),
    (-3.0718, -0.0698),
    (-2.8973, 2.8973),
    (-0.0175, 3.7525),
    (-2.8973, 2.8973),
]
PANDA_JOINTS = [f"panda_joint{i}" for i in range(1, 8)]
PANDA = urdf(
    *(
        (name, "revolute", f"panda_link{i}", f"panda_link{i + 1}", limit(*PANDA_LIMITS[i]))
        for i, name in enumerate(PANDA_JOINTS)
    ),
    ("panda_joint8", "fixed", "panda_link7", "panda_link8", ""),
    ("panda_hand_joint", "fixed", "panda_link8", "panda_hand", ""),
    ("panda_finger_joint1", "prismatic", "panda_hand", "panda_leftfinger", limit(0, 0.04)),
    (
        "panda_finger_joint2",
        "prismatic",
        "panda_hand",
        "panda_rightfinger",
        limit(0, 0.04) + '<mimic joint="panda_finger_joint1"/>',
    ),
)
READY = [0, -0.785, 0, -2.356, 0, 1.571, 0.785]


def panda_srdf():
    ready = dict(zip(PANDA_JOINTS, READY, strict=True))
    extended = dict(zip(PANDA_JOINTS, [0, 0, 0, 0, 0, 0, 0.785], strict=True))
    fingers = {"panda_finger_joint1": 0.035, "panda_finger_joint2": 0.035}
    return f"""<?xml version="1.0" encoding="utf-8"?>
<robot name="panda">
  <group name="panda_arm"><chain base_link="panda_link0" tip_link="panda_link8"/></group>
  {state("ready", "panda_arm", ready)}{state("extended", "panda_arm", extended)}
  <virtual_joint child_link="panda_link0" name="virtual_joint" parent_frame="world"
    type="floating"/>
  <group name="hand">
    <link name="panda_hand"/><link name="panda_leftfinger"/><link name="panda_rightfinger"/>
    <joint name="panda_finger_joint1"/><passive_joint name="panda_finger_joint2"/>
  </group>
  <group name="panda_arm_hand"><group name="panda_arm"/><group name="hand"/></group>
  {state("open", "hand", fingers)}
  <end_effector group="hand" name="hand" parent_group="panda_arm" parent_link="panda_link8"/>
</robot>"""


def test_states_between_groups_and_a_passive_joint_inside_a_group():
    # moveit/moveit_resources: panda_moveit_config/config/panda.srdf
    semantic = load_srdf(panda_srdf(), PANDA)
    assert semantic.groups["hand"].joints == ("panda_finger_joint1",)
    assert semantic.groups["panda_arm"].ends == ("panda_link0", "panda_link8")
    assert semantic.groups["panda_arm_hand"].ends is None
    assert semantic.state("hand", "open") == dict.fromkeys(
        ["panda_finger_joint1", "panda_finger_joint2"], 0.035
    )
    assert semantic.posture(PANDA.chain("", "panda_link8"), "ready").tolist() == READY


def test_a_state_of_zeros_that_one_joint_cannot_reach():
    # moveit/moveit_resources: panda_moveit_config/config/panda.srdf, "extended": joint 4 at 0,
    # its limit is -0.0698.
    semantic = load_srdf(panda_srdf(), PANDA)
    (note,) = semantic.notes
    assert "group_state 'extended' of group 'panda_arm': joint 'panda_joint4' is at 0" in note
    with pytest.raises(RobotDescriptionError, match="outside its limits -3.0718 to -0.0698"):
        semantic.state("panda_arm", "extended")


def test_an_arm_with_two_fingers_is_the_arm():
    # moveit/moveit_resources: panda_description/urdf/panda.urdf with the SRDF above: the fingers
    # are the leaves, and no link is called tool0 or flange.
    chain = main_chain(PANDA, load_srdf(panda_srdf(), PANDA))
    assert (chain.base, chain.tip, chain.n) == ("panda_link0", "panda_link8", 7)
    with pytest.raises(RobotDescriptionError, match="several links could be the tip"):
        PANDA.chain()


UR_JOINTS = [
    f"{name}_joint"
    for name in ("shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3")
]
UR5E = load_description("ur5e")


def ur_srdf():
    home = dict.fromkeys(sorted(UR_JOINTS), 0) | {"shoulder_lift_joint": -1.5707}
    return f"""<robot name="ur">
      <group name="ur_manipulator"><chain base_link="base_link" tip_link="tool0" /></group>
      {state("home", "ur_manipulator", home)}
      <disable_collisions link1="base_link" link2="base_link_inertia" reason="Adjacent" />
    </robot>"""


def test_a_rounded_quarter_turn_and_joints_in_alphabetical_order():
    # UniversalRobots/Universal_Robots_ROS2_Driver: ur_moveit_config/srdf/ur_macro.srdf.xacro
    semantic = load_srdf(ur_srdf(), UR5E)
    assert semantic.notes == ()
    chain = main_chain(UR5E, semantic)
    assert chain.home().tolist() == [0, -1.5707, 0, 0, 0, 0]
    # The robot's own home posture, which is not singular, is no longer meant.
    assert UR5E.chain().home().tolist() != chain.home().tolist()


KINOVA = urdf(
    *(
        (
            f"joint_{i}",
            "continuous" if i % 2 else "revolute",
            f"link_{i - 1}",
            f"link_{i}",
            limit(-2.58, 2.58) if i % 2 == 0 else '<limit velocity="1" effort="1"/>',
        )
        for i in range(1, 8)
    ),
    ("end_effector", "fixed", "link_7", "end_effector_link", ""),
    ("robotiq_base_joint", "fixed", "end_effector_link", "robotiq_base", ""),
    ("left_knuckle_joint", "revolute", "robotiq_base", "left_knuckle", limit(0, 0.8)),
    (
        "right_knuckle_joint",
        "revolute",
        "robotiq_base",
        "right_knuckle",
        limit(-0.8, 0) + '<mimic joint="left_knuckle_joint" multiplier="-1"/>',
    ),
)


KINOVA_HOME = [0, 0.26, 3.14, -2.27, 0, 0.96, 1.57]


def kinova_srdf():
    home = {f"joint_{i}": place for i, place in enumerate(KINOVA_HOME, 1)}
    return f"""<robot name="gen3">
      <group name="manipulator"><chain base_link="link_0" tip_link="end_effector_link"/></group>
      <group name="gripper">
        <joint name="robotiq_base_joint"/><joint name="left_knuckle_joint"/>
        <joint name="right_knuckle_joint"/>
      </group>
      {state("Close", "gripper", {"left_knuckle_joint": 0.8})}
      {state("home", "manipulator", home)}
      {state("retract", "manipulator", home | {"joint_4": -2.54})}
      <end_effector name="gripper" parent_link="end_effector_link" group="gripper"/>
      <passive_joint name="right_knuckle_joint"/>
    </robot>"""


def test_a_gripper_group_of_fixed_and_following_joints_whose_states_name_the_leader_only():
    # Kinovarobotics/ros2_kortex: kortex_moveit_config/kinova_gen3_7dof_robotiq_2f_85_moveit_config
    # /config/gen3.srdf
    semantic = load_srdf(kinova_srdf(), KINOVA)
    assert semantic.groups["gripper"].joints == ("left_knuckle_joint",)
    assert semantic.groups["gripper"].links == ("robotiq_base", "left_knuckle", "right_knuckle")
    assert semantic.end_effectors["gripper"].parent_group == ""
    chain = main_chain(KINOVA, semantic)
    assert chain.tip == "end_effector_link"
    np.testing.assert_array_equal(chain.home(), KINOVA_HOME)
    close = KINOVA.joint_positions(semantic.state("gripper", "Close"))
    assert close["right_knuckle_joint"] == -0.8
    assert semantic.posture(chain, "retract")[3] == -2.54
    assert semantic.notes == ()


XARM = urdf(
    ("world_joint", "fixed", "world", "link_base", ""),
    *(
        (
            f"joint{i}",
            "revolute",
            f"link{i - 1}" if i > 1 else "link_base",
            f"link{i}",
            limit(-3.14159, 3.14159),
        )
        for i in range(1, 7)
    ),
    ("joint_eef", "fixed", "link6", "link_eef", ""),
    ("vacuum_gripper_fix", "fixed", "link_eef", "vacuum", ""),
    ("joint_tcp", "fixed", "vacuum", "link_tcp", ""),
)


XARM_JOINTS = [f"joint{i}" for i in range(1, 7)]


def xarm_srdf():
    listed = ["world_joint", *XARM_JOINTS, "joint_eef", "vacuum_gripper_fix", "joint_tcp"]
    joints = "".join(f'<joint name="{name}" />' for name in listed)
    home = dict.fromkeys(XARM_JOINTS, 0)
    hold = home | {"joint5": -1.5708, "joint6": 3.1416}
    return f"""<robot name="xarm6">
      <group name="xarm6">{joints}</group>
      {state("home", "xarm6", home)}{state("hold-up", "xarm6", hold)}
      <end_effector name="vacuum_gripper" parent_link="link_tcp" group="vacuum_gripper" />
      <passive_joint name="vacuum_gripper_fix" />
    </robot>"""


def test_an_arm_listed_by_joints_and_an_end_effector_without_its_group():
    # xArm-Developer/xarm_ros2: xarm_moveit_config/srdf/_xarm6_macro.srdf.xacro: the group of the
    # vacuum gripper is commented out, the end effector names it all the same.
    semantic = load_srdf(xarm_srdf(), XARM)
    assert semantic.groups["xarm6"].ends == ("world", "link_tcp")
    chain = group_chain(XARM, semantic.group("xarm6"))
    assert chain.joint_names == tuple(XARM_JOINTS)
    assert semantic.posture(chain, "hold-up").tolist() == [0, 0, 0, 0, -1.5708, 3.14159]
    (note,) = semantic.notes
    assert "group is 'vacuum_gripper', expected a group: xarm6" in note


def test_groups_of_joints_alone_two_arms_and_a_torso():
    # ros-industrial/motoman: motoman_csda10f_moveit_config/config/motoman_csda10f.srdf
    robot = urdf(
        ("torso_1", "revolute", "base_link", "torso", limit(-1, 1)),
        ("left_1", "revolute", "torso", "left_s", limit(-1, 1)),
        ("left_2", "revolute", "left_s", "left_l", limit(-1, 1)),
        ("left_tool", "fixed", "left_l", "left_tool0", ""),
        ("right_1", "revolute", "torso", "right_s", limit(-1, 1)),
        ("right_2", "revolute", "right_s", "right_l", limit(-1, 1)),
    )
    semantic = load_srdf(
        """<robot name="two">
          <group name="arm_left"><joint name="left_1" /><joint name="left_2" /></group>
          <group name="arm_right"><joint name="right_1" /><joint name="right_2" /></group>
          <group name="torso"><joint name="torso_1" /></group>
          <group name="arms"><group name="arm_left" /><group name="arm_right" /></group>
          <group name="all"><group name="torso" /><group name="arms" /></group>
        </robot>""",
        robot,
    )
    assert semantic.groups["arm_left"].ends == ("torso", "left_l")
    assert semantic.groups["all"].ends is None
    left = group_chain(robot, semantic.group("arm_left"), "left_tool0")
    assert left.joint_names == ("left_1", "left_2")
    whole = group_chain(robot, semantic.group("all"), "right_l")
    assert whole.joint_names == ("torso_1", "right_1", "right_2")


@pytest.mark.parametrize(
    ("robot", "document"),
    [(PANDA, panda_srdf()), (UR5E, ur_srdf()), (KINOVA, kinova_srdf()), (XARM, xarm_srdf())],
    ids=["panda", "ur", "kinova", "xarm"],
)
def test_states_are_those_that_pinocchio_reads(robot, document):
    import pinocchio

    semantic = load_srdf(document, robot)
    model = pinocchio.buildModelFromXML(robot.document)
    pinocchio.loadReferenceConfigurationsFromXML(model, document, False)
    read = {entry.key(): entry.data() for entry in model.referenceConfigurations}
    places = [
        (read[name], model.joints[model.getJointId(joint)], value)
        for states in semantic.states.values()
        for name, positions in states.items()
        for joint, value in positions.items()
    ]
    assert len(places) >= 6
    for q, joint, value in places:
        found = q[joint.idx_q]
        if joint.nq == 2:  # a turn without limits is a point on a circle there
            found = np.arctan2(q[joint.idx_q + 1], found)
        # 3.1416 means the limit, 3.14159.
        assert found == pytest.approx(value, abs=2e-5)
