"""A hand that holds an object: its contacts, what they hold, and with what forces."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from robomech_ros.errors import BadValueError, RobomechError
from robomech_ros.hands.contacts import MODELS
from robomech_ros.numerics.arrays import finite_number
from robomech_ros.rvs.layers.hand_scene import HandScene
from robomech_ros.rvs.model.hands.grasp import Grasp, Line, quality_line, study_grasp
from robomech_ros.rvs.model.hands.grasped_object import SHAPES
from robomech_ros.rvs.model.hands.hand_view import SPOT, HandView
from robomech_ros.rvs.page.clients import AllControls, Controls
from robomech_ros.rvs.page.folder import Folder
from robomech_ros.rvs.page.layer import Layer, LayerContext
from robomech_ros.rvs.page.switches import Switches
from robomech_ros.rvs.page.tables import fact_table
from robomech_ros.spatial.arrays import as_choice, as_finite, as_flag

# Greatest force and moment of a load that is asked for (N, N m).
MOST_LOAD = 1000.0
# What can be shown, by its label.
PARTS = ("object", "cones", "forces")
# Step of the numbers of a load.
LOAD_STEP = 0.1
SIZE_HINT = "m: radius of a ball or cylinder, half the side of a box"
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


class HandLayer(Layer):
    """The layer; the quality is found on a thread of its own, and of each grasp the latest."""

    label, order, expanded = "Grasp", 3.5, True

    def __init__(self, place: LayerContext) -> None:
        if not isinstance(place.moved, HandView):
            raise TypeError("the page shows no hand")
        super().__init__(place)
        self.hand = place.moved
        self._scene = HandScene(place.server.scene, place.base, place.seen.reach)
        self.on = dict.fromkeys(PARTS, True)
        self._studied: object = None
        self._lines: tuple[Line, ...] = ()
        self._separates = False
        self._quality: Line = ("quality", "looking ...")
        self._switches = Switches(place, {part: part for part in PARTS}, self.on)
        self.show()

    def show(self) -> None:
        """Follow the hand and its object."""
        grasp, now = self.hand.grasp, self.hand.state
        if now != self._studied:
            self._studied = now
            study = study_grasp(grasp)
            self._lines, self._separates = study.lines, study.separating is not None
            self._quality = ("quality", "looking ...")
            self._scene.draw(self.hand, study)
            self.find("quality", partial(_quality, grasp), partial(self._know, now))
        self._scene.switch(self.on)
        if self.is_open:
            closure, *rest = self._lines
            lines = [closure, self._quality, *rest, *self._legend()]
            self._table.content = fact_table("grasp", lines)

    def controls(self, client: Any) -> Controls:
        """Give a browser the folders "Grasp" and "Contacts"."""
        grasp = super().controls(client)
        self._contacts = self._add_folder(client.gui, "Contacts", self.order + 0.1)
        with self._contacts:
            for k, name in enumerate(self.hand.hand.finger_names):
                self._add_spot(self._contacts, k, name)
        return AllControls([grasp, self._contacts])

    def _fill(self, folder: Folder, gui: Any) -> None:
        hand, choose = self.hand, self._choose_contact
        self._table = folder.text()
        folder.dropdown("shape", SHAPES, hand.held.shape, self._choose_shape)
        folder.slider("size", "m", hand.sizes, hand.held.size, self._choose_size, SIZE_HINT)
        folder.dropdown("contacts", MODELS, hand.model, partial(choose, "model"), MODEL_HINT)
        for name, (most, hint) in SHARES.items():
            folder.slider(name, "", (0.0, most), getattr(hand, name), partial(choose, name), hint)
        for name, (rows, hint) in LOADS.items():
            field = gui.add_vector3(name, hand.load[rows].tolist(), step=LOAD_STEP, hint=hint)
            folder.listen(field, partial(self.ask, name, self._choose_load, name))
        for part in self.on:
            self._switches.add_to(folder, part)

    def _add_spot(self, folder: Folder, finger: int, name: str) -> None:
        spot, choose = self.hand.spots[finger], partial(self._choose_spot, finger)
        folder.checkbox(f"{name} touches", spot.touches, partial(choose, "touches"))
        for what, (low, high, unit) in SPOT.items():
            value, change = getattr(spot, what), partial(choose, what)
            folder.slider(f"{name} {what}", unit, (low, high), value, change)

    # What browsers ask for, on the thread of the page.

    def _choose_shape(self, value: Any) -> None:
        self.hand.held = replace(self.hand.held, shape=as_choice("object", value, SHAPES))
        self.hand.touch()

    def _choose_size(self, value: Any) -> None:
        size = _between("size", value, (*self.hand.sizes, "m"))
        self.hand.held = replace(self.hand.held, size=size)
        self.hand.touch()

    def _choose_contact(self, name: str, value: Any) -> None:
        hand = self.hand
        given = {"model": hand.model, "friction": hand.friction, "torsional": hand.torsional}
        contact = replace(hand.contact(0), **{**given, name: value})
        setattr(hand, name, getattr(contact, name))
        hand.touch()

    def _choose_load(self, name: str, value: Any) -> None:
        """Change the "force" (N) or the "moment" (N m) of the load."""
        given = as_finite(name, value, (3,))
        if given.shape != (3,) or np.abs(given).max() > MOST_LOAD:
            raise BadValueError(name, value, f"three numbers up to {MOST_LOAD:g}")
        self.hand.load[LOADS[name][0]] = given

    def _choose_spot(self, finger: int, name: str, value: Any) -> None:
        new: Any = as_flag(name, value) if name == "touches" else _between(name, value, SPOT[name])
        self.hand.spots[finger] = replace(self.hand.spots[finger], **{name: new})
        self.hand.touch()

    # What happens inside.

    def _know(self, key: object, line: Line) -> None:
        if key == self._studied:
            self._quality = line

    def _legend(self) -> list[Line]:
        if not self.on["forces"]:
            return []
        if self._separates:
            return [("arrows", "orange: the load; red along, purple about: what is not held")]
        return [("arrows", "green: what fingers exert; orange: the load")]


def _quality(grasp: Grasp) -> Line:
    try:
        return quality_line(grasp)
    except RobomechError as error:
        return ("quality", str(error))


def _between(what: str, value: Any, travel: tuple[float, float, str]) -> float:
    low, high, unit = travel
    given = finite_number(what, value, unit)
    if not low <= given <= high:
        raise BadValueError(what, value, f"{low:g} to {high:g} {unit}")
    return given
