"""Controls of the commanding browser for a running mobile robot: hold to move."""

from __future__ import annotations

from typing import Any

from robomech_ros.errors import BadValueError
from robomech_ros.rvs.model.jog import HoldHeartbeat
from robomech_ros.rvs.model.running.live_mobile_robot import LiveMobileRobot
from robomech_ros.rvs.model.running.observed_robot import ObservedRobot
from robomech_ros.rvs.page.folder import Folder
from robomech_ros.rvs.page.live.hold_field import HoldField
from robomech_ros.rvs.page.live.jog_pad import hold_pad
from robomech_ros.rvs.page.live.trunk_controls import TrunkControls
from robomech_ros.rvs.page.units import Units
from robomech_ros.spatial.arrays import as_choice

ORDER = 3.5


class MobileRobotControls:
    """The controls of one browser.

    Parameters
    ----------
    client : viser.ClientHandle
        The browser.
    units : Units
    followed : ObservedRobot
    robot : LiveMobileRobot
    layer : LiveMobileRobotLayer
    """

    def __init__(
        self, client: Any, units: Units, followed: ObservedRobot, robot: LiveMobileRobot, layer: Any
    ) -> None:
        self.client_id = client.client_id
        self._followed, self._robot, self._layer = followed, robot, layer
        gui = client.gui
        self.folder = Folder(gui, units, followed.verb.capitalize(), ORDER, expanded=True)
        with self.folder:
            self._pad = HoldField(gui, 0, self._hold, robot.let_go, layer.refuse)
            self.folder.text().content = hold_pad(self._pad.identifier, [followed.ways])
            if followed.gaits:
                hint = "Choose one, in which it walks on as soon as it stands"
                gaits = ("", *followed.gaits)
                self.folder.dropdown("gait", gaits, "", self._choose_gait, hint)
            if followed.shifts:
                TrunkControls(self.folder, followed.shifts, robot.move_trunk, layer.refuse)
            layer.switches.add_to(self.folder, "trail")
            self.folder.button("Clear trail", layer.clear_trail)

    def _choose_gait(self, value: Any) -> None:
        if value == "":
            return
        try:
            self._robot.choose_gait(as_choice("gait", value, self._followed.gaits))
        except BadValueError as error:
            self._layer.refuse(error)

    def _hold(self, beat: HoldHeartbeat, speed: float) -> None:
        """Go on with a jog."""
        direction, ways = beat.direction, self._followed.ways
        if (direction.kind, direction.index) not in [(way.kind, way.axis) for way in ways]:
            expected = ", ".join(f"'{way.kind} {way.axis}' ({way.name})" for way in ways)
            raise BadValueError("jog", f"{direction.kind} {direction.index}", expected)
        self._robot.hold(beat, speed)

    def remove(self) -> None:
        """Take the controls from the browser, and end its jog."""
        self._pad.end()
        self.folder.remove()
