"""Checks of a motion while it is executed, since the world may change."""

import time
from contextlib import suppress
from typing import Any

import numpy as np

from robomech_ros.errors import RobomechError
from robomech_ros.nodes.common.robot_description import RobotModel
from robomech_ros.nodes.move_group.scenes import Scenes
from robomech_ros.nodes.moveit.whole_robot import WholeRobot
from robomech_ros.robots import SerialChain
from robomech_ros.typing import Array

# How often a changing world is looked at, s.
_PERIOD = 0.1
# A contact this near to where the robot is, in points of the trajectory, is one that it leaves.
_HERE = 1.0


class MotionWatch:
    """Looks for contacts on the rest of a motion.

    Parameters
    ----------
    robot : WholeRobot
    scenes : Scenes
    trajectory : JointTrajectory
        One with joints that are not known, or with points of the wrong size, is not looked at: the
        controller refuses it.
    """

    def __init__(self, robot: WholeRobot, scenes: Scenes, trajectory: Any) -> None:
        self._robot, self._scenes = robot, scenes
        self._chain = _chain_of(robot.model, trajectory.joint_names)
        self._known = robot.known()
        self._rows = self._read(trajectory)
        self._done, self._due = 0, 0.0
        self._seen: Any = None

    async def obstruction(self) -> str:
        """Say what the rest of the motion would touch; "" for nothing, or while nothing changes."""
        world, now = self._scenes.world, time.monotonic()
        if self._rows is None or world is self._seen or now < self._due:
            return ""
        self._seen, self._due = world, now + _PERIOD
        scene = await self._scenes.of(self._chain, self._robot.with_defaults(self._known))
        rest = self._rest()
        found = scene.check_motion(rest)
        if found.free or (found.parameter < _HERE and not scene.is_free(rest[0])):
            return ""
        first, second = found.bodies
        return f"'{first}' and '{second}' would touch on the rest of the motion"

    def _read(self, trajectory: Any) -> Array | None:
        """Return the joint values (m, n) of the chain along the trajectory (rad or m)."""
        names = list(trajectory.joint_names)
        points = [point.positions for point in trajectory.points]
        missing = [
            name
            for name in self._chain.joint_names
            if name not in names and name not in self._known
        ]
        if missing or not points or any(len(point) != len(names) for point in points):
            return None
        table = np.array(points)
        columns = [
            table[:, names.index(name)] if name in names else np.full(len(table), self._known[name])
            for name in self._chain.joint_names
        ]
        rows = np.stack(columns, axis=-1)
        return rows if np.isfinite(rows).all() else None

    def _rest(self) -> Array:
        """Return the points (m, n) from where the robot is."""
        assert self._rows is not None
        known, names = self._robot.known(), self._chain.joint_names
        if all(name in known for name in names):
            here = np.array([known[name] for name in names])
            apart = np.abs(self._rows[self._done :] - here).max(axis=1)
            self._done += int(np.argmin(apart))
        return self._rows[self._done :]


def _chain_of(model: RobotModel, joint_names: Any) -> SerialChain:
    """Return the chain of exactly these joints; the configured one if there is none."""
    for group in model.groups:
        with suppress(RobomechError):
            chain = model.chain_of(group)
            if set(chain.joint_names) == set(joint_names):
                return chain
    return model.chain
