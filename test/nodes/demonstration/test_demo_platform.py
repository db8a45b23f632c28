"""Demonstration with parallel robots: in reach, apart, without obstacles."""

import numpy as np
import pytest

from robomech_ros.cartesian import waypoint_path
from robomech_ros.nodes.demonstration.demo_platform import DemoPlatform
from robomech_ros.parallel import list_parallel, load_parallel, plan_platform
from robomech_ros.spatial import pose_error


@pytest.mark.parametrize("name", list_parallel())
def test_pick_and_place_are_apart_and_in_reach(name):
    mechanism = load_parallel(name).mechanism
    pick, place = DemoPlatform(mechanism).targets()
    assert np.linalg.norm(pose_error(pick, place)) > 1e-2
    for pose in (pick, place):
        assert len(mechanism.postures(pose, seed=mechanism.home()).q)
    again = DemoPlatform(mechanism).targets()
    np.testing.assert_array_equal(again, (pick, place))


@pytest.mark.parametrize(
    ("name", "circle"), [("hexapod", "circle with tilt"), ("delta", "circle"), ("agile_eye", None)]
)
def test_ways_of_the_platform_can_be_planned(name, circle):
    mechanism = load_parallel(name).mechanism
    robot = DemoPlatform(mechanism)
    pick, place = robot.targets()
    ways = [robot.path_to_place(pick, place), robot.path_onward(place)]
    if circle is None:
        assert ways == [None, None]
        return
    over, on = ways
    assert (over.name, over.path_kind) == ("place", "STRAIGHT")
    assert (on.name, on.path_kind) == (circle, "SPLINE")
    # Up, across, and down.
    assert over.waypoints[0][2, 3] > pick[2, 3]
    np.testing.assert_array_equal(over.waypoints[-1], place)
    for begin, way, kind in ((pick, over, "straight"), (place, on, "spline")):
        start = mechanism.postures(begin, seed=mechanism.home()).q[0]
        path = waypoint_path(mechanism.pose(start), way.waypoints, kind)
        assert plan_platform(mechanism, path, start).stop is None
    turned = pose_error(on.waypoints[len(on.waypoints) // 2], place)[:3]
    assert (np.linalg.norm(turned) > 0.05) == (circle == "circle with tilt")
