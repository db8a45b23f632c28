"""All links of a tree, joints that mimic others, and where a robot begins."""

import numpy as np
import pytest

from robomech_ros.errors import (
    BadValueError,
    NonFiniteError,
    RobotDescriptionError,
    UnknownJointError,
)
from robomech_ros.kinematics import forward_kinematics, link_poses
from robomech_ros.kinetostatics import jacobian
from robomech_ros.robots import PRISMATIC, list_robots, load_description, load_robot

LIMIT = '<limit lower="-1" upper="2" velocity="3" effort="4"/>'


def slide(name, parent, child, inside=""):
    return (
        f'<joint name="{name}" type="prismatic"><parent link="{parent}"/><child link="{child}"/>'
        f"{LIMIT}{inside}</joint>"
    )


def robot(*joints, links="a b c d"):
    named = "".join(f'<link name="{link}"/>' for link in links.split())
    return f'<robot name="r">{named}{"".join(joints)}</robot>'


CHAINED = robot(
    slide("third", "a", "d", '<mimic joint="second" multiplier="0.5" offset="0.25"/>'),
    slide("second", "a", "c", '<mimic joint="first" multiplier="-2" offset="0.5"/>'),
    slide("first", "a", "b"),
)


@pytest.mark.parametrize("name", list_robots())
def test_the_links_of_a_tree_are_where_those_of_the_chain_are(name):
    description = load_description(name)
    chain = description.chain()
    q = np.random.default_rng(2).uniform(chain.lower.clip(-3), chain.upper.clip(max=3))
    poses = description.link_poses(dict(zip(chain.joint_names, q, strict=True)))
    assert tuple(poses) == tuple(dict.fromkeys(poses))
    assert set(poses) == set(description.links)
    np.testing.assert_allclose(poses[chain.tip], forward_kinematics(chain, q), atol=1e-14)
    along = link_poses(chain, q)
    for link, pose in zip(chain.links, along, strict=True):
        np.testing.assert_allclose(poses[link], pose, atol=1e-14)


def test_joints_that_mimic_joints_that_mimic():
    description = load_description(CHAINED)
    assert set(description.followers) == {"second", "third"}
    third = description.followers["third"]
    assert (third.leader, third.multiplier, third.offset) == ("first", -1.0, 0.5)
    positions = description.joint_positions({"first": 0.3})
    assert list(positions) == ["third", "second", "first"]
    assert positions == pytest.approx({"third": 0.2, "second": -0.1, "first": 0.3})
    poses = description.link_poses({"first": 0.3})
    assert [poses[link][0, 3] for link in "bcd"] == pytest.approx([0.3, -0.1, 0.2])
    # A measured position of a joint that mimics counts, and moves none of the others.
    assert description.joint_positions({"third": 0.7})["third"] == 0.7
    assert description.joint_positions({"third": 0.7})["second"] == 0.5


def test_circles_are_refused_however_one_gets_there():
    text = robot(
        slide("first", "a", "b", '<mimic joint="second"/>'),
        slide("second", "a", "c", '<mimic joint="third"/>'),
        slide("third", "a", "d", '<mimic joint="second"/>'),
    )
    description = load_description(text)
    expected = "joint '{}': <mimic> is circular: 'second', 'third', 'second'"
    for name, link in (("second", "c"), ("third", "d")):
        with pytest.raises(RobotDescriptionError, match=expected.format(name)):
            description.chain("a", link)
    assert [note.split("'")[1] for note in description.notes] == ["second", "third"]
    # The first one follows a joint that exists, and now stands by itself.
    assert description.followers["first"].leader == "second"
    fixed = robot(
        '<joint name="f" type="fixed"><parent link="a"/><child link="b"/></joint>',
        slide("first", "a", "c", '<mimic joint="f"/>'),
        links="a b c",
    )
    with pytest.raises(RobotDescriptionError, match="names joint 'f', which does not exist"):
        load_description(fixed).chain("a", "c")


def test_a_joint_that_would_follow_out_of_all_numbers_is_named():
    mimic = '<mimic joint="first" multiplier="1e308"/>'
    joints = slide("first", "a", "b"), slide("second", "a", "c", mimic)
    description = load_description(robot(*joints, links="a b c"))
    with pytest.raises(NonFiniteError, match="position of joint 'second' is inf"):
        description.link_poses({"first": 100.0})


def test_many_that_mimic_each_other_in_a_row_take_no_time():
    count = 3000
    links = " ".join(f"l{i}" for i in range(count + 1))
    joints = [
        slide(f"j{i}", "l0", f"l{i + 1}", f'<mimic joint="j{i + 1}"/>' if i < count - 1 else "")
        for i in range(count)
    ]
    description = load_description(robot(*joints, links=links))
    assert description.followers["j0"].leader == f"j{count - 1}"
    assert description.joint_positions({f"j{count - 1}": 0.5})["j0"] == 0.5


def test_positions_that_are_none():
    description = load_description(CHAINED)
    with pytest.raises(UnknownJointError) as caught:
        description.link_poses({"firs": 0.0})
    assert caught.value.available == ("third", "second", "first")
    with pytest.raises(BadValueError, match="position of joint 'first' is 'x', expected a number"):
        description.link_poses({"first": "x"})
    with pytest.raises(NonFiniteError, match="position of joint 'first' is nan"):
        description.link_poses({"first": np.nan})
    with pytest.raises(BadValueError, match="expected a mapping"):
        description.link_poses([0.1])


def dexterity(chain, q):
    """Ratio of the least singular value to the greatest, lengths in parts of the arm's reach.

    Of the rows that the arm can move at all.
    """
    rng = np.random.default_rng(3)
    samples = rng.uniform(chain.lower.clip(-3), chain.upper.clip(max=3), (300, chain.n))
    reach = np.linalg.norm(forward_kinematics(chain, samples)[:, :3, 3], axis=1).max()

    def singular_values(q):
        J = jacobian(chain, q)
        J[..., 3:, :] /= reach
        return np.linalg.svd(J, compute_uv=False)

    rank = int(np.median((singular_values(samples) > 1e-9).sum(axis=1)))
    values = singular_values(q)
    return values[rank - 1] / values[0]


@pytest.mark.parametrize("name", list_robots())
def test_no_robot_begins_near_a_singular_posture(name):
    chain = load_robot(name)
    home = chain.home()
    margin = np.minimum(home - chain.lower, chain.upper - home)
    assert (margin > np.where(chain.types == PRISMATIC, 0.05, 0.25)).all()
    # Most arms do not get above 0.15 anywhere; at mid-range most are at 0.
    assert dexterity(chain, home) > 0.05


def test_home_is_part_of_a_chain_that_it_covers():
    chain = load_robot("ur5e")
    half = np.pi / 2
    np.testing.assert_allclose(chain.home(), [0, -half, half, -half, -half, 0], atol=1e-15)
    assert chain.with_tip("forearm_link").home().tolist() == chain.home()[:3].tolist()
    chain.home()[0] = 1.0
    assert chain.home()[0] == 0.0


@pytest.mark.parametrize(
    ("home", "text"),
    [
        ("{joint_1: 0.5}", None),
        ("{joint_9: 0.5}", "expected positions of joints among joint_1, joint_2, joint_3"),
        ("[0, 0, 0]", "expected positions of joints among joint_1"),
        ("{joint_1: 4}", "home: joint_1 is 4, expected a number from -3 to 3"),
        ("{joint_1: up}", "home: joint_1 is 'up', expected a finite number"),
    ],
)
def test_home_in_a_file(home, text):
    with open(load_description("planar3r").where, encoding="utf-8") as file:
        document = file.read().split("home:")[0]
    if text is None:
        description = load_description(f"{document}home: {home}\n")
        assert description.home == {"joint_1": 0.5}
        assert description.chain().home_given is None
        return
    with pytest.raises(RobotDescriptionError, match=text):
        load_description(f"{document}home: {home}\n")


def test_home_of_a_chain_is_within_its_limits():
    from dataclasses import replace

    chain = load_robot("planar3r")
    narrow = replace(chain, home_given=[0.0, 3.5, 0.0])
    assert narrow.home().tolist() == [0.0, chain.upper[1], 0.0]
    with pytest.raises(BadValueError, match="home of joint 'joint_2' is nan, expected a finite"):
        replace(chain, home_given=[0.0, np.nan, 0.0])
