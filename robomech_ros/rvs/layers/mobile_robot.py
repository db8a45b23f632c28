"""A robot that moves over the ground of the page: command, what becomes of it, trail, way ahead."""

from __future__ import annotations

from functools import partial
from typing import Any, cast

from robomech_ros.errors import BadValueError
from robomech_ros.numerics.arrays import finite_number
from robomech_ros.rvs.model.kinds.mobile_robot import AXES, MobileRobotView
from robomech_ros.rvs.page.clients import Controls
from robomech_ros.rvs.page.fact_table import fact_table
from robomech_ros.rvs.page.folder import Folder
from robomech_ros.rvs.page.layer import LayerContext
from robomech_ros.rvs.page.mobile.stepping import Stepping
from robomech_ros.rvs.page.path_nodes import PathNode
from robomech_ros.rvs.page.switches import Switches
from robomech_ros.spatial.arrays import as_flag

ORDER = 3.5
TRAIL, AHEAD = (31, 119, 180), (230, 120, 20)


class MobileRobotLayer:
    """The layer.

    Parameters
    ----------
    place : LayerContext
        Of a page on which a :class:`MobileRobotView` is moved.
    """

    def __init__(self, place: LayerContext) -> None:
        self._place = place
        self._robot = robot = cast(MobileRobotView, place.moved)
        scene = place.server.scene
        self._trail = PathNode(scene, f"{place.base}/trail", TRAIL, place.seen.reach)
        self._ahead = PathNode(scene, f"{place.base}/way_ahead", AHEAD, place.seen.reach)
        self._switches = Switches(place, {"trail": "trail"}, {"trail": True})
        # Whether it is to follow the command; if not, it stops.
        self._follows = False
        self._folder: Folder | None = None
        self._table: Any = None
        self.stepping = Stepping(place, robot.period, self._go_on, lambda: robot.moved_joint)

    def show(self) -> None:
        """Follow the robot."""
        robot = self._robot
        if not robot.stands:
            self.stepping.begin()
        self._trail.show(robot.trail if self._switches["trail"] else robot.trail[:0])
        self._ahead.show(robot.path_ahead())
        if self._folder is not None and not self._folder.removed:
            self._table.content = fact_table(robot.kind, robot.facts())

    def controls(self, client: Any) -> Controls:
        """Give a browser the folder "Drive" or "Walk"."""
        robot, verb = self._robot, self._robot.verb
        folder = self._folder = Folder(
            client.gui, self._place.units, verb.capitalize(), ORDER, expanded=True
        )
        with folder:
            for name, unit, k in AXES:
                most = float(robot.most[k])
                if most > 0.0:
                    command = partial(self._command, name, k)
                    folder.slider(name, unit, (-most, most), float(robot.command[k]), command)
            hint = f"On: {verb}s as commanded, within the limits. Off: stops within them"
            folder.checkbox(verb, self._follows, self._switch, hint)
            self._switches.add_to(folder, "trail")
            folder.button("Clear trail", self._clear)
            self._table = folder.text()
        self.show()
        return folder

    def close(self) -> None:
        """Stop."""
        self.stepping.close()

    def _command(self, name: str, axis: int, value: Any) -> None:
        def commanded() -> None:
            given, most = finite_number(name, value, AXES[axis][1]), float(self._robot.most[axis])
            if abs(given) > most:
                raise BadValueError(name, value, f"{-most:g} to {most:g} {AXES[axis][1]}")
            self._robot.command[axis] = given
            self._robot.preview()

        self._place.ask((self, name), commanded, name)

    def _switch(self, value: Any) -> None:
        def switched() -> None:
            self._follows = as_flag(self._robot.verb, value)
            if self._follows:
                self.stepping.begin()

        self._place.ask((self, "follow"), switched)

    def _clear(self) -> None:
        self._place.ask((self, "clear"), self._robot.forget)

    def _go_on(self, steps: int) -> bool:
        """Move on; where nobody looks any more, stop."""
        if not self._place.server.get_clients():
            self._follows = False
        self._robot.drive(steps, brake=not self._follows)
        return self._follows or not self._robot.stands
