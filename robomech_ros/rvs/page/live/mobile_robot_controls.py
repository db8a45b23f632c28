"""Controls of the commanding browser for a running mobile robot: hold to move."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from robomech_ros.errors import BadValueError
from robomech_ros.rvs.model.jog import read_beat
from robomech_ros.rvs.model.running.live_mobile_robot import LiveMobileRobot
from robomech_ros.rvs.model.running.observed_robot import ObservedRobot
from robomech_ros.rvs.page.folder import Folder
from robomech_ros.rvs.page.live.hold_field import HoldField
from robomech_ros.rvs.page.live.jog_pad import hold_pad
from robomech_ros.rvs.page.live.trunk_controls import TrunkControls
from robomech_ros.rvs.page.units import Units
from robomech_ros.spatial.arrays import as_choice

ORDER = 3.5
# Parts of the greatest jogging speed.
SLOWEST, AT_FIRST = 0.05, 0.5


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
            hint = "Part of the greatest jogging speed, a parameter of the node"
            self._speed = self.folder.listen(
                gui.add_slider("speed", SLOWEST, 1.0, 0.05, AT_FIRST, hint=hint), lambda _: None
            )
            self._pad = HoldField(gui, self._hold, robot.let_go, layer.refuse)
            self.folder.text().content = hold_pad(self._pad.identifier, [followed.ways])
            if followed.gaits:
                hint = "Choose one, in which it walks on as soon as it stands"
                gait = gui.add_dropdown("gait", ("", *followed.gaits), hint=hint)
                self.folder.listen(gait, self._choose(followed.gaits))
            if followed.shifts:
                TrunkControls(self.folder, followed.shifts, robot.move_trunk, layer.refuse)
            layer.switches.add_to(self.folder, "trail")
            self.folder.button("Clear trail", layer.clear_trail)

    def _choose(self, gaits: tuple[str, ...]) -> Callable[[Any], None]:
        def choose(value: Any) -> None:
            if value == "":
                return
            try:
                self._robot.choose_gait(as_choice("gait", value, gaits))
            except BadValueError as error:
                self._layer.refuse(error)

        return choose

    def _hold(self, text: str) -> None:
        """Go on with a jog."""
        beat = read_beat(text, 0)
        direction, ways = beat.direction, self._followed.ways
        if (direction.kind, direction.index) not in [(way.kind, way.axis) for way in ways]:
            expected = ", ".join(f"'{way.kind} {way.axis}' ({way.name})" for way in ways)
            raise BadValueError("jog", f"{direction.kind} {direction.index}", expected)
        speed = self._speed.value
        if not SLOWEST <= speed <= 1.0:
            raise BadValueError("speed", speed, f"{SLOWEST:g} to 1")
        self._robot.hold(beat, speed)

    def remove(self) -> None:
        """Take the controls from the browser, and end its jog."""
        self._pad.end()
        self.folder.remove()
