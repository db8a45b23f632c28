"""Ways to links on which joints mimic others, against the poses of the whole tree."""

import numpy as np
import pytest

from robomech_ros.errors import RobotDescriptionError
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.robots import load_description
from robomech_ros.robots.following_chain import following_chain

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
    ("tip", "leaders"),
    [
        ("b", ("lift", "turn")),
        ("d", ("lift", "turn")),
        ("e", ("lift", "turn", "finger")),
        ("f", ("lift", "turn", "finger")),
    ],
)
def test_links_are_where_the_tree_has_them(tip, leaders):
    description, random = load_description(URDF), np.random.default_rng(3)
    way = following_chain(description, "base", tip)
    assert (way.joint_names, way.n, way.tip) == (leaders, len(leaders), tip)
    q = random.uniform(-1.0, 1.0, (20, way.n))
    poses = forward_kinematics(way.chain, way.positions(q))
    for row, pose in zip(q, poses, strict=True):
        tree = description.link_poses(dict(zip(leaders, row, strict=True)))
        np.testing.assert_allclose(pose, tree[tip], atol=1e-13)
    np.testing.assert_array_equal(way.positions(q[0]), way.positions(q)[0])


def test_a_link_that_is_not_below_the_other_is_refused():
    with pytest.raises(RobotDescriptionError, match="not below"):
        following_chain(load_description(URDF), "d", "e")
