"""Whatever is given to a function of Cartesian motions, it answers or raises an error of ours."""

import numpy as np
import pytest
from wrong_values import WRONG_VALUES, answered_or_refused, with_options

from robomech_ros import cartesian
from robomech_ros.cartesian import (
    PathStopLimits,
    Sampling,
    follow_path,
    link_speed_limit,
    plan_along,
    plan_followed,
    relative_jump,
    serial_arm,
    stop_on_condition,
    waypoint_fraction,
    waypoint_path,
)
from robomech_ros.errors import BadValueError
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.robots import load_robot

VALUES = (
    *WRONG_VALUES,
    {"waist": "x"},
    [np.nan] * 6,
    [1e300] * 6,
    np.zeros(6, complex),
    np.full((1, 4, 4), np.nan),
    np.full((1, 4, 4), 1e300),
    np.zeros((2, 4, 4)),
    np.zeros((2, 2, 4, 4)),
)
PUMA = load_robot("puma560")
START = np.array([0.3, -0.4, 0.2, 0.5, 0.6, -0.7])
HERE = forward_kinematics(PUMA, START)


def calls():
    there = HERE.copy()
    there[0, 3] += 0.05
    path = waypoint_path(HERE, [there])
    followed = follow_path(PUMA, path, START)
    found = with_options(waypoint_path, start=HERE, waypoints=[there])
    found |= with_options(serial_arm, chain=PUMA)
    found |= with_options(PathStopLimits)
    found |= with_options(Sampling)
    found |= with_options(follow_path, chain=PUMA, path=path, start=START)
    found |= with_options(plan_along, chain=PUMA, path=path, start=START)
    found |= with_options(plan_followed, followed=followed)
    found |= with_options(waypoint_fraction, followed=followed, waypoints=[there])
    found |= with_options(relative_jump, chain=PUMA, step=0.1, factor=2.0)
    found |= with_options(stop_on_condition, broken=lambda q: "", step=0.1)
    elbow = load_robot("puma560", tip="link_3")
    found |= with_options(
        link_speed_limit, chain=PUMA, joints=followed.joints, link=elbow, speed=0.1
    )
    return found


CALLS = calls()


def test_every_public_function_is_called_here():
    called = {name.partition(".")[0] for name in CALLS}
    assert {name for name in cartesian.__all__ if name[0].islower()} <= called


@pytest.mark.parametrize("name", CALLS)
def test_wrong_arguments_are_answered_or_refused_with_an_error_of_ours(name):
    answered_or_refused(CALLS[name], VALUES)


@pytest.mark.parametrize("value", [True, 1, "x", (), np.zeros(3)], ids=str)
def test_a_check_that_gives_no_cut_is_refused(value):
    there = HERE.copy()
    there[0, 3] += 0.05
    path = waypoint_path(HERE, [there])
    with pytest.raises(BadValueError, match="a PathCut or None"):
        follow_path(PUMA, path, START, bounds=PathStopLimits(checks=[lambda joints: value]))
