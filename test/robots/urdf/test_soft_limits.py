"""Limits of a safety controller, as MoveIt's RobotModel takes them."""

import pytest

from robomech_ros.robots import load_robot


def limits(kind, safety, lower=-1.0, upper=2.0):
    chain = load_robot(
        '<robot name="r"><link name="a"/><link name="b"/>'
        f'<joint name="j" type="{kind}"><parent link="a"/><child link="b"/>'
        f'<limit lower="{lower}" upper="{upper}" velocity="1" effort="1"/>'
        f"<safety_controller {safety} k_velocity='1'/></joint></robot>"
    )
    return float(chain.lower[0]), float(chain.upper[0])


@pytest.mark.parametrize("kind", ["revolute", "prismatic"])
@pytest.mark.parametrize(
    ("safety", "expected"),
    [
        ("soft_lower_limit='-0.5' soft_upper_limit='1.5'", (-0.5, 1.5)),
        ("soft_lower_limit='-5' soft_upper_limit='1.5'", (-1.0, 1.5)),
        ("soft_lower_limit='-0.5' soft_upper_limit='5'", (-0.5, 2.0)),
        # One that is missing is 0, as in urdfdom.
        ("soft_upper_limit='1.5'", (0.0, 1.5)),
        ("soft_lower_limit='-0.5'", (-0.5, 0.0)),
        ("k_position='20'", (-1.0, 2.0)),
    ],
)
def test_soft_limits_narrow_those_of_position(kind, safety, expected):
    assert limits(kind, safety) == expected


def test_a_joint_that_turns_for_ever_has_none():
    """Nor in MoveIt, where a continuous joint is not bounded."""
    lower, upper = limits("continuous", "soft_lower_limit='-0.5' soft_upper_limit='1.5'")
    assert (lower, upper) == (-float("inf"), float("inf"))


def test_soft_limits_of_an_arm_of_the_makers():
    """moveit/moveit_resources: panda.urdf: the same values as the hard ones."""
    assert limits("revolute", "soft_lower_limit='-2.8973' soft_upper_limit='2.8973'") == (-1.0, 2.0)
