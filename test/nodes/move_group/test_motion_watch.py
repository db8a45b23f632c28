"""Checks of a motion while the world around the robot changes."""

import time

import numpy as np
import pytest
from move_group_client import HERE, THERE, UR5E, box
from shaped_arm import shaped_ur5e

from robomech_ros.nodes.common.cooperative_wait import Worker
from robomech_ros.nodes.common.robot.robot_description import RobotModel
from robomech_ros.nodes.move_group.motion_watch import MotionWatch
from robomech_ros.nodes.move_group.scenes import Scenes
from robomech_ros.robots import load_description
from robomech_ros.trajectory.waypoints import Waypoints

AWAY = box(name="away", position=(0.0, 0.0, 3.0))
WALL = box(name="wall", sizes=(0.4, 0.02, 0.6), position=(0.65, 0.0, 0.3))


class Watched:
    """A motion in a world that a test changes."""

    def __init__(self, worker, seconds):
        self.model = RobotModel(load_description(shaped_ur5e()))
        self.scenes = Scenes(self.model, worker, 0.0)
        self.known = dict(zip(UR5E.joint_names, HERE, strict=True))
        times = np.linspace(0.0, seconds, round(seconds) + 1)
        self.rows = HERE + np.linspace(0.0, 1.0, len(times))[:, None] * (THERE - HERE)
        rates = np.tile((THERE - HERE) / seconds, (len(times), 1))
        waypoints = Waypoints(times, self.rows, rates)
        self.watch = MotionWatch(self.model, lambda: self.known, UR5E.joint_names, waypoints)

    def change(self, *objects):
        world = self.scenes.world.copy(empty=True)
        for one in objects:
            world.apply_object(one, {"": np.eye(4)})
        self.scenes.adopt(world, self.known)

    def is_due(self):
        return self.watch.is_due(self.scenes.world)

    def checked(self):
        assert self.is_due()
        return self.watch.obstruction(self.scenes.whole(self.known))


@pytest.fixture
def worker(graph):
    made = Worker(graph.client)
    yield made
    made.close()


def test_a_change_that_is_checked_late_stops_the_robot(worker):
    one = Watched(worker, 10.0)
    # Before the motion nothing is late.
    time.sleep(0.6)
    assert one.checked() == ""
    one.change(AWAY)
    time.sleep(0.15)
    assert one.checked() == ""
    # Nothing changes for a while.
    time.sleep(0.6)
    assert not one.is_due()
    one.change()
    time.sleep(0.15)
    assert one.checked() == ""
    one.change(AWAY)
    time.sleep(0.6)
    assert one.checked().startswith("the scene changed up to 0.")
    one.change(WALL)
    time.sleep(0.6)
    assert "'wall'" in one.checked()


def test_a_long_motion_is_checked_some_seconds_ahead(worker):
    one = Watched(worker, 60.0)
    one.change(WALL)
    # The first check is of the whole motion.
    assert "'wall'" in one.checked()
    one.change()
    time.sleep(0.15)
    assert one.checked() == ""
    one.change(WALL)
    time.sleep(0.15)
    assert one.checked() == "" and not one.is_due()
    found, second = "", 0
    while not found:
        second += 1
        one.known.update(zip(UR5E.joint_names, one.rows[second], strict=True))
        time.sleep(0.15)
        if one.is_due():
            found = one.watch.obstruction(one.scenes.whole(one.known))
    at = float(found.split(" s of the motion")[0].split()[-1])
    assert "'wall'" in found and 4.0 < at - second < 11.0
