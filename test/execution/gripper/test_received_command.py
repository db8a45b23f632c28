"""Commands to fingers as they arrive."""

import numpy as np
import pytest

from robomech_ros.errors import (
    BadValueError,
    LimitExceededError,
    NonFiniteError,
    UnknownJointError,
    WrongSizeError,
)
from robomech_ros.execution.gripper.received_command import CommandReader
from robomech_ros.trajectory import Limits

LIMITS = Limits(
    ["thumb", "finger", "palm"],
    lower=[0.0, -1.0, None],
    upper=[0.04, 1.0, None],
    units=["m", "rad", "rad"],
)
FASTEST, STRONGEST = np.array([0.2, 2.0, np.inf]), np.array([20.0, np.nan, np.nan])


def reader(*commanded):
    return CommandReader(LIMITS, commanded, FASTEST, STRONGEST)


def test_one_position_for_all_that_are_commanded():
    command = reader("thumb", "finger").read([], [0.03])
    np.testing.assert_array_equal(command.position, [0.03, 0.03, np.nan])
    np.testing.assert_array_equal(command.moved, [True, True, False])
    np.testing.assert_array_equal(command.velocity, FASTEST)
    np.testing.assert_array_equal(command.effort, STRONGEST)


def test_joints_by_name_in_any_order():
    command = reader("thumb").read(["palm", "thumb"], [7.0, 0.0], [3.0, 0.1], [5.0, 6.0])
    np.testing.assert_array_equal(command.position, [0.0, np.nan, 7.0])
    np.testing.assert_array_equal(command.velocity, [0.1, 2.0, 3.0])
    np.testing.assert_array_equal(command.effort, [6.0, np.nan, 5.0])


@pytest.mark.parametrize(("given", "allowed"), [(0.0, 20.0), (-1.0, 20.0), (1e9, 20.0), (3.0, 3.0)])
def test_the_most_that_a_joint_can(given, allowed):
    assert reader("thumb").read([], [0.0], [], [given]).effort[0] == allowed


def test_an_effort_without_a_limit():
    assert reader("finger").read([], [0.0], [], [np.inf]).effort[1] == np.inf
    assert np.isnan(reader("finger").read([], [0.0]).effort[1])


@pytest.mark.parametrize(
    ("given", "error", "text"),
    [
        (
            ([], [0.05]),
            LimitExceededError,
            "position of joint 'thumb' is 0.05 m, over its limit 0.04 m by 0.01 m",
        ),
        (([], [-0.1]), LimitExceededError, "'thumb' is -0.1 m, over its limit 0 m"),
        (([], [0.040002]), LimitExceededError, "by 2e-06 m"),
        (([], [np.nan]), NonFiniteError, "position of joint 'thumb'"),
        (([], [np.inf]), NonFiniteError, "position of joint 'thumb'"),
        (([], []), WrongSizeError, "position.*0.*1"),
        (([], [0.0, 0.0]), WrongSizeError, "position.*2.*1"),
        ((["thumb"], []), WrongSizeError, "position"),
        ((["toe"], [0.0]), UnknownJointError, "'toe'.*thumb, finger, palm"),
        ((["thumb", "thumb"], [0.0, 0.0]), BadValueError, "every joint once"),
        ((["thumb"], [0.0], [1.0, 2.0]), WrongSizeError, "velocity.*2.*1, or 0"),
        ((["thumb"], [0.0], [], [1.0, 2.0]), WrongSizeError, "effort.*2.*1, or 0"),
        (([], [0.0], [np.nan]), NonFiniteError, "velocity of joint 'thumb'"),
        (([], [0.0], [], [np.nan]), NonFiniteError, "effort of joint 'thumb'"),
    ],
)
def test_what_is_refused(given, error, text):
    with pytest.raises(error, match=text):
        reader("thumb").read(*given)


@pytest.mark.parametrize(("given", "limit"), [(0.0400001, 0.04), (-1e-7, 0.0), (0.01, 0.01)])
def test_a_goal_that_rounding_puts_beyond_a_limit_means_the_limit(given, limit):
    assert reader("thumb").read([], [given]).position[0] == limit


def test_where_a_joint_has_to_be_named():
    with pytest.raises(BadValueError, match="one or more of the joints thumb, finger, palm"):
        reader().read([], [0.0])
    assert reader().read(["palm"], [9.0]).position[2] == 9.0


def test_a_posture_by_its_name_moves_the_joints_that_it_names():
    states = {"open": {"thumb": 0.04, "finger": -0.5}, "wide": {"thumb": 0.06}}
    named = CommandReader(LIMITS, (), FASTEST, STRONGEST, lambda name: states.get(name, {}))
    command = named.read(["open"], [], [0.1], [3.0])
    np.testing.assert_array_equal(command.position, [0.04, -0.5, np.nan])
    np.testing.assert_array_equal(command.velocity, [0.1, 0.1, np.inf])
    np.testing.assert_array_equal(command.effort, [3.0, 3.0, np.nan])
    with pytest.raises(LimitExceededError, match=r"'thumb' is 0.06 m"):
        named.read(["wide"], [])
    with pytest.raises(WrongSizeError, match="velocity"):
        named.read(["open"], [], [0.1, 0.1, 0.1])
    with pytest.raises(WrongSizeError, match="position"):
        named.read(["thumb"], [])
    with pytest.raises(UnknownJointError):
        reader("thumb").read(["open"], [0.0])
