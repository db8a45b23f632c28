"""The folders of the browser that commands a hand: what is held, and where it is touched."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

from robomech_ros.hands.contacts import MODELS
from robomech_ros.rvs.model.hands.grasped_object import SHAPES
from robomech_ros.rvs.model.hands.hand_view import SPOT
from robomech_ros.rvs.page.fact_table import fact_table
from robomech_ros.rvs.page.folder import Folder
from robomech_ros.rvs.page.units import Units

# Among the folders; step of the numbers of a load.
ORDER, LOAD_STEP = 3.5, 0.1
MODEL_HINT = "frictionless, with friction, or soft: with a moment about the normal, too"
# Of sliders from 0: the greatest value, and what it is.
SHARES = {
    "friction": (2.0, "Largest tangential force as a share of the normal force"),
    "torsional": (0.1, "m: largest moment of a soft finger for 1 N of normal force"),
}
LOADS = {
    "force": (slice(3, 6), "N, on the object at its centre, in the axes of the palm"),
    "moment": (slice(0, 3), "N m, on the object about its centre, in the axes of the palm"),
}


class HandControls:
    """The folders "Grasp" and "Contacts" of one browser.

    Parameters
    ----------
    gui : viser.GuiApi
    units : Units
    layer : HandLayer
    """

    def __init__(self, gui: Any, units: Units, layer: Any) -> None:
        self._grasp = Folder(gui, units, "Grasp", ORDER, expanded=True)
        with self._grasp:
            self._table = self._grasp.text()
            self._add_object(gui, layer)
            for part in layer.on:
                layer.switches.add_to(self._grasp, part)
        self._contacts = Folder(gui, units, "Contacts", ORDER + 0.1)
        with self._contacts:
            for k, name in enumerate(layer.hand.hand.finger_names):
                self._add_spot(layer, k, name)

    def write(self, lines: Sequence[tuple[str, str]]) -> None:
        """Show what is known."""
        if not self._grasp.removed:
            self._table.content = fact_table("grasp", lines)

    def remove(self) -> None:
        """Take the folders from the browser."""
        self._contacts.remove()
        self._grasp.remove()

    def _add_object(self, gui: Any, layer: Any) -> None:
        hand, listen = layer.hand, self._grasp.listen
        shape = gui.add_dropdown("shape", SHAPES, initial_value=hand.held.shape)
        listen(shape, layer.choose_shape)
        hint = "m: radius of a ball or cylinder, half the side of a box"
        self._grasp.slider("size", "m", hand.sizes, hand.held.size, layer.choose_size, hint)
        model = gui.add_dropdown("contacts", MODELS, initial_value=hand.model, hint=MODEL_HINT)
        listen(model, partial(layer.choose_contact, "model"))
        for name, (most, hint) in SHARES.items():
            choose, value = partial(layer.choose_contact, name), getattr(hand, name)
            self._grasp.slider(name, "", (0.0, most), value, choose, hint)
        for name, (part, hint) in LOADS.items():
            value = gui.add_vector3(name, hand.load[part].tolist(), step=LOAD_STEP, hint=hint)
            listen(value, partial(layer.choose_load, name))

    def _add_spot(self, layer: Any, finger: int, name: str) -> None:
        spot, choose = layer.hand.spots[finger], partial(layer.choose_spot, finger)
        self._contacts.checkbox(f"{name} touches", spot.touches, partial(choose, "touches"))
        for what, (low, high, unit) in SPOT.items():
            label = f"{name} {what}"
            value = getattr(spot, what)
            self._contacts.slider(label, unit, (low, high), value, partial(choose, what))
