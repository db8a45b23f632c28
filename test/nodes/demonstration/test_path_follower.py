"""Closed paths, and bases that follow them with delays and silences; no clock."""

import math
from collections import deque
from dataclasses import replace

import numpy as np
import pytest

from robomech_ros.errors import BadValueError
from robomech_ros.nodes.demonstration.closed_paths import figure_of_eight, rounded_square
from robomech_ros.nodes.demonstration.drive_task import paths_for, speed_on
from robomech_ros.nodes.demonstration.path_follower import PathFollower
from robomech_ros.nodes.mobile_base.drives import INTERFACES
from robomech_ros.nodes.mobile_base.mobile_base import BaseOptions, MobileBase
from robomech_ros.rolling import MotionLimits, RollingBase, Wheel, list_rolling, rolling_robot

PERIOD = 0.02
# Updates from a command to its effect, and how long nothing is heard (s).
LATE, SILENT = 2, 1.2
PATHS = [
    rounded_square(0.5, turning=True),
    rounded_square(2.0, turning=False),
    figure_of_eight(0.5, looking_ahead=False),
    figure_of_eight(2.0, looking_ahead=True),
]


@pytest.mark.parametrize("path", PATHS, ids=lambda path: path.name)
def test_paths_close_and_bend_no_more_than_at_their_radius(path):
    radius = path.length / (4.0 * (math.pi + 1.0))
    if path.name.startswith("eight"):
        radius = path.length / (2.0 * math.pi * 2.404825557695773)
    assert np.hypot(*path.places[-1]) < 1e-9 * radius
    assert abs(math.remainder(path.tangents[-1], 2.0 * math.pi)) < 1e-12
    assert abs(math.remainder(path.headings[-1], 2.0 * math.pi)) < 1e-12
    bend = np.abs(np.diff(path.tangents) / np.diff(path.lengths)).max()
    assert 1.0 - 1e-3 < bend * radius < 1.0 + 1e-9
    # What is said of a place is what lies between its neighbours.
    for length in np.linspace(0.1, 0.9, 7) * path.length:
        (before, _), (pose, motion), (after, _) = (path.at(length + d) for d in (-1e-3, 0.0, 1e-3))
        np.testing.assert_allclose((after - before)[:2] / 2e-3, motion[1:], atol=2e-3)
        assert (after - before)[2] / 2e-3 == pytest.approx(motion[0], abs=2e-3)
        np.testing.assert_allclose(0.5 * (before + after), pose, atol=1e-5)


def drive(robot, number, silent):
    """Drive one of the two paths of a robot; gives the follower and the base at its end."""
    radius, paths = paths_for(robot.base)
    path = paths[number]
    speed, acceleration = speed_on(robot, path, radius)
    follower = PathFollower(robot.base.axle, path, speed, acceleration, radius)
    base = MobileBase(robot, INTERFACES[robot.drive], BaseOptions(period=PERIOD, timeout=0.5))
    sent, heard = deque(), 0.4 * path.length / speed
    while not follower.arrived or base.motion.twist.any():
        assert base.time < 5.0 * path.length / speed
        if not heard < base.time < heard + silent:
            sent.append((base.time, follower.command(base.time, base.odometry.pose)))
        while sent and sent[0][0] <= base.time - LATE * PERIOD + 1e-9:
            at, command = sent.popleft()
            base.take(command, base.time - at)
        base.update()
    return follower, base, radius


@pytest.mark.parametrize("number", [0, 1])
@pytest.mark.parametrize("name", list_rolling())
def test_every_drive_follows_its_paths_and_arrives(name, number):
    follower, base, radius = drive(rolling_robot(name), number, 0.0)
    x, y, heading = base.simulated.pose
    assert math.hypot(x, y) < 5e-3
    assert abs(math.remainder(heading, 2.0 * math.pi)) < 5e-3
    assert 0.0 < follower.off < 0.05 * radius
    assert not base.motion.saturated


@pytest.mark.parametrize("name", ["differential", "mecanum", "tricycle"])
def test_a_base_that_hears_nothing_for_a_while_comes_back_to_its_path(name):
    follower, base, radius = drive(rolling_robot(name), 1, SILENT)
    x, y, heading = base.simulated.pose
    assert math.hypot(x, y) < 5e-3
    assert abs(math.remainder(heading, 2.0 * math.pi)) < 5e-3
    assert follower.off < 0.5 * radius


def test_bases_that_cannot_go_along_a_path_are_refused():
    axle = 0.2 * np.array([-math.sin(0.5), math.cos(0.5)])
    across = RollingBase(
        [
            Wheel(kind="fixed", position=side * axle, radius=0.1, heading=0.5, name=name)
            for side, name in ((1.0, "left"), (-1.0, "right"))
        ]
    )
    with pytest.raises(BadValueError, match=r"heading of the axle is 0\.5"):
        PathFollower(across.axle, PATHS[1], 0.3, 0.3, 1.0)
    known = rolling_robot("differential")
    slow = MotionLimits(velocity=[1e-5, 1.0, 0.0], acceleration=[1.0, 1.0, 1.0])
    with pytest.raises(BadValueError, match="limits is 'differential', expected some that allow"):
        speed_on(replace(known, limits=slow), PATHS[1], 2.0)
