"""A number of a DH table changed: the robot that the book's formula gives."""

import dataclasses

import numpy as np
import pytest

from robomech_ros.errors import BadValueError, RobotDescriptionError
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.robots import chain_from_dh, list_robots, load_robot
from robomech_ros.rvs.model.arms.dh_editing import (
    DHChange,
    changed_robot,
    read_change,
    table_of,
    yaml_of,
)


@pytest.mark.parametrize("robot", list_robots())
def test_the_table_of_every_robot_is_the_robot(robot):
    chain = load_robot(robot)
    table = table_of(chain)
    same = load_robot(yaml_of(chain, table))
    q = np.clip(np.random.default_rng(4).uniform(-2, 2, (20, chain.n)), chain.lower, chain.upper)
    poses = forward_kinematics(chain, q)
    np.testing.assert_allclose(forward_kinematics(same, q), poses, atol=1e-9)
    assert same.joint_names == chain.joint_names
    for key in ("lower", "upper", "velocity", "acceleration"):
        np.testing.assert_array_equal(getattr(same, key), getattr(chain, key))
    np.testing.assert_array_equal(same.home(), chain.home())


@pytest.mark.parametrize("robot", ["ur5e", "puma560", "stanford"])
@pytest.mark.parametrize("parameter", ["a", "b", "alpha", "theta"])
def test_a_changed_number_is_the_formula_with_it(robot, parameter):
    chain = load_robot(robot)
    _, found = changed_robot(chain, DHChange(1, parameter, 0.4321))
    table = table_of(chain)
    row = np.array(getattr(table, parameter))
    row[1] = 0.4321
    expected = dataclasses.replace(table, **{parameter: row})
    direct = chain_from_dh(
        expected.a, expected.b, expected.alpha, expected.theta,
        types=expected.types.tolist(), base=expected.base, tool=expected.tool,
    )  # fmt: skip
    q = np.random.default_rng(5).uniform(-1, 1, (10, chain.n))
    poses = forward_kinematics(direct, q)
    np.testing.assert_allclose(forward_kinematics(found, q), poses, atol=1e-12)
    np.testing.assert_array_equal(found.lower, chain.lower)


@pytest.mark.parametrize(
    "text", ["", "a", "2 a", "2 a far", "7 a 0.5", "0 a 0.5", "2 c 0.5", "2 a nan", "1 2 3 4"]
)
def test_what_is_no_change_is_refused_with_what_is_expected(text):
    with pytest.raises(BadValueError, match="a joint from 1 to 6, one of a, b, alpha and theta"):
        read_change(text, 6)


def test_a_number_too_large_is_refused_by_name():
    chain = load_robot("puma560")
    with pytest.raises(RobotDescriptionError, match=r"'shoulder'\): a is 1e\+07, at most 1e6"):
        changed_robot(chain, read_change("2 a 1e7", 6))
