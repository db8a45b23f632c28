"""A mobile robot on a page: its command, the executed part of it, trail and path ahead."""

import time
from functools import partial
from typing import Any

from robomech_ros.numerics.arrays import real_within
from robomech_ros.rvs.model.kinds.mobile_robot import AXES, MobileRobotView
from robomech_ros.rvs.page.folder import Folder
from robomech_ros.rvs.page.layer import Layer, LayerContext
from robomech_ros.rvs.page.path_nodes import PathNode
from robomech_ros.rvs.page.switches import Switches
from robomech_ros.rvs.serving.ticker import Ticker

# How often it is drawn while it moves (s), and what is made up for at most (s).
TICK, MOST = 0.05, 0.4
TRAIL, AHEAD = (31, 119, 180), (230, 120, 20)


class MobileRobotLayer(Layer):
    """The layer.

    - ``context``: context of a page on which a :class:`MobileRobotView` is moved.
    """

    order, expanded = 3.5, True

    def __init__(self, context: LayerContext) -> None:
        super().__init__(context)
        self._robot = robot = context.robot_of(MobileRobotView)  # type: ignore[type-abstract]
        self.label = robot.verb.capitalize()
        self._trail = PathNode(context.space, "trail", TRAIL)
        self._ahead = PathNode(context.space, "way_ahead", AHEAD)
        self._switches = Switches(context, {"trail": "trail"}, {"trail": True})
        # Whether it is to follow the command; if not, it stops.
        self._follows = False
        self._stepped = 0.0
        self._ticker = Ticker("steps", TICK, self._ask_for_step)

    @property
    def moves(self) -> bool:
        """True if the robot goes on in periods, on the thread of the page."""
        return self._ticker.is_on

    def show(self) -> None:
        """Follow the robot."""
        robot = self._robot
        if not robot.stands:
            self._begin()
        points = robot.trail.points
        self._trail.show(points if self._switches["trail"] else points[:0])
        self._ahead.show(robot.path_ahead())
        self.write(robot.kind, robot.facts())

    def _fill(self, folder: Folder, gui: Any) -> None:
        robot, verb = self._robot, self._robot.verb
        for name, unit, k in AXES:
            most = float(robot.most[k])
            if most > 0.0:
                command = partial(self._command, name, k)
                folder.slider(name, unit, (-most, most), float(robot.command[k]), command)
        hint = f"On: {verb}s as commanded, within the limits. Off: stops within them"
        folder.checkbox(verb, self._follows, self._follow, hint)
        self._switches.add_to(folder, "trail")
        folder.button("Clear trail", robot.trail.clear)
        self._table = folder.text()

    def _command(self, name: str, axis: int, value: Any) -> None:
        unit, most = AXES[axis][1], float(self._robot.most[axis])
        expected = f"{-most:g} to {most:g} {unit}"
        self._robot.command[axis] = real_within(name, value, expected, -most, most)
        self._robot.preview()

    def _follow(self, value: bool) -> None:
        self._follows = value
        if value:
            self._begin()

    def _begin(self) -> None:
        """Go on from now, unless it does already; in requests alone."""
        if not self.moves:
            self._stepped = time.monotonic()
            self._ticker.start()

    def _ask_for_step(self) -> None:
        self._context.ask((self, "step"), self._step, self._robot.moved_joint)

    def _step(self) -> None:
        """Move on to now; where nobody looks any more, stop."""
        robot, now = self._robot, time.monotonic()
        steps, most = int((now - self._stepped) / robot.period), int(MOST / robot.period)
        # Steps missed for long are dropped.
        self._stepped = now if steps > most else self._stepped + steps * robot.period
        if not self._context.server.get_clients():
            self._follows = False
        robot.drive(min(steps, most), brake=not self._follows)
        if not self._follows and robot.stands:
            self._ticker.stop()
