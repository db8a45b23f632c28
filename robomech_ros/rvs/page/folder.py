"""A folder of controls in one browser."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

from robomech_ros.rvs.page.units import AngleSlider, Units, UnitText
from robomech_ros.spatial.arrays import as_choice, as_flag


class Folder:
    """A folder of the page with its controls, each with an action.

    - ``order``: position among the folders of the page.
    - ``expanded``: whether the folder is open at first.
    - ``ask``: hands the action of a control, by its label, to another thread; by default it runs on
      the thread of the server.

    Actions of checkboxes and choices get checked values; others raise a BadValueError.
    """

    def __init__(
        self,
        gui: Any,
        units: Units,
        label: str,
        order: float,
        *,
        expanded: bool = False,
        ask: Callable[..., None] = lambda label, change, *values: change(*values),
    ) -> None:
        self._gui, self._units, self._ask = gui, units, ask
        self._folder = gui.add_folder(label, order=order, expand_by_default=expanded)
        self._handles: list[Any] = []
        self._boxes: dict[str, Any] = {}
        self.removed = False

    def __enter__(self) -> Folder:
        self._folder.__enter__()
        return self

    def __exit__(self, *raised: object) -> None:
        self._folder.__exit__(*raised)

    def text(self) -> UnitText:
        """Add HTML, empty at first, whose angles are in the unit of the page."""
        handle = self._units.html(self._gui)
        self._handles.append(handle)
        return handle

    def slider(
        self,
        label: str,
        unit: str,
        ends: tuple[float, float],
        value: float,
        changed: Callable[[Any], None],
        hint: str = "",
    ) -> AngleSlider:
        """Add a slider for a value of a unit between two ends; its changes are in this unit."""
        slider = self._units.slider(self._gui, label, unit, ends, value, hint or f"{unit}")
        self.listen(slider, partial(self._ask, label, changed))
        return slider

    def checkbox(
        self, label: str, checked: bool, changed: Callable[[Any], None], hint: str | None = None
    ) -> Any:
        """Add a checkbox."""
        box = self._boxes[label] = self._gui.add_checkbox(label, checked, hint=hint)
        change = partial(self._ask, label, lambda value: changed(as_flag(label, value)))
        return self.listen(box, change)

    def dropdown(
        self,
        label: str,
        options: Sequence[str],
        chosen: str,
        changed: Callable[[Any], None],
        hint: str | None = None,
    ) -> Any:
        """Add a choice between options."""
        handle = self._gui.add_dropdown(label, options, initial_value=chosen, hint=hint)

        def change(value: Any) -> None:
            changed(as_choice(label.lower(), value, handle.options))

        return self.listen(handle, partial(self._ask, label, change))

    def mark(self, label: str, checked: bool) -> None:
        """Mark a checkbox, of which something else was the switch."""
        if not self.removed:
            self._boxes[label].value = checked

    def listen(self, handle: Any, changed: Callable[[Any], None]) -> Any:
        """Keep a control; the value that the page gives it is handed on."""
        self._handles.append(handle)

        @handle.on_update
        async def _(event: Any) -> None:
            if event.client is not None:
                changed(handle.value)

        return handle

    def button(self, label: str, pressed: Callable[[], None], hint: str | None = None) -> Any:
        """Add a button."""
        handle = self._gui.add_button(label, hint=hint)
        self._handles.append(handle)

        @handle.on_click
        async def _(_: Any) -> None:
            self._ask(label, pressed)

        return handle

    def remove(self) -> None:
        """Take it from the browser, with what is in it."""
        self.removed = True
        for handle in reversed(self._handles):
            handle.remove()
        self._folder.remove()
