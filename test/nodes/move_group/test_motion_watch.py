"""Checks of a motion while the world around the robot changes."""

import time

import numpy as np
from move_group_client import HERE, THERE, UR5E, box
from shaped_arm import shaped_ur5e

from robomech_ros.nodes.common.cooperative_wait import Worker
from robomech_ros.nodes.common.robot_description import RobotModel
from robomech_ros.nodes.move_group.motion_watch import MotionWatch
from robomech_ros.nodes.move_group.scenes import Scenes
from robomech_ros.robots import load_description
from robomech_ros.trajectory.waypoints import Waypoints

AWAY = box(name="away", position=(0.0, 0.0, 3.0))


def test_a_change_that_is_checked_late_stops_the_robot(graph):
    model, worker = RobotModel(load_description(shaped_ur5e())), Worker(graph.client)
    scenes, known = Scenes(model, worker, 0.0), dict(zip(UR5E.joint_names, HERE, strict=True))
    rows = Waypoints(np.array([0.0, 10.0]), np.array([HERE, THERE]), np.zeros((2, 6)))
    watch = MotionWatch(model, lambda: known, UR5E.joint_names, rows)

    def change(*objects):
        world = scenes.world.copy(empty=True)
        for one in objects:
            world.apply_object(one, {"": np.eye(4)})
        scenes.adopt(world, known)

    def checked():
        assert watch.is_due(scenes.world)
        return watch.obstruction(scenes.whole(known))

    # Before the motion nothing is late.
    time.sleep(0.6)
    assert checked() == ""
    change(AWAY)
    time.sleep(0.15)
    assert checked() == ""
    # Nothing changes for a while.
    time.sleep(0.6)
    assert not watch.is_due(scenes.world)
    change()
    time.sleep(0.15)
    assert checked() == ""
    change(AWAY)
    time.sleep(0.6)
    assert checked().startswith("a change of the scene was checked after up to 0.")
    change(box(name="wall", sizes=(0.4, 0.02, 0.6), position=(0.65, 0.0, 0.3)))
    time.sleep(0.6)
    assert "'wall'" in checked()
    worker.close()
