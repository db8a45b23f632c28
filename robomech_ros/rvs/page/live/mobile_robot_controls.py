"""Controls of the commanding browser for a running mobile robot: hold to move."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from robomech_ros.errors import BadValueError
from robomech_ros.numerics.arrays import finite_number
from robomech_ros.rvs.model.draggable import ROUNDING
from robomech_ros.rvs.model.jog import HoldHeartbeat
from robomech_ros.rvs.model.live_robot import LiveMobileRobot
from robomech_ros.rvs.model.observed_robot import ObservedRobot, Shift
from robomech_ros.rvs.page.folder import Folder
from robomech_ros.rvs.page.live.hold_field import HoldField
from robomech_ros.rvs.page.live.jog_pad import hold_pad
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
        direction, ways = beat.direction, self._followed.ways
        if (direction.kind, direction.index) not in [(way.kind, way.axis) for way in ways]:
            expected = ", ".join(f"'{way.kind} {way.axis}' ({way.name})" for way in ways)
            raise BadValueError("jog", f"{direction.kind} {direction.index}", expected)
        self._robot.hold(beat, speed)

    def remove(self) -> None:
        """Take the controls from the browser, and end its jog."""
        self._pad.end()
        self.folder.remove()


class TrunkControls:
    """Controls of the trunk in a folder.

    Parameters
    ----------
    folder : Folder
        That is entered.
    shifts : sequence of Shift
        How the trunk can be moved.
    ask : callable
        Asks for a pose beside the level one: a value (m or rad) for each shift.
    refuse : callable
        Says that something was refused.
    """

    def __init__(
        self,
        folder: Folder,
        shifts: Sequence[Shift],
        ask: Callable[[list[float]], None],
        refuse: Callable[[BadValueError], None],
    ) -> None:
        self._shifts, self._ask, self._refuse = shifts, ask, refuse
        self._sliders = []
        for shift in shifts:
            hint = f"Beside the level pose, {shift.unit}"
            ends = (-shift.most, shift.most)
            self._sliders.append(
                folder.slider(shift.name, shift.unit, ends, 0.0, lambda _: None, hint)
            )
        hint = "Over feet that stay; what would tip the robot or overstretch a leg is refused"
        folder.button("Move trunk", self._move, hint)
        folder.button("Level trunk", self._level)

    def _move(self) -> None:
        try:
            pairs = zip(self._shifts, self._sliders, strict=True)
            self._ask([_checked(shift, slider.value) for shift, slider in pairs])
        except BadValueError as error:
            self._refuse(error)

    def _level(self) -> None:
        for slider in self._sliders:
            slider.value = 0.0
        self._ask([0.0] * len(self._sliders))


def _checked(shift: Shift, value: object) -> float:
    given = finite_number(shift.name, value, shift.unit)
    if abs(given) > shift.most + ROUNDING:
        expected = f"{-shift.most:.6g} to {shift.most:.6g} {shift.unit}"
        raise BadValueError(shift.name, given, expected)
    return given
