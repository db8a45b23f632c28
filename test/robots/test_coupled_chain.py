"""Chains on which joints follow others: their drives, and poses against those of the whole tree."""

from pathlib import Path

import numpy as np
import pytest

from robomech_ros.errors import BadValueError, RobotDescriptionError
from robomech_ros.kinematics import forward_kinematics, link_poses
from robomech_ros.kinematics.forward_uncompiled import tip_poses
from robomech_ros.robots import dh_from_chain, load_description, load_robot

DATA = Path(__file__).parents[1] / "data" / "coupled"
JOINT = """<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>
  <origin xyz="0.1 0.2 0.3" rpy="0.1 0.4 -0.2"/><axis xyz="{axis}"/>
  <limit lower="-3" upper="3" effort="1" velocity="1"/>{more}</joint>"""
ROWS = [
    ("lift", "prismatic", "base", "a", "0 0 1", ""),
    ("knee", "revolute", "a", "b", "0 1 0", '<mimic joint="turn" multiplier="-2" offset="0.3"/>'),
    ("turn", "revolute", "b", "c", "1 0 0", ""),
    ("bar", "revolute", "c", "d", "0 0 1", '<mimic joint="knee" multiplier="0.5" offset="-0.1"/>'),
    ("side", "prismatic", "c", "e", "1 0 0", '<mimic joint="finger"/>'),
    ("finger", "prismatic", "c", "f", "-1 0 0", ""),
]
KEYS = ("name", "kind", "parent", "child", "axis", "more")
URDF = (
    '<robot name="r"><link name="base"/>'
    + "".join(f'<link name="{name}"/>' for name in "abcdef")
    + "".join(JOINT.format(**dict(zip(KEYS, row, strict=True))) for row in ROWS)
    + "</robot>"
)


@pytest.mark.parametrize(
    ("tip", "drives"),
    [
        ("b", ("lift", "turn")),
        ("d", ("lift", "turn")),
        ("e", ("lift", "turn", "finger")),
        ("f", ("lift", "turn", "finger")),
    ],
)
def test_links_are_where_the_tree_has_them(tip, drives):
    description, random = load_description(URDF), np.random.default_rng(3)
    chain = description.chain("base", tip)
    assert (chain.joint_names, chain.n, chain.tip) == (drives, len(drives), tip)
    q = random.uniform(-1.0, 1.0, (20, chain.n))
    poses = forward_kinematics(chain, q)
    np.testing.assert_allclose(tip_poses(chain, q), poses, atol=1e-14)
    for row, pose, along in zip(q, poses, link_poses(chain, q), strict=True):
        tree = description.link_poses(dict(zip(drives, row, strict=True)))
        np.testing.assert_allclose(pose, tree[tip], atol=1e-13)
        for link, found in zip(chain.links, along, strict=True):
            np.testing.assert_allclose(found, tree[link], atol=1e-13)


def test_friction_of_followers_counts_at_their_drive():
    knee = '<axis xyz="0 1 0"/>'
    text = URDF.replace(knee, knee + '<dynamics damping="0.5" friction="0.2"/>')
    # knee = -2 turn + 0.3: its friction is felt twice, and its rate is twice as large.
    drive = load_description(text).chain("base", "b").drives[1]
    assert (drive.viscous, drive.coulomb) == (2.0, 0.4)


def test_limits_of_followers_restrict_their_drive():
    chain = load_description(URDF).chain("base", "d")
    # knee = -2 turn + 0.3 within 3 and at most 1 rad/s; bar = -turn + 0.05 restricts no more.
    np.testing.assert_allclose(chain.lower, [-3.0, -1.35])
    np.testing.assert_allclose(chain.upper, [3.0, 1.65])
    np.testing.assert_allclose(chain.velocity, [1.0, 0.5])
    assert chain.types.tolist() == [1, 0]
    assert chain.turns.tolist() == [False, True]


def test_the_drives_of_a_palletizer_of_a_finger_and_of_a_hollow_wrist():
    palletizer = load_robot(DATA / "palletizer.urdf")
    assert palletizer.joint_names == ("turn", "rear", "fore", "spin")
    assert palletizer.velocity.tolist() == [2.0, 2.0, 2.0, 3.0]
    assert palletizer.with_tip("upper_arm").joint_names == ("turn", "rear", "fore")
    assert palletizer.with_tip("lower_arm").coupling is None
    assert palletizer.dh is None
    finger = load_robot(DATA / "coupled_finger.urdf")
    assert finger.joint_names == ("spread", "curl")
    assert finger.upper[1] == 1.6  # 1.3 / 0.8 is more
    # A whole turn of the drive turns the last joint by 0.8 of one.
    assert finger.turns.tolist() == [True, False]
    wrist = load_robot(DATA / "hollow_wrist.urdf")
    assert wrist.joint_names == tuple(f"j{i}" for i in range(1, 7))
    np.testing.assert_array_equal(wrist.joint_values(np.eye(6)[4])[4:6], [1.0, -1.0])


def test_what_needs_joints_that_move_by_themselves_says_so():
    chain = load_robot(DATA / "palletizer.urdf")
    with pytest.raises(BadValueError, match="palletizer with mimic joints rear_back, level"):
        dh_from_chain(chain)
    assert dh_from_chain(chain.uncoupled).a.shape == (6,)


def test_limits_that_leave_a_drive_no_position_are_refused():
    text = URDF.replace('offset="0.3"', 'offset="30"')
    expected = (
        r"'knee': it stays inside its limits \[-3, 3\] only if joint 'turn', .* is in "
        r"\[13.5, 16.5\], but that joint is limited to \[-3, 3\]"
    )
    with pytest.raises(RobotDescriptionError, match=expected):
        load_robot(text, "base", "d")
    assert load_robot(text, "base", "a").n == 1


def test_limits_of_a_follower_may_lack_the_sign_of_its_multiplier():
    text = (DATA / "coupled_finger.urdf").read_text()
    turned = text.replace('multiplier="0.8"', 'multiplier="-0.8"')
    assert turned != text
    finger = load_robot(turned)
    np.testing.assert_allclose((finger.lower[1], finger.upper[1]), (0.0, 1.6))


def test_a_link_that_is_not_below_the_other_is_refused():
    with pytest.raises(RobotDescriptionError, match="not below"):
        load_description(URDF).chain("d", "e")
