"""Sliders and buttons for the pose that the trunk of a walking machine is to take."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from robomech_ros.errors import BadValueError
from robomech_ros.numerics.arrays import finite_number
from robomech_ros.rvs.model.draggable import ROUNDING
from robomech_ros.rvs.model.running.observed_robot import Shift
from robomech_ros.rvs.page.folder import Folder


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
