"""Angles of a page in rad or in degrees, as its switch says."""

from __future__ import annotations

import math
import re
from abc import ABC, abstractmethod
from typing import Any
from weakref import WeakSet

# Steps of sliders, and decimals of their fields, which have room for no more: rad or m, degrees.
STEP, DECIMALS = 0.001, 4
STEP_DEGREES, DECIMALS_DEGREES = 0.1, 2

_NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:e[+-]?\d+)?"
# One number or several, as "is 7, expected -6.28 to 6.28 rad" or "+0.1 -0.2 rad", and the unit.
_NEXT = rf"(?:,? expected | to | of | (?=[+-])){_NUMBER}"
_ANGLES = re.compile(rf"(?<![\w.]){_NUMBER}(?:{_NEXT})* (m?rad)\b")
_EACH = re.compile(rf"(?<![\w.]){_NUMBER}")


class Units:
    """The unit in which a page writes angles; values of the program are in rad.

    - ``degrees``: whether angles are in degrees.
    - ``shown``: what is written again when that changes.
    """

    def __init__(self) -> None:
        self.degrees = False
        self.shown: WeakSet[_Shown] = WeakSet()

    def turn(self, degrees: bool) -> None:
        """Write angles in degrees, or in rad."""
        self.degrees = degrees
        for one in list(self.shown):
            one.write()

    def factor(self, unit: str) -> float:
        """Return the factor from a unit of the program to that of the page."""
        return math.degrees(1.0) if self.degrees and unit.startswith("rad") else 1.0

    def name(self, unit: str) -> str:
        """Return the unit of the page for one of the program, such as rad/s."""
        return unit.replace("rad", "deg", 1) if self.factor(unit) != 1.0 else unit

    def number(self, value: float, unit: str, decimals: int) -> str:
        """Write a value of the program, with fewer decimals in degrees."""
        factor = self.factor(unit)
        return f"{value * factor:.{decimals if factor == 1.0 else max(decimals - 2, 1)}f}"

    def text(self, text: str) -> str:
        """Convert the angles of a text, which is in rad."""
        return _ANGLES.sub(_in_degrees, text) if self.degrees else text

    def html(self, gui: Any, **options: Any) -> UnitText:
        """Add empty HTML to a page or a browser (viser.GuiApi), whose angles follow the switch."""
        return UnitText(self, gui.add_html("", **options))

    def slider(
        self, gui: Any, label: str, unit: str, ends: tuple[float, float], value: float, hint: str
    ) -> AngleSlider:
        """Add a slider for a value of a unit, such as rad, between two ends."""
        return AngleSlider(self, gui.add_slider(label, *ends, STEP, value, hint=hint), unit, hint)


# Units of text outside pages.
RADIANS = Units()


class _Shown(ABC):
    """A control that follows the unit of its page until it is removed."""

    def __init__(self, units: Units, handle: Any) -> None:
        self._units, self._handle = units, handle
        self.write()
        units.shown.add(self)

    @abstractmethod
    def write(self) -> None:
        """Show the unit of the page."""

    def remove(self) -> None:
        """Remove it from the page."""
        self._units.shown.discard(self)
        self._handle.remove()


class UnitText(_Shown):
    """HTML of a page, written in rad."""

    _content = ""

    @property
    def content(self) -> str:
        """The HTML, in rad."""
        return self._content

    @content.setter
    def content(self, content: str) -> None:
        self._content = content
        self.write()

    def write(self) -> None:
        """Show the content in the unit of the page."""
        self._handle.content = self._units.text(self._content)


class AngleSlider(_Shown):
    """A slider whose value is in the unit of the program.

    - ``handle``: in that unit, viser.GuiSliderHandle.
    """

    def __init__(self, units: Units, handle: Any, unit: str, hint: str) -> None:
        self._unit, self._hint, self._factor = unit, hint, 1.0
        handle.precision = DECIMALS
        super().__init__(units, handle)

    def __getattr__(self, name: str) -> Any:
        # All but the value is that of the slider.
        return getattr(self._handle, name)

    @property
    def value(self) -> Any:
        """Value of the slider; returned unchanged if it is no number."""
        value = self._handle.value
        return value / self._factor if type(value) in (int, float) else value

    @value.setter
    def value(self, value: float) -> None:
        self._handle.value = self._factor * value

    def between(self, low: float, high: float) -> None:
        """Change the ends, in the unit of the program."""
        self._handle.min, self._handle.max = self._factor * low, self._factor * high

    def write(self) -> None:
        """Show the unit of the page."""
        handle, factor = self._handle, self._units.factor(self._unit)
        if factor == self._factor:
            return
        low, high, value = handle.min / self._factor, handle.max / self._factor, self.value
        self._factor = factor
        plain = factor == 1.0
        handle.step, handle.precision = (
            (STEP, DECIMALS) if plain else (STEP_DEGREES, DECIMALS_DEGREES)
        )
        self.between(low, high)
        handle.hint, self.value = self._units.text(self._hint), value


def _in_degrees(found: re.Match[str]) -> str:
    numbers, milli = found[0].removesuffix(f" {found[1]}"), found[1] == "mrad"
    return f"{_EACH.sub(lambda one: _degrees(one[0], milli), numbers)} deg"


def _degrees(number: str, milli: bool) -> str:
    """Write an angle in rad, or mrad, in degrees with about the resolution that it had."""
    mantissa, _, power = number.lower().partition("e")
    decimals = len(mantissa.partition(".")[2]) - int(power or 0)
    value = math.degrees(float(number)) * (1e-3 if milli else 1.0)
    kept = max(decimals - 2, 1) + (3 if milli else 0)
    # Adding 0 makes -0 a plain 0.
    sign = "+" if number.startswith("+") else ""
    return f"{round(value, kept) + 0.0:{sign}.{kept}f}"
